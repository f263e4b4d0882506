"""The pictures and the table of docs/gallery.md: ready cases at collapse.

    python benchmarks/gallery.py [NAME ...]     # all, or the cases named; pictures go to docs/pictures/gallery

Associative, the named load of each case; one row of the table each.
"""

import sys
from pathlib import Path

import churchpipe as cp
from churchpipe.compare import safety, stone_parts
from churchpipe.report.figures import mechanism_picture
from churchpipe.stones.joints import joint_strength

FOLDER = Path("docs/pictures/gallery")
SIZE = (760, 560)
# Number of the load in the case file.
CASES = {
    "wall": 0,
    "arch": 0,
    "arch_piers": 0,
    "box": 0,
    "apse": 0,
    "apse_window": 0,
    "round_tower": 0,
    "thick_wall": 0,
    "tower": 0,
    "s5": 0,
    "s22": 0,
    "vault": 0,
    "dome": 0,
    "chapel": 0,
    "church": 0,
    "church_vaults": 0,
}


def main(names: list[str]) -> None:
    """Solve the cases, draw their mechanisms and print a row of the table for each."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    print("| case | stones | load | load factor | moves | e* | a0*, m/s2 |\n|---|---|---|---|---|---|---|")
    for name in names or CASES:
        case = cp.read_case(f"pipeline/cases/{name}.toml")
        load = case.loads[CASES[name]]
        stones = cp.derive_blocks(case.building())
        contacts = cp.find_contacts(stones)
        state = cp.limit_analysis(stones, contacts, load, *joint_strength(stones, contacts, case.materials))
        mechanism_picture(stones, state.velocities, FOLDER / f"{name}.png", load.direction, size=SIZE)
        check = safety(stones, state, load, case.check)
        parts = stone_parts(stones, state, load).get("parts", [])
        moving = ", ".join(f"{part.name} {part.motion:.2f}" for part in parts[:4] if part.motion >= 0.01)
        figures = f"{state.load_factor:.4f} | {moving} | {check.mass_fraction:.3f} | {check.a0:.3f}"
        print(f"| {name} | {(~stones.fixed).sum()} | {load.name} | {figures} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
