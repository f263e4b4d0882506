"""The sample churches R14 and R: counts, load factors and their sensitivity, as a table for docs/church.md.

    python benchmarks/church.py [NAME ...]     # all variants, or those named

Each variant is solved for its loads (associative); times are processor time.
"""

import sys
import time
from dataclasses import dataclass, field

import churchpipe as cp

TOWER = ("tower_front", "tower_back", "tower_outer", "tower_inner")
LOADS = {
    "+x": cp.LoadCase((1, 0, 0)),
    "-x": cp.LoadCase((-1, 0, 0)),
    "+y": cp.LoadCase((0, 1, 0)),
    "-y": cp.LoadCase((0, -1, 0)),
    "tower +x": cp.LoadCase((1, 0, 0), name="tower +x", panels=TOWER),
}
MAIN = ("+x", "-y")


@dataclass(frozen=True)
class Variant:
    """A case with changes, and the loads it is solved for."""

    case: str
    loads: tuple[str, ...] = MAIN
    friction: float = 0.6
    changes: tuple[str, ...] = field(default=())


VARIANTS = {
    "R14": Variant("church", tuple(LOADS)),
    "R": Variant("church_r", tuple(LOADS)),
    "R half stones": Variant("church_half_stones", ("+x",)),
    "R14 y first": Variant("church", changes=("source.first_course=y",)),
    "R y first": Variant("church_r", changes=("source.first_course=y",)),
    "R mu .5": Variant("church_r", friction=0.5),
    "R mu .7": Variant("church_r", friction=0.7),
    "R b .46": Variant("church_r", changes=("source.stone_length_m=0.46",)),
    "R b .70": Variant("church_r", changes=("source.stone_length_m=0.70",)),
    "R rose .9": Variant("church_r", ("+x",), changes=("source.openings.1.width_m=1.8",)),
    "R eaves 9.9": Variant("church_r", ("-y",), changes=("source.nave.height_m=9.9",)),
    "R eaves 12.1": Variant("church_r", ("-y",), changes=("source.nave.height_m=12.1",)),
}


def main(names: list[str]) -> None:
    """Solve the variants and print a row of the table for each load."""
    print("| variant | stones | points | kN | load | load factor | seconds |\n|---|---|---|---|---|---|---|")
    for name in names or VARIANTS:
        variant = VARIANTS[name]
        stones = cp.derive_blocks(cp.read_case(f"pipeline/cases/{variant.case}.toml", variant.changes).building())
        contacts = cp.find_contacts(stones)
        free = ~stones.fixed
        sizes = f"{free.sum()} | {len(contacts.point)} | {stones.weight[free].sum() / 1e3:.0f}"
        for load in variant.loads:
            start = time.process_time()
            state = cp.limit_analysis(stones, contacts, LOADS[load], friction=variant.friction)
            seconds = time.process_time() - start
            note = "" if state.status == "optimal" else f" ({state.status})"
            print(f"| {name} | {sizes} | {load} | {state.load_factor:.4f}{note} | {seconds:.0f} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
