"""Joints hidden by nearer ones: at each place a face is joined to one neighbour, the nearest."""

import numpy as np

from churchpipe.geometry.planar import Region, area, areas, common, hull, less, mapped, pieces_of, united, widths
from churchpipe.model.arrays import FloatArray
from churchpipe.stones.facets import Facets
from churchpipe.stones.facing import Overlaps, measured
from churchpipe.stones.interfaces import Interfaces, frames

# A facet is examined if the area of its joints exceeds its own by this factor. A hidden part is kept if it is less than this
# share of its joint.
COVERED = 1.001
HIDDEN = 0.02


def uncovered(facets: Facets, exact: Interfaces, found: Overlaps, noise: float) -> Overlaps:
    """Return the overlaps without the parts that nearer joints hide.

    exact: the joints of facets in one plane, which are never hidden. Hidden strips narrower than the noise, m, are ignored.
    """
    sides = np.concatenate([exact.side, found.side])
    shared = np.concatenate([exact.area, found.area])
    covered = np.bincount(sides.ravel(), np.repeat(shared, 2), minlength=len(facets))
    polygon: list[Region] = found.polygon.tolist()
    changed = np.zeros(len(found), dtype=np.bool_)
    for facet in np.flatnonzero(covered > COVERED * facets.area).tolist():
        plane = frames(facets.normal[facet][None])[0]
        nearer = _of_exact(facets, exact, facet, plane)
        rows = np.flatnonzero((found.side == facet).any(axis=1))
        for row in rows[np.argsort(np.abs(found.middle[rows]), kind="stable")].tolist():
            # From the overlap's mean plane to the facet's plane.
            matrix = plane[1:] @ found.frame[row, 1:].T
            shift = plane[1:] @ (found.origin[row] - facets.centre[facet])
            own = mapped(polygon[row], matrix, shift)
            cover = united(nearer)
            hidden = pieces_of(np.array([common(own, cover)], dtype=np.object_))[0]
            if areas(hidden).sum() > HIDDEN * area(own) and widths(hidden).max(initial=0.0) > noise:
                own = less(own, [cover])
                back = np.linalg.inv(matrix)
                polygon[row], changed[row] = mapped(own, back, -back @ shift), True
            nearer.append(own)
    part, row = pieces_of(np.array(polygon, dtype=np.object_))
    keep = ~changed[row] | ((widths(part) > noise) & (areas(part) > HIDDEN * found.area[row]))
    part, row = part[keep], row[keep]
    return measured(facets, found.side[row], found.frame[row], found.origin[row], part) if changed.any() else found


def _of_exact(facets: Facets, exact: Interfaces, facet: int, plane: FloatArray) -> list[Region]:
    rows = np.flatnonzero((exact.side == facet).any(axis=1))
    corners = [exact.point[exact.point_ptr[row] : exact.point_ptr[row + 1]] for row in rows]
    return [hull((corner - facets.centre[facet]) @ plane[1:].T) for corner in corners]
