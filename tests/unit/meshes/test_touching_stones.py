"""Stones of any shape that touch, in one soup of triangles: told apart by the side on which each face is solid."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Voronoi

import churchpipe as cp
from churchpipe.findings import FindingsError
from churchpipe.model.arrays import FloatArray
from solids import box

SIZE = np.array([2.0, 0.5, 2.0])


def rubble(count: int, seed: int) -> list[FloatArray]:
    """Triangles (nt, 3, 3), counter-clockwise from outside, of stones that fill a block and share whole faces.

    Neighbours divide the face that they share along different diagonals. Mirrored seeds make the sides of the block plane.
    """
    seeds = np.random.default_rng(seed).random((count, 3)) * SIZE
    mirrored = [seeds + 2 * (side - seeds) * axis for axis in np.eye(3) for side in (0 * SIZE, SIZE)]
    cells = Voronoi(np.concatenate([seeds, *mirrored]))
    stones: list[FloatArray] = []
    for number in range(count):
        points = cells.vertices[cells.regions[cells.point_region[number]]]
        hull = ConvexHull(points)
        corners = points[hull.simplices]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        inwards = np.einsum("ij,ij->i", normal, hull.equations[:, :3]) < 0
        corners[inwards] = corners[inwards][:, ::-1]
        stones.append(corners)
    return stones


def soup(path: Path, stones: list[FloatArray], decimals: int = 6) -> Path:
    """Write all triangles as one solid of a text STL, in any order."""
    facets = np.random.default_rng(1).permutation(np.concatenate(stones))
    lines = ["solid rubble"]
    for facet in facets.tolist():
        corners = ["vertex " + " ".join(f"{value:.{decimals}f}" for value in corner) for corner in facet]
        lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid rubble"]) + "\n")
    return path


@pytest.mark.parametrize("outwards", [True, False])
@pytest.mark.parametrize("decimals", [15, 6, 4])
def test_rubble_is_told_apart_however_its_corners_are_rounded(decimals: int, outwards: bool, tmp_path: Path) -> None:
    # Rounded, the triangles on both sides of a joint no longer lie in one plane: which comes first about an edge is chance.
    stones = rubble(20, seed=0)
    given = stones if outwards else [corners[:, ::-1] for corners in stones]
    read, _ = cp.read_stones(soup(tmp_path / "a.stl", given, decimals), support="base", unit_weight=20e3)
    volumes = [float(np.linalg.det(corners - SIZE / 2).sum() / 6) for corners in stones]
    assert sorted(read.volume[~read.fixed].tolist()) == pytest.approx(sorted(volumes), abs=max(1e-5, 3 * 0.1**decimals))
    assert sum(volumes) == pytest.approx(SIZE.prod())


def test_thin_stones_that_meet_in_an_edge_are_told_apart(tmp_path: Path) -> None:
    # Two steps about a newel of no thickness, 5 degrees each.
    stones: list[FloatArray] = []
    for start in np.radians([0.0, 5.0]):
        outline = [(0.0, 0.0), *((2 * np.cos(a), 2 * np.sin(a)) for a in (start, start + np.radians(5.0)))]
        hull = [(x, y, z) for z in (0.0, 0.5) for x, y in outline]
        sides = [[k, (k + 1) % 3, (k + 1) % 3 + 3, k + 3] for k in range(3)]
        fans = [(2, 1, 0), (3, 4, 5), *((f[0], f[k], f[k + 1]) for f in sides for k in (1, 2))]
        stones.append(np.array(hull)[np.array(fans)])
    read, _ = cp.read_stones(soup(tmp_path / "a.stl", stones, 9), support="base", unit_weight=20e3)
    assert read.volume[~read.fixed] == pytest.approx([np.sin(np.radians(5.0))] * 2)


def test_a_stone_with_a_hole_is_told_from_the_sound_ones_that_it_touches(tmp_path: Path) -> None:
    stones = rubble(20, seed=0)
    # Of a triangle on the side of the block; the neighbours are whole.
    open_air = [(abs(s[:, :, 1]) < 1e-9).all(axis=1) for s in stones]
    broken = next(k for k, outside in enumerate(open_air) if outside.any())
    stones[broken] = np.delete(stones[broken], np.flatnonzero(open_air[broken])[0], axis=0)
    path = soup(tmp_path / "a.stl", stones)
    with pytest.raises(FindingsError, match=r"E10 .*do not close a solid, an open edge") as raised:
        cp.read_stones(path, support="base", unit_weight=20e3)
    assert len(raised.value.findings.errors) == 1
    read, _ = cp.read_stones(path, support="base", unit_weight=20e3, repair=True)
    assert read.volume[~read.fixed].sum() == pytest.approx(SIZE.prod(), rel=1e-5)
    assert (~read.fixed).sum() == 20


@pytest.mark.parametrize("lost", range(4))
def test_a_face_that_is_missing_where_two_stones_touch_is_named(lost: int, tmp_path: Path) -> None:
    # Each of the four triangles of the common face in turn; without it the two stones are one body with faces on each other.
    stones: list[FloatArray] = []
    for low in (0.0, 0.5):
        points, faces = box((0, 1), (0, 1), (low, low + 0.5))
        stones.append(np.concatenate([points[[[f[0], f[1], f[2]], [f[0], f[2], f[3]]]] for f in faces]))
    soup_ = np.concatenate(stones)
    joint = np.flatnonzero((soup_[:, :, 2] == 0.5).all(axis=1))
    gone = soup_[joint[lost]]
    with pytest.raises(FindingsError, match=r"a face is missing beside this edge, .*: 3 edges have an odd number") as raised:
        cp.read_stones(soup(tmp_path / "a.stl", [np.delete(soup_, joint[lost], axis=0)]), support="base")
    (error,) = raised.value.findings.errors
    assert error.position is not None
    middles = (gone + np.roll(gone, 1, axis=0)) / 2
    assert np.abs(middles - error.position).max(axis=1).min() < 1e-9


def test_stones_that_cannot_be_told_apart_are_said_to_be_perhaps_several(tmp_path: Path) -> None:
    # Half of the triangles look inwards: nothing says on which side the stones are.
    points, faces = box((0, 1), (0, 1), (0, 0.5))
    corners = np.concatenate([points[[[f[0], f[1], f[2]], [f[0], f[2], f[3]]]] for f in faces])
    mixed = np.concatenate([corners, corners + np.array([0, 0, 0.5])])
    mixed[::2] = mixed[::2, ::-1]
    with pytest.raises(FindingsError) as raised:
        cp.read_stones(soup(tmp_path / "a.stl", [mixed]), support="base")
    said = str(raised.value)
    assert "If these are several stones that touch" in said
    assert "each as an object or a file of its own" in said
