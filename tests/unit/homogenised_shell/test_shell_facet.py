from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.linalg import spsolve

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.edges import find_edges
from churchpipe.homogenised_shell.element import Membrane, ShellElements, shell_elements, surface_load
from churchpipe.model.shell import ShellModel
from shell_meshes import grid, joined_walls, plate_points, shell, wall_points


def rigid_motion(elements: ShellElements, translation: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Return the unknowns (n,) of a rigid motion: translation (3,) m of the origin, small rotation (3,) rad about it."""
    points = elements.shell.points
    turn = elements.edges.directions(points) @ rotation
    return np.concatenate([(translation + np.cross(rotation, points)).ravel(), turn, np.zeros(len(elements.bubble_edge))])


def corner_of_walls() -> ShellModel:
    """Three walls on one vertical edge, at 90 and 37 degrees, facets wound both ways and normals to both sides."""
    flat, one = grid(2, 2, 0.8, 0.9)
    angles = [0.0, np.pi / 2, np.radians(217)]
    walls = [(np.column_stack([flat[:, 0] * np.cos(t), flat[:, 0] * np.sin(t), flat[:, 1]]), one) for t in angles]
    points, triangles = joined_walls(walls)
    triangles[::3] = triangles[::3, ::-1]
    model = shell(points, triangles, bed=(1.0, 0.3, 0.1), surface_weight=700.0, supported=lambda p: p[:, 2] < 1e-9)
    turned = np.array(model.axes)
    turned[::2, 1:] *= -1
    return replace(model, axes=turned)


def irregular_plate(membrane: Membrane) -> ShellElements:
    """An irregular plate that lies askew in space."""
    points, triangles = grid(3, 3, 1.0, 1.2)
    inner: Any = (points > 1e-9).all(axis=1) & (points < [0.99, 1.19]).all(axis=1)
    points = points + inner[:, None] * np.random.default_rng(2).uniform(-0.07, 0.07, points.shape)
    turn, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    return shell_elements(shell(plate_points(points) @ turn.T, triangles, bed=tuple(turn[:, 0])), membrane)


@pytest.mark.parametrize("membrane", ["LST", "CST"])
@settings(max_examples=25, deadline=None)
@given(motion=st.lists(st.floats(-1, 1), min_size=6, max_size=6))
def test_rigid_motions_of_folded_walls_do_not_strain(membrane: Membrane, motion: list[float]) -> None:
    elements = shell_elements(corner_of_walls(), membrane)
    strain = elements.strain @ rigid_motion(elements, np.array(motion[:3]), np.array(motion[3:]))
    # Curvatures over the facets' size, .2 m.
    assert np.abs(strain).max() < 1e-12


@pytest.mark.parametrize("membrane", ["LST", "CST"])
def test_free_walls_have_six_motions_without_strain(membrane: Membrane) -> None:
    model = corner_of_walls()
    elements = shell_elements(model, membrane)
    stiffness = elements.stiffness_matrix(np.broadcast_to(np.diag([1, 1, 1, 0.01, 0.01, 0.01]), (len(model.triangles), 6, 6)))
    values = np.linalg.eigvalsh(stiffness.toarray())
    assert (values < 1e-9 * values[-1]).sum() == 6


def plane_motion(elements: ShellElements, gradient: np.ndarray, quadratic: np.ndarray, bend: np.ndarray) -> np.ndarray:
    """Return the unknowns of u_a = gradient_ab x_b + quadratic_abc x_b x_c, w = -1/2 x bend x in the axes of a flat plate."""
    model, axes = elements.shell, elements.shell.axes[0]
    nodes = model.points @ axes[:2].T
    middle = nodes[elements.edges.nodes].mean(axis=1)

    def translation(x: np.ndarray) -> np.ndarray:
        return x @ gradient.T + np.einsum("abc,nb,nc->na", quadratic, x, x)

    deflection = -0.5 * np.einsum("nb,bc,nc->n", nodes, bend, nodes)
    along = elements.edges.directions(model.points) @ axes[:2].T
    left = np.column_stack([-along[:, 1], along[:, 0]])
    slope = -np.einsum("eb,bc,ec->e", left, bend, middle)
    ends = translation(nodes)[elements.edges.nodes].mean(axis=1)
    beyond = (translation(middle) - ends) @ axes[:2]
    bubbles = np.einsum("bc,bc->b", beyond[elements.bubble_edge], elements.bubble_direction)
    return np.concatenate([(np.column_stack([translation(nodes), deflection]) @ axes).ravel(), slope, bubbles])


def test_linear_strain_and_constant_curvature_are_exact() -> None:
    elements = irregular_plate("LST")
    rng = np.random.default_rng(8)
    gradient, quadratic, bend = rng.normal(size=(2, 2)), rng.normal(size=(2, 2, 2)), rng.normal(size=(2, 2))
    quadratic, bend = quadratic + quadratic.transpose(0, 2, 1), bend + bend.T
    strain = (elements.strain @ plane_motion(elements, gradient, quadratic, bend)).reshape(-1, 3, 6)
    corners = elements.shell.points[elements.shell.triangles] @ elements.shell.axes[0, :2].T
    stations = np.einsum("qk,fkb->fqb", (np.ones((3, 3)) + 3 * np.eye(3)) / 6, corners)
    slope = gradient + 2 * np.einsum("abc,fqc->fqab", quadratic, stations)
    expected = [slope[..., 0, 0], slope[..., 1, 1], slope[..., 0, 1] + slope[..., 1, 0]]
    np.testing.assert_allclose(strain[..., :3], np.stack(expected, axis=-1), atol=1e-11)
    np.testing.assert_allclose(
        strain[..., 3:], np.broadcast_to([bend[0, 0], bend[1, 1], 2 * bend[0, 1]], (len(corners), 3, 3)), atol=1e-11
    )


@pytest.mark.parametrize("membrane", ["LST", "CST"])
def test_patch_is_in_equilibrium_under_constant_stress(membrane: Membrane) -> None:
    elements = irregular_plate(membrane)
    model = elements.shell
    stiffness = np.diag([3.0, 2.0, 1.0, 0.3, 0.2, 0.1])
    stiffness[0, 1] = stiffness[1, 0] = stiffness[3, 4] = stiffness[4, 3] = 0.05
    matrix = elements.stiffness_matrix(np.broadcast_to(stiffness, (len(model.triangles), 6, 6)))
    exact = plane_motion(elements, np.array([[0.3, -0.2], [0.7, 0.4]]), np.zeros((2, 2, 2)), np.array([[0.5, 0.2], [0.2, -0.6]]))
    on_border = elements.edges.facets == 1
    node = np.zeros(len(model.points), dtype=bool)
    node[elements.edges.nodes[on_border]] = True
    free = np.flatnonzero(~np.concatenate([np.repeat(node, 3), on_border, on_border[elements.bubble_edge]]))
    held = np.setdiff1d(np.arange(elements.unknowns), free)
    found = spsolve(matrix[free][:, free], -matrix[free][:, held] @ exact[held])
    assert len(free) > 30
    np.testing.assert_allclose(found, exact[free], atol=1e-11)


@pytest.mark.parametrize("membrane", ["LST", "CST"])
def test_load_does_the_work_of_the_weight(membrane: Membrane) -> None:
    model = corner_of_walls()
    elements = shell_elements(model, membrane)
    direction = np.array([0.3, -0.2, -1.0])
    force = surface_load(elements, model.surface_weight[:, None] * direction)
    total = 3 * 0.8 * 0.9 * 700.0
    assert model.weight.sum() == pytest.approx(total)
    centre = model.weight @ model.points[model.triangles].mean(axis=1) / total
    rng = np.random.default_rng(6)
    for move, turn in rng.normal(size=(4, 2, 3)):
        work = total * direction @ (move + np.cross(turn, centre))
        assert force @ rigid_motion(elements, move, turn) == pytest.approx(work)


def test_quadratic_motion_meets_its_exact_work() -> None:
    # Work of a unit load along x on u = x^2 over 1 x 1.2: 1.2 / 3.
    points, triangles = grid(3, 2, 1.0, 1.2)
    elements = shell_elements(shell(plate_points(points), triangles), "LST")
    quadratic = np.zeros((2, 2, 2))
    quadratic[0, 0, 0] = 1.0
    motion = plane_motion(elements, np.zeros((2, 2)), quadratic, np.zeros((2, 2)))
    assert surface_load(elements, np.tile([1.0, 0, 0], (len(triangles), 1))) @ motion == pytest.approx(0.4, rel=1e-12)


def test_clamped_are_supported_nodes_and_the_border_between_them() -> None:
    points, triangles = grid(2, 2, 1.0, 1.0)
    elements = shell_elements(shell(wall_points(points), triangles, supported=lambda p: p[:, 2] < 1e-9), "LST")
    assert elements.translations(elements.clamped).all(axis=1).sum() == 3
    base = np.flatnonzero(elements.edge_rotation(elements.clamped))
    np.testing.assert_array_equal(elements.shell.points[elements.edges.nodes[base]][:, :, 2], 0)
    assert len(base) == 2
    assert elements.clamped[3 * len(points) + len(elements.edges.nodes) :].sum() == 4


def test_an_edge_inside_the_surface_turns_even_between_supported_nodes() -> None:
    # A square cut by its diagonal, held all round: the diagonal joins two supported corners.
    points, triangles = grid(1, 1, 1.0, 1.0, cut=2)
    elements = shell_elements(shell(plate_points(points), triangles, supported=lambda p: np.ones(len(p), dtype=bool)))
    np.testing.assert_array_equal(elements.edge_rotation(elements.clamped), elements.edges.facets == 1)


def test_mid_sides_move_out_of_the_surface_at_folds_only() -> None:
    model = corner_of_walls()
    elements = shell_elements(model, "LST")
    count = np.bincount(elements.bubble_edge, minlength=len(elements.edges.nodes))
    shared = elements.edges.facets == 3
    assert shared.sum() == 2
    np.testing.assert_array_equal(count, np.where(shared, 3, 2))


def test_mid_sides_of_level_folds_move_in_the_surface_alone() -> None:
    # A wall under a slope of 45 degrees: no membrane resists a kink of the thrust between the ends of their common edge.
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1], [0, -1, 2], [1, -1, 2]])
    triangles = np.array([[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]])
    elements = shell_elements(shell(points, triangles), "LST")
    assert (np.bincount(elements.bubble_edge) == 2).all()


def test_edges_are_shared_by_any_number_of_facets() -> None:
    edges = find_edges(np.array([[0, 1, 2], [1, 0, 3], [4, 0, 1]]))
    shared = np.flatnonzero((edges.nodes == [0, 1]).all(axis=1))[0]
    assert edges.facets[shared] == 3
    assert (edges.of_facet == shared).sum(axis=1).tolist() == [1, 1, 1]
    assert len(edges.nodes) == 7


def test_unknown_membrane_is_named() -> None:
    with pytest.raises(InputError, match="unknown element; found DKT; expected LST, CST"):
        shell_elements(corner_of_walls(), "DKT")  # pyright: ignore[reportArgumentType]
