"""The normal matrix sum_k B_k S_k B_k^T, assembled straight into the nonzeros of its lower triangle."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numba
import numpy as np
import scipy.sparse as sp

from churchpipe.conic.interior_point.coupling import Coupling
from churchpipe.conic.interior_point.division import Division, divided
from churchpipe.conic.threads import in_shares, shares_of
from churchpipe.conic.tiles import COLUMNS, padded, subtract_products
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of, ragged_indices

# So many local problems of an element are summed at a time.
_TOGETHER = 16


class NormalMatrix:
    """Fixed pattern and repeated assembly of the normal matrix of a coupling.

    Local problems that touch the same row blocks form one element, whose matrix is summed before it is scattered.
    """

    def __init__(self, coupling: Coupling) -> None:
        self._coupling = coupling
        order, ends = _elements(coupling)
        first = coupling.pointer[order[ends[:-1]]]
        width = np.diff(coupling.pointer)[order[ends[:-1]]]
        graph = _block_graph(coupling, first, width)
        self.pattern, columns = _pattern(graph, coupling.block)
        rank, rank_pointer = _ranks(coupling, first, width, graph)
        self._order = (order, ends, coupling.pointer, coupling.blocks, rank_pointer, rank, columns)
        self._first, self._width = first, width
        self._division: Division | None = None
        self._widest = int(width.max(initial=0))
        self._assemble = _kernel(coupling.dimension, coupling.block, self._widest)
        self.diagonal: IntArray = self.pattern.indptr[:-1].astype(np.int64)

    def assemble(self, compliance: FloatArray) -> FloatArray:
        """Return the values of the lower triangle, in the order of the pattern; compliance_ijk (d, d, count)."""
        places = self._coupling.count
        shares = shares_of(places)
        if self._division is None or self._division.shares != shares:
            count = self._coupling.rows // self._coupling.block
            self._division = divided(self._first, self._width, self._coupling.blocks, count, shares)
        values = np.zeros(self.pattern.nnz)
        in_shares(self._assemble, places, *self._division, self._order, self._coupling.values, compliance, values)
        return values


@lru_cache
def _kernel(dimension: int, block: int, widest: int) -> Callable[..., Any]:
    """Compile the assembly for one size of block."""

    @numba.njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
    def assemble(
        share: int,
        _: int,
        members: IntArray,
        first: IntArray,
        owner: IntArray,
        elements: tuple[IntArray, IntArray, IntArray, IntArray, IntArray, IntArray, IntArray],
        coupled: FloatArray,
        compliance: FloatArray,
        out: FloatArray,
    ) -> None:
        order, ends, pointer, blocks, rank_pointer, rank, columns = elements
        most, wide = padded(widest * block), padded(dimension)
        columns_of_pairs = dimension * _TOGETHER + COLUMNS
        pairs, total = np.empty(columns_of_pairs * (2 * most + wide)), np.empty(most * most)
        for looked in range(first[share], first[share + 1]):
            element = members[looked]
            start = pointer[order[ends[element]]]
            width = pointer[order[ends[element]] + 1] - start
            rows = int(width * block)
            # Columns of B_k^T, below them those of -B_k^T S_k, and S_k.
            line = padded(rows)
            apart = 2 * line + wide
            for begin in range(ends[element], ends[element + 1], _TOGETHER):
                length = 0
                for member in range(begin, min(begin + _TOGETHER, ends[element + 1])):
                    k = order[member]
                    own = pairs[length * apart :]
                    for a in range(dimension):
                        column = own[a * apart :]
                        for p in range(width):
                            for c in range(block):
                                column[p * block + c] = coupled[pointer[k] + p, a, c]
                        column[rows:line] = 0.0
                        for b in range(dimension):
                            column[2 * line + b] = compliance[a, b, k]
                    for a in range(0, dimension, COLUMNS):
                        subtract_products(own, own[line:], 0, rows, 2 * line + a, a, apart, dimension, apart, True)
                    length += dimension
                for j in range(0, rows, COLUMNS):
                    subtract_products(pairs, total, j, rows, line + j, j, apart, length, line, begin == ends[element])
            pair = rank_pointer[element]
            for p in range(width):
                for q in range(p + 1):
                    place = rank[pair] * block
                    pair += 1
                    if owner[blocks[start + q]] != share:
                        continue
                    for c in range(block):
                        at = columns[blocks[start + q] * block + c] + place - c
                        sums = total[(q * block + c) * line + p * block :]
                        for r in range(c if p == q else 0, block):
                            out[at + r] += sums[r]

    return assemble


def _elements(coupling: Coupling) -> tuple[IntArray, IntArray]:
    """Return the local problems that touch anything, those with the same blocks side by side, and where each group ends."""
    width = np.diff(coupling.pointer)
    chosen: list[IntArray] = []
    ends: list[IntArray] = [np.zeros(1, dtype=np.int64)]
    done = 0
    for wide in np.unique(width[width > 0]).tolist():
        mine = np.flatnonzero(width == wide)
        touched = coupling.blocks[coupling.pointer[mine] + np.arange(wide)[:, None]]
        order = np.lexsort(touched[::-1])
        touched = touched[:, order]
        last = np.flatnonzero(np.append((touched[:, 1:] != touched[:, :-1]).any(axis=0), True))
        chosen.append(mine[order])
        ends.append(done + last + 1)
        done += len(mine)
    return np.concatenate([*chosen, np.zeros(0, dtype=np.int64)]), np.concatenate(ends)


def _block_graph(coupling: Coupling, first: IntArray, width: IntArray) -> sp.csc_matrix[np.float64]:
    """Return the lower triangle of which blocks meet in an element, the diagonal always."""
    count = coupling.rows // coupling.block
    rows: list[IntArray] = [np.arange(count)]
    columns: list[IntArray] = [np.arange(count)]
    for p in range(1, int(width.max(initial=0))):
        start = first[width > p]
        for q in range(p):
            rows.append(coupling.blocks[start + p])
            columns.append(coupling.blocks[start + q])
    row, column = np.concatenate(rows), np.concatenate(columns)
    graph = sp.csc_matrix((np.ones(len(row)), (row, column)), shape=(count, count))
    graph.sort_indices()
    return graph


def _pattern(graph: sp.csc_matrix[np.float64], block: int) -> tuple[sp.csc_matrix[np.float64], IntArray]:
    """Return the pattern of the lower triangle with full blocks, and where each column starts."""
    count = graph.shape[0]
    blocks_below = np.diff(graph.indptr).astype(np.int64)
    lengths = (block * blocks_below[:, None] - np.arange(block)).ravel()
    pointer = pointer_of(lengths)
    rows = (block * graph.indices[:, None] + np.arange(block, dtype=graph.indices.dtype)).ravel()
    # Every column of a block column has all its rows, less those above the diagonal.
    starts = np.repeat(block * graph.indptr[:-1].astype(np.int64), block) + np.tile(np.arange(block), count)
    take = ragged_indices(starts, lengths)
    size = count * block
    pattern = sp.csc_matrix((np.zeros(len(take)), rows[take], pointer), shape=(size, size))
    return pattern, pointer


def _ranks(coupling: Coupling, first: IntArray, width: IntArray, graph: sp.csc_matrix[np.float64]) -> tuple[IntArray, IntArray]:
    """Return for each pair p >= q of an element's blocks the rank of block p in column q, and where elements start."""
    count = graph.shape[0]
    columns = np.repeat(np.arange(count), np.diff(graph.indptr))
    start = np.asarray(graph.indptr, dtype=np.int64)
    keys = columns * count + graph.indices
    pointer = pointer_of(width * (width + 1) // 2)
    rank = np.empty(int(pointer[-1]), dtype=np.int64)
    for p in range(int(width.max(initial=0))):
        wide = np.flatnonzero(width > p)
        upper = coupling.blocks[first[wide] + p]
        for q in range(p + 1):
            lower = coupling.blocks[first[wide] + q]
            place = np.asarray(np.searchsorted(keys, lower * count + upper), dtype=np.int64)
            rank[pointer[wide] + p * (p + 1) // 2 + q] = place - start[lower]
    return rank, pointer
