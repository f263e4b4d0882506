"""A support below stones that were given without one."""

from collections.abc import Sequence

import numpy as np

from churchpipe.model.arrays import FloatArray

Solid = tuple[FloatArray, tuple[tuple[int, ...], ...]]

# A face stands on the ground if its corners are this near to the lowest level, as a share of the smallest dimension of the median
# stone: 3 mm of bricks, 12 mm of stones in courses of 250 mm.
LEVEL = 0.05
# A face is too small to need a support, as a share of the largest on which its stone stands.
CHIP = 0.01
# Depth and margin of the support, as shares of the stones' size. They have no influence on the results.
DEPTH, MARGIN = 0.5, 0.5
# A support of one face becomes narrower below, to this share: neighbours whose feet are lower do not lean against its sides.
NARROWED = 0.2


def level_supports(solids: Sequence[tuple[FloatArray, Sequence[Sequence[int]]]]) -> tuple[list[Solid], list[int]]:
    """Return solids to fix under the lowest faces, and the indices of the solids that stand on them.

    solids: points (n, 3), z up, in any one unit, and outward faces. Where the lowest faces are in one level plane the support is
    one plate; else each face gets a block of its own below it, which becomes narrower where it is convex. Both lists are empty
    when no face looks down at the lowest level.
    """
    low = min(float(points[:, 2].min()) for points, _ in solids)
    extents = np.array([np.ptp(points, axis=0) for points, _ in solids])
    size, least = float(np.median(extents.max(axis=1))), float(np.median(extents.min(axis=1)))
    resting: list[int] = []
    faces: list[FloatArray] = []
    for index, (points, around) in enumerate(solids):
        near = points[:, 2] <= low + LEVEL * least
        if near.sum() < 3:
            continue
        found = [points[list(face)] for face in around if near[list(face)].all()]
        footprint = [_footprint(corners) for corners in found]
        found = [corners for corners, own in zip(found, footprint, strict=True) if own > CHIP * max(footprint) > 0]
        if found:
            resting.append(index)
            faces += found
    if not faces:
        return [], []
    corners = np.concatenate(faces)
    if np.ptp(corners[:, 2]) <= 1e-6 * size:
        start, stop = corners.min(axis=0) - MARGIN * size, corners.max(axis=0) + MARGIN * size
        plan = np.array([(start[0], start[1]), (stop[0], start[1]), (stop[0], stop[1]), (start[0], stop[1])])
        return [_block(np.column_stack([plan, np.full(4, corners[:, 2].mean())]), DEPTH * size)], resting
    return [_foot(face[::-1], DEPTH * size) for face in faces], resting


def _footprint(corners: FloatArray) -> float:
    """Return the area of a face (n, 3) in plan, negative where it looks up."""
    x, y = corners[:, 0], corners[:, 1]
    return -0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def _foot(top: FloatArray, depth: float) -> Solid:
    """Return a block below one face (n, 3), counter-clockwise from above, no deeper than about half the width of the face."""
    u, v = (np.roll(top, -1, axis=0) - top)[:, :2].T
    if (u * np.roll(v, -1) - v * np.roll(u, -1) < 0).any():
        return _block(top, depth)
    width = float(np.linalg.svd(top - top.mean(axis=0), compute_uv=False)[1]) / np.sqrt(len(top))
    return _block(top, min(depth, width), NARROWED)


def _block(top: FloatArray, depth: float, share: float = 1.0) -> Solid:
    """Return a block with the given top (n, 3), counter-clockwise from above, and a bottom that much lower, a share as wide."""
    count = len(top)
    middle = top.mean(axis=0)
    points = np.concatenate([top, middle + share * (top - middle) - [0.0, 0.0, depth]])
    sides = ((i, i + count, (i + 1) % count + count, (i + 1) % count) for i in range(count))
    return points, (tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1)), *sides)
