"""Parameters in, buildings out."""

import math
from dataclasses import fields

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.generators import GENERATORS, arch, box, prototype, tower, wall
from churchpipe.model.materials import Material
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from sound import laid

BRICK = (0.08, 0.04, 0.03)
WALL = {"length": 0.32, "brick": BRICK, "courses": 5}
ARCH = {"mean_radius": 1.0, "thickness": 0.2, "width": 0.5, "voussoirs": 27}
PROTOTYPE = {"brick": BRICK, "main_wall_bricks": 8, "partitions_x": [0.0, 0.6], "partition_length": 0.32, "courses": 21}
BOX = {"length": 1.0, "width": 0.8, "courses": 4, "brick": BRICK}
BOND = {"course": 0.25, "stone_length": 0.5}
SIZE = {"width": 3.0, "height": 4.0, "thickness": 0.5}
NAVE = {"width": 4.0, "length": 5.0, "height": 4.0, "thickness": 0.5}
APSE = {"inner_radius": 1.0, "thickness": 0.5, "height": 3.0, "wall_length": 4.0, "wall_thickness": 0.5, "wall_height": 4.0}
PIERS = {"span": 2.0, "springing": 1.5, "pier_width": 0.8, "thickness": 0.5, "height": 3.5, "voussoirs": 9, "depth": 0.3}
EXAMPLES = {
    "wall": WALL,
    "arch": ARCH,
    "prototype": PROTOTYPE,
    "box": BOX,
    "house": BOND | {"height": 2.5, "thickness": 0.4, "walls": [{"name": "only", "start": (0, 0), "end": (3, 0)}]},
    "tower": BOND | SIZE | {"depth": 3.0},
    "chapel": BOND | SIZE | {"length": 5.0},
    "church": BOND | {"nave": NAVE},
    "apse": BOND | APSE,
    "arch_piers": BOND | PIERS,
    "vault": {"span": 3.0, "thickness": 0.3, "courses": 9, "stone_length": 0.6, "length": 2.0},
    "dome": {"span": 3.0, "thickness": 0.3, "rings": 5, "sides": 16},
}


@pytest.mark.parametrize("name", GENERATORS)
def test_every_generator_takes_its_parameters_a_name_and_materials(name):
    generator = GENERATORS[name]
    assert set(EXAMPLES[name]) <= {f.name for f in fields(generator.parameters)}
    tuff = Material("tuff", 16e3, 0.5)
    building = generator.build(**EXAMPLES[name], name="mine", materials=(tuff,))
    assert building.name == "mine"
    stones = derive_blocks(building)
    assert set(stones.material) == {"tuff"}
    assert (stones.unit_weight == 16e3).all()


@pytest.mark.parametrize(
    ("build", "parameters", "message"),
    [
        (wall, WALL | {"length": 0.0}, r"wall\.length: out of range; found 0\.0"),
        (wall, WALL | {"length": math.inf}, r"wall\.length: out of range"),
        (wall, WALL | {"brick": (0.08, 0.04)}, r"wall\.brick: wrong number of dimensions; found 2"),
        (wall, WALL | {"brick": (0.08, -0.04, 0.03)}, r"wall\.brick\[1\]: out of range; found -0\.04"),
        (wall, WALL | {"pattern": "flemish"}, r'wall\.pattern: unknown value; found flemish; expected "running" or "stack"'),
        (wall, WALL | {"courses": 2.5}, r"wall\.courses: out of range; found 2\.5"),
        (wall, WALL | {"height": 0.15}, "its height is given twice"),
        (wall, {"length": 0.32, "brick": BRICK}, "its height is given twice or not at all"),
        (wall, {"length": 0.32, "brick": BRICK, "height": 0.16}, r"found 5\.333 courses of 0\.03 m; expected 0\.15 m"),
        (wall, WALL | {"openings": [{"start": 0.3, "width": 0.1, "height_courses": 2}]}, "reaches beyond the wall"),
        (wall, WALL | {"openings": [{"start": 0.1, "width": 0.1, "height_courses": 6}]}, "higher than the wall"),
        (wall, WALL | {"openings": [{"start": 0.1, "wide": 0.1}]}, r"wall\.openings\.0\.wide: unknown key"),
        (wall, WALL | {"openings": [{"start": 0.1, "width": 0.1}]}, r"wall\.openings\.0\.height_courses: missing"),
        (arch, ARCH | {"thickness": 2.0}, r"arch\.thickness: no opening is left"),
        (arch, ARCH | {"voussoirs": 1}, r"arch\.voussoirs: out of range; found 1"),
        (arch, ARCH | {"half_angle": 3.0}, r"arch\.half_angle: out of range"),
        (prototype, PROTOTYPE | {"main_wall_length": 0.64}, "the length of the main wall is given twice"),
        (prototype, PROTOTYPE | {"partitions_x": [0.0, 0.62]}, "a partition stands beyond the main wall; found 0.62 to 0.66 m"),
        (prototype, PROTOTYPE | {"partitions_x": [0.0, 0.03]}, "partitions overlap"),
        (prototype, PROTOTYPE | {"partition_length": 0.04}, "no longer than the main wall is thick"),
        (prototype, PROTOTYPE | {"first_course": "both"}, r"prototype\.first_course: unknown value"),
        (box, BOX | {"width": 0.08}, r"box\.width: no room inside"),
        (box, BOX | {"joints": "even"}, r"box\.joints: unknown value"),
    ],
)
def test_parameters_out_of_range_are_named(build, parameters, message):
    with pytest.raises(InputError, match=message):
        build(**parameters)


