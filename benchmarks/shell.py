"""Speed and size of the homogenised shell: limit load and capacity curve, beside the same stated in cvxpy. S22 by default.

    PYTHONPATH=tests python benchmarks/shell.py
    PYTHONPATH=tests python benchmarks/shell.py --planes cell --solvers interior-point --runs limit:0.2m:CST:church:+x
    PYTHONPATH=tests python benchmarks/shell.py --planes cell --steps 3 --runs pushover:0.2m:CST:church:-y

Every run is a process of its own with one thread, capped at 600 s of wall time (ours at 3600 s, for machines that are shared).
"limit" is the limit load, "step" dead load and one step of a tenth of the elastic displacement at load factor one (in cvxpy
the step alone), "pushover" the whole curve. cvxpy solves the first two with Clarabel. Prints rows for docs/benchmarks_shell.md.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[1]
CAP, OWN_CAP = 600, 3600
# Facets of S22 at an element size of 1 m, about: mesh area over the area of a facet.
FACETS = 5.2
# What cvxpy states as well; the product's own default is the exact cell.
PLANES = "paper"
STEPS = 40
RUNS = ("limit:2000:LST", "step:2000:LST", "limit:10000:LST")
EACH = "processor s a step, dead load first"
HEAD = ("run", "facets", "unknowns", "solver", "outcome", "iterations", "processor s", EACH, "memory MiB", "result")


def run(
    what: str,
    mesh: str,
    membrane: str,
    solver: str,
    name: str = "s22",
    direction: str = "",
    planes: str = PLANES,
    steps: int = STEPS,
) -> dict[str, Any]:
    """Make one model, solve it and return the figures; mesh: facets of S22, or the size of elements: 0.2m. steps: at most."""
    import churchpipe as cp
    from churchpipe.homogenised_shell.element import shell_elements

    case = cp.read_case(ROOT / "pipeline" / "cases" / f"{name}.toml")
    size = float(mesh[:-1]) if mesh.endswith("m") else float(np.sqrt(FACETS / int(mesh)))
    shell = cp.derive_shell(case.building(), element_size=size)
    load = next(load for load in case.loads if direction in ("", load.name))
    materials = case.materials
    elements = shell_elements(shell, membrane)  # pyright: ignore[reportArgumentType]
    out: dict[str, Any] = {"facets": len(shell.triangles), "unknowns": int((~elements.clamped).sum())}
    prepared = before_step(elements, load, materials, membrane) if (what, solver) == ("step", "cvxpy") else None
    begin = process_time()
    if solver == "cvxpy":
        out |= stated(elements, load, materials, prepared)
    elif what == "limit":
        state = cp.shell_limit_analysis(shell, load, materials, planes=planes, membrane=membrane, solver="interior-point")  # pyright: ignore[reportArgumentType]
        out |= {"outcome": state.status, "iterations": state.iterations}
        out["result"] = f"{state.lower_bound:.7f} .. {state.upper_bound:.7f}"
    else:
        ends: list[float] = [begin]
        most = 1 if what == "step" else steps
        curve = cp.pushover(  # pyright: ignore[reportArgumentType]
            shell,
            load,
            materials,
            planes=planes,
            membrane=membrane,
            steps=most,
            progress=lambda _: ends.append(process_time()),  # pyright: ignore[reportArgumentType]
        )
        out[EACH] = np.diff(ends).round(1).tolist()
        proved = len(curve.steps) == 2 if what == "step" else curve.status == "converged"
        out |= {"outcome": "proved" if proved else curve.message, "iterations": sum(step.iterations for step in curve.steps)}
        out["result"] = f"{len(curve.steps) - 1} steps, {curve.plateau:.7f}"
    out["processor s"] = round(process_time() - begin, 1)
    out["memory MiB"] = round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10)
    return out


def before_step(elements: Any, load: Any, materials: Any, membrane: Any) -> tuple[np.ndarray, float]:
    """Return the stresses under dead load, and the displacement of the first step."""
    import churchpipe as cp
    from churchpipe.homogenised_shell.condensed import CondensedShell
    from churchpipe.homogenised_shell.stiffness import facet_stiffness

    step = cp.pushover(elements.shell, load, materials, planes=PLANES, membrane=membrane, steps=1).steps[1]
    condensed = CondensedShell(elements, load, materials, PLANES)
    unit = condensed.loads.unit.T
    flexibility = np.linalg.inv(facet_stiffness(elements.shell, materials))[elements.facet] * elements.weight[:, None, None]
    size = condensed.loads.weight * 10 * step.displacement
    compliance = np.moveaxis(flexibility, 0, 2) * unit[:, None] * unit[None, :] / size
    standing = condensed.solve(condensed.loads.dead, None, compliance=compliance, cap=1.0)
    return standing.stress.T * condensed.loads.unit, step.displacement


def stated(elements: Any, load: Any, materials: Any, prepared: tuple[np.ndarray, float] | None) -> dict[str, Any]:
    """Solve the statement in cvxpy: the limit load, or the first step after dead load (which is not timed)."""
    from churchpipe.homogenised_shell.stiffness import facet_stiffness
    from shell_reference import reference_load_factor, reference_step, shell_program

    program = shell_program(elements, load, materials, PLANES)
    if prepared is None:
        factor = reference_load_factor(program)
    else:
        flexibility = np.linalg.inv(facet_stiffness(elements.shell, materials))[elements.facet] * elements.weight[:, None, None]
        factor, _ = reference_step(program, flexibility, *prepared)
    return {"outcome": "solved" if np.isfinite(factor) else "not solved", "result": f"{factor:.7f}"}


def in_child(name: str, solver: str, *options: str) -> dict[str, Any]:
    """Run one solve in a process with one thread, capped in wall time; options: of the command line."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    command = [sys.executable, __file__, "--one", name, solver, *options]
    cap = CAP if solver == "cvxpy" else OWN_CAP
    row: dict[str, Any] = {"run": name, "solver": solver}
    try:
        done = subprocess.run(command, env=os.environ | threads, capture_output=True, text=True, timeout=cap, check=True)
    except subprocess.TimeoutExpired:
        return row | {"outcome": f"not done in {cap} s"}
    except subprocess.CalledProcessError as error:
        return row | {"outcome": f"ended with {error.returncode}"}
    return row | json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    """Run the chosen models and print a row of each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", nargs="+", default=list(RUNS), help="limit|step|pushover:FACETS or SIZEm:LST|CST[:CASE[:LOAD]]")
    parser.add_argument("--solvers", nargs="+", default=["interior-point", "cvxpy"])
    parser.add_argument("--one", nargs=2, metavar=("RUN", "SOLVER"), help="one run, as JSON")
    parser.add_argument("--planes", default=PLANES, help="strength of the shell: paper, paper+torsion or cell")
    parser.add_argument("--steps", type=int, default=STEPS, help="steps of a pushover, at most")
    chosen = parser.parse_args()
    if chosen.one:
        what, mesh, membrane, *where = chosen.one[0].split(":")
        print(json.dumps(run(what, mesh, membrane, chosen.one[1], *where, planes=chosen.planes, steps=chosen.steps)))
        return
    print("| " + " | ".join(HEAD) + " |\n|" + "---|" * len(HEAD), flush=True)
    for name in chosen.runs:
        for solver in chosen.solvers:
            if solver == "cvxpy" and name.startswith("pushover"):
                continue
            row = in_child(name, solver, "--planes", chosen.planes, "--steps", str(chosen.steps))
            print("| " + " | ".join(str(row.get(key, "")) for key in HEAD) + " |", flush=True)


if __name__ == "__main__":
    main()
