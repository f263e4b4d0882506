"""The joints at the feet of a shell: how their corners move, what they stand on, and how wide they are."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.generators import arch
from churchpipe.generators.house import house
from churchpipe.homogenised_shell.edges import find_edges
from churchpipe.homogenised_shell.element import shell_elements
from churchpipe.homogenised_shell.foot_joints import foot_joints
from churchpipe.model.shell import ShellModel
from shell_meshes import grid, shell, wall_points

THICKNESS = 0.3


def wall(normal: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> ShellModel:
    points, triangles = grid(3, 2, 1.5, 1.0)
    model = shell(wall_points(points), triangles, thickness=THICKNESS, supported=lambda p: p[:, 2] < 1e-9)
    return replace(model, bed_normal=model.supported[:, None] * np.array(normal))


@pytest.mark.parametrize("normal", [(0.0, 0.0, 0.0), (0.0, 0.0, 2.0), (0.3, -0.2, 0.9), (1.0, 0.0, 0.0)])
def test_corners_move_as_those_of_a_rigid_body(normal: tuple[float, float, float]) -> None:
    model = wall(normal)
    edges = find_edges(model.triangles)
    joints = foot_joints(model, edges)
    assert joints.count == 6
    rng = np.random.default_rng(3)
    shift, turn = rng.normal(size=3), rng.normal(size=3)
    nodes = shift + np.cross(turn, model.points)
    unknowns = np.concatenate([nodes.ravel(), edges.directions(model.points) @ turn])
    found = np.asarray(joints.motion @ unknowns).reshape(-1, 2, 3)
    along = edges.directions(model.points)[joints.edge]
    # One along the edges tells nothing.
    given = np.array(normal) if any(normal[1:]) else np.array([0.0, 0.0, 1.0])
    away = given - (along @ given)[:, None] * along
    away /= np.linalg.norm(away, axis=1)[:, None]
    frame = np.stack([away, along, np.cross(away, along)], axis=1)
    for corner, side in enumerate((-0.5, 0.5)):
        place = model.points[joints.node] + side * THICKNESS * frame[:, 2]
        expected = np.einsum("pkc,pc->pk", frame, shift + np.cross(turn, place))
        np.testing.assert_allclose(found[:, corner], expected, atol=1e-12)


def test_leaves_stand_each_for_itself() -> None:
    whole, model = wall(), replace(wall(), bonds=np.array(["leaves"]))
    edges = find_edges(model.triangles)
    turned = np.concatenate([np.zeros(3 * len(model.points)), np.ones(len(edges.nodes))])
    rise = [float(np.abs(np.asarray(foot_joints(one, edges).motion @ turned)).max()) for one in (whole, model)]
    assert rise == pytest.approx([THICKNESS / 2, THICKNESS / 4])


def test_what_a_shell_stands_on_is_known_from_the_building() -> None:
    ring = cp.derive_shell(arch(mean_radius=2.0, thickness=0.4, width=0.8, voussoirs=17, half_angle=1.0), 0.4)
    # A skewback is square to the arch: its normal is the tangent, upwards.
    radius = ring.points[ring.supported] * [1.0, 0.0, 1.0]
    radius /= np.linalg.norm(radius, axis=1)[:, None]
    tangent = np.cross(radius, [0.0, 1.0, 0.0])
    tangent *= np.sign(tangent[:, 2])[:, None]
    np.testing.assert_allclose(ring.bed_normal[ring.supported], tangent, atol=1e-3)
    storeys = [{"above": 1.0, "thickness": 0.3}]
    room = house(
        course=0.25,
        stone_length=0.5,
        height=2.0,
        thickness=0.5,
        walls=[{"name": "a", "start": (0.0, 0.0), "end": (3.0, 0.0), "storeys": storeys}],
        materials=[cp.Material("default", 18e3, 0.6)],
    )
    both = cp.derive_shell(room, 0.5)
    np.testing.assert_array_equal(both.bed_normal[both.supported], np.tile([0.0, 0.0, 1.0], (int(both.supported.sum()), 1)))
    elements = shell_elements(both, on_joints=True)
    assert elements.feet is not None
    assert set(both.thickness[elements.feet.facet].tolist()) == {0.5, 0.3}
    # Without joints nothing moves at the feet.
    assert shell_elements(both).clamped.sum() > elements.clamped.sum()


def test_the_strain_of_a_facet_shows_what_happens_in_the_joint_below_it() -> None:
    model = replace(wall(), bed_normal=np.zeros((0, 3)))
    elements = shell_elements(model, "CST", on_joints=True)
    low = (model.supported[model.triangles].sum(axis=1) == 2).nonzero()[0]
    turn, lift = np.array([0.01, 0.0, 0.0]), np.array([0.0, 0.0, 0.002])
    nodes = lift + np.cross(turn, model.points)
    unknowns = np.concatenate([nodes.ravel(), elements.edges.directions(model.points) @ turn])
    found = elements.facet_strain(unknowns)
    # Each of the three facets at the foot, .5 m wide and .125 m2 large, has one joint; no other facet is strained.
    expected = np.zeros((len(model.triangles), 6))
    expected[low, 1] = 0.002 * 0.5 / model.area[low]
    np.testing.assert_allclose(found[:, :3], expected[:, :3], atol=1e-12)
    assert np.abs(found[low, 4]) == pytest.approx(0.01 * 0.5 / model.area[low], rel=1e-9)
    # The wall turns about the foot as its facets bend: away from its outer face.
    bent = shell_elements(model, "CST")
    tilted = np.where(model.points[:, 2:] > 1e-9, nodes - lift, 0.0)
    still = model.supported[bent.edges.nodes].all(axis=1)
    held = np.concatenate([tilted.ravel(), np.where(still, 0.0, bent.edges.directions(model.points) @ turn)])
    assert (np.sign(found[low, 4]) == np.sign(bent.facet_strain(held)[low, 4])).all()
