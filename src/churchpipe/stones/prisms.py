"""Flat tiles of a wall thickened into closed solids."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.bond.tiles import TileSet
from churchpipe.errors import InputError
from churchpipe.geometry.charts import lift
from churchpipe.geometry.planar import boxes, clip, polygon
from churchpipe.geometry.polygons import TOLERANCE, corners, snap, snap_onto
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of
from churchpipe.model.building import Chart, PlaneChart


@dataclass(frozen=True, slots=True)
class Solids:
    """Polyhedra as flat arrays, fields as in `Assemblage`: faces counter-clockwise from outside."""

    points: FloatArray
    face_nodes: IntArray
    face_ptr: IntArray
    block_face_ptr: IntArray
    block_point_ptr: IntArray


def thicken(chart: Chart, thickness: float, tiles: TileSet) -> Solids:
    """Return one closed solid for each tile, over its share of the wall's thickness (m)."""
    if isinstance(chart, PlaneChart):
        return _prisms(chart, thickness, tiles)
    return _bent_prisms(chart, thickness, tiles)


def stations_of(chart: Chart, tiles: TileSet) -> FloatArray:
    """Return s of all head joints of a curved wall, m. The wall is straight from one to the next.

    For a full circle they are repeated on both sides of the seam. Joints between voussoirs do not count.
    """
    laid = np.repeat(~tiles.voussoir, np.diff(tiles.corner_ptr))
    stations = np.unique(snap(tiles.corner[laid, 0]))
    if isinstance(chart, PlaneChart) or chart.sweep < 2 * np.pi:
        return stations
    turn = 2 * np.pi * chart.radius
    return np.unique(snap_onto(np.concatenate((stations - turn, stations, stations + turn)), stations))


def _prisms(chart: Chart, thickness: float, tiles: TileSet) -> Solids:
    """Right prisms: per tile of n corners first the n points of the back face, then those of the front face."""
    corner, pointer = tiles.corner, tiles.corner_ptr
    count = np.diff(pointer)
    start = np.repeat(pointer[:-1], count)
    size = np.repeat(count, count)
    local = np.arange(len(corner)) - start
    back = start + np.arange(len(corner))
    front = back + size
    after = np.where(local == size - 1, 1 - size, 1)
    points = np.empty((2 * len(corner), 3))
    points[back], points[front] = (lift(chart, corner, np.repeat(side * thickness, count)) for side in tiles.reach.T)
    nodes = np.empty(6 * len(corner), dtype=np.int64)
    nodes[6 * start + size - 1 - local] = back
    nodes[6 * start + size + local] = front
    sides = 6 * start + 2 * size + 4 * local
    for place, node in enumerate((back, back + after, front + after, front)):
        nodes[sides + place] = node
    # Faces of a tile: back and front with n corners each, then n sides of four.
    face_sizes = np.full(len(corner) + 2 * tiles.count, 4, dtype=np.int64)
    first_face = pointer[:-1] + 2 * np.arange(tiles.count)
    face_sizes[first_face] = face_sizes[first_face + 1] = count
    return Solids(points, nodes, pointer_of(face_sizes), pointer_of(count + 2), 2 * pointer)


def _bent_prisms(chart: Chart, thickness: float, tiles: TileSet) -> Solids:
    """Return the stones of a curved wall. Each is bent at all head joints of the wall, so that courses fit face to face."""
    stations = stations_of(chart, tiles)
    stones: list[tuple[FloatArray, list[IntArray]]] = []
    for number in range(tiles.count):
        outline = tiles.corner[tiles.corner_ptr[number] : tiles.corner_ptr[number + 1]].copy()
        # Tiles of different courses may differ in the last digit of one joint.
        outline[:, 0] = snap_onto(outline[:, 0], stations)
        flat, faces = _bend(outline, stations, int(tiles.course[number]))
        points = np.concatenate([lift(chart, flat, side * thickness) for side in tiles.reach[number]])
        stones.append((points, [np.array(face, dtype=np.int64) for face in faces]))
    return solids_of(stones)


def solids_of(stones: Sequence[tuple[FloatArray, Sequence[IntArray]]]) -> Solids:
    """Return polyhedra given one by one, as points (n, 3) m and the corners of each face, as flat arrays."""
    points, faces = [stone[0] for stone in stones], [face for stone in stones for face in stone[1]]
    offset = pointer_of([len(part) for part in points])
    shift = np.repeat(offset[:-1], [len(stone[1]) for stone in stones])
    return Solids(
        np.concatenate(points),
        np.concatenate([face + by for face, by in zip(faces, shift, strict=True)]),
        pointer_of([len(face) for face in faces]),
        pointer_of([len(stone[1]) for stone in stones]),
        offset,
    )


def _bend(outline: FloatArray, stations: FloatArray, course: int) -> tuple[FloatArray, list[list[int]]]:
    """Return the mid-surface points (n, 2) of one stone, and its faces: node k is on the back, n + k on the front."""
    after = np.roll(outline, -1, axis=0)
    if (np.abs(after - outline) > TOLERANCE).all(axis=1).any():
        raise InputError(
            f"course {course} of a curved wall", "a sloping edge", expected="upright and level edges in curved walls"
        )
    low, high = outline[:, 0].min(), outline[:, 0].max()
    s = stations[(stations >= low) & (stations <= high)]
    level = np.ones(len(s) - 1)
    strips = boxes(np.stack([s[:-1], level * outline[:, 1].min(), s[1:], level * outline[:, 1].max()], axis=1))
    corner, pointer = corners(clip(strips, polygon(outline))[0])
    snapped = np.stack([snap_onto(corner[:, 0], s), snap_onto(corner[:, 1], outline[:, 1])], axis=1)
    flat, inverse = np.unique(snapped, axis=0, return_inverse=True)
    count = len(flat)
    faces: list[list[int]] = []
    for piece in np.split(inverse.ravel(), pointer[1:-1]):
        faces += [piece[::-1].tolist(), (count + piece).tolist()]
    for start, stop in zip(outline, after, strict=True):
        # The nodes on one edge of the tile, in its direction: one side face, level or upright.
        axis = 0 if abs(stop[0] - start[0]) > TOLERANCE else 1
        inside = (flat[:, axis] - start[axis]) * (flat[:, axis] - stop[axis]) <= 0
        chain = np.flatnonzero(inside & (flat[:, 1 - axis] == start[1 - axis]))
        chain = chain[np.argsort(flat[chain, axis] * np.sign(stop[axis] - start[axis]))].tolist()
        faces.append(chain + [count + k for k in chain[::-1]])
    return flat, faces
