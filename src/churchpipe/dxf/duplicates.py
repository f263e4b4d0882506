"""Stones drawn twice: the commonest slip of copy and paste."""

import numpy as np

from churchpipe.dxf.stones import Stone
from churchpipe.findings import Finding
from churchpipe.geometry.mending import signed_volumes
from churchpipe.model.arrays import FloatArray

# Stones whose boxes, corner means and volumes agree to this part of the median stone are one stone drawn twice.
SAME_STONE = 1e-6


def distinct_stones(stones: list[Stone], repair: bool, findings: list[Finding]) -> list[Stone]:
    """Report stones drawn twice (E11); with `repair`, drop the later ones that are equal in all but their name (W11)."""
    dropped: set[int] = set()
    for first, second in coinciding(stones):
        one, other = stones[first], stones[second]
        handle = f" (#{one.place.handle})" if one.place.handle else ""
        found = f'stone "{other.name}" lies on "{one.name}"{handle}'
        if repair and (one.fixed, one.material) == (other.fixed, other.material):
            findings.append(other.place.finding("W11", f"{found} and was dropped"))
            dropped.add(second)
        else:
            remedy = "Delete one of the two" + (": one is ground or of other material." if repair else ", or pass --repair.")
            findings.append(other.place.finding("E11", found, expected="one stone in one place", remedy=remedy))
    return [stone for index, stone in enumerate(stones) if index not in dropped]


def coinciding(stones: list[Stone]) -> list[tuple[int, int]]:
    """Return (first drawn, copy) for every stone that lies on one drawn before it, in drawing order of the copies."""
    if len(stones) < 2:
        return []
    marks = _marks(stones)
    size = float(np.median(np.cbrt(marks[:, 9])))
    limit = SAME_STONE * np.append(np.full(9, size), size**3)
    # Sorted along a direction that no building follows, equal stones are neighbours.
    weights = np.sqrt([2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0])
    along = marks[:, :9] @ weights
    reach = limit[0] * weights.sum()
    groups: list[list[int]] = []
    start = 0
    for index in np.argsort(along, kind="stable").tolist():
        while start < len(groups) and along[index] - along[groups[start][0]] > reach:
            start += 1
        equal = (group for group in groups[start:] if (np.abs(marks[index] - marks[group[0]]) <= limit).all())
        if (group := next(equal, None)) is None:
            groups.append([index])
        else:
            group.append(index)
    pairs = [(min(group), copy) for group in groups for copy in group if copy != min(group)]
    return sorted(pairs, key=lambda pair: pair[1])


def _marks(stones: list[Stone]) -> FloatArray:
    """Return box, mean of the face corners (which tells two halves of one box apart) and volume (ns, 10), drawing units."""
    corners = [stone.points[[node for face in stone.faces for node in face]] for stone in stones]
    count = np.array([len(own) for own in corners])
    start = np.cumsum(count) - count
    together = np.concatenate(corners)
    low, high, total = (edge.reduceat(together, start, axis=0) for edge in (np.minimum, np.maximum, np.add))
    volume = signed_volumes([(stone.points, stone.faces) for stone in stones])
    return np.column_stack([low, high, total / count[:, None], volume])
