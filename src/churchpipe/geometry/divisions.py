"""Curves divided into chords where the lines beside them have corners, so that both sides of a curved joint are divided alike."""

from collections.abc import Sequence

import numpy as np
import shapely

from churchpipe.model.arrays import FloatArray

# Corners of other lines divide a curve from a distance of this share of the size of its outline: across a joint of mortar.
REACH = 0.1
# Divisions nearer to each other than this share of that size are one: the corners of two stones on both sides of a joint.
APART = 0.06


def divided(lines: Sequence[FloatArray], curves: Sequence[FloatArray | None]) -> list[FloatArray]:
    """Return lines with corners added on their curves, opposite the corners of the other lines.

    Two rings of an arch seldom have their joints at one place. The chords of one ring would lean against those of the other, by
    up to half the angle of a voussoir, and faces that lean are no joint.

    Parameters
    ----------
    lines: corners (n, 2) of each line, those on its curves among them, without the first one repeated.
    curves: the same lines drawn finely (m, 2), the first point repeated where they are closed; None for lines without curves.
    """
    bent = [k for k, curve in enumerate(curves) if curve is not None]
    if not bent:
        return list(lines)
    owner = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    corner = np.concatenate(lines)
    tree = shapely.STRtree([shapely.Point(point) for point in corner])
    out = list(lines)
    for k in bent:
        curve = shapely.LineString(curves[k])
        size = float(np.ptp(lines[k], axis=0).max())
        near = tree.query(curve, predicate="dwithin", distance=REACH * size)
        own = shapely.line_locate_point(curve, shapely.points(lines[k]))
        beside = shapely.points(corner[near[owner[near] != k]])
        places = _clusters(np.atleast_1d(shapely.line_locate_point(curve, beside)), APART * size)
        end = curve.length if curve.is_closed else np.inf
        away = np.abs(places[:, None] - np.concatenate([own, own + end, own - end])[None, :]).min(axis=1, initial=np.inf)
        added = places[away > APART * size]
        order = np.argsort(np.concatenate([own, added]), kind="stable")
        out[k] = np.concatenate([lines[k], shapely.get_coordinates(shapely.line_interpolate_point(curve, added))])[order]
    return out


def _clusters(places: FloatArray, apart: float) -> FloatArray:
    """Return the means of groups of numbers whose neighbours are no farther apart than that."""
    if not len(places):
        return places
    ordered = np.sort(places)
    group = np.concatenate([[0], np.cumsum(np.diff(ordered) > apart)])
    return np.bincount(group, ordered) / np.bincount(group)
