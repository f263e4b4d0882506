"""Load factors of drawn buildings as stones and as a shell, the shell held at its feet and on joints there.

    PYTHONPATH=tests python benchmarks/shell_and_stones.py building-4 building-6 building-7 segmental-0 segmental-1

Names: `random_shape` of `tests/models.py` with its seeds, and segmental barrels and groin vaults and low domes on skewbacks
(`segmental`). Associative load factors; nothing was chosen on them.
"""

import argparse

import numpy as np

import churchpipe as cp
from churchpipe.generators import dome, vault
from churchpipe.homogenised_shell.bounds import proved_bounds
from churchpipe.homogenised_shell.condensed import CondensedShell
from churchpipe.homogenised_shell.element import shell_elements
from models import random_shape


def segmental(seed: int) -> tuple[cp.Building, float, cp.LoadCase]:
    """Return a barrel, a dome, or a groin vault that is less than half round, its friction, and a push across."""
    rng = np.random.default_rng(seed)
    friction, span = round(float(rng.uniform(0.4, 0.9)), 2), round(float(rng.uniform(2, 5)), 2)
    sizes = {
        "span": span,
        "rise": round(span * float(rng.uniform(0.15, 0.4)), 2),
        "thickness": round(float(rng.uniform(0.15, 0.5)), 2),
    }
    kind = ("barrel", "dome", "groin")[seed % 3]
    if kind == "dome":
        return dome(rings=8, sides=24, **sizes), friction, cp.LoadCase((1, 0, 0))
    shape = {
        "kind": kind,
        "shape": "segmental",
        "courses": 21,
        "stone_length": 0.4,
        **({"length": 1.2} if kind == "barrel" else {}),
    }
    return vault(**sizes, **shape), friction, cp.LoadCase((1, 0, 0))


def held(shell: cp.ShellModel, load: cp.LoadCase, materials: list[cp.Material]) -> float:
    """Return the load factor of a shell that is held at its feet, NaN where it falls under its own weight."""
    condensed = CondensedShell(shell_elements(shell), load, materials, "cell")
    dead, live = condensed.loads.dead, condensed.loads.live
    if condensed.solve(None, dead, cap=1.0).load < 1 - 1e-6:
        return float("nan")
    return proved_bounds(condensed, condensed.solve(dead, live), dead, live).lower


def row(name: str, size: float) -> str:
    """Return a row of the table."""
    kind, _, seed = name.partition("-")
    building, friction, load = {"building": random_shape, "segmental": segmental}[kind](int(seed))
    materials = [cp.Material(one.name, one.unit_weight, friction) for one in building.materials]
    stones = cp.derive_blocks(building)
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, friction)
    shell = cp.derive_shell(building, size)
    on_joints = cp.shell_limit_analysis(shell, load, materials)
    values = state.load_factor, held(shell, load, materials), on_joints.load_factor
    shares = " | ".join(f"{value:.4f}" for value in values)
    return f"| {name} | {building.name} | {friction:g} | {shares} | {values[2] / values[0]:.2f} | {on_joints.iterations} |"


def main() -> None:
    """Print a row for each name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+")
    parser.add_argument("--element-size", type=float, default=0.4, help="m")
    arguments = parser.parse_args()
    print("| drawn | kind | friction | stones | shell, held | shell on joints | over the stones | iterations |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for name in arguments.names:
        print(row(name, arguments.element_size), flush=True)


if __name__ == "__main__":
    main()
