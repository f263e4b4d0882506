"""A gable facade with two side walls behind it, for tests and the table of docs/walls.md."""

from typing import Any

import churchpipe as cp
from churchpipe import generators

THICKNESS, WIDTH, EAVES, RIDGE, FRICTION = 0.6, 5.0, 4.0, 5.0, 0.6
GROUTED = cp.Material("default", unit_weight=18e3, friction=FRICTION, cohesion=20e3)


def facade(**junction: Any) -> tuple[cp.Assemblage, cp.Contacts]:
    """A gable facade with two side walls behind it."""
    stones = cp.derive_blocks(facade_building(**junction))
    return stones, cp.find_contacts(stones)


def facade_building(**junction: Any) -> cp.Building:
    """A gable facade with two side walls behind it."""
    walls = [{"walls": ("facade", side), **junction} for side in ("nave_left", "nave_right")]
    return generators.church(
        course=0.5,
        stone_length=1.0,
        nave={"width": WIDTH - THICKNESS, "length": 3.0, "height": EAVES, "thickness": THICKNESS},
        facade={"thickness": THICKNESS, "ridge": RIDGE},
        junctions=walls if junction else (),
    )
