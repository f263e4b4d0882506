"""How far corners of stones lie off their walls, as the stones tell."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from churchpipe.generators import prototype, tower
from churchpipe.model.assemblage import Assemblage
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.raggedness import STRAIGHT, raggedness
from solids import moved


def built() -> Assemblage:
    return derive_blocks(
        prototype(brick=(0.5, 0.25, 0.25), partitions_x=[0.0], partition_length=3.0, courses=4, main_wall_length=4.0)
    )


def turned(stones: Assemblage, degrees: float, step: float) -> Assemblage:
    """Stones turned in plan, with coordinates rounded to a step, m; 0 for none."""
    rotation = Rotation.from_euler("z", degrees, degrees=True).as_matrix()
    found = moved(stones, rotation, np.array([3.21, -1.7, 0.0]))
    return replace(found, points=step * np.round(found.points / step)) if step else found


@pytest.mark.parametrize("degrees", [0.0, 17.0, 33.0, 61.0])
def test_exact_stones_are_straight(degrees: float) -> None:
    assert raggedness(turned(built(), degrees, 0.0)) == STRAIGHT


def test_rounded_stones_along_the_axes_are_straight() -> None:
    assert raggedness(turned(built(), 0.0, 1e-3)) == STRAIGHT


@pytest.mark.parametrize("step", [1e-4, 1e-3, 2.5e-3])
@pytest.mark.parametrize("degrees", [17.0, 33.0, 61.0])
def test_rounded_stones_tell_how_far_their_corners_are_off(degrees: float, step: float) -> None:
    """The corner of a square of one step is half of its diagonal from its middle: no rounded corner is further off."""
    off = raggedness(turned(built(), degrees, step)).off
    assert 0.8 * step / np.sqrt(2) < off < 2.0 * step / np.sqrt(2)


@pytest.mark.parametrize("width", [4.0, 40.0])
def test_stones_of_an_exact_round_wall_are_straight(width: float) -> None:
    assert (
        raggedness(derive_blocks(tower(course=0.25, stone_length=0.5, width=width, height=0.5, thickness=0.5, plan="round")))
        == STRAIGHT
    )


def test_few_stones_drawn_askew_tell_nothing_of_the_others() -> None:
    stones = built()
    points = stones.points.copy()
    rng = np.random.default_rng(1)
    own = slice(*stones.block_point_ptr[1:3])
    _, corner = np.unique(np.round(points[own, :2], 6), axis=0, return_inverse=True)
    points[own, :2] += rng.uniform(-1e-3, 1e-3, (corner.max() + 1, 2))[corner.ravel()]
    assert raggedness(replace(stones, points=points)) == STRAIGHT


def test_corners_may_be_off_by_a_hundredth_of_the_thickness() -> None:
    """Courses are .25 m high: a hundredth of that is less than centimetres take corners off, and more than millimetres do."""
    assert not raggedness(turned(built(), 33.0, 1e-3)).too_much
    coarse = raggedness(turned(built(), 33.0, 1e-2))
    assert coarse.too_much
    assert coarse.flat == STRAIGHT.flat


def test_low_courses_are_as_thick_as_their_wall() -> None:
    low = prototype(brick=(0.5, 0.25, 0.05), partitions_x=[0.0], partition_length=3.0, courses=4, main_wall_length=4.0)
    assert raggedness(turned(derive_blocks(low), 33.0, 1e-3)).most == pytest.approx(0.01 * 0.25, rel=0.01)
