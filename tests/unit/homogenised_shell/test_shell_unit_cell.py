import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.unit_cell import cell_limit, joint_closing

COMPRESSION = np.array([-1.0, -1.0, 0, 0, 0, 0])


def cross_openings(a: float, b: float, h: float, motion: np.ndarray) -> list[np.ndarray]:
    """Openings at the twelve corners from rigid motions of the two blocks, in 3-D and one corner at a time."""
    e11, e22, g12, k11, k22, k12, *omega = motion
    strain = np.array([[e11, g12 / 2, 0], [g12 / 2, e22, 0], [0, 0, 0]])
    bend = np.array([[k11, k12 / 2, 0], [k12 / 2, k22, 0], [0, 0, 0]])
    joints = [((b, 0), 0, [(b / 2, -a / 2), (b / 2, a / 2)])]
    joints += [((b / 2, a), 1, [(0, a / 2), (b / 2, a / 2)]), ((-b / 2, a), 1, [(-b / 2, a / 2), (0, a / 2)])]
    out = []
    for neighbour, normal, corners in joints:
        v = np.array([*neighbour, 0.0])
        turn = np.array([-(bend @ v)[1], (bend @ v)[0], 0.0]) + omega
        for corner in corners:
            for depth in (-h / 2, h / 2):
                y = np.array([*corner, depth])
                there = strain @ v + [0, 0, -v @ bend @ v / 2] + np.cross(turn, y - v)
                jump = there - np.cross(omega, y)
                out.append(jump[[normal, 1 - normal, 2]])
    return out


def test_closing_is_the_relative_rigid_motion_of_neighbours() -> None:
    rng = np.random.default_rng(3)
    for a, b, h in rng.uniform(0.02, 0.9, (5, 3)):
        motion = rng.normal(size=9)
        closing = joint_closing(a, b, h) @ motion * a * b
        np.testing.assert_allclose(-closing, cross_openings(a, b, h, motion), atol=1e-12)


def test_cells_broadcast() -> None:
    many = joint_closing([0.03, 0.275], [0.08, 0.57], 0.04)
    assert many.shape == (2, 12, 3, 9)
    np.testing.assert_array_equal(many[1], joint_closing(0.275, 0.57, 0.04))


def test_compression_is_unbounded_and_tension_is_none() -> None:
    assert cell_limit(0.03, 0.08, 0.04, 0.7, COMPRESSION, base=COMPRESSION).factor == np.inf
    assert cell_limit(0.03, 0.08, 0.04, 0.7, -COMPRESSION, base=COMPRESSION).factor == pytest.approx(1, rel=1e-6)
    outside = cell_limit(0.03, 0.08, 0.04, 0.7, [0, 0, 1, 0, 0, 0], base=-COMPRESSION)
    assert outside.outcome == "infeasible"
    assert np.isnan(outside.factor)


def test_cohesion_moves_the_apex() -> None:
    h, friction, cohesion = 0.04, 0.7, 3e4
    apex = h * cohesion / friction
    direction = np.array([0.3, 0.4, 0.5, 0.2 * h, -0.1 * h, 0.3 * h])
    with_cohesion = cell_limit(0.03, 0.08, h, friction, direction, cohesion=cohesion)
    without = cell_limit(0.03, 0.08, h, friction, direction, base=apex * COMPRESSION)
    assert with_cohesion.factor == pytest.approx(without.factor, rel=1e-6)
    assert cell_limit(0.03, 0.08, h, friction, [0, 1, 0, 0, 0, 0], cohesion=cohesion).factor == pytest.approx(apex, rel=1e-6)


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({"a": 0.0}, "a"),
        ({"h": np.nan}, "h"),
        ({"friction": 0.0}, "friction"),
        ({"cohesion": -1.0}, "cohesion"),
        ({"direction": [0] * 6}, "direction"),
    ],
)
def test_values_out_of_range_are_named(changes: dict, where: str) -> None:
    with pytest.raises(InputError) as error:
        cell_limit(**({"a": 0.03, "b": 0.08, "h": 0.04, "friction": 0.7, "direction": COMPRESSION} | changes))
    assert error.value.where == where
