"""Buildings of random sizes, seeded: laid without gaps or overlaps, or refused in words."""

from typing import Any

import numpy as np
import pytest

from churchpipe import generators
from churchpipe.errors import InputError
from sound import laid

COURSE, STONE = 0.25, 0.5


def opening(rng: np.random.Generator, wall: str, reach: float, top: float) -> dict[str, Any]:
    width, shape = rng.uniform(0.5, 1.3), str(rng.choice(["round", "segmental", "pointed", "circle"]))
    rise = {"segmental": {"rise": rng.uniform(0.1, 0.5) * width}, "pointed": {"rise": rng.uniform(0.6, 1.4) * width}}
    place = {"centre": rng.uniform(-reach, reach), "springing": rng.uniform(1.2, top - 1.5), "sill": rng.choice([0.0, 0.6])}
    if shape == "circle":
        del place["sill"]
    ring = {"voussoirs": 2 * int(rng.integers(4, 8)), "depth": rng.uniform(0.2, 0.35)}
    return {"name": "o", "wall": wall, "width": width, "shape": shape} | place | ring | rise.get(shape, {})


def tower(rng: np.random.Generator, joints: str) -> Any:
    size = {"width": rng.uniform(3, 6), "depth": rng.uniform(3, 6), "height": 5.0, "thickness": rng.uniform(0.4, 0.9)}
    return {"openings": [opening(rng, "front", 0.3, 5.0)], "joints": joints, **size}


def round_tower(rng: np.random.Generator, joints: str) -> Any:
    size = {"plan": "round", "width": rng.uniform(4, 6), "height": 5.0, "thickness": rng.uniform(0.4, 0.9)}
    return {"openings": [opening(rng, "round", 9.0, 5.0)], "joints": joints, **size}


def apse(rng: np.random.Generator, joints: str) -> Any:
    wall = {"wall_length": 9.0, "wall_thickness": rng.uniform(0.4, 0.9), "wall_height": 5.5}
    size = {"inner_radius": rng.uniform(1.2, 2.5), "thickness": rng.uniform(0.4, 0.9), "height": 5.0}
    return {"openings": [opening(rng, "apse", 0.8, 5.0)], "joints": joints, **size, **wall}


KINDS = {"tower": (generators.tower, tower), "round": (generators.tower, round_tower), "apse": (generators.apse, apse)}


MORE = pytest.mark.slow("docs/church.md: random buildings are laid")
QUICK = [("tower", "grid"), ("tower", "bay"), ("apse", "grid")]


@pytest.mark.parametrize(
    ("kind", "joints", "number"),
    [(*pair, 1) for pair in QUICK] + [pytest.param(kind, joints, 2, marks=MORE) for kind in KINDS for joints in ("grid", "bay")],
)
def test_random_buildings_are_laid(kind: str, joints: str, number: int) -> None:
    build, sizes = KINDS[kind]
    rng = np.random.default_rng(list(f"{kind} {joints}".encode()))
    count = 0
    while count < number:
        try:
            building = build(course=COURSE, stone_length=STONE, **sizes(rng, joints))
        except InputError:
            continue  # The generator names what does not fit; what it accepts must be laid.
        laid(building)
        count += 1
