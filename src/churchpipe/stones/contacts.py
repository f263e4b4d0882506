"""Interfaces between stones: every pair of opposite faces that meet, exactly or nearly."""

from dataclasses import replace

import numpy as np

from churchpipe.geometry.planar import hull_corners, widths
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOUCHING, Contacts, ContactTolerances
from churchpipe.model.doubts import doubt_argument
from churchpipe.stones.contact_tolerances import MOST_ANGLE, Limits, given_or_none, limits_of, search_reach
from churchpipe.stones.coplanar import coplanar_interfaces
from churchpipe.stones.covering import uncovered
from churchpipe.stones.facets import Facets, facets_of, perimeters
from churchpipe.stones.facing import Overlaps, facing
from churchpipe.stones.interfaces import Interfaces, chosen, contacts_of, joined
from churchpipe.stones.near_misses import near_misses
from churchpipe.stones.raggedness import raggedness

# A facet is covered when its exact joints leave no more than this share of its area free.
COVERED = 1e-6
# Exact interfaces are all that two facets share, unless the rest of their overlap is more than this share of it.
SAME_AREA = 1e-4
# Overlaps narrower than the corners are exact are no joints, unless they are this share of the narrower facet's width.
NARROW_SHARE = 0.25
# Facets that are parallel enough only because their surfaces are curved share at least this part of the smaller one: the tip of
# a stone cut to two chords of an arch touches the next voussoir, and does not rest on it.
BENT_SHARE = 0.05
# Normals of faces that are parallel differ by less than this, rad: so much is lost where coordinates are rounded.
FOLD = 1e-3


def find_contacts(
    stones: Assemblage,
    contact_gap: float | None = None,
    contact_angle: float | None = None,
    overlap: float | None = None,
    least_width: float | None = None,
) -> Contacts:
    """Return the interfaces of an assemblage with their contact points, the near misses, and the tolerances used.

    First, opposite faces in one plane become joints, exactly as drawn. The faces that remain are then taken as facets:
    neighbouring triangles and strips of one nearly plane surface count as one. Two facets that face each other within the
    tolerances become a joint in the plane midway between them. At each place a face is joined to its nearest neighbour only.

    The contact points are the corners of the overlap, without those on a straight edge. Where the overlap is not convex they are
    the corners of its convex hull, which can carry the same forces. Stones that overlap or float are found by `check_soundness`,
    not here.

    Parameters
    ----------
    stones
        The assemblage.
    contact_gap
        Greatest distance of the two faces of a joint where they are nearest, m. Tolerances that are not given are
        proposed from the gaps and angles of the stones, and are at most half the thickness of the thinnest one. Joints that
        are too wide in the middle are then rejected as well. What is rejected is among `Contacts.near_misses`.
    contact_angle
        Greatest angle between the two faces, rad.
    overlap
        Greatest depth to which two stones may interpenetrate, m.
    least_width
        Least width of a joint, m. Narrower strips are none, unless they are a quarter of the narrower face. Where four stones
        grown into their mortar meet, two that lie across from each other touch by as much as their faces were drawn uneven: a
        fifth of the mortar's width leaves that out.

    Raises
    ------
    InputError
        No assemblage, or a tolerance that is not positive.
    """
    check_kind("find_contacts: stones", stones, Assemblage)
    contact_gap = given_or_none("contact_gap", contact_gap)
    contact_angle = given_or_none("contact_angle", contact_angle, most=0.5 * np.pi)
    overlap = given_or_none("overlap", overlap)
    least_width = given_or_none("least_width", least_width) or 0.0
    doubt_argument("find_contacts: contact_gap", contact_gap, ContactTolerances, "contact_gap")
    doubt_argument("find_contacts: overlap", overlap, ContactTolerances, "overlap")
    facets = facets_of(stones)
    exact = _exact(stones, facets, min(TOUCHING, contact_gap or TOUCHING))
    sure = np.all(facets.single[exact.side], axis=1, keepdims=True)[:, 0]
    covered = np.bincount(exact.side[sure].ravel(), np.repeat(exact.area[sure], 2), minlength=len(facets))
    open_facets = covered < (1.0 - COVERED) * facets.area
    found = facing(facets, open_facets, search_reach(stones, contact_gap, overlap), contact_angle or MOST_ANGLE)
    found = found[~np.isin(_pair(facets, found.side), _pair(facets, exact.side[sure]))]
    least, ragged = facets.area[found.side].min(axis=1), raggedness(stones).off
    drawn = _as_drawn(facets, exact, found)
    limits = limits_of(stones, found, contact_gap, contact_angle, overlap, least, int(sure.sum()), drawn, ragged)
    narrowest = max(limits.noise, least_width)
    wide = _wide_enough(facets, found.side, widths(found.polygon), narrowest)
    meet = _meet(facets, found, limits)
    folded, found = found[_folded(found) & wide & ~meet], found[meet & wide]
    exact, found = _one_of_both(facets, exact, sure, found)
    if narrowest > TOUCHING:
        exact = chosen(exact, np.flatnonzero(_wide_enough(facets, exact.side, _widths(exact), narrowest)))
    joints = joined([exact, _interfaces(uncovered(facets, exact, found, limits.noise), limits.noise)])
    joints = joined([joints, _interfaces(_beside(facets, joints, folded, limits, narrowest), limits.noise)])
    return contacts_of(stones, facets.stone, joints, near_misses(facets, joints, limits), limits.tolerances)


