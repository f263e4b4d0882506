"""Ring beams: rigid stones along the tops of walls, which friction alone holds to the masonry."""

from collections.abc import Sequence

import numpy as np

from churchpipe.errors import InputError
from churchpipe.loading.walls import wall_line
from churchpipe.model.arguments import check_kind, listed, positive
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage, Polyhedron, assemble

# A wall's top is level to this, m.
_LEVEL = 1e-5
_BOX = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def with_ring_beams(
    stones: Assemblage,
    walls: Sequence[str],
    *,
    height: float,
    unit_weight: float = 25e3,
    width: float | None = None,
    begin: float | None = None,
    end: float | None = None,
) -> Assemblage:
    """Return the stones with a rigid beam on the level top of each of some walls.

    Each beam is one stone along its wall, in its middle, and rests on it by friction; beams that meet at a corner
    butt against each other. Its weight presses and is pushed as that of any stone.

    Parameters
    ----------
    stones
        With the names of their walls as `panel`.
    walls
        Names of straight walls.
    height
        Of the beams, m.
    unit_weight
        N/m3; that of concrete unless given.
    width
        Of the beams, m; None: the thickness of each wall.
    begin, end
        m along each wall, as in `LineLoad`, where a beam stops short of what stands higher; None: the wall's own ends.

    Returns
    -------
    Assemblage
        The stones, and after them the beams, as panels "beam on WALL" of the material of their wall.

    Raises
    ------
    InputError
        A wall that is not there, is not straight or has no level top; a beam wider than its wall, or without height.
    """
    check_kind("with_ring_beams: stones", stones, Assemblage)
    positive("ring beam: height", height)
    positive("ring beam: unit weight", unit_weight)
    out = stones
    taken: list[tuple[FloatArray, FloatArray]] = []
    for name in listed("with_ring_beams: walls", walls, str):
        where = f"ring beam on {name}"
        wall = wall_line(stones, name, where)
        wide = wall.thickness if width is None else width
        if not 0 < wide <= wall.thickness + _LEVEL:
            raise InputError(f"{where}: width", "out of range", found=wide, expected=f"> 0 and at most {wall.thickness:.6g} m")
        high = np.maximum.reduceat(stones.points[:, 2], stones.block_point_ptr[:-1])[wall.stones]
        upper = wall.stones[high > wall.top - _LEVEL]
        covered = stones.points[np.isin(np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr)), upper)]
        along = covered[np.abs(covered[:, 2] - wall.top) < _LEVEL, :2] @ wall.axis - float(wall.origin @ wall.axis)
        span = float(along.min()) if begin is None else begin, float(along.max()) if end is None else end
        if not along.min() - _LEVEL <= span[0] < span[1] <= along.max() + _LEVEL:
            found, expected = f"from {span[0]:g} m to {span[1]:g} m", f"within {along.min():.6g} and {along.max():.6g} m"
            raise InputError(where, "not on the wall's level top", found=found, expected=expected)
        for other, axis in taken:
            span = _shortened(wall.at(0.0), wall.axis, wide, span, other, axis)
        corners = np.array([[*wall.at(s, a), wall.top + z] for s in span for a in (-wide / 2, wide / 2) for z in (0.0, height)])
        taken.append((corners, wall.axis))
        out = _joined(out, (corners, _BOX), unit_weight, f"beam on {name}", str(stones.material[wall.stones[0]]))
    return out


def _shortened(
    origin: FloatArray, axis: FloatArray, wide: float, span: tuple[float, float], other: FloatArray, other_axis: FloatArray
) -> tuple[float, float]:
    """Return the span of a beam up to the face of another one that it would run into."""
    begin, end = span
    if abs(float(axis @ other_axis)) > 0.5:
        return span
    normal = np.array([-axis[1], axis[0]])
    along, across = (other[:, :2] - origin) @ axis, (other[:, :2] - origin) @ normal
    low, high = float(along.min()), float(along.max())
    if across.min() >= wide / 2 or across.max() <= -wide / 2 or low >= end or high <= begin:
        return span
    return (high, end) if low <= begin + wide else (begin, low)


def _joined(stones: Assemblage, solid: Polyhedron, unit_weight: float, panel: str, material: str) -> Assemblage:
    beam = Assemblage.from_polyhedra([solid], unit_weight, material=material, panel=panel, block_id=[panel])
    points, faces = len(stones.points), len(stones.face_ptr) - 1
    return assemble(
        points=np.concatenate([stones.points, beam.points]),
        face_nodes=np.concatenate([stones.face_nodes, beam.face_nodes + points]),
        face_ptr=np.concatenate([stones.face_ptr, beam.face_ptr[1:] + len(stones.face_nodes)]),
        block_face_ptr=np.concatenate([stones.block_face_ptr, beam.block_face_ptr[1:] + faces]),
        block_point_ptr=np.concatenate([stones.block_point_ptr, beam.block_point_ptr[1:] + points]),
        **{
            name: np.concatenate([getattr(stones, name), getattr(beam, name)])
            for name in ("unit_weight", "material", "panel", "course", "fixed", "block_id")
        },
    )
