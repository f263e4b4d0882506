"""Stones drawn twice: the commonest slip of copy and paste."""

import numpy as np
from scipy.spatial import KDTree

from churchpipe.dxf.stones import Stone
from churchpipe.findings import Finding
from churchpipe.geometry.mending import signed_volumes
from churchpipe.model.arrays import FloatArray

# Stones whose boxes, corner means and volumes agree to this part of the median stone are one stone drawn twice.
SAME_STONE = 1e-6
# So are stones whose boxes and corner means agree to the first part of their smallest side, and that fill more than the second
# part of their boxes: a copy that slipped.
NEARLY_SAME, FILLED = 0.01, 0.51


def distinct_stones(stones: list[Stone], repair: bool, findings: list[Finding]) -> list[Stone]:
    """Report stones drawn twice (E11); with `repair`, drop the later ones that are equal in all but their name (W11)."""
    dropped: set[int] = set()
    for first, second in coinciding(stones):
        one, other = stones[first], stones[second]
        handle = f" (#{one.place.handle})" if one.place.handle else ""
        found = f'stone "{other.name}" lies on "{one.name}"{handle}'
        slip = float(np.abs(np.ptp([*map(_box, (one, other))], axis=0)).max())
        lengths = (slip,) if slip > SAME_STONE * float(np.ptp(one.points, axis=0).max()) else ()
        found += ", but for a slip of {}," if lengths else ""
        if repair and (one.fixed, one.material) == (other.fixed, other.material):
            findings.append(other.place.finding("W11", f"{found} and was dropped", lengths=lengths))
            dropped.add(second)
        else:
            remedy = "Delete one of the two" + (": one is ground or of other material." if repair else ", or pass --repair.")
            expected = "one stone in one place"
            findings.append(other.place.finding("E11", found.rstrip(","), expected=expected, remedy=remedy, lengths=lengths))
    return [stone for index, stone in enumerate(stones) if index not in dropped]


def coinciding(stones: list[Stone]) -> list[tuple[int, int]]:
    """Return (first drawn, copy) for every stone that lies on one drawn before it, in drawing order of the copies."""
    if len(stones) < 2:
        return []
    marks = _marks(stones)
    size = float(np.median(np.cbrt(marks[:, 9])))
    pairs = KDTree(marks[:, :9]).query_pairs(max(SAME_STONE, NEARLY_SAME) * size, p=np.inf, output_type="ndarray")
    first, second = marks[pairs].transpose(1, 0, 2)
    away, volume = np.abs(first - second)[:, :9].max(axis=1), first[:, 9]
    same = (away <= SAME_STONE * size) & (np.abs(volume - second[:, 9]) <= SAME_STONE * size**3)
    sides = first[:, 3:6] - first[:, :3]
    # Of boxes that agree, stones that fill more than half of theirs have a place in common.
    filled = np.minimum(volume, second[:, 9]) > FILLED * sides.prod(axis=1)
    nearly = filled & (away <= NEARLY_SAME * sides.min(axis=1))
    one = dict[int, int]()
    copies: list[list[int]] = np.unique(np.sort(pairs[same | nearly], axis=1), axis=0).tolist()
    for a, b in copies:
        if b not in one:
            one[b] = one.get(a, a)
    return sorted(((a, b) for b, a in one.items()), key=lambda pair: pair[1])


def _box(stone: Stone) -> FloatArray:
    return np.concatenate([stone.points.min(axis=0), stone.points.max(axis=0)])


def _marks(stones: list[Stone]) -> FloatArray:
    """Return box, mean of the face corners (which tells two halves of one box apart) and volume (ns, 10), drawing units."""
    corners = [stone.points[[node for face in stone.faces for node in face]] for stone in stones]
    count = np.array([len(own) for own in corners])
    start = np.cumsum(count) - count
    together = np.concatenate(corners)
    low, high, total = (edge.reduceat(together, start, axis=0) for edge in (np.minimum, np.maximum, np.add))
    volume = signed_volumes([(stone.points, stone.faces) for stone in stones])
    return np.column_stack([low, high, total / count[:, None], volume])
