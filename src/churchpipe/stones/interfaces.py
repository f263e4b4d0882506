"""Interfaces while contacts are searched: the two faces, the place, and the gap between them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, ContactTolerances, NearMisses

# A joint within this angle of level, or of upright, counts as level or upright, rad: stones of a survey are no more exact.
UPRIGHT = math.radians(1.0)


@dataclass(frozen=True, slots=True)
class Interfaces:
    """Interfaces by their faces, or facets: side (n, 2); exact (n,), True where both faces lie in one plane; frame, area, gap,
    angle, point and point_ptr as in `Contacts`."""

    side: IntArray
    exact: BoolArray
    frame: FloatArray
    area: FloatArray
    gap: FloatArray
    angle: FloatArray
    point: FloatArray
    point_ptr: IntArray

    def __len__(self) -> int:
        return len(self.side)


def frames(n: FloatArray) -> FloatArray:
    """Return right-handed frames (k, 3, 3), rows n, t1, t2; t1 is horizontal where n is not vertical."""
    helper = np.where(np.abs(n[:, 2:]) > 0.9, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    t1 = np.cross(helper, n)
    t1 /= np.maximum(np.linalg.norm(t1, axis=1, keepdims=True), np.finfo(float).tiny)
    return np.stack([n, t1, np.cross(n, t1)], axis=1).astype(np.float64)


def chosen(found: Interfaces, rows: IntArray) -> Interfaces:
    """Return some of the interfaces, in the order of `rows`."""
    counts = np.diff(found.point_ptr)[rows]
    return Interfaces(
        found.side[rows],
        found.exact[rows],
        found.frame[rows],
        found.area[rows],
        found.gap[rows],
        found.angle[rows],
        found.point[ragged_indices(found.point_ptr[:-1][rows], counts)],
        pointer_of(counts),
    )


def joined(parts: Sequence[Interfaces]) -> Interfaces:
    """Return the interfaces of several lists as one."""
    counts = np.concatenate([np.diff(part.point_ptr) for part in parts])
    names = ("side", "exact", "frame", "area", "gap", "angle", "point")
    fields = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return Interfaces(**fields, point_ptr=pointer_of(counts))


def contacts_of(
    stones: Assemblage, stone: IntArray, found: Interfaces, near_misses: NearMisses, tolerances: ContactTolerances
) -> Contacts:
    """Return interfaces as contacts, sorted by their stones; stone: of each face or facet."""
    blocks = stone[found.side]
    order = np.lexsort((blocks[:, 1], blocks[:, 0]))
    found, blocks = chosen(found, order), blocks[order]
    return Contacts(
        blocks=blocks,
        frame=found.frame,
        area=found.area,
        point=found.point,
        point_ptr=found.point_ptr,
        kind=_kinds(stones, blocks, found),
        gap=found.gap,
        angle=found.angle,
        near_misses=near_misses,
        tolerances=tolerances,
    )


def _kinds(stones: Assemblage, blocks: IntArray, found: Interfaces) -> np.ndarray:
    upward = np.abs(found.frame[:, 0, 2])
    level = np.where(found.exact, 1e-6, 1.0 - np.cos(UPRIGHT))
    kind = np.select([upward > 1 - level, upward < np.where(found.exact, 1e-6, np.sin(UPRIGHT))], ["bed", "head"], "radial")
    panels = stones.panel[blocks]
    of_walls = np.where(stones.butts[blocks].any(axis=1), "butt", "junction")
    kind = np.where((panels[:, 0] != panels[:, 1]) & (kind == "head"), of_walls, kind)
    return np.where(stones.fixed[blocks].any(axis=1), "base", kind)
