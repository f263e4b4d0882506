"""Where capacity curves with elastic ties begin: drawn corners and buildings with a bar across the push, and a vaulted chapel.

    PYTHONPATH=tests python benchmarks/tied_curves.py chapel $(seq -f "corner-%g" 1 20)
    PYTHONPATH=tests python benchmarks/tied_curves.py building-3 building-7 building-16 building-25 building-34 building-43

Names: `random_corner` and `random_building` of `tests/models.py` with their seeds; the bar is its `bar_across`. The chapel
is the sample case with a higher ridge, a barrel over its nave and two bars below it.
"""

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import churchpipe as cp
from models import bar_across, random_building, random_corner

DRAWN = {"corner": random_corner, "building": random_building}
SAMPLE = Path(__file__).parents[1] / "pipeline/cases/chapel.toml"
BARREL = """
[[source.vaults]]
over = "nave"
kind = "barrel"
thickness_m = 0.3
courses = 27
stone_length_m = 0.6
"""
BAR = """
[[ties]]
name = "bar {along:g}"
start = {{ wall = "nave_left", along_m = {along:g}, height_m = 4.5 }}
end = {{ wall = "nave_right", along_m = {along:g}, height_m = 4.5 }}
area_mm2 = 400
steel_strength_MPa = 235
"""


def chapel() -> tuple[cp.Assemblage, cp.Contacts, float, cp.LoadCase, list[cp.Tie]]:
    """Return stones, contacts, friction, load and ties of the vaulted chapel, pushed across."""
    text = SAMPLE.read_text().replace("ridge_m = 7.2", "ridge_m = 8.0") + BARREL
    with TemporaryDirectory() as folder:
        path = Path(folder) / "chapel.toml"
        path.write_text(text + "".join(BAR.format(along=along) for along in (3.0, 6.0)))
        case = cp.read_case(path)
    stones = cp.derive_blocks(case.building())
    return stones, cp.find_contacts(stones), 0.6, cp.LoadCase((1, 0, 0)), cp.place_ties(stones, case.carries.ties)


def row(name: str) -> str:
    """Return a row of the table."""
    kind, _, seed = name.partition("-")
    if kind == "chapel":
        stones, contacts, friction, load, ties = chapel()
    else:
        stones, contacts, friction, load = DRAWN[kind](int(seed))
        ties = [bar_across(stones, load)]
    made = {
        key: cp.limit_analysis(stones, contacts, load, friction, flow=flow, ties=ties)
        for key, flow in (("state", "associative"), ("sliding", "non-associative"))
    }
    curve = cp.block_pushover(stones, contacts, load, friction, ties, **made, steps=4)
    share = made["sliding"].tie_forces.max() / stones.weight.sum()
    factors = " | ".join(f"{found.load_factor:.4f}" for found in made.values())
    follows = ", ".join(f"{value:.4f}" for value in curve.load_factor[:3])
    return f"| {name} | {stones.count} | {factors} | {share:.1g} | {follows} |"


def main() -> None:
    """Print a row for each name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+")
    print("| drawn | stones | associative | without dilatancy | largest tension, weights | first three steps of the curve |")
    print("|---|---|---|---|---|---|", flush=True)
    for name in parser.parse_args().names:
        print(row(name), flush=True)


if __name__ == "__main__":
    main()