def test_a_wall_by_height_or_by_courses_is_the_same():
    by_courses = derive_blocks(wall(**WALL))
    by_height = derive_blocks(wall(length=0.32, brick=BRICK, height=0.15))
    np.testing.assert_array_equal(by_courses.points, by_height.points)


def test_stack_bond_has_continuous_head_joints():
    stones = derive_blocks(wall(**(WALL | {"pattern": "stack"})))
    assert (~stones.fixed).sum() == 5 * 4
    beds = find_contacts(stones)
    between = (beds.kind == "bed").sum()
    assert between == 4 * 4


def test_a_wall_with_a_door_and_a_window():
    openings = [
        {"start": 0.16, "width": 0.16, "height_courses": 6, "lintel_bearing": 0.04},
        {"start": 0.56, "width": 0.16, "sill_courses": 3, "height_courses": 3, "lintel_bearing": 0.08},
    ]
    stones = derive_blocks(wall(length=0.96, brick=BRICK, courses=9, thickness=0.1, openings=openings))
    holes = 0.16 * 0.18 + 0.16 * 0.09
    assert stones.volume[~stones.fixed].sum() == pytest.approx((0.96 * 0.27 - holes) * 0.1, rel=1e-12)
    lintels = stones.block_id[np.isclose(stones.volume, 0.24 * 0.03 * 0.1) | np.isclose(stones.volume, 0.32 * 0.03 * 0.1)]
    assert len(lintels) == 2


@pytest.mark.parametrize("half_angle", [math.pi / 2, 1.0, 2.0])
def test_an_arch_stands_between_two_skewbacks(half_angle):
    stones = derive_blocks(arch(**ARCH, half_angle=half_angle))
    assert stones.block_id[stones.fixed].tolist() == ["skewback-right", "skewback-left"]
    assert (~stones.fixed).sum() == 27
    # Straight-sided voussoirs: (R_o^2 - R_i^2)/2 sin(step) each.
    step = 2 * half_angle / 27
    np.testing.assert_allclose(stones.volume[~stones.fixed], 0.5 * (1.1**2 - 0.9**2) * math.sin(step) * 0.5, rtol=1e-9)
    contacts = find_contacts(stones)
    assert len(contacts.blocks) == 28
    assert len(contacts.point) == 4 * 28
    np.testing.assert_allclose(contacts.area, 0.2 * 0.5, rtol=1e-9)
    assert (contacts.kind == "base").sum() == 2


def test_a_box_with_windows():
    opening = {"start": 0.4, "width": 0.16, "sill_courses": 2, "height_courses": 4, "lintel_bearing": 0.08}
    stones = derive_blocks(box(**(BOX | {"courses": 10, "openings_x": [opening]})))
    plan = 1.0 * 0.8 - 0.92 * 0.72
    assert stones.volume[~stones.fixed].sum() == pytest.approx(plan * 0.3 - 2 * 0.16 * 0.12 * 0.04, rel=1e-12)


def test_the_default_joints_of_short_bricks_are_half_a_brick_off():
    # Targets: b = 40 mm takes through joints at 20 + 40 k, cut joints at 40 k; longer bricks start at 0.
    short = prototype(**(PROTOTYPE | {"brick": (0.04, 0.04, 0.03), "main_wall_bricks": 16})).panels[0].regions[0]
    assert (short.through_offset, short.cut_offset) == (0.02, 0.04)
    long = prototype(**PROTOTYPE).panels[0].regions[0]
    assert (long.through_offset, long.cut_offset) == (0.0, 0.04)
    given = prototype(**(PROTOTYPE | {"through_offset": 0.01, "cut_offset": 0.03})).panels[0].regions[0]
    assert (given.through_offset, given.cut_offset) == (0.01, 0.03)


def test_a_crown_may_touch_the_top_of_a_course():
    # 5.7 + 1.55 / 2 + 0.4 = 25 courses of 0.275, but for the last digit.
    circle = {"name": "rose", "wall": "back", "shape": "circle", "width": 1.55, "springing": 5.7, "voussoirs": 12, "depth": 0.4}
    sizes = {"course": 0.275, "stone_length": 0.6, "width": 6.713, "depth": 6.169, "height": 9.9, "thickness": 0.836}
    laid(tower(**sizes, openings=[circle | {"centre": 0.075}]))
