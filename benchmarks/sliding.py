"""Sliding without dilatancy from the canonical dead-load start: value, gap and cost of box buildings and of the test models.

PYTHONPATH=tests python benchmarks/sliding.py wall1 S5 S5-swapped S22 1k 5k --gap 1e-5
"""

import argparse
from time import process_time
from typing import Any

from churchpipe.conic.solve import solver_for
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.coulomb import EXACT, dead_load_start
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.iterations import certified_iteration
from churchpipe.rigid_blocks.limit import associative_program, point_strength
from churchpipe.rigid_blocks.settings import SchemeSettings
from churchpipe.stones.contacts import find_contacts
from models import FACADES, FERRIS_TIN_LOI_LOAD, TILTING_LOADS, box_building, facade, ferris_tin_loi_wall, tilting_test


def problem(name: str) -> tuple[Any, Any]:
    """Return balance and strength of a model of tests/models.py."""
    if name.startswith("wall"):
        stones, load, friction = ferris_tin_loi_wall(int(name[4:])), FERRIS_TIN_LOI_LOAD, 0.65
        contacts = find_contacts(stones)
    elif name.startswith("S"):
        test, _, swapped = name.partition("-")
        stones, contacts = tilting_test(test, first_course="partitions" if swapped else "main")
        load, friction = TILTING_LOADS[test], 0.7
    elif name.partition("-")[0] in FACADES:
        shape, _, friction = name.partition("-")
        stones, contacts = facade(shape)
        load, friction = LoadCase((1, 0, 0)), float(friction)
    else:
        stones, contacts = box_building(name)
        load, friction = LoadCase((1, 0, 0)), 0.6
    balance = equilibrium(stones, contacts, load)
    return balance, point_strength(contacts, friction, 0.0, balance.force)


def main() -> None:
    """Print one row a model."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="+")
    parser.add_argument("--gap", type=float, default=1e-5)
    arguments = parser.parse_args()
    for name in arguments.models:
        balance, strength = problem(name)
        solve = solver_for(balance.wrenches)
        # Solved like the programs of the scheme, so that iterations of one kind are compared.
        associative = solve(associative_program(balance, strength), duality_gap=EXACT)
        begin = process_time()
        run = certified_iteration(balance, strength, dead_load_start(balance), solve, SchemeSettings(gap=arguments.gap))
        seconds = process_time() - begin
        if run is None:
            print(f"| {name} | no feasible step |")
            continue
        equivalent = f"{run.iterations / associative.iterations:.1f} ({associative.iterations})"
        cells = [name, f"{run.load_factor:.5f}", f"{run.gap / run.load_factor:.1e}", run.solves, run.iterations, equivalent]
        print("| " + " | ".join(map(str, cells)) + f" | {seconds:.0f} s |")


if __name__ == "__main__":
    main()
