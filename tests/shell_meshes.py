"""Structured meshes of walls, plates and roofs, made by hand."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from churchpipe.homogenised_shell.element import shell_elements
from churchpipe.model.shell import ShellModel


def grid(nx: int, ny: int, width: float, height: float, cut: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Return points (n, 2) and triangles of a rectangle of nx x ny cells, each cut in two or, by its centre, in four."""
    x, y = np.meshgrid(np.linspace(0, width, nx + 1), np.linspace(0, height, ny + 1))
    points = np.column_stack([x.ravel(), y.ravel()])
    lower = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    a, b, c, d = lower, lower + 1, lower + nx + 2, lower + nx + 1
    if cut == 2:
        return points, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    centre = len(points) + np.arange(nx * ny)
    points = np.vstack([points, points[[a, b, c, d]].mean(axis=0)])
    return points, np.vstack([np.column_stack([i, j, centre]) for i, j in ((a, b), (b, c), (c, d), (d, a))])


def shell(
    points: np.ndarray,
    triangles: np.ndarray,
    *,
    bed: tuple[float, float, float] = (1, 0, 0),
    thickness: float = 0.04,
    surface_weight: float = 0.0,
    cell: tuple[float, float] = (0.03, 0.08),
    supported: Callable[[np.ndarray], np.ndarray] = lambda p: np.zeros(len(p), dtype=bool),
    yields: bool = True,
) -> ShellModel:
    """Return a shell of one material, its beds along `bed` projected on each facet."""
    nt = len(triangles)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    first = np.array(bed, dtype=float) - (normal @ np.array(bed, dtype=float))[:, None] * normal
    first /= np.linalg.norm(first, axis=1)[:, None]
    return ShellModel(
        points=points,
        triangles=triangles,
        axes=np.stack([first, np.cross(normal, first), normal], axis=1),
        thickness=np.full(nt, thickness),
        surface_weight=np.full(nt, surface_weight),
        cell=np.zeros(nt, dtype=np.int64),
        unit_cells=np.array([cell]),
        material=np.full(nt, "default"),
        panel=np.full(nt, "wall"),
        yields=np.full(nt, yields),
        supported=supported(points),
    )


def wall_points(points: np.ndarray) -> np.ndarray:
    """Put points (n, 2) of a wall in the x-z plane, its normal along -y."""
    return np.column_stack([points[:, 0], np.zeros(len(points)), points[:, 1]])


def plate_points(points: np.ndarray) -> np.ndarray:
    """Put points (n, 2) of a plate in the x-y plane, its normal along z."""
    return np.column_stack([points, np.zeros(len(points))])


def joined_walls(walls: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return one mesh of several (points (n, 3), triangles), nodes in the same place merged."""
    points = np.vstack([place for place, _ in walls])
    starts = np.cumsum([0, *(len(place) for place, _ in walls)])
    triangles = np.vstack([start + facets for start, (_, facets) in zip(starts[:-1], walls, strict=True)])
    _, first, same = np.unique(points.round(8), axis=0, return_index=True, return_inverse=True)
    return points[first], same.ravel()[triangles]


def check_follows_rigid_motions(shell: ShellModel, seed: int) -> None:
    """Assert that feet follow any rigid motion of what they stand on, without strain, where nothing supports the shell."""
    elements: Any = shell_elements(replace(shell, supported=np.zeros(len(shell.points), dtype=np.bool_)))
    velocity, spin = np.random.default_rng(seed).normal(size=(2, 3))
    moved = velocity + np.cross(spin, shell.points)
    turned = elements.edges.directions(shell.points) @ spin
    unknowns = np.concatenate([moved.ravel(), turned, np.zeros(len(elements.bubble_edge))])
    unknowns[elements.clamped] = 0.0
    np.testing.assert_allclose(elements.translations(unknowns), moved, atol=1e-12)
    np.testing.assert_allclose(elements.edge_rotation(unknowns), turned, atol=1e-12)
    np.testing.assert_allclose(elements.strain @ unknowns, 0.0, atol=1e-8)
