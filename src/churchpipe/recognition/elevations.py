"""The outlines of stones seen from the front of their wall, and their sections with the mid-plane of another wall."""

import numpy as np

from churchpipe.geometry.planar import Polygons, Region, hulls, polygon, united
from churchpipe.model.arrays import FloatArray, IntArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Chart, CylinderChart, PlaneChart
from churchpipe.model.polyhedra import face_normals
from churchpipe.recognition.curved_walls import curved_coordinates
from churchpipe.stones.raggedness import STRAIGHT, Raggedness, face_lengths

# Corners of a curved wall are rounded to this, m, so that the faces of a bent stone meet.
ROUND = 12
ON_FACE = 1e-4


def elevations(stones: Assemblage, blocks: IntArray, chart: Chart, thickness: float, ragged: Raggedness = STRAIGHT) -> Polygons:
    """Return the front of each of some stones (n,) of a wall, in chart coordinates; ragged: how far corners lie off its faces."""
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    least, near = np.full(len(mean), 1 - 1e-6), ON_FACE
    if ragged.counted > 0:
        least = np.minimum(least, np.cos(ragged.turn(face_lengths(stones))))
        near = max(ON_FACE, ragged.flat)
    found: list[Region] = []
    for block in blocks:
        faces = np.arange(*stones.block_face_ptr[block : block + 2])
        if isinstance(chart, PlaneChart):
            faces = faces[normal[faces] @ np.cross(chart.s_axis, chart.t_axis) > least[faces]]
            rings = [flat(chart, _corners(stones, int(face))) for face in faces]
        else:
            faces = faces[np.abs(normal[faces, 2]) < ON_FACE]
            rings = [
                ring for face in faces for ring in _bent_front(chart, _corners(stones, int(face)), mean[face], thickness, near)
            ]
        found.append(united([polygon(ring) for ring in rings]))
    return np.array(found, dtype=np.object_)


def flat(chart: PlaneChart, points: FloatArray) -> FloatArray:
    """Return the chart coordinates (n, 2) of points (n, 3)."""
    return np.stack([(points - chart.origin) @ chart.s_axis, points[:, 2] - chart.origin[2]], axis=1)


def _bent_front(chart: CylinderChart, points: FloatArray, middle: FloatArray, thickness: float, near: float) -> list[FloatArray]:
    """Return the ring of a face on the outside of a curved wall, to `near` m; none for any other face."""
    ring, distance = curved_coordinates(chart, points)
    if (np.abs(distance - 0.5 * thickness) > near).any():
        return []
    # On a full circle a corner on the seam gets the s of the side on which its face lies.
    girth = 2 * np.pi * chart.radius
    centre = curved_coordinates(chart, middle[None])[0][0, 0]
    ring[:, 0] -= girth * np.round((ring[:, 0] - centre) / girth) if chart.sweep > 2 * np.pi - ON_FACE else 0.0
    return [np.round(ring, ROUND)]


def _corners(stones: Assemblage, face: int) -> FloatArray:
    return stones.points[stones.face_nodes[stones.face_ptr[face] : stones.face_ptr[face + 1]]]


def sections(stones: Assemblage, blocks: IntArray, chart: PlaneChart, contact_gap: float) -> Polygons:
    """Return the (convex hulls of the) sections of some stones with the plane of a chart, in its coordinates.

    Of stones that end at the plane, within `contact_gap` m: the faces that lie on it.
    """
    normal = np.cross(chart.s_axis, chart.t_axis)
    first = stones.block_face_ptr[:-1][blocks]
    face = ragged_indices(first, np.diff(stones.block_face_ptr)[blocks])
    count = np.diff(stones.face_ptr)[face]
    block = np.repeat(np.repeat(blocks, np.diff(stones.block_face_ptr)[blocks]), count)
    place = ragged_indices(stones.face_ptr[:-1][face], count)
    last = np.cumsum(count) - 1
    after = np.append(place[1:], 0)
    after[last] = stones.face_ptr[:-1][face]
    start, stop = stones.points[stones.face_nodes[place]], stones.points[stones.face_nodes[after]]
    height, top = (start - chart.origin) @ normal, (stop - chart.origin) @ normal
    cut = height * top < 0
    share = (height[cut] / (height[cut] - top[cut]))[:, None]
    on = np.abs(height) < contact_gap
    points = flat(chart, np.concatenate([start[cut] + share * (stop[cut] - start[cut]), start[on]]))
    _, owner = np.unique(np.concatenate([block[cut], block[on]]), return_inverse=True)
    order = np.argsort(owner, kind="stable")
    return hulls(points[order], owner.ravel()[order])
