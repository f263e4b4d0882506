"""The pictures of docs/vaults.md: vaults at collapse, and the line of thrust of a barrel.

python benchmarks/vaults.py     # pictures go to docs/pictures/vaults
"""

from pathlib import Path

import churchpipe as cp
from churchpipe.generators import dome, vault
from churchpipe.model.building import Building
from churchpipe.report.figures import mechanism_picture
from churchpipe.report.thrust import thrust_picture

FOLDER = Path("docs/pictures/vaults")
SIZE = (640, 480)
FRICTION = 0.7


def draw(name: str, building: Building, direction: tuple[float, float, float] | None = (1, 0, 0)) -> None:
    """Draw the mechanism of a vault that is pushed along a direction, or outwards all round."""
    stones = cp.derive_blocks(building)
    load = cp.LoadCase(direction) if direction else cp.outward_load(stones)
    state = cp.limit_analysis(stones, cp.find_contacts(stones), load, FRICTION)
    mechanism_picture(stones, state.velocities, FOLDER / f"{name}.png", load.direction if direction else None, size=SIZE)
    print(f"{name}: {state.load_factor:.4f}")


def thrust() -> None:
    """Draw the line of thrust of a barrel on walls at collapse."""
    case = cp.read_case("pipeline/cases/vault.toml")
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, case.loads[0], FRICTION)
    panels, section = ("vault", "wall_left", "wall_right"), {"through": (0.0, 1.5), "width": 3.0}
    line = cp.thrust_line(stones, contacts, state.forces, "vault", **section)
    thrust_picture(stones, line, FOLDER / "thrust.png", (*panels, "backing_left", "backing_right"), **section)


def main() -> None:
    """Draw all."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    piers = {"wall_height": 1.0, "wall_thickness": 0.9, "wall_course": 0.5}
    crossed = {"courses": 19, "stone_length": 0.6}
    draw("groin", vault(span=3.7, thickness=0.3, kind="groin", **crossed, **piers))
    draw("pavilion", vault(span=3.8, thickness=0.2, kind="pavilion", **crossed))
    draw("rings", vault(span=3.7, thickness=0.3, courses=27, stone_length=0.5, length=4.0, laid="rings"))
    drum = {"drum_height": 1.0, "drum_thickness": 0.5, "drum_course": 0.25}
    draw("half_dome", dome(span=3.7, thickness=0.3, rings=10, sides=16, plan="half", **drum), (0, 1, 0))
    draw("dome_outward", dome(span=3.8, thickness=0.2, rings=10, sides=32, stone_sides=1, laid="lunes"), None)
    thrust()


if __name__ == "__main__":
    main()
