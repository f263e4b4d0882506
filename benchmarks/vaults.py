"""The pictures of docs/vaults.md: vaults at collapse, and the line of thrust of a barrel.

python benchmarks/vaults.py [PICTURE ...]     # all, or those named; they go to docs/pictures/vaults
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import churchpipe as cp
from churchpipe.generators import dome, vault
from churchpipe.model.building import Building
from churchpipe.report.figures import mechanism_picture
from churchpipe.report.thrust import thrust_picture

FOLDER = Path("docs/pictures/vaults")
SIZE = (640, 480)
FRICTION = 0.7

CROSSED: dict[str, Any] = {"courses": 19, "stone_length": 0.6}
PIERS: dict[str, Any] = {"wall_height": 1.0, "wall_thickness": 0.9, "wall_course": 0.5}
DRUM: dict[str, Any] = {"drum_height": 1.0, "drum_thickness": 0.5, "drum_course": 0.25}
ALONG: dict[str, Any] = {"courses": 27, "stone_length": 0.5, "length": 4.0}
# Vaults, pushed along +x if not said.
VAULTS: dict[str, Callable[[], Building]] = {
    "transverse": lambda: vault(span=3.76, thickness=0.24, arches=3, arch_width=0.5, arch_depth=0.2, **ALONG),
    "rings": lambda: vault(span=3.7, thickness=0.3, laid="rings", **ALONG),
    "pointed": lambda: vault(span=3.2, thickness=0.3, shape="pointed", rise=2.3, **ALONG),
    "groin": lambda: vault(span=3.7, thickness=0.3, kind="groin", **CROSSED, **PIERS),
    "wall_arches": lambda: vault(span=3.76, thickness=0.24, kind="groin", arches=4, arch_width=0.5, arch_depth=0.3, **CROSSED),
    "ribs": lambda: vault(span=3.76, thickness=0.24, kind="groin", rib_width=0.24, rib_depth=0.2, **CROSSED),
    "pavilion": lambda: vault(span=3.8, thickness=0.2, kind="pavilion", **CROSSED),
    "octagonal": lambda: vault(span=3.8, thickness=0.2, kind="octagonal", **CROSSED),
    "dome_rings": lambda: dome(span=3.8, thickness=0.2, rings=16, sides=32, shortest_stone=0.4, **DRUM),
    "dome_outward": lambda: dome(span=3.8, thickness=0.2, rings=10, sides=32, stone_sides=1, laid="lunes"),
    "half_dome": lambda: dome(span=3.7, thickness=0.3, rings=10, sides=16, plan="half", **DRUM),
}
PUSHED: dict[str, tuple[float, float, float] | None] = {"half_dome": (0, 1, 0), "dome_outward": None}
# Where a vault is looked at from near the ground.
TOWARD = {"ribs": (0.85, -0.5, 0.05)}


def draw(name: str) -> None:
    """Draw the mechanism of a vault that is pushed along a direction, or outwards all round."""
    stones = cp.derive_blocks(VAULTS[name]())
    direction = PUSHED.get(name, (1, 0, 0))
    load = cp.LoadCase(direction) if direction else cp.outward_load(stones)
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, FRICTION)
    toward = np.array(TOWARD[name]) / np.linalg.norm(TOWARD[name]) if name in TOWARD else None
    push = load.direction if direction else None
    mechanism_picture(stones, state.velocities, FOLDER / f"{name}.png", push, size=SIZE, toward=toward)
    print(f"{name}: {state.load_factor:.4f}", flush=True)


def thrust() -> None:
    """Draw the line of thrust of a barrel on walls at collapse."""
    case = cp.read_case("pipeline/cases/vault.toml")
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, case.loads[0], FRICTION)
    panels, section = ("vault", "wall_left", "wall_right"), {"through": (0.0, 1.5), "width": 3.0}
    line = cp.thrust_line(stones, contacts, state.forces, "vault", **section)
    thrust_picture(stones, line, FOLDER / "thrust.png", (*panels, "backing_left", "backing_right"), **section)


def main(names: Sequence[str]) -> None:
    """Draw all, or those named."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in names or (*VAULTS, "thrust"):
        if name == "thrust":
            thrust()
        else:
            draw(name)


if __name__ == "__main__":
    main(sys.argv[1:])
