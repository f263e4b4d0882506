"""Contacts of imprecise stones against those of exact ones, and the time that 5000 stones take.

PYTHONPATH=tests python benchmarks/contacts.py --seeds 20 --solved 5
"""

import argparse
from time import process_time

import numpy as np

from churchpipe.config.case import read_case
from churchpipe.dxf.reading import Reading
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOUCHING
from churchpipe.model.loads import LoadCase
from churchpipe.resources import pipeline_folder
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.coplanar import coplanar_interfaces
from churchpipe.stones.ground import level_supports
from churchpipe.stones.mortar import close_joints
from imprecise import FIRST_SEED, MODELS, changes, corner, joined_pairs, noisy, shaken, two_leaves

FRICTION = 0.7


def accuracy(name: str, seeds: int, solved: int) -> None:
    """Print a row for each change of a model."""
    stones = MODELS[name]()
    exact = find_contacts(stones)
    pairs, push = joined_pairs(exact.blocks.tolist()), LoadCase((1, 0, 0))
    factor = limit_analysis(stones, exact, push, FRICTION).load_factor
    for words, made in changes(stones, seeds):
        lost = named = false = points = 0
        factors: list[float] = []
        for number, changed in enumerate(made):
            found = find_contacts(changed)
            mine, near = joined_pairs(found.blocks.tolist()), joined_pairs(found.near_misses.stones.tolist())
            lost, named, false = lost + len(pairs - mine), named + len((pairs - mine) & near), false + len(mine - pairs)
            points += len(found.point)
            if number < solved:
                factors.append(limit_analysis(changed, found, push, FRICTION).load_factor)
        cells = [name, words, f"{lost} of {len(pairs) * len(made)}", named, false, f"{points / len(made) / len(exact.point):.3f}"]
        spread = f"{min(factors):.6f} to {max(factors):.6f}" if len(factors) > 1 else f"{factors[0]:.6f}"
        print("| " + " | ".join(map(str, cells)) + f" | {factor:.6f} | {spread} |", flush=True)


def open_joints() -> None:
    """Print what becomes of head joints that are open on purpose."""
    print("\n| head joints of the corner open by | joints | near misses | with that contact gap asked for |\n|---|---|---|---|")
    for gap in (1e-5, 1e-4, 1e-3, 3e-3, 5e-3, 1e-2, 2e-2):
        stones = corner(head_gap=gap)
        found, asked = find_contacts(stones), find_contacts(stones, contact_gap=gap)
        print(f"| {1e3 * gap:g} mm | {len(found.blocks)} | {len(found.near_misses)} | {len(asked.blocks)} |")


def grown(seeds: int, solved: int) -> None:
    """Print what becomes of two leaves of bricks that grow into their mortar of 10 mm."""
    print(
        "\n| two leaves, noise | joints lost | of them near misses | false joints | load factor across | without a least width |"
    )
    print("|---|---|---|---|---|---|")
    joint, across = 0.01, LoadCase((0, 1, 0))
    tolerances = Reading(joint=joint).tolerances({})
    pairs: set[tuple[int, int]] = set()
    for noise in (0.0, 1e-6, 1e-5, 1e-4, 5e-4, 1e-3, 2e-3):
        lost = named = false = 0
        factors: list[list[float]] = [[], []]
        for seed in range(FIRST_SEED, FIRST_SEED + (seeds if noise else 1)):
            solids = close_joints(shaken(two_leaves(joint), noise, seed), joint).solids
            feet = level_supports(solids)[0]
            supports = range(len(solids), len(solids) + len(feet))
            stones = Assemblage.from_polyhedra([*solids, *feet], 18e3, fixed=supports)
            found = find_contacts(stones, **tolerances)
            mine, near = (
                {pair for pair in joined_pairs(blocks.tolist()) if max(pair) < len(solids)}
                for blocks in (found.blocks, found.near_misses.stones)
            )
            pairs = pairs or mine
            lost, named, false = lost + len(pairs - mine), named + len((pairs - mine) & near), false + len(mine - pairs)
            if seed < FIRST_SEED + solved:
                for row, contacts in zip(factors, (found, find_contacts(stones)), strict=True):
                    row.append(limit_analysis(stones, contacts, across, FRICTION).load_factor)
        spread = " | ".join(f"{min(row):.4f} to {max(row):.4f}" for row in factors)
        print(
            f"| {1e3 * noise:g} mm | {lost} of {len(pairs) * (seeds if noise else 1)} | {named} | {false} | {spread} |",
            flush=True,
        )


def times() -> None:
    """Print the time of the church, 5916 stones and the ground, beside that of the joints in one plane alone."""
    print("\n| church, 5916 stones and the ground | faces | joints | processor s | joints in one plane alone, s |")
    print("|---|---|---|---|---|")
    stones = derive_blocks(read_case(pipeline_folder() / "cases" / "church.toml").building())
    for words, changed in (("exact", stones), ("triangles, noise .1 mm", noisy(stones, 1e-4, FIRST_SEED))):
        find_contacts(stones)
        begin = process_time()
        found = find_contacts(changed)
        taken = process_time() - begin
        begin = process_time()
        coplanar_interfaces(changed, np.ones(len(changed.face_ptr) - 1, dtype=np.bool_), TOUCHING)
        alone = process_time() - begin
        print(f"| {words} | {len(changed.face_ptr) - 1} | {len(found.blocks)} | {taken:.2f} | {alone:.2f} |")


def main() -> None:
    """Print the tables of docs/contacts.md, the first of them whole as in docs/development.md."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--models", nargs="+", default=list(MODELS), choices=list(MODELS))
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--solved", type=int, default=5)
    arguments = parser.parse_args()
    print("| model | change | joints lost | of them near misses | false joints | points | exact load factor | load factor |")
    print("|---|---|---|---|---|---|---|---|")
    for name in arguments.models:
        accuracy(name, arguments.seeds, arguments.solved)
    open_joints()
    grown(arguments.seeds, arguments.solved)
    times()


if __name__ == "__main__":
    main()
