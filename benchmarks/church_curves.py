"""Capacity curves of the church for its seven loads, reduced and in full, as a table for docs/capacity_curve.md.

    python benchmarks/church_curves.py --processes 2 [--full] [-- LOAD ...]                  # all loads, or those named in order
    python benchmarks/church_curves.py --case chapel --halo 2 --step 0.02 --steps 12 -- -y   # another model, halo, step

Reduced: the stones that move with their halo. --full: all stones. The seconds of a row are processor time of one thread, without
the associative analysis of the whole model, which a run of a case hands on; the last line gives it, and how long all took by
the clock.
"""

import argparse
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

# One thread each: before a library starts more.
os.environ.update(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")

import churchpipe as cp

FRICTION = 0.6


def row(options: argparse.Namespace, name: str) -> tuple[str, float, float]:
    """Follow a load, and return a row of the table, the seconds of the curve and those of the analysis before it."""
    case = cp.read_case(f"pipeline/cases/{options.case}.toml")
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    load = next(load for load in case.loads if load.name == name)
    begin = time.process_time()
    state = cp.limit_analysis(stones, contacts, load, FRICTION)
    start = time.process_time()
    halo = 0 if options.full else options.halo
    curve = cp.block_pushover(stones, contacts, load, FRICTION, step=options.step, steps=options.steps, halo=halo, state=state)
    seconds = time.process_time() - start
    fallen, unproved = sum(len(part.stones) for part in curve.fallen), int((curve.misfit > 0.01).sum())
    text = (
        f"| {name} | {curve.initial:.4f} | {len(curve.load_factor)} | {curve.largest[-1]:.3f} | {curve.load_factor[-1]:.4f}"
        f" | {curve.misfit.max():.1e} | {unproved} | {fallen} | {curve.status} | {seconds:.0f} |"
    )
    return text, seconds, start - begin


def rows(options: argparse.Namespace) -> Iterator[tuple[str, float, float]]:
    """Follow the loads, so many at a time, in the order in which they are named."""
    loads = options.loads or [load.name for load in cp.read_case(f"pipeline/cases/{options.case}.toml").loads]
    if options.processes == 1:
        yield from (row(options, name) for name in loads)
        return
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        yield from pool.map(row, [options] * len(loads), loads)


def main() -> None:
    """Print a row of the table for each load."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", default="church", help="a sample case")
    parser.add_argument("--full", action="store_true", help="follow all stones")
    parser.add_argument("--halo", type=int, default=5, help="contacts from a moving stone to those held still")
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--step", type=float, default=0.04, help="m")
    parser.add_argument("--processes", type=int, default=1, help="loads that are followed at a time")
    parser.add_argument("loads", nargs="*")
    options = parser.parse_args()
    print("| load | starts at | steps | largest, m | load factor there | largest misfit | unproved | fallen | ends | seconds |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    start, spent, before = time.perf_counter(), 0.0, 0.0
    for text, seconds, analysis in rows(options):
        print(text, flush=True)
        spent, before = spent + seconds, before + analysis
    clock = time.perf_counter() - start
    print(f"{spent:.0f} s of processor time, {before:.0f} s of associative analyses before; {clock:.0f} s by the clock in all")


if __name__ == "__main__":
    main()
