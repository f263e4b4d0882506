"""Models that tests and benchmarks share: walls of Ferris and Tin-Loi, tilting tests, box buildings, and drawn ones."""

from dataclasses import replace
from typing import Any

import numpy as np

from churchpipe.generators import apse, arch, chapel, dome, prototype, tower, vault, wall
from churchpipe.generators.box import box as box_walls
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.ties import Tie
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground

# Courses of Ferris and Tin-Loi's walls from the bottom, and brick lengths of each in units of .4 m; negative is a gap.
FERRIS_TIN_LOI_PATTERNS = {
    1: ("E U E U E U", {"E": [0.5, 1, 1, 1, 1, 0.5], "U": [1] * 5}),
    2: ("E U E U E U E U E U", {"E": [0.5, 1, 1, 1, 1, 0.5], "U": [1] * 5}),
    3: (
        "E U E w v w v w E U E",
        {"E": [1] * 4, "U": [0.5, 1, 1, 1, 0.5], "w": [0.5, 1, -1, 1, 0.5], "v": [1, 0.5, -1, 0.5, 1]},
    ),
    4: (
        "E U E w v w v w E U E",
        {"E": [0.5, 1, 1, 1, 1, 0.5], "U": [1] * 5, "w": [1, -1, 1, -1, 1], "v": [0.5, 0.5, -1, 0.5, 0.5, -1, 0.5, 0.5]},
    ),
    5: (
        "E U E w v w v w E U E w v w v w E U E",
        {"E": [0.5, 1, 1, 0.5], "U": [1] * 3, "w": [1, -1, 1], "v": [0.5, 0.5, -1, 0.5, 0.5]},
    ),
    6: (
        "E U E U w v w v w U E U w v w v w U E U E",
        {
            "E": [0.5, 1, 1, 1, 1, 1, 1, 0.5],
            "U": [1] * 7,
            "w": [0.5, 1, -1, 1, 1, -1, 1, 0.5],
            "v": [1, 0.5, -1, 0.5, 1, 0.5, -1, 0.5, 1],
        },
    ),
}
FERRIS_TIN_LOI_LOAD = LoadCase((1, 0, 0))

DRY_STONE = (Material("default", 28.6e3, 0.7),)
# The tilting tests of Malena, Portioli et al. (2019), section 4.1: 28.6 kN/m3, bricks of 80 x 40 x 30 mm.
TILTING_BRICKS: dict[str, Any] = {"brick": (0.08, 0.04, 0.03), "courses": 21}
TILTING_DOOR = {"start": 0.12, "width": 0.16, "height_courses": 15, "lintel_bearing": 0.04}
S5 = TILTING_BRICKS | {"main_wall_length": 0.64, "partitions_x": [0.0, 0.6], "partition_length": 0.32}
S22 = TILTING_BRICKS | {
    "main_wall_length": 1.12,
    "partitions_x": [0.0, 0.52, 1.08],
    "partition_length": 0.84,
    "opening": TILTING_DOOR,
}
TILTING_LOADS = {"S5": LoadCase((0, 1, 0)), "S22": LoadCase((0, -1, 0))}

# Outer length and width in bricks of 1 m, and courses, of box buildings: about this many stones.
BOXES = {
    "warm": (4, 3, 2),
    "1k": (14, 9, 24),
    "5k": (24, 16, 69),
    "10k": (34, 22, 92),
    "20k": (48, 32, 128),
    "50k": (76, 50, 200),
    "100k": (108, 72, 280),
    "low": (76, 12, 30),
    "tube": (6, 6, 224),
}


def ferris_tin_loi_wall(number: int) -> Assemblage:
    """Lay one of the six walls: bricks of .4 x .175 m, unit thickness."""
    courses, lengths = FERRIS_TIN_LOI_PATTERNS[number]
    bricks = []
    for c, name in enumerate(courses.split()):
        left = 0.0
        for length in lengths[name]:
            if length > 0:
                bricks.append(box((0.4 * left, 0.4 * (left + length)), (0, 1), (0.175 * c, 0.175 * (c + 1))))
            left += abs(length)
    return on_ground(*bricks)


def tilting_test(test: str, brick_length: float = 0.08, **options: Any) -> tuple[Assemblage, Contacts]:
    """Stones and contacts of the tilting tests "S5" and "S22"."""
    layout = {"S5": S5, "S22": S22}[test] | {"brick": (brick_length, 0.04, 0.03)}
    stones = derive_blocks(prototype(materials=DRY_STONE, **layout, **options))
    return stones, find_contacts(stones)


def box_building(name: str) -> tuple[Assemblage, Contacts]:
    """Stones and contacts of four walls around a room, by a name of `BOXES`."""
    length, width, courses = BOXES[name]
    building = box_walls(length=length, width=width, courses=courses, brick=(1.0, 0.5, 0.4))
    # The largest box is above what a case file may ask for unless it says so.
    stones = derive_blocks(replace(building, most_stones=200_000))
    return stones, find_contacts(stones)


