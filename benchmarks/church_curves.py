"""Capacity curves of the church for its seven loads, reduced and in full, as a table for docs/capacity_curve.md.

    python benchmarks/church_curves.py --processes 2 [--full] [-- LOAD ...]                  # all loads, or those named in order
    python benchmarks/church_curves.py --case chapel --halo 2 --step 0.02 --steps 12 -- -y   # another model, halo, step
    python benchmarks/church_curves.py --halved -- +x -x +y "tower +x"                       # and what half the step changes
    python benchmarks/church_curves.py --sliding --steps 5 -- +x -y "tower +x"               # from the analysis without dilatancy

Reduced: the stones that move with their halo. --full: all stones. Seconds are processor time of one thread, without the
analyses of the whole model, which a run of a case hands on. The last line says how long all took by the clock; the load that
moves most stones is begun first.
"""

import argparse
import os
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

# One thread each: before a library starts more.
os.environ.update(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")

import numpy as np

import churchpipe as cp

# Stones that are faster than this share of the fastest move.
MOVING = 1e-3
FRICTION = 0.6


def analysed(case_name: str, name: str, sliding: bool) -> tuple[dict[str, cp.LimitState], float]:
    """Return the analyses of a load, the associative one and, from the centre, that without dilatancy, and their seconds."""
    stones, contacts, load = pushed(case_name, name)
    begin = time.process_time()
    found = {"state": cp.limit_analysis(stones, contacts, load, FRICTION)}
    if sliding:
        found["sliding"] = cp.limit_analysis(stones, contacts, load, FRICTION, flow="non-associative", start="centre")
    return found, time.process_time() - begin


def row(options: argparse.Namespace, name: str, made: dict[str, cp.LimitState]) -> tuple[str, float]:
    """Follow a load from its analyses, and return a row of the table and its seconds."""
    stones, contacts, load = pushed(options.case, name)
    begin = time.process_time()
    halo = 0 if options.full else options.halo
    curve = cp.block_pushover(stones, contacts, load, FRICTION, step=options.step, steps=options.steps, halo=halo, **made)
    seconds = time.process_time() - begin
    half = ""
    if options.halved:
        shorter = {"step": 0.5 * options.step, "steps": 2 * options.steps, "halo": halo}
        half = "\n" + apart(curve, cp.block_pushover(stones, contacts, load, FRICTION, **shorter, **made))
    fallen, unproved = sum(len(part.stones) for part in curve.fallen), int((curve.misfit > 0.01).sum())
    text = (
        f"| {name} | {curve.initial:.4f} | {len(curve.load_factor)} | {curve.largest[-1]:.3f} | {curve.load_factor[-1]:.4f}"
        f" | {curve.misfit.max():.1e} | {unproved} | {fallen} | {curve.status} | {seconds:.0f} |"
    )
    return text + half, seconds


def apart(curve: cp.BlockCapacityCurve, other: cp.BlockCapacityCurve) -> str:
    """Say how far two curves are apart at most, until the first one has gone so far, and on average: over its first load factor.

    And by how much the work differs that they take up, the areas below them.
    """
    way = np.linspace(0.0, min(curve.displacement[-1], other.displacement[-1]), 400)
    one, two = (np.interp(way, each.displacement, each.load_factor) for each in (curve, other))
    share, gone = np.abs(one - two) / curve.load_factor[0], np.interp(way, curve.displacement, curve.largest)
    until = [*np.arange(0.1, gone[-1], 0.1), gone[-1]]
    most = ", ".join(f"{100 * share[gone <= end].max():.2g} % until {end:.2f} m" for end in until)
    return f"half the step: {most}; {100 * share.mean():.2g} % on average, work {100 * (two.sum() / one.sum() - 1):+.2g} %"


def pushed(case_name: str, name: str) -> tuple[cp.Assemblage, cp.Contacts, cp.LoadCase]:
    """Return the stones of a sample case, their contacts and a load."""
    case = cp.read_case(f"pipeline/cases/{case_name}.toml")
    stones = cp.derive_blocks(case.building())
    return stones, cp.find_contacts(stones), next(load for load in case.loads if load.name == name)


def moving(state: cp.LimitState) -> int:
    """Return how many stones move in an analysis."""
    speed = np.linalg.norm(state.velocities[:, :3], axis=1)
    return int((speed > MOVING * speed.max()).sum())


def main() -> None:
    """Print a row of the table for each load, so many at a time, in the order in which they are named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", default="church", help="a sample case")
    parser.add_argument("--full", action="store_true", help="follow all stones")
    parser.add_argument("--sliding", action="store_true", help="hand on the analysis without dilatancy as well")
    parser.add_argument("--halved", action="store_true", help="follow each load with half the step as well, and compare")
    parser.add_argument("--halo", type=int, default=5, help="contacts from a moving stone to those held still")
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--step", type=float, default=0.04, help="m")
    parser.add_argument("--processes", type=int, default=1, help="loads that are followed at a time")
    parser.add_argument("loads", nargs="*")
    options = parser.parse_args()
    loads = options.loads or [load.name for load in cp.read_case(f"pipeline/cases/{options.case}.toml").loads]
    print("| load | starts at | steps | largest, m | load factor there | largest misfit | unproved | fallen | ends | seconds |")
    print("|---|---|---|---|---|---|---|---|---|---|", flush=True)
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        states, before = zip(*pool.map(analysed, [options.case] * len(loads), loads, [options.sliding] * len(loads)), strict=True)
        start, spent = time.perf_counter(), 0.0
        longest_first = sorted(range(len(loads)), key=lambda load: -moving(states[load]["state"]))
        rows = {load: pool.submit(row, options, loads[load], states[load]) for load in longest_first}
        for load in range(len(loads)):
            text, seconds = rows[load].result()
            print(text, flush=True)
            spent += seconds
    clock = time.perf_counter() - start
    print(f"{clock:.0f} s by the clock, {spent:.0f} s of processor time; analyses before: {sum(before):.0f} s")


if __name__ == "__main__":
    main()
