"""Forces at the corners of rigid cells, and the sums of them that the shell knows.

Each point of a shell stands for one cell of rigid stones. The sums are the stress of the cell, and the forces and moments on its
stones, which vanish. Points whose cells are alike form a kind. All corner forces lie in one array (3, corners), component first:
kind by kind, in each corner by corner, in each point by point.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numba
import numpy as np
import scipy.sparse as sp

from churchpipe.conic.threads import bounds_of, in_shares
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of

# So many points are summed at a time: their forces stay in the cache.
_CHUNK = 256


@dataclass(frozen=True, slots=True)
class CellForces:
    """Which corner forces make which sums, for ng kinds of cells.

    points (nq,): those of kind 0, then of kind 1, ...; first (ng + 1,): where each kind starts in it. corners, still (ng,):
    number of corners, and of sums on the stones, of one cell; corner, row (ng + 1,): where those of each kind start. table, flat:
    the coefficients as dense blocks (corners, 3, 6 + still), one a kind. entry (ng + 1,): where those that are not zero start in
    `sums`, `components`, `of_corner`, `values`: sum s of a cell, the stresses 0 to 5 first, has `values` times component i of the
    force at corner c.
    """

    points: IntArray
    first: IntArray
    corners: IntArray
    still: IntArray
    corner: IntArray
    row: IntArray
    entry: IntArray
    sums: IntArray
    components: IntArray
    of_corner: IntArray
    values: FloatArray
    table: FloatArray

    @property
    def count(self) -> int:
        """Number of corners of all points."""
        return int(self.corner[-1])

    @property
    def rows(self) -> int:
        """Number of sums that vanish, of all points."""
        return int(self.row[-1])

    def of_each_corner(self, values: FloatArray) -> FloatArray:
        """Return values (nq,) of the points at their corners (corners,)."""
        parts = [np.tile(values[self._members(kind)], count) for kind, count in enumerate(self.corners.tolist())]
        return np.concatenate(parts)

    def by_corner(self, values: FloatArray) -> FloatArray:
        """Return values at the corners (corners,) as (most corners of a cell, nq), zero where a cell has fewer."""
        out = np.zeros((int(self.corners.max()), len(self.points)))
        for kind, count in enumerate(self.corners.tolist()):
            mine = values[self.corner[kind] : self.corner[kind + 1]].reshape(count, -1)
            out[:count, self._members(kind)] = mine
        return out

    def of_each_row(self, values: FloatArray) -> FloatArray:
        """Return values (nq,) of the points at their sums that vanish (rows,)."""
        return np.concatenate([np.tile(values[self._members(kind)], count) for kind, count in enumerate(self.still.tolist())])

    def add_up(self, force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the stresses (6, nq) and the sums on the stones (rows,) of the forces (3, corners)."""
        stress, still = np.empty((6, len(self.points))), np.empty(self.rows)
        in_shares(_add_up, self.count, self.kinds, self.entries, force, stress, still)
        return stress, still

    def spread(self, stress: FloatArray, still: FloatArray) -> FloatArray:
        """Return the transpose: forces (3, corners) from (6, nq) and (rows,)."""
        out = np.zeros((3, self.count))
        in_shares(_spread, self.count, self.kinds, self.entries, np.ascontiguousarray(stress), still, out)
        return out

    def matrix(self) -> tuple[sp.csr_matrix[np.float64], sp.csr_matrix[np.float64]]:
        """Return the stresses (6 nq, 3 corners), rows component first, and the sums on the stones (rows, 3 corners)."""
        stress: list[tuple[IntArray, IntArray, FloatArray]] = []
        still: list[tuple[IntArray, IntArray, FloatArray]] = []
        for kind in range(len(self.corners)):
            own = self._members(kind)
            for at in range(int(self.entry[kind]), int(self.entry[kind + 1])):
                s, place = int(self.sums[at]), np.arange(len(own))
                column = self.components[at] * self.count + self.corner[kind] + self.of_corner[at] * len(own) + place
                row = s * len(self.points) + own if s < 6 else self.row[kind] + (s - 6) * len(own) + place
                (stress if s < 6 else still).append((row, column, np.full(len(own), self.values[at])))
        width = 3 * self.count
        return _assembled(stress, (6 * len(self.points), width)), _assembled(still, (self.rows, width))

    def _members(self, kind: int) -> IntArray:
        return self.points[self.first[kind] : self.first[kind + 1]]

    @property
    def kinds(self) -> "Kinds":
        """Points, and where points, corners and sums of each kind start."""
        return self.points, self.first, self.corner, self.row

    @property
    def entries(self) -> "Entries":
        """The coefficients that are not zero."""
        return self.entry, self.sums, self.components, self.of_corner, self.values


