"""Sliding without dilatancy as one run from the centre: value, gap, cost and spread of test models, box buildings and facades.

    PYTHONPATH=tests python benchmarks/sliding.py wall1 S5 S5-swapped S22 1k 5k long-.4 storeys-.7 --starts 12
    PYTHONPATH=tests python benchmarks/sliding.py church+x church-y church-tower barrel
    PYTHONPATH=tests python benchmarks/sliding.py random-1 random-2 building-1 building-2
    PYTHONPATH=tests python benchmarks/sliding.py wall1 S5 S22 --search
    PYTHONPATH=tests python benchmarks/sliding.py box apse+y apse-y wall4 wall6 S5 S22 --whole --starts 12

With --search the sequence of programs from the dead-load forces instead. With --whole the analysis that names no start:
associative solve, both starts and interval. A disturbed start is the model with each dead load changed by a ten-millionth.
"""

import argparse
from dataclasses import replace
from time import process_time
from typing import Any

import numpy as np
from church import LOADS

import churchpipe as cp
from churchpipe.conic.solve import solver_for
from churchpipe.generators import vault
from churchpipe.model.loads import LoadCase
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.associative import associative_program
from churchpipe.rigid_blocks.central import from_centre
from churchpipe.rigid_blocks.coulomb import EXACT, dead_load_start
from churchpipe.rigid_blocks.equilibrium import Equilibrium, equilibrium
from churchpipe.rigid_blocks.iterations import SlidingRun, certified_iteration
from churchpipe.rigid_blocks.limit import analysed, point_strength
from churchpipe.rigid_blocks.settings import SchemeSettings
from churchpipe.rigid_blocks.sliding import SlidingOptions
from churchpipe.stones.contacts import find_contacts
from models import (
    FACADES,
    FERRIS_TIN_LOI_LOAD,
    TILTING_LOADS,
    box_building,
    facade,
    ferris_tin_loi_wall,
    random_building,
    random_facade,
    tilting_test,
)


def problem(name: str) -> tuple[Any, Any]:
    """Return balance and strength of a model of tests/models.py, of a sample case, or of a barrel of ten staggered rings."""
    if name.startswith("church"):
        stones = cp.derive_blocks(cp.read_case("pipeline/cases/church.toml").building())
        contacts = find_contacts(stones)
        load, friction = LOADS["tower +x" if name == "church-tower" else name.removeprefix("church")], 0.6
    elif name == "box" or name.startswith("apse"):
        stones = cp.derive_blocks(cp.read_case(f"pipeline/cases/{name[:4].rstrip('+-')}.toml").building())
        contacts = find_contacts(stones)
        load, friction = {"+y": LoadCase((0, 1, 0)), "-y": LoadCase((0, -1, 0))}.get(name[4:], LoadCase((1, 0, 0))), 0.6
    elif name == "barrel":
        stones = cp.derive_blocks(vault(span=1.85, thickness=0.15, length=2.5, courses=27, stone_length=0.25, laid="rings"))
        contacts = find_contacts(stones)
        load, friction = LoadCase((1, 0, 0)), 0.7
    elif name.startswith("wall"):
        stones, load, friction = ferris_tin_loi_wall(int(name[4:])), FERRIS_TIN_LOI_LOAD, 0.65
        contacts = find_contacts(stones)
    elif name.startswith("S"):
        test, _, swapped = name.partition("-")
        stones, contacts = tilting_test(test, first_course="partitions" if swapped else "main")
        load, friction = TILTING_LOADS[test], 0.7
    elif name.startswith("random-"):
        stones, contacts, friction = random_facade(int(name.removeprefix("random-")))
        load = LoadCase((1, 0, 0))
    elif name.startswith("building-"):
        stones, contacts, friction, load = random_building(int(name.removeprefix("building-")))
    elif name.partition("-")[0] in FACADES:
        shape, _, friction = name.partition("-")
        stones, contacts = facade(shape)
        load, friction = LoadCase((1, 0, 0)), float(friction)
    else:
        stones, contacts = box_building(name)
        load, friction = LoadCase((1, 0, 0)), 0.6
    balance = equilibrium(stones, contacts, load)
    return balance, point_strength(contacts, friction, 0.0, balance.force)


