"""What capacity curves owe to their steps: drawn corners and buildings, each with whole steps and with half of them.

    PYTHONPATH=tests python benchmarks/curve_steps.py $(seq -f "corner-%g" 1 12)
    PYTHONPATH=tests python benchmarks/curve_steps.py building-3 building-8 building-16 building-17 building-25 building-26

Names: `random_corner` and `random_building` of `tests/models.py` with their seeds. Seconds are processor time, of both curves and
the analyses before them.
"""

import argparse
from time import process_time

import numpy as np

import churchpipe as cp
from churchpipe.model.block_curve import step_difference
from models import random_building, random_corner

DRAWN = {"corner": random_corner, "building": random_building}


def row(name: str) -> str:
    """Return a row of the table."""
    kind, _, seed = name.partition("-")
    stones, contacts, friction, load = DRAWN[kind](int(seed))
    begin = process_time()
    made = {
        key: cp.limit_analysis(stones, contacts, load, friction, flow=flow)
        for key, flow in (("state", "associative"), ("sliding", "non-associative"))
    }
    curves = [cp.block_pushover(stones, contacts, load, friction, **made, halved=halved) for halved in (False, True)]
    share, place = step_difference(*curves)
    ends = [curve.d0 if np.isfinite(curve.d0) else curve.displacement[-1] for curve in curves]
    told = " | ".join(
        f"{1e3 * end:.2f}, {curve.status} | {int((curve.misfit > 0.01).sum())} of {len(curve.misfit)}"
        for curve, end in zip(curves, ends, strict=True)
    )
    apart, seconds = f"{100 * share:.2g} % at {1e3 * place:.2f}", process_time() - begin
    return f"| {name} | {stones.count} | {friction} | {told} | {apart} | {seconds:.0f} |"


def main() -> None:
    """Print a row for each name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+")
    print("| drawn | stones | friction | ends at, mm | unproved | in half the step, mm | unproved | apart at most, mm | s |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for name in parser.parse_args().names:
        print(row(name), flush=True)


if __name__ == "__main__":
    main()
