"""How long the edge is along which an anchor plate punches out of a wall."""

from itertools import product

import numpy as np
import shapely
from shapely import MultiPoint

from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage

# Gaps as wide as twice this, m, are joints, and no free edges.
_JOINT = 0.025
# The section lies so little beside the middle of the wall, on which joints between two leaves may lie.
_DEPTH = 0.501
# A side that goes on to a free edge ends so far beyond it, m, and so many edges are tried on each side.
_BEYOND, _TRIED = 1e-3, 5


def punched_edge(
    stones: Assemblage, centre: FloatArray, outward: FloatArray, plate: tuple[float, float], thickness: float
) -> float:
    """Return the length, m, of what shears where a plate punches a pyramid at 45 degrees out of a wall, half way through.

    In the midst of a wall it is 2 (b + h + 2 t), the perimeter of a rectangle of (b + t) x (h + t). Near the top of the wall, its
    end or an opening only the sides within the masonry hold; and where it is shorter so, the pyramid breaks out to such an edge,
    as slabs do near their edges (EN 1992-1-1, 6.4.2). The least of these lengths counts.

    Parameters
    ----------
    stones
        Those of the wall and of what stands beside it; fixed ones hold as well.
    centre
        Of the plate (3,) m, on the face of the wall.
    outward
        Unit vector (3,) that the face looks along.
    plate
        Its width b, level, and its height h, m.
    thickness
        Of the wall, t, m.
    """
    frame = level_frame(outward)
    half = 0.5 * (np.array(plate) + thickness)
    masonry = _section(stones, centre - _DEPTH * thickness * outward, frame, outward, float(half.sum()))
    corners = shapely.get_coordinates(masonry)
    tried = [_stops(corners[:, axis], sign, half[axis], half[1 - axis]) for axis in (0, 1) for sign in (-1, 1)]
    left, right, down, up = np.array(list(product(*tried))).T
    around = shapely.boundary(shapely.box(-left, -down, right, up))
    return float(shapely.length(shapely.intersection(around, masonry)).min())


def level_frame(normal: FloatArray) -> FloatArray:
    """Return a level and a rising unit vector (2, 3) in the plane of a face."""
    level = np.array([-normal[1], normal[0], 0.0])
    length = float(np.linalg.norm(level))
    level = level / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    return np.array([level, np.cross(normal, level)])


def _stops(place: FloatArray, sign: int, half: float, across: float) -> list[float]:
    """Return how far (n,) m one side of the pyramid may lie from the plate's middle: where 45 degrees put it, or at a free edge.

    The two sides beside it grow by as much as it moves out, so that it does not pay to move it further than half its length.
    """
    beyond = sign * place
    edges = np.unique(beyond[(beyond > half - _BEYOND) & (beyond < half + across)].round(3))
    return [half, *(edges[:_TRIED] + _BEYOND).tolist()]


def _section(stones: Assemblage, origin: FloatArray, frame: FloatArray, normal: FloatArray, reach: float) -> shapely.Geometry:
    """Return the masonry that a plane through `origin` cuts, in the axes (2, 3) of the plane, its joints closed: all stones that
    come as near to its origin as `reach`, m, along both axes."""
    place, starts = (stones.points - origin) @ np.array([normal, *frame]).T, stones.block_point_ptr[:-1]
    within = np.array([0.0, reach + 2 * _JOINT, reach + 2 * _JOINT])
    cut = (np.minimum.reduceat(place, starts) < within).all(axis=1) & (np.maximum.reduceat(place, starts) > -within).all(axis=1)
    parts: list[FloatArray] = []
    for stone in np.flatnonzero(cut).tolist():
        points, faces = stones.solid(stone)
        ends = np.array([pair for face in faces for pair in zip(face, [*face[1:], face[0]], strict=True)])
        side = np.asarray(points - origin) @ normal
        first, last = side[ends[:, 0]], side[ends[:, 1]]
        crosses = first * last < 0
        share = (first[crosses] / (first[crosses] - last[crosses]))[:, None]
        crossed = points[ends[crosses, 0]] * (1 - share) + points[ends[crosses, 1]] * share
        parts.append((crossed - origin) @ frame.T)
    cuts = [MultiPoint(part).convex_hull for part in parts]
    grown = shapely.buffer(shapely.union_all(cuts), _JOINT, join_style="mitre")
    return shapely.simplify(shapely.buffer(grown, -_JOINT, join_style="mitre"), 1e-4)