def otherwise(balance: Equilibrium, start: int) -> Equilibrium:
    """Return the balance with each dead load changed by a ten-millionth, by chance; as it is for start 0."""
    noise = np.random.default_rng(start).normal(scale=1e-7, size=len(balance.dead)) * (start > 0)
    return replace(balance, dead=balance.dead * (1.0 + noise))


def whole(models: list[str], starts: int) -> None:
    """Print one row a model: the analysis that names no start."""
    print("| model | associative | load factor, of which start | gap | interval | lowest found | processor s | spread |")
    print("|---|---|---|---|---|---|---|---|")
    for name in models:
        balance, strength = problem(name)
        solve = solver_for(balance.wrenches)
        begin = process_time()
        associative = solve(associative_program(balance, strength), duality_gap=EXACT)
        price = process_time() - begin
        found: list[LimitState] = []
        seconds: list[float] = []
        for start in range(starts):
            begin = process_time()
            options = SlidingOptions()
            found.append(analysed(otherwise(balance, start), strength, solve, "non-associative", options, None))
            seconds.append(process_time() - begin)
        first, factors = found[0], [state.load_factor for state in found]
        lead = next((run.start for run in first.starts if run.load_factor == first.load_factor), "")
        share, middle = first.gap / first.load_factor, sorted(seconds)[len(seconds) // 2]
        spread = f"{(max(factors) - min(factors)) / first.load_factor:.1e}" if len(found) > 1 else ""
        certified = sum(state.status == "converged" for state in found)
        cells = [
            name,
            f"{associative.tau:.5f}",
            f"{first.load_factor:.5f}, {lead}",
            f"{share:.1e} ({certified} of {starts} certified)",
        ]
        cells += ["{:.5f} .. {:.5f}".format(*first.interval), f"{min(first.fixed_points, default=np.nan):.5f}"]
        cells += [f"{middle:.1f} = {middle / price:.1f} x {price:.2f}", spread]
        print("| " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    """Print one row a model."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="+")
    parser.add_argument("--gap", type=float, default=1e-5)
    parser.add_argument("--starts", type=int, default=1)
    parser.add_argument("--search", action="store_true")
    parser.add_argument("--whole", action="store_true")
    arguments = parser.parse_args()
    if arguments.whole:
        whole(arguments.models, arguments.starts)
        return
    print("| model | associative | load factor | gap | factorisations | programs | associative solves | processor s | spread |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name in arguments.models:
        balance, strength = problem(name)
        solve = solver_for(balance.wrenches)
        # Solved like the programs of the search, so that iterations of one kind are compared.
        begin = process_time()
        associative = solve(associative_program(balance, strength), duality_gap=EXACT)
        price = process_time() - begin
        found: list[SlidingRun] = []
        seconds: list[float] = []
        for start in range(arguments.starts):
            disturbed = otherwise(balance, start)
            begin = process_time()
            if arguments.search:
                settings = SchemeSettings(bipotential_gap=arguments.gap)
                run = certified_iteration(disturbed, strength, dead_load_start(disturbed), solve, settings)
            else:
                run = from_centre(disturbed, strength, arguments.gap, solve)
            seconds.append(process_time() - begin)
            if run is not None:
                found.append(run)
        if not found:
            print(f"| {name} | {associative.tau:.5f} | nothing found |", flush=True)
            continue
        first, factors = found[0], [run.load_factor for run in found]
        costs = sorted(run.iterations / associative.iterations for run in found)
        solves = f"{costs[len(costs) // 2]:.1f} ({costs[0]:.1f} .. {costs[-1]:.1f})" if len(costs) > 1 else f"{costs[0]:.1f}"
        spread = f"{(max(factors) - min(factors)) / first.load_factor:.1e}" if len(found) > 1 else ""
        cells = [name, f"{associative.tau:.5f}", f"{first.load_factor:.5f}", f"{first.relative_gap:.1e}", first.iterations]
        cells += [first.solves, solves, f"{seconds[0]:.1f} = {seconds[0] / price:.1f} x {price:.1f}", spread]
        print("| " + " | ".join(map(str, cells)) + " |", flush=True)


if __name__ == "__main__":
    main()
