"""Soil or water against the face of a wall, and fill on the back of a vault."""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.bare import bare_triangles, open_triangles
from churchpipe.geometry.locate import inside_stones
from churchpipe.geometry.polygons import behind, below
from churchpipe.geometry.walls import WallLine, named_walls, points_of
from churchpipe.loading.bearing import CLOSE
from churchpipe.loading.ends import AGAINST, OUTERMOST, outward_of, pressed_ends
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.carried import Pressure
from churchpipe.model.fill import Fill
from churchpipe.model.polyhedra import face_normals

# A face bears fill if its normal rises more than this.
_UP = 1e-6


def pressure_forces(stones: Assemblage, wall: WallLine, load: Pressure) -> list[tuple[FloatArray, int, FloatArray]]:
    """Return the forces of a pressure on a wall: point (3,) m, stone, force (3,) N.

    What another stone lies against bears nothing. The rest of each face is cut into triangles, their parts below the surface,
    with the force of each where it acts. Where stones of other walls show in the face of this one, as at a toothed corner, they
    bear it, and so do the far ends of buttresses before it, and of what else the load names.

    Raises
    ------
    InputError: no face below the surface; a direction along the wall; ends of what does not stand before it.
    """
    outward = outward_of(wall, load)
    found: list[tuple[FloatArray, float, int, FloatArray]] = []

    def pressed(z: FloatArray) -> FloatArray:
        return load.coefficient * (load.unit_weight * (load.top - z) + load.surcharge)

    for stone, normal, corners in chain(_in_face(stones, wall, outward), pressed_ends(stones, wall, load)):
        found += [(*part, stone, normal) for part in _on_face(below(corners, load.top), pressed)]
    if not found:
        raise InputError(load.called, f"no face of the wall {wall.name} below z = {load.top:g} m on that side")
    place = np.array([point for point, *_ in found])
    free = ~inside_stones(stones, place + 10 * CLOSE * np.array([normal for *_, normal in found]))
    return [
        (point, stone, -size * normal)
        for (point, size, stone, normal), bare in zip(found, free.tolist(), strict=True)
        if bare and size > 0
    ]


def _in_face(stones: Assemblage, wall: WallLine, outward: FloatArray) -> Iterator[tuple[int, FloatArray, FloatArray]]:
    """Yield what shows in the face of a wall that looks outward (3,): a stone, the normal (3,) and the corners (k, 3) m of a
    part of a face of it, of stones of other walls between the ends of this one."""
    points = points_of(stones, wall.stones)
    front, foot = float((points @ outward).max()), float(points[:, 2].min())
    slack = OUTERMOST * wall.thickness
    own = np.isin(np.arange(stones.count), wall.stones)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    shown = ~stones.fixed[owner] & (normal @ outward > AGAINST) & (np.abs(mean @ outward - front) < slack + CLOSE)
    axis = np.append(wall.axis, 0.0)
    start = float(wall.origin @ wall.axis)
    corner = stones.points[stones.face_nodes]
    low, high = (edge.reduceat(corner, stones.face_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    shown &= np.minimum.reduceat(corner @ outward, stones.face_ptr[:-1]) > front - slack
    shown &= own[owner] | ((low[:, 2] >= foot - CLOSE) & (high[:, 2] <= wall.top + CLOSE))
    for face, triangles in bare_triangles(stones, np.flatnonzero(shown)):
        for part in triangles:
            inner = part if own[owner[face]] else behind(behind(part, axis, start + wall.length), -axis, -start)
            yield int(owner[face]), normal[face], inner


def fill_weights(stones: Assemblage, load: Fill) -> list[tuple[FloatArray, int, float]]:
    """Return the weight of the fill over parts of the stones below it: point (3,) m of the face under it, stone, weight N.

    Each column of fill stands on the face under it. What another stone stands over, below the surface, bears none.

    Raises
    ------
    InputError: a vault that is not there, nothing below the surface that looks up.
    """
    panel = stones.panel[~stones.fixed]
    for name in load.on:
        if not name or name not in panel:
            raise InputError(f"{load.called}: on", "no such vault", found=name, expected=named_walls(panel))
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    found: list[tuple[FloatArray, int, float]] = []
    for face, triangles in open_triangles(stones, backs(stones, load.on), load.top):
        for corners in triangles:
            parts = _on_face(below(corners, load.top), lambda z: load.unit_weight * (load.top - z))
            found += [(point, int(owner[face]), size * float(normal[face, 2])) for point, size in parts]
    if not found:
        expected = f"faces of {', '.join(load.on)} that look up, below z = {load.top:g} m"
        raise InputError(load.called, "nothing that it could lie on", expected=expected)
    return found


def backs(stones: Assemblage, names: Sequence[str]) -> IntArray:
    """Return the faces that look up of the free stones of some walls or vaults."""
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    chosen = np.isin(stones.panel, names) & ~stones.fixed
    return np.flatnonzero((normal[:, 2] > _UP) & np.repeat(chosen, np.diff(stones.block_face_ptr)))


def _on_face(polygon: FloatArray, pressed: Callable[[FloatArray], FloatArray]) -> list[tuple[FloatArray, float]]:
    """Return the force of each triangle of a convex polygon, N, and where it acts (3,) m.

    pressed: the pressure at heights (n,), Pa.
    """
    parts: list[tuple[FloatArray, float]] = []
    for k in range(1, len(polygon) - 1):
        triangle = polygon[[0, k, k + 1]]
        area = 0.5 * float(np.linalg.norm(np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])))
        at_corners = pressed(triangle[:, 2])
        if not area > 0 or not at_corners.sum() > 0:
            continue
        # A pressure linear over a triangle: corner k of three shares of A / 12 (p_k + sum p).
        share = (at_corners + at_corners.sum()) / 12
        parts.append((share @ triangle / share.sum(), area * float(share.sum())))
    return parts