def cell_forces(closings: Sequence[FloatArray], kind: IntArray) -> CellForces:
    """Return the sums of points of some kinds (nq,), whose cells have coefficients (corners, 3, 6 + still) each."""
    points = np.argsort(kind, kind="stable").astype(np.int64)
    sizes = np.bincount(kind, minlength=len(closings)).astype(np.int64)
    corners = np.array([len(closing) for closing in closings], dtype=np.int64)
    still = np.array([closing.shape[2] - 6 for closing in closings], dtype=np.int64)
    found = [np.nonzero(closing) for closing in closings]
    # Sum by sum, so that each is collected in one go.
    order = [np.lexsort((c, i, s)) for c, i, s in found]
    parts = [(s[by], i[by], c[by]) for (c, i, s), by in zip(found, order, strict=True)]
    values = [closing[c, i, s] for closing, (s, i, c) in zip(closings, parts, strict=True)]
    sums, components, of_corner = (np.concatenate(same).astype(np.int64) for same in zip(*parts, strict=True))
    return CellForces(
        points=points,
        first=pointer_of(sizes),
        corners=corners,
        still=still,
        corner=pointer_of(corners * sizes),
        row=pointer_of(still * sizes),
        entry=pointer_of(np.array([len(part) for part in values], dtype=np.int64)),
        sums=sums,
        components=components,
        of_corner=of_corner,
        values=np.concatenate(values),
        table=np.concatenate([closing.ravel() for closing in closings]),
    )


Kinds: TypeAlias = tuple[IntArray, IntArray, IntArray, IntArray]
Entries: TypeAlias = tuple[IntArray, IntArray, IntArray, IntArray, FloatArray]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _add_up(
    share: int, shares: int, kinds: Kinds, entries: Entries, force: FloatArray, stress: FloatArray, still: FloatArray
) -> None:
    points, first, corner, row = kinds
    entry, sums, components, of_corner, values = entries
    buffer = np.zeros(_CHUNK)
    for g in range(len(first) - 1):
        n = first[g + 1] - first[g]
        begun, end = bounds_of(n, share, shares)
        for start in range(begun, end, _CHUNK):
            size = min(_CHUNK, end - start)
            at = entry[g]
            while at < entry[g + 1]:
                s = sums[at]
                buffer[:] = 0.0
                while at < entry[g + 1] and sums[at] == s:
                    value, i, begin = values[at], components[at], corner[g] + of_corner[at] * n + start
                    for j in range(size):
                        buffer[j] += value * force[i, begin + j]
                    at += 1
                if s < 6:
                    for j in range(size):
                        stress[s, points[first[g] + start + j]] = buffer[j]
                else:
                    for j in range(size):
                        still[row[g] + (s - 6) * n + start + j] = buffer[j]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _spread(
    share: int, shares: int, kinds: Kinds, entries: Entries, stress: FloatArray, still: FloatArray, force: FloatArray
) -> None:
    points, first, corner, row = kinds
    entry, sums, components, of_corner, values = entries
    buffer = np.zeros(_CHUNK)
    for g in range(len(first) - 1):
        n = first[g + 1] - first[g]
        begun, end = bounds_of(n, share, shares)
        for start in range(begun, end, _CHUNK):
            size = min(_CHUNK, end - start)
            at = entry[g]
            while at < entry[g + 1]:
                s = sums[at]
                if s < 6:
                    for j in range(size):
                        buffer[j] = stress[s, points[first[g] + start + j]]
                else:
                    for j in range(size):
                        buffer[j] = still[row[g] + (s - 6) * n + start + j]
                while at < entry[g + 1] and sums[at] == s:
                    value, i, begin = values[at], components[at], corner[g] + of_corner[at] * n + start
                    for j in range(size):
                        force[i, begin + j] += value * buffer[j]
                    at += 1


def _assembled(parts: list[tuple[IntArray, IntArray, FloatArray]], shape: tuple[int, int]) -> sp.csr_matrix[np.float64]:
    if not parts:
        return sp.csr_matrix(shape)
    row, column, values = (np.concatenate(same) for same in zip(*parts, strict=True))
    return sp.csr_matrix((values, (row, column)), shape=shape)
