"""The zones of a wall in which others cross it: from which height to which one they hold."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Band:
    """A band of a wall, from low to high, t in m, and the zones (nz, 2) of its junctions there: s from face to face, disjoint and
    sorted."""

    low: float
    high: float
    zones: FloatArray


def bands_of(crossed: FloatArray) -> list[Band]:
    """Return the bands of a wall from below upwards, in each of which its junctions have the same faces; the first begins at
    -inf, the last one ends at inf.

    A junction counts below and above the height that both walls share, too, so that joints lie there as they lie within. But
    where a crossing wall gets thinner its faces move, and from there on those of the upper part count.

    Parameters
    ----------
    crossed: of each crossing wall the rectangle (nc, 4), s0, t0, s1, t1 m, in which it crosses this one.
    """
    holds = np.tile([-np.inf, np.inf], (len(crossed), 1))
    for lower, (s0, _, s1, top) in enumerate(crossed.tolist()):
        for upper, (s2, bottom, s3, _) in enumerate(crossed.tolist()):
            alike = max(abs(s2 - s0), abs(s3 - s1)) < TOLERANCE
            if not alike and min(s1, s3) - max(s0, s2) > TOLERANCE and top < bottom + TOLERANCE:
                holds[lower, 1] = min(holds[lower, 1], bottom)
                holds[upper, 0] = max(holds[upper, 0], bottom)
    levels = np.unique(np.append(holds.ravel(), [-np.inf, np.inf])).tolist()
    return [
        Band(low, high, merged(crossed[(holds[:, 0] <= low) & (holds[:, 1] >= high)][:, [0, 2]]))
        for low, high in pairwise(levels)
    ]


def merged(spans: FloatArray | Sequence[FloatArray]) -> FloatArray:
    """Return overlapping or touching intervals (n, 2) joined, sorted."""
    joined: list[FloatArray] = []
    for span in sorted(spans, key=lambda s: (s[0], s[1])):
        if joined and span[0] <= joined[-1][1] + TOLERANCE:
            joined[-1] = np.array([joined[-1][0], max(joined[-1][1], span[1])])
        else:
            joined.append(span)
    return np.array(joined) if joined else np.empty((0, 2))
