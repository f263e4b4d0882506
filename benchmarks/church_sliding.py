"""Sliding without dilatancy of the sample church R14: value and gap, as a table for docs/church.md.

    python benchmarks/church_sliding.py --start dead-load associative --seconds 600 --keep FOLDER -- "+x" "-y" "tower +x"

The certified scheme from each start; after so many seconds of processor time it reports the best state that it has, with its gap.
With --keep the states lie in FOLDER as NumPy archives (x, y: forces and velocities in the units of `Equilibrium`; history).
"""

import argparse
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from church import LOADS

import churchpipe as cp
from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.conic.solve import Solve, solver_for
from churchpipe.rigid_blocks.associative import associative_program
from churchpipe.rigid_blocks.coulomb import CoulombState, dead_load_start
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.interval import mechanism_interval
from churchpipe.rigid_blocks.iterations import certified_iteration
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.rigid_blocks.settings import SchemeSettings

FRICTION = 0.6


def within(solve: Solve, seconds: float) -> Solve:
    """Return a solver that fails once so much processor time has been spent: the iteration then ends with what it has."""
    begin = process_time()

    def limited(program: ConeProgram, /, **wanted: Any) -> ConeSolution:
        if process_time() - begin > seconds:
            forces, rates = np.full((program.points, 3), np.nan), np.full(len(program.constant), np.nan)
            return ConeSolution(forces, np.nan, rates, "failed", 0, 0.0, "", "out of time")
        return solve(program, **wanted)

    return limited


def main() -> None:
    """Print one row for each load and start."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("loads", nargs="+", choices=LOADS)
    parser.add_argument("--start", nargs="+", choices=("dead-load", "associative"), default=["dead-load"])
    parser.add_argument("--gap", type=float, default=1e-5)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--intervals", action="store_true", help="of the mechanisms too: up to 20 programs more each")
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    stones = cp.derive_blocks(cp.read_case("pipeline/cases/church.toml").building())
    contacts = cp.find_contacts(stones)
    print("| load | associative | start | load factor | g / alpha | interval | programs | iterations | seconds |")
    print("|---|---|---|---|---|---|---|---|---|")
    for load in arguments.loads:
        balance = equilibrium(stones, contacts, LOADS[load])
        strength = point_strength(contacts, FRICTION, 0.0, balance.force)
        solve = solver_for(balance.wrenches)
        program = associative_program(balance, strength)
        answer = solve(program)
        forces, upper = restore_balance(program, answer.x, answer.tau)
        for start in arguments.start:
            n = dead_load_start(balance) if start == "dead-load" else np.maximum(forces[:, 0], 0.0)
            begin = process_time()
            run = certified_iteration(
                balance, strength, n, within(solve, arguments.seconds), SchemeSettings(bipotential_gap=arguments.gap)
            )
            seconds = process_time() - begin
            if run is None:
                print(f"| {load} | {upper:.4f} | {start} | no feasible step |", flush=True)
                continue
            if arguments.keep:
                history = np.array([(step.load_factor, step.violation, step.gap) for step in run.history])
                name = f"{load}_{start}.npz".replace(" ", "-")
                np.savez(arguments.keep / name, x=run.x, y=run.y, load_factor=run.load_factor, gap=run.gap, history=history)
            interval = ""
            if arguments.intervals:
                begin = process_time()
                low, high = mechanism_interval(balance, strength, CoulombState(run.x, run.load_factor, run.y, run.gap))
                interval = f"{low:.4f} to {high:.4f} ({process_time() - begin:.0f} s)"
            found = f"{run.load_factor:.4f} | {run.gap / run.load_factor:.1e} | {interval}"
            print(f"| {load} | {upper:.4f} | {start} | {found} | {run.solves} | {run.iterations} | {seconds:.0f} |", flush=True)


if __name__ == "__main__":
    main()