# Plane walls of bricks .4 x .2 x .2 m with doors and windows: length in m, courses, and openings as (start, width, sill, height),
# the last two in courses. They have 173, 1400 to 1700, 5500 and 900 stones.
FACADES: dict[str, tuple[float, int, list[tuple[float, float, int, int]]]] = {
    "small": (6.0, 12, [(1.2, 0.8, 2, 4), (4.0, 0.8, 2, 4)]),
    "long": (
        32.0,
        23,
        [
            (2.4, 1.2, 6, 8),
            (6.4, 1.2, 0, 14),
            (10.4, 1.2, 6, 8),
            (15.2, 1.6, 0, 14),
            (20.0, 1.2, 6, 8),
            (24.4, 1.2, 0, 14),
            (28.4, 1.2, 6, 8),
        ],
    ),
    "storeys": (
        13.2,
        50,
        [
            *((start, 1.2, 6, 9) for start in (1.6, 10.0)),
            (5.8, 1.6, 0, 15),
            *((start, 1.2, 30, 9) for start in (1.6, 6.0, 10.0)),
        ],
    ),
    "street": (
        40.0,
        60,
        [(start, 1.2, sill, 9) for sill in (6, 24, 42) for start in (1.6, 6.0, 10.4, 14.8, 19.2, 23.6, 28.0, 32.4, 36.8)],
    ),
    "slender": (7.2, 60, [(start, 0.8, sill, 8) for sill in (4, 18, 32, 46) for start in (1.6, 4.8)]),
}


def facade(name: str) -> tuple[Assemblage, Contacts]:
    """Stones and contacts of a plane wall of `FACADES`."""
    length, courses, openings = FACADES[name]
    cut = [
        {"start": start, "width": width, "sill_courses": sill, "height_courses": height, "lintel_bearing": 0.2}
        for start, width, sill, height in openings
    ]
    stones = derive_blocks(wall(length=length, brick=(0.4, 0.2, 0.2), courses=courses, openings=cut))
    return stones, find_contacts(stones)


