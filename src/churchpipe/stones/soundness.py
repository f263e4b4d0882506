"""Checks of an assemblage: stones that float, that coincide or overlap, and that lack the joints that should hold them."""

import manifold3d
import numpy as np
import scipy.sparse as sp

from churchpipe.errors import InputError
from churchpipe.geometry.manifolds import manifold
from churchpipe.geometry.planar import overlapping
from churchpipe.model.arguments import check_call, check_kind
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOUCHING, Contacts, check_contacts_of
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.progress import Progress
from churchpipe.stones.account import NAMED, near_miss_share, remedy_words, surface_account
from churchpipe.stones.self_crossing import self_crossing_stones
from churchpipe.wording import counted

# A joint holds a stone from below when its normal rises by at least this much.
LEAST_LIFT = 0.05
# Near misses with more than this share of the area of all joints and near misses would decide the result, so an engineer must say
# whether they are joints. A movement joint between two buildings, or a few open joints, are below it.
DECISIVE_SHARE = 0.1
# The joints of a stone may exceed its surface by this share at most; more means that joints were counted twice.
COUNTED_TWICE = 0.02


def floating_stones(stones: Assemblage, contacts: Contacts) -> IntArray:
    """Return the indices of the free stones without a path of contacts to a fixed stone."""
    ones = np.ones(len(contacts.blocks))
    graph = sp.coo_matrix((ones, (contacts.blocks[:, 0], contacts.blocks[:, 1])), shape=(stones.count, stones.count))
    # Fixed stones are one body, however far apart they lie.
    _, component = sp.csgraph.connected_components(graph, directed=False)
    return np.flatnonzero(~np.isin(component, np.unique(component[stones.fixed])))


def unsupported_stones(stones: Assemblage, contacts: Contacts) -> IntArray:
    """Return the indices of the free stones that nothing holds from below: no joint of theirs can push them upwards."""
    # Frames point from the first stone to the second, so the second is pushed along the normal, the first against it.
    up = contacts.frame[:, 0, 2]
    held = np.concatenate([contacts.blocks[up > LEAST_LIFT, 1], contacts.blocks[up < -LEAST_LIFT, 0]])
    return np.setdiff1d(np.flatnonzero(~stones.fixed), held)


def duplicate_stones(stones: Assemblage) -> IntArray:
    """Return pairs (k, 2) of stones that coincide: bounding boxes and centroids to `TOUCHING`, m, and volumes."""
    pairs = _close_boxes(stones, -TOUCHING)
    low, high = _boxes(stones)
    same = (np.abs(low[pairs[:, 0]] - low[pairs[:, 1]]) < TOUCHING).all(axis=1)
    same &= (np.abs(high[pairs[:, 0]] - high[pairs[:, 1]]) < TOUCHING).all(axis=1)
    same &= np.linalg.norm(stones.centroid[pairs[:, 0]] - stones.centroid[pairs[:, 1]], axis=1) < TOUCHING
    same &= np.abs(stones.volume[pairs[:, 0]] / stones.volume[pairs[:, 1]] - 1) < 1e-6
    return pairs[same]


def overlapping_stones(stones: Assemblage, tolerance: float = TOUCHING, progress: Progress | None = None) -> IntArray:
    """Return pairs (k, 2) of stones whose solids overlap by more than the tolerance, m.

    Bounding boxes that overlap propose pairs. Most of these are excluded by a plane that separates the two stones; for the
    others the intersection of the solids is computed. The depth of an overlap is the mean thickness of the intersection: twice
    its volume over its surface.
    """
    pairs = _close_boxes(stones, 0.5 * tolerance)
    pairs = pairs[~_separated(stones, pairs, tolerance)]
    solids: dict[int, manifold3d.Manifold] = {}
    overlapping = np.zeros(len(pairs), dtype=bool)
    for row, (i, j) in enumerate(pairs.tolist()):
        for k in (i, j):
            if k not in solids:
                solids[k] = manifold(*stones.solid(k))
        shared = solids[i] ^ solids[j]
        overlapping[row] = 2.0 * shared.volume() > tolerance * shared.surface_area()
        if progress and row % 64 == 0:
            progress("overlaps", row / len(pairs))
    return pairs[overlapping]