def _exact(stones: Assemblage, facets: Facets, gap: float) -> Interfaces:
    """Return the interfaces of faces in one plane, by their facets; of a triangulated drawing those of whole facets alone.

    Of others all faces count: the two sides of a bed round a corner are a joint each, as drawn, however small the angle.
    """
    whole = facets.single[facets.of_face]
    triangulated = (np.diff(stones.face_ptr) == 3).mean() > 0.5
    looked_at = whole if triangulated else np.ones(len(whole), dtype=bool)
    found = coplanar_interfaces(stones, looked_at, gap)
    return replace(found, side=facets.of_face[found.side])


def _pair(facets: Facets, side: IntArray) -> IntArray:
    """Return a number for each unordered pair of facets (n, 2)."""
    return np.sort(side, axis=1) @ np.array([len(facets), 1])


def _meet(facets: Facets, found: Overlaps, limits: Limits) -> BoolArray:
    half = 0.5 * limits.thickness[facets.stone[found.side]].min(axis=1)
    allowed = limits.tolerances
    return (
        (found.opening <= np.minimum(allowed.contact_gap, half) + TOUCHING)
        & (found.penetration <= np.minimum(allowed.overlap, half) + TOUCHING)
        & (found.angle <= allowed.contact_angle)
        & ((found.lean <= allowed.contact_angle) | (found.area > BENT_SHARE * facets.area[found.side].min(axis=1)))
        & (found.middle - found.slack <= limits.middle)
    )


def _folded(found: Overlaps) -> BoolArray:
    """Return which overlaps (n,) are of facets with a fold, so that a face of the one may be parallel to the other."""
    return (found.bend > 0) & (found.lean <= 2.0 * found.bend + FOLD)


def _beside(facets: Facets, joints: Interfaces, folded: Overlaps, limits: Limits, narrowest: float) -> Overlaps:
    """Return what meets of overlaps that gape as a whole, without the parts where other stones lie between.

    A facet with a fold lies on another along one of its faces, and may gape where the stone on its other face begins.
    """
    left = folded[~np.isin(_pair(facets, folded.side), _pair(facets, joints.side))]
    left = uncovered(facets, joints, left, limits.noise)
    return left[_meet(facets, left, limits) & _wide_enough(facets, left.side, widths(left.polygon), narrowest)]


def _wide_enough(facets: Facets, side: IntArray, width: FloatArray, noise: float) -> BoolArray:
    narrower = (2.0 * facets.area[side] / perimeters(facets)[side]).min(axis=1)
    return width >= np.minimum(noise, NARROW_SHARE * narrower)


def _widths(found: Interfaces) -> FloatArray:
    """Return twice the area over the perimeter of interfaces (n,) m."""
    if not len(found):
        return np.zeros(0)
    after = np.arange(len(found.point)) + 1
    after[found.point_ptr[1:] - 1] = found.point_ptr[:-1]
    length = np.linalg.norm(found.point[after] - found.point, axis=1)
    return 2.0 * found.area / np.add.reduceat(length, found.point_ptr[:-1])


def _one_of_both(facets: Facets, exact: Interfaces, sure: BoolArray, found: Overlaps) -> tuple[Interfaces, Overlaps]:
    """Return both lists without joints that are in both: faces of one facet may already have met one by one."""
    of_exact, of_found = _pair(facets, exact.side), _pair(facets, found.side)
    pairs, row = np.unique(np.concatenate([of_exact, of_found]), return_inverse=True)
    mine, theirs = row[: len(of_exact)], row[len(of_exact) :]
    count, area = np.bincount(mine, minlength=len(pairs)), np.bincount(mine, exact.area, minlength=len(pairs))
    shared = np.bincount(theirs, found.area, minlength=len(pairs))
    enough = shared <= (1.0 + SAME_AREA) * area
    return chosen(exact, np.flatnonzero(sure | enough[mine])), found[~((count > 0) & enough)[theirs]]


def _as_drawn(facets: Facets, exact: Interfaces, found: Overlaps) -> BoolArray:
    """Return which overlaps (n,) exact interfaces of faces of the same facets account for: their facets are bent, and the gaps
    between these say nothing of how exactly the stones are drawn."""
    of_exact, of_found = _pair(facets, exact.side), _pair(facets, found.side)
    pairs, row = np.unique(np.concatenate([of_exact, of_found]), return_inverse=True)
    area = np.bincount(row[: len(of_exact)], exact.area, minlength=len(pairs))
    shared = np.bincount(row[len(of_exact) :], found.area, minlength=len(pairs))
    drawn: BoolArray = (shared <= (1.0 + SAME_AREA) * area)[row[len(of_exact) :]]
    return drawn


def _interfaces(found: Overlaps, noise: float) -> Interfaces:
    """Return overlaps as interfaces, their points midway between both facets along the mean normal."""
    corner, corner_ptr = hull_corners(found.polygon, np.full(len(found), max(0.5 * noise, TOUCHING)))
    owner = np.repeat(np.arange(len(found)), np.diff(corner_ptr))
    level = found.height[owner, 0] + np.einsum("ij,ij->i", found.height[owner, 1:], corner)
    flat = np.einsum("ia,iac->ic", corner, found.frame[owner][:, 1:])
    point = found.origin[owner] + flat + level[:, None] * found.frame[owner][:, 0]
    exact = np.zeros(len(found), dtype=bool)
    return Interfaces(found.side, exact, found.frame, found.area, found.gap, found.lean, point, corner_ptr)
