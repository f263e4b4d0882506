"""Rings of voussoirs among the stones of a wall, recognised by beds that turn from stone to stone."""

import numpy as np
from scipy.spatial import cKDTree

from churchpipe.geometry.clusters import components
from churchpipe.geometry.planar import Polygons, united
from churchpipe.geometry.polygons import corners
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.building import BondRegion, UnitCell
from churchpipe.recognition.ring_outlines import main_corners

# An edge is level or upright within this angle (rad); joints of a ring pass its centre within this share of the ring's radius.
ALIGNED = 1e-3
CENTRED = 0.02
# Corners of bent sides are rounded to this, m, where the outline of the ring is made of them.
GRID = 1e-9
LEAST_PIECES = 3


def voussoir_rings(polygons: Polygons, contact_gap: float) -> tuple[list[BondRegion], IntArray]:
    """Return the rings among the stones (n,) of a wall, and the stones that are voussoirs.

    A voussoir has four corners, those between the chords of a bent side not counted, and at most one edge that is level or
    upright; so has a stone between two of them. Neighbours share radial joints, whose lines meet in the centre. A pointed
    arch is two rings. Two stones alone are a ring if their corners are on two circles. A full circle becomes two half rings.

    Parameters
    ----------
    polygons: the stones in chart coordinates. contact_gap: how far apart two voussoirs may be, m.
    """
    quads, shape = _quadrilaterals(polygons)
    side = np.roll(shape, -1, axis=1) - shape
    aligned = (np.abs(side).min(axis=2) < ALIGNED * np.abs(side).max(axis=2)).sum(axis=1)
    first, second, joint = _joints(shape, contact_gap)
    turning = aligned <= 1
    beside = np.bincount(np.concatenate([first[turning[second]], second[turning[first]]]), minlength=len(quads))
    member = turning | ((aligned == 2) & (beside >= 2))
    linked = member[first] & member[second]
    part = components(len(quads), np.stack([first[linked], second[linked]], axis=1))
    rings: list[BondRegion] = []
    used = np.zeros(len(quads), dtype=np.bool_)
    for number in np.unique(part[member]):
        pieces = np.flatnonzero((part == number) & member)
        inside = linked & (part[first] == number)
        if len(pieces) < LEAST_PIECES or inside.sum() < 2:
            continue
        for own, between in _about_one_centre(shape, np.stack([first, second], axis=1), joint, pieces, np.flatnonzero(inside)):
            found = _ring(shape[own], polygons[quads[own]], joint[between], f"ring-{len(rings) + 1}")
            if found:
                rings += found
                used[own] = True
    for pair in np.stack([first, second], axis=1)[(aligned[first] <= 2) & (aligned[second] <= 2)]:
        if used[pair].any() or (centre := _centre_of_two(shape[pair], contact_gap)) is None:
            continue
        (x, y), (u, v) = shape[pair].mean(axis=1) - centre
        order = pair if x * v - y * u > 0 else pair[::-1]
        rings.append(_region(shape[order], polygons[quads[order]], centre, f"ring-{len(rings) + 1}"))
        used[pair] = True
    return rings, quads[used]


def _quadrilaterals(polygons: Polygons) -> tuple[IntArray, FloatArray]:
    """Return the stones (k,) with four corners, and these (k, 4, 2); of stones with more, the four at which they turn sharply."""
    corner, pointer = corners(polygons)
    found: list[int] = []
    shape = [np.empty((0, 2))]
    for number, (start, stop) in enumerate(zip(pointer[:-1].tolist(), pointer[1:].tolist(), strict=True)):
        ring = corner[start:stop]
        quad = ring if len(ring) == 4 else ring[main_corners(ring)]
        if len(quad) == 4:
            found.append(number)
            shape.append(quad)
    return np.array(found, dtype=np.int64), np.concatenate(shape).reshape(-1, 4, 2)


