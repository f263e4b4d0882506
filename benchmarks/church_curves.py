"""Capacity curves of the church for its seven loads, reduced and in full, as a table for docs/capacity_curve.md.

    python benchmarks/church_curves.py [--full] [--steps 30] [LOAD ...]     # all loads, or those named
    python benchmarks/church_curves.py --case chapel --halo 2 --step 0.02 --steps 12 -- -y      # another model, halo, step

Reduced: the stones that move with their halo. --full: all stones. Times are processor time, on one core, with the limit
analyses before the first step.
"""

import argparse
import time

import churchpipe as cp


def main() -> None:
    """Follow the loads and print a row of the table for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", default="church", help="a sample case")
    parser.add_argument("--full", action="store_true", help="follow all stones")
    parser.add_argument("--halo", type=int, default=5, help="contacts from a moving stone to those held still")
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--step", type=float, default=0.04, help="m")
    parser.add_argument("loads", nargs="*")
    options = parser.parse_args()
    case = cp.read_case(f"pipeline/cases/{options.case}.toml")
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    print("| load | starts at | steps | largest, m | load factor there | largest misfit | fallen | ends | seconds |")
    print("|---|---|---|---|---|---|---|---|---|")
    total = 0.0
    for load in case.loads:
        if options.loads and load.name not in options.loads:
            continue
        start = time.process_time()
        halo = 0 if options.full else options.halo
        curve = cp.block_pushover(stones, contacts, load, 0.6, step=options.step, steps=options.steps, halo=halo)
        fallen, seconds = sum(len(part.stones) for part in curve.fallen), time.process_time() - start
        total += seconds
        print(
            f"| {load.name} | {curve.initial:.4f} | {len(curve.load_factor)} | {curve.largest[-1]:.3f}"
            f" | {curve.load_factor[-1]:.4f} | {curve.misfit.max():.1e} | {fallen} | {curve.status} | {seconds:.0f} |",
            flush=True,
        )
    print(f"{total:.0f} s in all")


if __name__ == "__main__":
    main()
