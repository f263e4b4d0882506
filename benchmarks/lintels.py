"""Sliding without dilatancy of drawn walls whose opening has a flat head and no lintel.

    PYTHONPATH=tests python benchmarks/lintels.py --walls 40

Length, width of the opening, height over it, friction and the direction of the load are drawn; every second wall is pushed
across. Seconds are processor time of both analyses.
"""

import argparse
from time import process_time

import numpy as np

import churchpipe as cp
from flat_heads import flat_headed_wall


def row(number: int, rng: np.random.Generator) -> str:
    """Return a row of the table."""
    top, width = float(rng.choice([2.25, 2.5, 2.75, 3.0])), round(float(rng.uniform(0.8, 1.8)), 2)
    length, friction = round(float(rng.uniform(4, 7)), 2), round(float(rng.uniform(0.4, 0.8)), 2)
    angle = 0.5 * np.pi if number % 2 else float(rng.uniform(0, 2 * np.pi))
    stones, contacts = flat_headed_wall(top, width, length)
    load, begin = cp.LoadCase((np.cos(angle), np.sin(angle), 0.0)), process_time()
    drawn = f"{number} | {length} x {top}, opening {width} | {friction} | {np.degrees(angle):.0f}"
    associative = cp.limit_analysis(stones, contacts, load, friction)
    if associative.status != "optimal":
        return f"| {drawn} | {associative.status} | | | |"
    found = cp.limit_analysis(stones, contacts, load, friction, flow="non-associative")
    starts = ", ".join(f"{run.start} {run.load_factor:.4f}" for run in found.starts)
    told = f"{found.load_factor:.4f}, {found.status}, {found.interval[0]:.4f} to {found.interval[1]:.4f}"
    return f"| {drawn} | {associative.load_factor:.4f} | {told} | {starts} | {process_time() - begin:.1f} |"


def main() -> None:
    """Print a row for each wall."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--walls", type=int, default=40)
    rng = np.random.default_rng(7)
    print("| wall | m | friction | pushed at, degrees | associative | without dilatancy, interval | starts | s |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for number in range(parser.parse_args().walls):
        print(row(number, rng), flush=True)


if __name__ == "__main__":
    main()
