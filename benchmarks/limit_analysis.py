"""Speed and size of limit analysis on box buildings and other shapes: our interior-point core, Clarabel, cvxpy.

    PYTHONPATH=tests python benchmarks/limit_analysis.py --models 1k 5k 10k 20k 50k
    PYTHONPATH=tests python benchmarks/limit_analysis.py --models low tube street church --solvers interior-point clarabel
    PYTHONPATH=tests python benchmarks/limit_analysis.py --models 20k 100k --solvers interior-point --threads 1 2

Every run is a process of its own, with one thread unless more are asked for, so that peak memory and processor time are its
own. Clarabel has its default settings and the form that suits it best (kinematic, forces in the weight of a stone). With
`--mkl DIR` it also runs with the PARDISO of an MKL wheel: DIR must hold libmkl_rt.so (a link to the wheel's libmkl_rt.so.N).
Prints a table for docs/benchmarks_limit_analysis.md.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
from time import perf_counter, process_time
from typing import Any

import numpy as np

# The largest model of each, and the cap of one run, s.
LIMITS = {"interior-point": 10**6, "clarabel": 6000, "clarabel-mkl": 21000, "cvxpy": 6000}
CAP = 600


def model(name: str) -> tuple[Any, Any]:
    """Return balance and strength of a box building, a facade, or the sample church; friction .6, pushed along x."""
    import churchpipe as cp
    from churchpipe.model.loads import LoadCase
    from churchpipe.rigid_blocks.equilibrium import equilibrium
    from churchpipe.rigid_blocks.limit import point_strength
    from models import FACADES, box_building, facade

    if name == "church":
        stones = cp.derive_blocks(cp.read_case("pipeline/cases/church.toml").building())
        contacts = cp.find_contacts(stones)
    else:
        stones, contacts = facade(name) if name in FACADES else box_building(name)
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    return balance, point_strength(contacts, 0.6, 0.0, balance.force)


def run(name: str, solver: str) -> dict[str, Any]:
    """Solve one model and return its figures; the bounds come from the arrays."""
    from churchpipe.conic.clarabel import solve_clarabel
    from churchpipe.conic.interior_point import InteriorPointSolver
    from churchpipe.conic.polish import restore_balance
    from churchpipe.conic.solve import solver_for
    from churchpipe.rigid_blocks.associative import associative_program
    from churchpipe.rigid_blocks.certificate import certify

    # Compiled kernels are loaded from their cache, or made, before the clock starts.
    InteriorPointSolver(associative_program(*model("warm")).balance).solve(associative_program(*model("warm")))
    balance, strength = model(name)
    program = associative_program(balance, strength)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    processor, wall = process_time(), perf_counter()
    out: dict[str, Any] = {"model": name, "solver": solver, "stones": len(balance.free), "points": program.points}
    if solver == "interior-point":
        own = InteriorPointSolver(program.balance)
        answer = own.solve(program)
        out["processor"], out["wall"] = process_time() - processor, perf_counter() - wall
        out["memory"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10
        out["factor"], out["nonzeros"] = own.factorisation_seconds(), own.factor_nonzeros()
    else:
        if solver.startswith("clarabel"):
            answer = solve_clarabel(program, settings=clarabel_settings(solver))
        else:
            answer = solver_for(program.balance, solver)(program)
        out["processor"], out["wall"] = process_time() - processor, perf_counter() - wall
        out["memory"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10
    out["before"] = before / 2**10
    out |= {"iterations": answer.iterations, "outcome": answer.outcome}
    if answer.outcome == "solved":
        x, tau = restore_balance(program, answer.x, answer.tau)
        found = certify(balance, strength, x, tau, answer.y)
        out |= {"lower": found.lower_bound, "upper": found.upper_bound, "residual": found.equilibrium_residual}
    return out


def clarabel_settings(solver: str) -> Any:
    """Return Clarabel's default settings, on one thread, or with MKL's PARDISO, which takes two."""
    import clarabel

    settings: Any = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    if solver == "clarabel-mkl":
        settings.direct_solve_method, settings.max_threads = "mkl", 2
    return settings


def in_child(name: str, solver: str, threads: int, mkl: str, cap: float) -> dict[str, Any]:
    """Run one solve in a process with so many threads, capped at so many seconds of wall time."""
    environment = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), str(threads))
    if solver == "clarabel-mkl":
        environment = {"LD_LIBRARY_PATH": mkl, "MKL_NUM_THREADS": "2"}
    command = [sys.executable, __file__, "--one", name, solver]
    try:
        done = subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, timeout=cap, check=True)
    except (subprocess.TimeoutExpired, subprocess.CalledProcessError) as error:
        return {"model": name, "solver": solver, "threads": threads, "outcome": type(error).__name__}
    return json.loads(done.stdout.splitlines()[-1]) | {"threads": threads}


def table(rows: list[dict[str, Any]]) -> str:
    """Return the table: one row a run, then exponents of growth and the distance from bare factorisations."""
    head = (
        "| model | stones | points | solver | outcome | iterations | processor s | wall s | memory MiB | nonzeros of L | bounds |"
    )
    lines = [head, "|" + "---|" * 11]
    for row in rows:
        bounds = f"{row['lower']:.8f} .. {row['upper']:.8f}" if "lower" in row else ""
        cells = [row.get(key, "") for key in ("model", "stones", "points", "solver", "outcome", "iterations")]
        if row["threads"] > 1:
            cells[3] += f", {row['threads']} threads"
        cells += [f"{row[key]:.1f}" if key in row else "" for key in ("processor", "wall", "memory")]
        cells += [f"{row['nonzeros']:.3g}" if "nonzeros" in row else "", bounds]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    own = [row for row in rows if "factor" in row and row["threads"] == 1]
    if len(own) > 1:
        size = np.log([row["stones"] for row in own])
        lines.append("")
        for key in ("processor", "factor", "memory"):
            power = np.polyfit(size, np.log([row[key] for row in own]), 1)[0]
            lines.append(f"{key} of the interior-point core grows as stones^{power:.2f}.")
    for row in rows:
        ours = next((one for one in own if one["model"] == row["model"]), None)
        if ours is None or row is ours or "processor" not in row:
            continue
        lines.append("")
        if row["threads"] > 1:
            lines.append(f"{row['model']}: {row['threads']} threads take {row['wall'] / ours['wall']:.2f} of the time of one.")
        else:
            lines.append(
                f"{row['model']}: {row['solver']} takes {row['processor'] / ours['processor']:.1f} times our processor time."
            )
    for row in own:
        bare = row["factor"]
        share = row["processor"] / (max(row["iterations"], 1) * bare)
        lines.append("")
        lines.append(
            f"{row['model']}: one factorisation {bare:.3f} s; an iteration costs {share:.1f} of them, "
            f"the solve {row['processor'] / (25 * bare):.1f} times 25 of them."
        )
    return "\n".join(lines)


def main() -> None:
    """Run the chosen models, solvers interleaved, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--models", nargs="+", default=["1k", "5k", "10k", "20k", "50k"])
    parser.add_argument("--solvers", nargs="+", default=["interior-point", "clarabel", "cvxpy"], choices=LIMITS)
    parser.add_argument("--threads", nargs="+", type=int, default=[1], help="of our own solver; the others have one")
    parser.add_argument("--mkl", default="", metavar="DIR", help="folder with libmkl_rt.so, for clarabel-mkl")
    parser.add_argument("--cap", type=float, default=CAP, help="of one run, s of wall time")
    parser.add_argument("--one", nargs=2, metavar=("MODEL", "SOLVER"), help="one run, as JSON")
    chosen = parser.parse_args()
    if chosen.one:
        print(json.dumps(run(*chosen.one)))
        return
    rows: list[dict[str, Any]] = []
    for name in chosen.models:
        for solver in chosen.solvers:
            if all(row.get("stones", 0) <= LIMITS[solver] for row in rows if row["model"] == name):
                for threads in chosen.threads if solver == "interior-point" else [1]:
                    rows.append(in_child(name, solver, threads, chosen.mkl, chosen.cap))
                    print(rows[-1], file=sys.stderr, flush=True)
    print(table(rows))


if __name__ == "__main__":
    main()