def check_soundness(stones: Assemblage, contacts: Contacts, progress: Progress | None = None) -> None:
    """Raise an error that names stones that float, coincide, overlap or cross themselves, and near misses that matter.

    Stones overlap if they interpenetrate by more than the contacts' own tolerance. A near miss matters where it is all that a
    stone has below it. All near misses matter together where they are more than `DECISIVE_SHARE` of the area of joints and near
    misses, unless the contact gap was given.

    Parameters
    ----------
    stones
        The assemblage.
    contacts
        Its joints, from `find_contacts`.
    progress
        Called with a text and the share done.

    Raises
    ------
    InputError
        Stones that float, coincide or overlap, near misses that matter; all of them in one message.
    """
    check_kind("check_soundness: stones", stones, Assemblage)
    check_kind("check_soundness: contacts", contacts, Contacts)
    check_contacts_of(stones, contacts)
    check_call("check_soundness: progress", progress)
    problems: list[str] = []
    remedies: list[str] = []
    double = duplicate_stones(stones)
    if len(double):
        problems.append(f"{len(double)} drawn twice ({_name_pairs(stones, double)})")
        remedies.append("Delete one of each pair.")
    crossing = self_crossing_stones(stones)
    if crossing:
        named = ", ".join(
            f"{stones.block_id[block]} at ({', '.join(f'{x:.3f}' for x in place)}) m" for block, place in crossing[:NAMED]
        )
        problems.append(f"{len(crossing)} whose surface crosses itself ({named})")
        remedies.append("Draw them again, or cut each at the place named into bodies that do not.")
    overlap = overlapping_stones(stones, contacts.tolerances.overlap, progress)
    overlap = overlap[~(overlap[:, None] == double[None]).all(axis=2).any(axis=1)] if len(double) else overlap
    if len(overlap):
        problems.append(f"{counted(len(overlap), 'pair overlaps', 'pairs overlap')} ({_name_pairs(stones, overlap)})")
        remedies.append("Trim or move the stones that overlap.")
    floating = floating_stones(stones, contacts)
    loose = np.isin(contacts.near_misses.stones, floating).any(axis=1)
    if len(floating):
        problems.append(f"{len(floating)} without a path to a support ({_name(stones, floating)})")
        remedies.append("Close the gaps to their neighbours, or fix a stone that rests on the ground." if not loose.any() else "")
    hung, below = _nearly_held(stones, contacts)
    hung = np.setdiff1d(hung, floating)
    if len(hung):
        problems.append(f"{len(hung)} with nothing below but a gap ({_name(stones, hung)})")
    share = near_miss_share(contacts)
    decisive = share > DECISIVE_SHARE and "contact_gap" not in contacts.tolerances.given
    if decisive:
        near = contacts.near_misses
        pairs = counted(len(near), "pair of faces nearly meets", "pairs of faces nearly meet")
        problems.append(f"{pairs}, {100 * share:.0f} % of all area that meets or nearly meets")
        gap = f"{1e3 * contacts.tolerances.contact_gap:.2g}"
        typed = f"give --contact-gap {gap}mm to check and import, contact_gap_mm = {gap} in [rigid] of a case"
        remedies.append(f"To leave faces that nearly meet open {typed}.")
    if len(rows := np.flatnonzero(loose | (below & np.isin(contacts.near_misses.stones, hung).any(axis=1)) | decisive)):
        remedies.insert(0, remedy_words(stones, contacts, rows))
    account = surface_account(stones, contacts)
    if not problems and len(twice := np.flatnonzero(account.free < -COUNTED_TWICE * account.surface)):
        problems.append(f"{len(twice)} with more joint than surface ({_name(stones, twice)})")
        remedies.append("Find the contacts again: faces are joined twice.")
    if problems:
        raise InputError(
            "stones",
            "; ".join(problems),
            expected="separate stones that all rest on a support",
            remedy=" ".join(filter(None, remedies)),
        )


def _nearly_held(stones: Assemblage, contacts: Contacts) -> tuple[IntArray, BoolArray]:
    """Return the stones that nothing holds from below but that have a near miss there, and which near misses lie below one."""
    near = contacts.near_misses
    unheld = unsupported_stones(stones, contacts)
    up = near.normal[:, 2]
    held = np.stack([up < -LEAST_LIFT, up > LEAST_LIFT], axis=1) & np.isin(near.stones, unheld)
    return np.unique(near.stones[held]), held[:, 0] | held[:, 1]


def _name(stones: Assemblage, chosen: IntArray) -> str:
    named = ", ".join(f"{stones.block_id[i]} at {np.round(stones.centroid[i], 3).tolist()} m" for i in chosen[:8])
    return named + (f" and {len(chosen) - 8} more" if len(chosen) > 8 else "")


def _name_pairs(stones: Assemblage, pairs: IntArray) -> str:
    named = ", ".join(f"{stones.block_id[i]} and {stones.block_id[j]}" for i, j in pairs[:8])
    return named + (f" and {counted(len(pairs) - 8, 'pair')} more" if len(pairs) > 8 else "")


def _boxes(stones: Assemblage) -> tuple[np.ndarray, np.ndarray]:
    low = np.minimum.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0)
    high = np.maximum.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0)
    return low, high


def _close_boxes(stones: Assemblage, shrink: float) -> IntArray:
    """Return pairs i < j, sorted, whose bounding boxes, each shrunk by `shrink` on all sides, overlap."""
    low, high = _boxes(stones)
    # A thin stone shrunk to nothing keeps its centre.
    low, high = np.minimum(low + shrink, high - shrink), np.maximum(low + shrink, high - shrink)
    # The tree of boxes has two dimensions: those in which the fewest overlap. In plan all stones of a wall lie on each other.
    a, b, c = np.argsort([_overlaps(low[:, axis], high[:, axis]) for axis in range(3)], kind="stable")
    i, j = overlapping(np.column_stack([low[:, a], low[:, b], high[:, a], high[:, b]])).T
    keep = (low[i, c] <= high[j, c]) & (low[j, c] <= high[i, c])
    pairs = np.stack([i[keep], j[keep]], axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def _overlaps(low: FloatArray, high: FloatArray) -> int:
    """Return how many pairs of intervals from low (n,) to high (n,) overlap, each pair twice and each interval with itself."""
    after = np.searchsorted(np.sort(high), low, side="left")
    return int((np.searchsorted(np.sort(low), high, side="right") - after).sum())


def _separated(stones: Assemblage, pairs: IntArray, tolerance: float) -> BoolArray:
    """Return True for pairs that a face of one of them separates, to the tolerance, m."""
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    offset = np.einsum("fc,fc->f", normal, mean)

    def separates(i: int, j: int) -> bool:
        own, others = (stones.points[stones.block_point_ptr[k] : stones.block_point_ptr[k + 1]] for k in (i, j))
        faces = slice(*stones.block_face_ptr[i : i + 2])
        behind = (own @ normal[faces].T <= offset[faces] + tolerance).all(axis=0)
        return bool((behind & (others @ normal[faces].T >= offset[faces] - tolerance).all(axis=0)).any())

    return np.array([separates(i, j) or separates(j, i) for i, j in pairs.tolist()], dtype=np.bool_)
