"""Nets of lines drawn by hand: of random masonry, whose lines meet three at a place, no stone is lost and none is added."""

import numpy as np
import pytest
import shapely
from scipy.spatial import Voronoi

from churchpipe.geometry.nets import net_of
from churchpipe.model.arrays import FloatArray

LENGTH, HEIGHT, STONES = 2.5, 1.6, 18
# Stones of a net whose shortest line is this long, m, or longer: an end may be off by more than a shorter one is long.
SHORTEST = 0.04


def masonry(seed: int) -> list[FloatArray]:
    """The outlines of random stones that fill a wall; mirrored seeds make its borders straight."""
    seeds = np.random.default_rng(seed).random((STONES, 2)) * [LENGTH, HEIGHT]
    while True:
        mirrored = [seeds * [-1, 1], seeds * [1, -1], [2 * LENGTH, 0] - seeds * [1, -1], [0, 2 * HEIGHT] - seeds * [-1, 1]]
        cells = Voronoi(np.concatenate([seeds, *mirrored]))
        stones = [shapely.MultiPoint(cells.vertices[cells.regions[cells.point_region[k]]]).convex_hull for k in range(STONES)]
        outlines = [shapely.get_coordinates(stone)[:-1] for stone in stones]
        if min(float(np.linalg.norm(np.roll(o, -1, axis=0) - o, axis=1).min()) for o in outlines) >= SHORTEST:
            return outlines
        # Towards stones of one size, in which short sides grow.
        seeds = np.array([shapely.get_coordinates(stone.centroid)[0] for stone in stones])


def drawn(outlines: list[FloatArray], past: float, off: float, seed: int) -> list[FloatArray]:
    """A line for each side; its ends run past their place, or fall short, by up to `past`, and lie beside it by up to `off`."""
    rng = np.random.default_rng(seed)
    sides: dict[tuple[float, ...], FloatArray] = {}
    for outline in outlines:
        for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            sides.setdefault(tuple(np.sort(np.round([a, b], 6), axis=0).ravel().tolist()), np.array([a, b]))
    out: list[FloatArray] = []
    for side in sides.values():
        along = (side[1] - side[0]) / np.linalg.norm(side[1] - side[0])
        out.append(side + rng.uniform(-past, past, (2, 1)) * along + rng.uniform(-off, off, (2, 2)))
    return out


@pytest.mark.parametrize(("past", "off"), [(0.0, 0.0), (0.001, 0.0), (0.005, 0.0), (0.0, 0.0003), (0.0, 0.001), (0.003, 0.001)])
@pytest.mark.parametrize("seed", range(6))
def test_ends_that_miss_each_other_enclose_the_stones_that_were_meant(past: float, off: float, seed: int) -> None:
    outlines = masonry(seed)
    net = net_of(drawn(outlines, past, off, seed), [])
    meshes = [shapely.Polygon(corners) for _, corners in net.meshes]
    assert len(meshes) == STONES
    assert not net.loose
    assert not net.alone
    for stone in map(shapely.Polygon, outlines):
        assert max(stone.intersection(mesh).area / stone.union(mesh).area for mesh in meshes) > 0.95
    assert bool(net.mended) == (past > 0 or off > 0)


@pytest.mark.parametrize("off", [0.0, 0.0003, 0.001])
def test_beds_drawn_in_pieces_that_miss_each_other_are_whole(off: float) -> None:
    # Running bond; the median line is 250 mm long. Where no head joint ends, two pieces of a bed point at each other.
    rng = np.random.default_rng(7)
    beds = [[[x / 4, z / 10], [(x + 1) / 4, z / 10]] for z in range(5) for x in range(10)]
    marks = [sorted({0.0, 2.5, *(np.arange(0, 2.5, 0.25) + 0.125 * (z % 2))}) for z in range(4)]
    heads = [[[x, z / 10], [x, (z + 1) / 10]] for z in range(4) for x in marks[z]]
    lines = [np.array(side) + rng.uniform(-off, off, (2, 2)) for side in [*beds, *heads]]
    net = net_of(lines, [])
    assert not net.loose
    assert len(net.meshes) == sum(len(row) - 1 for row in marks)