def _joints(shape: FloatArray, contact_gap: float) -> tuple[IntArray, IntArray, FloatArray]:
    """Return pairs of quadrilaterals with a whole edge in common, and that edge (n, 2, 2)."""
    after = np.roll(shape, -1, axis=1)
    middle = (0.5 * (shape + after)).reshape(-1, 2)
    if not len(middle):
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64), np.empty((0, 2, 2))
    pairs = cKDTree(middle).query_pairs(contact_gap, output_type="ndarray")
    one, other = pairs[:, 0], pairs[:, 1]
    length = np.linalg.norm(after - shape, axis=2).ravel()
    keep = (one // 4 != other // 4) & (np.abs(length[one] - length[other]) < contact_gap)
    edge = np.stack([shape, after], axis=2).reshape(-1, 2, 2)
    return one[keep] // 4, other[keep] // 4, edge[one[keep]]


def _about_one_centre(
    shape: FloatArray, pair: IntArray, joint: FloatArray, pieces: IntArray, links: IntArray
) -> list[tuple[IntArray, IntArray]]:
    """Return linked stones and the joints between them, as one, or as the two arcs of a pointed arch, each about its own centre.

    The joint at the crown, where the arcs meet, belongs to neither.

    Parameters
    ----------
    pair (n, 2), joint (n, 2, 2): the stones of each joint, and its edge. pieces, links: the linked stones, and their joints.
    """
    if _meeting(joint[links], shape[pieces]) is None:
        for crown in links:
            rest = links[links != crown]
            part = components(len(shape), pair[rest])
            arcs = [pieces[part[pieces] == part[side]] for side in pair[crown]]
            between = [rest[np.isin(pair[rest, 0], arc)] for arc in arcs]
            if part[pair[crown, 0]] == part[pair[crown, 1]] or min(map(len, arcs)) < LEAST_PIECES:
                continue
            if all(_meeting(joint[own], shape[arc]) is not None for arc, own in zip(arcs, between, strict=True)):
                return list(zip(arcs, between, strict=True))
    return [(pieces, links)]


def _ring(pieces: FloatArray, polygons: Polygons, joint: FloatArray, name: str) -> list[BondRegion]:
    """Return one or two bond regions, or none when the joints do not meet in a point."""
    centre = _meeting(joint, pieces)
    if centre is None:
        return []
    middle = pieces.mean(axis=1) - centre
    turn = np.arctan2(middle[:, 1], middle[:, 0])
    # Start behind the widest gap, so that a ring is not broken where angles begin anew.
    order = np.argsort(turn)
    gaps = np.diff(turn[order], append=turn[order[0]] + 2 * np.pi)
    order = np.roll(order, -(int(np.argmax(gaps)) + 1))
    full = gaps.max() < 1.5 * np.median(gaps)
    halves = np.array_split(order, 2) if full else [order]
    names = [name if len(halves) == 1 else f"{name}-{k}" for k in range(1, len(halves) + 1)]
    return [_region(pieces[half], polygons[half], centre, own) for half, own in zip(halves, names, strict=True)]


def _meeting(joint: FloatArray, pieces: FloatArray) -> FloatArray | None:
    """Return the point (2,) in which the lines of joints (n, 2, 2) meet, None where they do not."""
    along = joint[:, 1] - joint[:, 0]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1, keepdims=True)
    reach = np.einsum("nc,nc->n", normal, joint[:, 0])
    centre = np.linalg.lstsq(normal, reach, rcond=None)[0]
    radius = np.linalg.norm(pieces - centre, axis=2)
    return centre if np.abs(normal @ centre - reach).max() <= CENTRED * radius.mean() else None


def _centre_of_two(pair: FloatArray, contact_gap: float) -> FloatArray | None:
    """Return the centre (2,) about which two stones (2, 4, 2) with a common joint are a ring; None where they are none."""
    edge = np.stack([pair, np.roll(pair, -1, axis=1)], axis=2)
    middle = edge.mean(axis=2)
    apart = np.linalg.norm(middle[0][:, None] - middle[1], axis=2)
    one, other = np.unravel_index(np.argmin(apart), apart.shape)
    if apart[one, other] > contact_gap:
        return None
    springings = np.stack([edge[0, (one + 2) % 4], edge[1, (other + 2) % 4]])
    centre = _meeting(np.concatenate([edge[0, one][None], springings]), pair)
    if centre is None:
        return None
    radius = np.sort(np.linalg.norm(pair - centre, axis=2).ravel()).reshape(2, 4)
    return centre if np.ptp(radius, axis=1).max() < CENTRED * radius.mean() < np.diff(radius.mean(axis=1))[0] else None


def _region(pieces: FloatArray, polygons: Polygons, centre: FloatArray, name: str) -> BondRegion:
    """Return the region of voussoirs, corners (n, 4, 2) and whole polygons (n,), in their order about the centre."""
    spoke = pieces - centre
    middle = spoke.mean(axis=1)
    turn = np.arctan2(
        middle[:, None, 0] * spoke[:, :, 1] - middle[:, None, 1] * spoke[:, :, 0], np.einsum("nc,nkc->nk", middle, spoke)
    )
    # Corners: by angle the two of the first joint, then the two of the last; of each pair the farther is on the extrados.
    by_angle = np.take_along_axis(spoke, np.argsort(turn, axis=1)[:, :, None], axis=1).reshape(-1, 2, 2, 2)
    far = np.argsort(np.linalg.norm(by_angle, axis=3), axis=2)[..., None]
    pairs = np.take_along_axis(by_angle, far, axis=2)
    inner = np.concatenate([pairs[:, 0, 0], pairs[-1:, 1, 0]])
    outer = np.concatenate([pairs[:, 0, 1], pairs[-1:, 1, 1]])
    depth = float(np.linalg.norm(outer - inner, axis=1).mean())
    width = np.linalg.norm(np.diff(0.5 * (inner + outer), axis=0), axis=1).mean()
    outline = np.concatenate([outer, inner[::-1]]) + centre
    if (np.diff(corners(polygons)[1]) > 4).any():
        outline = corners(np.array([united(polygons, GRID)], dtype=np.object_))[0]
    cell = UnitCell(a=float(width), b=depth)
    return BondRegion(name, outline, "voussoir", cell, centre=(float(centre[0]), float(centre[1])), pieces=len(pieces))