def random_facade(seed: int) -> tuple[Assemblage, Contacts, float]:
    """Stones, contacts and friction of a plane wall with openings, all drawn: 5 to 25 m long, at most some 1300 stones a leaf.

    Bricks, courses, storeys, bays and openings vary, friction from .4 to .8. One in five is of bricks that overlap by a third,
    one in five has two leaves and headers.
    """
    rng = np.random.default_rng(seed)
    height = float(rng.choice([0.1, 0.15, 0.2, 0.25]))
    brick = height * float(rng.choice([1.5, 2.0, 3.0]))
    length = round(float(rng.uniform(5, 25)) / brick) * brick
    courses = int(np.clip(rng.uniform(3, 12) / height, 12, max(12, int(1300 * brick / length))))
    friction, bond = round(float(rng.uniform(0.4, 0.8)), 2), int(rng.integers(5))
    storeys = int(np.clip(round(courses * height / 3), 1, courses // 10))
    bays = max(1, round(length / float(rng.uniform(2.6, 4.5))))
    half, width = brick / 2, float(rng.uniform(0.25, 0.45)) * length / bays
    each = courses // storeys
    openings: list[dict[str, float]] = []
    for storey in range(storeys):
        for bay in range(bays):
            if rng.uniform() < 0.15:
                continue
            door = storey == 0 and rng.uniform() < 0.3
            sill = 0 if door else storey * each + max(2, each // 3)
            start = round(((bay + 0.5) * length / bays - width / 2) / half) * half
            opening = {"start": start, "width": max(brick, round(width / half) * half), "lintel_bearing": half}
            top = storey * each + each - max(3, each // 4)
            openings.append({**opening, "sill_courses": sill, "height_courses": top - sill})
    bonds: dict[int, dict[str, Any]] = {3: {"cut_offset": brick / 3}, 4: {"pattern": "header-stretcher"}}
    thickness = half if bond == 4 else 0.2
    shape = wall(length=length, brick=(brick, thickness, height), courses=courses, openings=openings, **bonds.get(bond, {}))
    stones = derive_blocks(shape)
    return stones, find_contacts(stones), friction


def random_corner(seed: int) -> tuple[Assemblage, Contacts, float, LoadCase]:
    """Stones, contacts, friction and load of a corner of two short walls of tilting-test bricks, all drawn: 20 to 70 stones.

    Friction is drawn from .35 to .85, and the direction of the load in plan. Such corners slide in many joints at once.
    """
    rng = np.random.default_rng(seed)
    layout = {"courses": int(rng.integers(4, 10)), "main_wall_length": 0.08 * int(rng.integers(2, 6)), "partitions_x": [0.0]}
    layout["partition_length"] = 0.08 * int(rng.integers(1, 4)) + 0.04 * int(rng.integers(0, 2))
    stones = derive_blocks(prototype(materials=DRY_STONE, **TILTING_BRICKS | layout))
    angle, friction = float(rng.uniform(0, 2 * np.pi)), round(float(rng.uniform(0.35, 0.85)), 2)
    return stones, find_contacts(stones), friction, LoadCase((float(np.cos(angle)), float(np.sin(angle)), 0.0))


def random_building(seed: int) -> tuple[Assemblage, Contacts, float, LoadCase]:
    """Stones, contacts, friction and load of a `random_shape`."""
    shape, friction, load = random_shape(seed)
    stones = derive_blocks(shape)
    return stones, find_contacts(stones), friction, load


def random_shape(seed: int) -> tuple[Building, float, LoadCase]:
    """A box, tower, round tower, chapel, dome, apse, arch, vault or wall, its friction and load, all drawn.

    The kinds follow each other with the seeds. Friction is drawn from .35 to .85, and the direction of the load in plan; walls
    and arches are pushed along themselves. Few have more than a thousand stones.
    """
    rng = np.random.default_rng(seed)
    kind = ("box", "tower", "round tower", "chapel", "dome", "apse", "arch", "vault", "wall")[seed % 9]
    course, friction = float(rng.choice([0.2, 0.25, 0.3])), round(float(rng.uniform(0.35, 0.85)), 2)
    angle = float(rng.uniform(0, 2 * np.pi))
    direction = (1.0, 0.0, 0.0) if kind in ("arch", "wall") else (float(np.cos(angle)), float(np.sin(angle)), 0.0)

    def length(low: float, high: float) -> float:
        return round(float(rng.uniform(low, high)), 2)

    def courses(low: int, high: int) -> int:
        return int(rng.integers(low, high))

    bonded = {"course": course, "stone_length": 2 * course}
    if kind == "box":
        brick = (2 * course, length(0.3, 0.6), course)
        shape = box_walls(length=length(3, 6), width=length(3, 6), courses=courses(8, 18), brick=brick)
    elif kind == "tower":
        plan = {"width": length(2.5, 4), "depth": length(2.5, 4)}
        shape = tower(**bonded, **plan, height=courses(16, 36) * course, thickness=length(0.4, 0.7))
    elif kind == "round tower":
        plan = {"plan": "round", "width": length(2.5, 4)}
        shape = tower(**bonded, **plan, height=courses(12, 26) * course, thickness=length(0.3, 0.6))
    elif kind == "chapel":
        eaves = courses(12, 20)
        portal = {"name": "portal", "wall": "facade", "centre": 0.0, "width": 1.2, "springing": 6 * course, "voussoirs": 7}
        plan = {"width": length(4, 6), "length": length(5, 8), "thickness": length(0.4, 0.7)}
        top = {"height": eaves * course, "ridge": (eaves + courses(4, 9)) * course}
        shape = chapel(**bonded, **plan, **top, openings=[{**portal, "depth": 0.3}])
    elif kind == "dome":
        rings = {"rings": courses(6, 10), "sides": 24, "stone_sides": 2, "laid": "staggered"}
        shape = dome(span=length(3, 6), thickness=length(0.3, 0.5), **rings)
    elif kind == "apse":
        rear = {"inner_radius": length(1.2, 2.5), "thickness": length(0.3, 0.6), "height": courses(10, 16) * course}
        front = {"wall_length": length(5.5, 7), "wall_thickness": length(0.4, 0.7), "wall_height": courses(16, 22) * course}
        shape = apse(**bonded, **rear, **front)
    elif kind == "arch":
        shape = arch(mean_radius=2.0, thickness=length(0.3, 0.6), width=0.8, voussoirs=courses(9, 31))
    elif kind == "vault":
        size = {"span": length(2, 4), "thickness": length(0.25, 0.4), "length": length(2, 3), "stone_length": 0.4}
        shape = vault(**size, courses=2 * courses(8, 14) + 1, laid=str(rng.choice(["rings", "courses"])))
    else:
        stone = 2 * course
        window = {"start": stone * courses(2, 4) + course, "width": 2 * stone, "sill_courses": 3, "height_courses": 4}
        size = {"length": stone * courses(10, 24), "brick": (stone, length(0.15, 0.4), course), "courses": courses(10, 22)}
        shape = wall(**size, openings=[{**window, "lintel_bearing": course}])
    return shape, friction, LoadCase(direction)


def bar_across(stones: Assemblage, load: LoadCase) -> Tie:
    """An elastic tie between the two of the uppermost stones that are farthest apart across a push.

    Its strength is the weight of the stones, its stiffness twenty times that over their height.
    """
    top = np.flatnonzero(~stones.fixed & (stones.centroid[:, 2] > stones.centroid[:, 2].max() - 1e-6))
    along = stones.centroid[top] @ np.array([-load.direction[1], load.direction[0], 0.0])
    first, second = int(top[along.argmin()]), int(top[along.argmax()])
    weight, height = float(stones.weight.sum()), float(np.ptp(stones.points[:, 2]))
    ends = stones.centroid[first], stones.centroid[second]
    return Tie("bar", *ends, (first, second), strength=weight, stiffness=20 * weight / height)
