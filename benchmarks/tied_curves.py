"""Where capacity curves with an elastic tie begin: drawn corners and buildings with a bar across the push.

    PYTHONPATH=tests python benchmarks/tied_curves.py $(seq -f "corner-%g" 1 12)
    PYTHONPATH=tests python benchmarks/tied_curves.py building-3 building-7 building-16 building-25 building-34 building-43

Names: `random_corner` and `random_building` of `tests/models.py` with their seeds; the bar is its `bar_across`.
"""

import argparse

import churchpipe as cp
from models import bar_across, random_building, random_corner

DRAWN = {"corner": random_corner, "building": random_building}


def row(name: str) -> str:
    """Return a row of the table."""
    kind, _, seed = name.partition("-")
    stones, contacts, friction, load = DRAWN[kind](int(seed))
    ties = [bar_across(stones, load)]
    made = {
        key: cp.limit_analysis(stones, contacts, load, friction, flow=flow, ties=ties)
        for key, flow in (("state", "associative"), ("sliding", "non-associative"))
    }
    curve = cp.block_pushover(stones, contacts, load, friction, ties, **made, steps=4)
    share = made["sliding"].tie_forces[0] / stones.weight.sum()
    factors = " | ".join(f"{found.load_factor:.4f}" for found in made.values())
    follows = ", ".join(f"{value:.4f}" for value in curve.load_factor[:3])
    return f"| {name} | {stones.count} | {factors} | {share:.1g} | {follows} |"


def main() -> None:
    """Print a row for each name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+")
    print("| drawn | stones | associative | without dilatancy | its tension, weights | first three steps of the curve |")
    print("|---|---|---|---|---|---|", flush=True)
    for name in parser.parse_args().names:
        print(row(name), flush=True)


if __name__ == "__main__":
    main()
