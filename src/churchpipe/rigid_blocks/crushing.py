"""Parts of joints, each of which bears at most its area times the compressive strength."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from churchpipe.errors import InputError
from churchpipe.model.arguments import whole
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.contacts import Contacts
from churchpipe.rigid_blocks.polygons import JointPolygons, cross, joint_polygons

# Parts along each side of a joint of four corners.
PARTS = 8
MOST_PARTS = 64
# The i-th of k lines between the edge of a joint and its middle lies at the share (i / k)^GRADING of the way: parts at the edge,
# where stones turn, are narrower.
_GRADING = 1.5
# The hull of a joint that is not convex encloses more than the joint by more than this share.
_SAME_AREA = 1e-3
# Parts of joints that are not convex are divided once more into so many squared, to see how much of each lies in the joint.
_FINER = 4
# Says of parts, by their joints (m,) and corners (m, 4, 2), which lie wholly in the joint.
Covered = Callable[[IntArray, FloatArray], BoolArray]
# Shares of a part at which two Gauss points lie; they integrate what a bilinear map makes of areas and centroids exactly.
_GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)


@dataclass(frozen=True, slots=True)
class JointParts:
    """Joints divided into parts, under uniform pressure each: its force acts in the part's centroid.

    contacts: the same interfaces, with the centroids of their parts as contact points (np, 3), or their corners where they are
    not divided; divided (np,): which are centroids; area (np,) m2 of each part, or share of each corner; shares (np, nc): how
    the force of a part is shared by the corners of its joint so that nothing changes for the stones.

    Any forces of the parts are forces of a joint under a pressure of at most the strength, with friction within its limit
    everywhere, but not the other way round: load factors lie below those of the undivided joint, and rise to them as the
    parts grow smaller.
    """

    contacts: Contacts
    divided: BoolArray
    area: FloatArray
    shares: sp.csr_matrix


def joint_parts(
    contacts: Contacts, count: int = PARTS, chosen: BoolArray | None = None, covered: Covered | None = None
) -> JointParts:
    """Return the parts of the chosen joints (ni,), all if None: `count` (even) along each side of one with four corners.

    Each corner, the middles of its two edges and the mean of all corners span a quadrilateral, which is divided into
    (count / 2)^2 parts. Where a joint is not convex its points are those of its convex hull. Then `covered` says what of each
    part bears, that which lies in the joint; without it the areas of all parts are reduced to that of the joint.

    Raises
    ------
    InputError: count not even, not positive or too large, or points that are not the corners of their interface in order.
    """
    count = whole("limit_analysis: crushing_parts", count, least=2, most=MOST_PARTS)
    if count % 2:
        raise InputError("limit_analysis: crushing_parts", "an odd number", found=count, expected="2, 4, 6 ...")
    polygons = joint_polygons(contacts)
    weights, area, _ = _quadrilaterals(polygons, count // 2, np.arange(len(polygons.corner)))
    share = contacts.area / np.abs(polygons.area)
    inside = area * share[polygons.interface, None]
    if covered is not None:
        bent = (share < 1.0 - _SAME_AREA) & (True if chosen is None else chosen)
        mine = np.flatnonzero(bent[polygons.interface])
        inside[mine], theirs = _covered_parts(polygons, count // 2, mine, covered)
        weights[mine] = np.where(inside[mine, :, None] > 0, theirs, weights[mine])
    inside = inside.ravel()
    own, corners = area.shape[1], len(polygons.corner)
    part, corner = np.arange(own * corners), np.repeat(np.arange(corners), own)
    # The nodes of a quadrilateral: its corner, the middle of the edge after it, the mean of all corners, that of the edge before.
    here, beyond, mean, behind = np.moveaxis(weights.reshape(-1, 4), 1, 0)
    shape = (len(part), corners)
    entries = (
        (here + 0.5 * (beyond + behind), corner),
        (0.5 * beyond, polygons.after[corner]),
        (0.5 * behind, polygons.before[corner]),
    )
    near = sum((sp.csr_matrix((value, (part, column)), shape=shape) for value, column in entries), sp.csr_matrix(shape))
    joints = len(polygons.start)
    each = 1.0 / polygons.count[polygons.interface]
    every = sp.csr_matrix((each, (polygons.interface, np.arange(corners))), shape=(joints, corners))
    far = sp.csr_matrix((mean, (part, polygons.interface[corner])), shape=(len(part), joints)) @ every
    shares = sp.csr_matrix(near + far)
    if chosen is None or chosen.all():
        divided = np.ones(len(inside), dtype=np.bool_)
        return JointParts(
            replace(contacts, point=shares @ contacts.point, point_ptr=contacts.point_ptr * own), divided, inside, shares
        )
    # Corners stand before parts; of each joint one kind is taken.
    points = polygons.count * np.where(chosen, own, 1)
    take = ragged_indices(polygons.start * np.where(chosen, own, 1) + np.where(chosen, corners, 0), points)
    shares = sp.csr_matrix(sp.vstack([sp.identity(corners), shares]))[take]
    area = np.concatenate([(contacts.area / polygons.count)[polygons.interface], inside])[take]
    pointer = pointer_of(points)
    return JointParts(
        replace(contacts, point=shares @ contacts.point, point_ptr=pointer), np.repeat(chosen, points), area, shares
    )


def _covered_parts(polygons: JointPolygons, lines: int, corners: IntArray, covered: Covered) -> tuple[FloatArray, FloatArray]:
    """Return how much (k, parts) of the parts of these corners (k,) lies in their joints, and the weights (k, parts, 4) of the
    nodes of each quadrilateral in its centroid.

    Each part is divided once more, and of that counts what lies wholly in the joint.
    """
    weights, area, quads = _quadrilaterals(polygons, lines * _FINER, corners)
    bears = area * covered(np.repeat(polygons.interface[corners], area.shape[1]), quads).reshape(area.shape)
    shape = (len(corners), lines, _FINER, lines, _FINER)
    moment = (bears[:, :, None] * weights).reshape(*shape, 4).sum(axis=(2, 4)).reshape(len(corners), lines**2, 4)
    bears = bears.reshape(shape).sum(axis=(2, 4)).reshape(len(corners), lines**2)
    return bears, moment / np.maximum(bears, np.finfo(float).tiny)[:, :, None]


def _quadrilaterals(polygons: JointPolygons, lines: int, corners: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the weights (k, parts, 4) of the nodes of the quadrilaterals of these corners (k,) in the centroids of their parts;
    the areas of these, (k, parts), and their corners, (k parts, 4, 2).

    The bilinear map of the unit square with sides s and t on the quadrilateral has the shape functions (1 - s) (1 - t),
    s (1 - t), s t and (1 - s) t; its Jacobian is linear in s and t.
    """
    corner = polygons.corner
    middles = [0.5 * (corner + corner[polygons.after]), np.zeros_like(corner), 0.5 * (corner + corner[polygons.before])]
    node = np.stack([corner, *middles], axis=1)[corners]
    line = (np.arange(lines + 1) / lines) ** _GRADING
    place = line[:-1, None] + np.diff(line)[:, None] * _GAUSS
    # s, t and the weight of the Gauss points of each part: (parts, 4).
    s = np.broadcast_to(place[:, None, :, None], (lines, lines, 2, 2)).reshape(-1, 4)
    t = np.broadcast_to(place[None, :, None, :], (lines, lines, 2, 2)).reshape(-1, 4)
    size = (np.diff(line)[:, None] * np.diff(line)).reshape(-1, 1) / 4.0
    value = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=-1)
    along = np.einsum("pgn,knc->kpgc", np.stack([t - 1, 1 - t, t, -t], axis=-1), node)
    across = np.einsum("pgn,knc->kpgc", np.stack([s - 1, -s, s, 1 - s], axis=-1), node)
    element = np.abs(cross(along, across)) * size
    area = element.sum(axis=2)
    weights = np.einsum("pgn,kpg->kpn", value, element) / area[:, :, None]
    i, j = (index.ravel() for index in np.indices((lines, lines)))
    s, t = line[np.stack([i, i + 1, i + 1, i], axis=1)], line[np.stack([j, j, j + 1, j + 1], axis=1)]
    quads = np.einsum("pgn,knc->kpgc", np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=-1), node)
    return weights, area, quads.reshape(-1, 4, 2)
