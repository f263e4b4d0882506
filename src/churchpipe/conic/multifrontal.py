"""Multifrontal Cholesky factorisation of many matrices with one sparsity pattern, on all cores (Duff and Reid 1983; Liu 1992).

A front begins with the entries of the matrix in its columns and with the update matrices of its children. Dense algebra
factorises its columns and leaves an update matrix to its parent. Disjoint subtrees know nothing of each other. Sums are made in
one order, whatever the number of threads. The dense algebra is our own, because a BLAS has threads of its own, which
would wait for each other: no faster, and on a busy machine a hundred times slower.
"""

import numba
import numpy as np
import scipy.sparse as sp

from churchpipe.conic.supernodes import Supernodes, supernodes
from churchpipe.conic.threads import threads, together
from churchpipe.model.arrays import FloatArray, IntArray

# Rows and columns that the dense loops take at a time.
_TILE = 4


class Multifrontal:
    """Factor of matrices with one sparsity pattern: symbolic analysis once, then `take(values)`, `factor` and `solve`."""

    def __init__(self, pattern: sp.csc_matrix[np.float64], order: IntArray) -> None:
        """Analyse a lower triangle (n, n) with sorted indices, to be eliminated about in this order (n,)."""
        self._tree = supernodes(pattern, order)
        self._panels, self._updates = np.empty(int(self._tree.panel[-1])), np.empty(int(self._tree.space[0]))
        self._values = np.zeros(0)

    def take(self, values: FloatArray) -> None:
        """Take the nonzeros of the matrix, in the order of the pattern."""
        self._values = values

    def factor(self) -> None:
        """Factorise the matrix.

        Raises
        ------
        ArithmeticError
            The matrix is not positive definite; with the row where that is found.
        """
        tree, parts = self._tree, len(self._tree.part_first)
        # One more than the first column of each part, and of those above, that is not positive.
        failed = np.zeros(parts + 1, dtype=np.int64)
        work = (tree, self._values, self._panels, self._updates)
        together(*((_factor_parts, share, *work, failed) for share in self._shares()))
        if not failed.any():
            _factor_fronts(tree.top, *work, failed[parts:])
        if failed.any():
            raise ArithmeticError(int(tree.order[failed[failed > 0].min() - 1]))

    def solve(self, right: FloatArray) -> FloatArray:
        """Return N^-1 right, right (n,) or (n, k). Each panel is read once for all k."""
        tree, shares = self._tree, self._shares()
        x = np.ascontiguousarray(np.atleast_2d(right.T)[:, tree.order])
        carried, beyond = np.empty((len(x), len(tree.reached))), np.zeros((len(shares), *x.shape))
        work = (tree, self._panels, x)
        together(*((_forward_parts, parts, *work, beyond[k], carried) for k, parts in enumerate(shares)))
        _forward_top(*work, carried)
        _backward(tree.top, *work)
        together(*((_backward_parts, parts, *work) for parts in shares))
        out = np.empty_like(x)
        out[:, tree.order] = x
        return out.T.reshape(right.shape)

    def nonzeros(self) -> int:
        """Number of stored entries of the factor."""
        return len(self._panels)

    def _shares(self) -> list[IntArray]:
        """Return the parts that each thread does, the largest first, so that all have about as much work."""
        shares: list[list[int]] = [[] for _ in range(threads())]
        busy = np.zeros(len(shares))
        for part in np.argsort(-self._tree.part_work, kind="stable").tolist():
            least = int(busy.argmin())
            shares[least].append(part)
            busy[least] += self._tree.part_work[part]
        return [np.array(share, dtype=np.int64) for share in shares if share]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _factor_parts(
    parts: IntArray, tree: Supernodes, values: FloatArray, panels: FloatArray, updates: FloatArray, failed: IntArray
) -> None:
    for k in range(len(parts)):
        part = int(parts[k])
        mine = np.arange(int(tree.part_first[part]), int(tree.part_last[part]) + 1)
        _factor_fronts(mine, tree, values, panels, updates, failed[part : part + 1])


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _factor_fronts(
    fronts: IntArray, tree: Supernodes, values: FloatArray, panels: FloatArray, updates: FloatArray, failed: IntArray
) -> None:
    """Factorise these fronts, children first, or write into `failed` one more than the column that is not positive."""
    for k in range(len(fronts)):
        s = int(fronts[k])
        width, rows = tree.width[s], tree.rows[s]
        deep = rows - width
        panel = panels[tree.panel[s] : tree.panel[s + 1]].reshape(rows, width)
        update = updates[tree.update[s] : tree.update[s] + deep * deep].reshape(deep, deep)
        _assemble(s, tree, values, panel, updates)
        column = _eliminate(panel)
        if column > 0:
            failed[0] = tree.start[s] + column
            return
        under: FloatArray = panel[width:].reshape(deep * width)
        flat = update.ravel()
        for i in range(0, deep, _TILE):
            for j in range(0, i + 1, _TILE):
                _subtract(under, width, deep, i, j, width, flat, deep, j, min(_TILE, deep - j), True)
        _extend(s, tree, update, updates)


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _assemble(s: int, tree: Supernodes, values: FloatArray, panel: FloatArray, updates: FloatArray) -> None:
    """Add up the panel of a front, of the matrix and of the update matrices of its children."""
    width = tree.width[s]
    flat = panel.reshape(panel.size)
    flat[:] = 0.0
    for p in range(tree.entry[s], tree.entry[s + 1]):
        flat[tree.put[p]] = values[tree.taken[p]]
    for k in range(tree.child[s], tree.child[s + 1]):
        c = tree.children[k]
        place = tree.place[tree.at[c] : tree.at[c + 1]]
        deep, inside = len(place), _inside(place, width)
        for i in range(deep):
            source = updates[tree.update[c] + i * deep : tree.update[c] + i * deep + i + 1]
            row = panel[place[i]]
            for j in range(np.uint64(min(inside, i + 1))):
                row[np.uint64(place[j])] += source[j]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _extend(s: int, tree: Supernodes, update: FloatArray, updates: FloatArray) -> None:
    """Add to the lower triangle of the update matrix of a front what its children leave to it."""
    width = tree.width[s]
    for k in range(tree.child[s], tree.child[s + 1]):
        c = tree.children[k]
        place = tree.place[tree.at[c] : tree.at[c + 1]]
        deep, inside = len(place), _inside(place, width)
        for i in range(inside, deep):
            source = updates[tree.update[c] + i * deep : tree.update[c] + i * deep + i + 1]
            row = update[place[i] - width]
            for j in range(np.uint64(inside), np.uint64(i + 1)):
                row[np.uint64(place[j] - width)] += source[j]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _inside(place: IntArray, width: int) -> int:
    """Return how many of the rows of a child are columns of its parent."""
    inside = 0
    while inside < len(place) and place[inside] < width:
        inside += 1
    return inside


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _eliminate(panel: FloatArray) -> int:
    """Factorise a panel (rows, width), and return one more than the column that is not positive, or 0."""
    rows, width = panel.shape
    flat = panel.reshape(rows * width)
    for first in range(0, width, _TILE):
        last = min(first + _TILE, width)
        if first > 0:
            for i in range(first, rows, _TILE):
                _subtract(flat, width, rows, i, first, first, flat, width, first, last - first, False)
        for j in range(first, last):
            # A number that is none fails here as well.
            if not panel[j, j] > 0.0:
                return j + 1
            panel[j, j] = np.sqrt(panel[j, j])
            for i in range(j + 1, last):
                panel[i, j] /= panel[j, j]
                for k in range(j + 1, i + 1):
                    panel[i, k] -= panel[i, j] * panel[k, j]
        _substitute(flat[first * width + first :], width, rows - first, last - first)
    return 0


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _substitute(block: FloatArray, width: int, rows: int, wide: int) -> None:
    """Multiply what is below a triangle of `wide` columns by its inverse transposed; rows begin `width` numbers apart."""
    if wide == _TILE:
        d0, d1, d2, d3 = 1.0 / block[0], 1.0 / block[width + 1], 1.0 / block[2 * width + 2], 1.0 / block[3 * width + 3]
        l10, l20, l30 = block[width], block[2 * width], block[3 * width]
        l21, l31, l32 = block[2 * width + 1], block[3 * width + 1], block[3 * width + 2]
        for i in range(np.uint64(_TILE), np.uint64(rows)):
            row = block[i * np.uint64(width) :]
            x0 = row[0] * d0
            x1 = (row[1] - x0 * l10) * d1
            x2 = (row[2] - x0 * l20 - x1 * l21) * d2
            row[3] = (row[3] - x0 * l30 - x1 * l31 - x2 * l32) * d3
            row[0], row[1], row[2] = x0, x1, x2
        return
    for i in range(wide, rows):
        row = block[i * width :]
        for j in range(wide):
            for k in range(j):
                row[j] -= row[k] * block[j * width + k]
            row[j] /= block[j * width + j]


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _subtract(
    panel: FloatArray,
    width: int,
    rows: int,
    i: int,
    j: int,
    length: int,
    out: FloatArray,
    across: int,
    column: int,
    wide: int,
    fresh: bool,
) -> None:
    """Subtract the products of four rows from i on with `wide` rows from j on, of this length, from out[i:, column:].

    `fresh`: from nothing, whatever stands there.

    panel (rows, width) and out (rows, across) are flat. All sixteen at once, so that they stay in registers. Where i is
    j nothing is written above the diagonal.
    """
    high = min(_TILE, rows - i)
    a0, b0 = panel[i * width :], panel[j * width :]
    a1, b1 = a0[min(1, high - 1) * width :], b0[min(1, wide - 1) * width :]
    a2, b2 = a0[min(2, high - 1) * width :], b0[min(2, wide - 1) * width :]
    a3, b3 = a0[(high - 1) * width :], b0[(wide - 1) * width :]
    c00 = c01 = c02 = c03 = c10 = c11 = c12 = c13 = 0.0
    c20 = c21 = c22 = c23 = c30 = c31 = c32 = c33 = 0.0
    for k in range(np.uint64(length)):
        p, q, r, s = b0[k], b1[k], b2[k], b3[k]
        c00 += a0[k] * p
        c01 += a0[k] * q
        c02 += a0[k] * r
        c03 += a0[k] * s
        c10 += a1[k] * p
        c11 += a1[k] * q
        c12 += a1[k] * r
        c13 += a1[k] * s
        c20 += a2[k] * p
        c21 += a2[k] * q
        c22 += a2[k] * r
        c23 += a2[k] * s
        c30 += a3[k] * p
        c31 += a3[k] * q
        c32 += a3[k] * r
        c33 += a3[k] * s
    row = out[i * across + column :]
    if wide == _TILE and high == _TILE and i != j:
        _take(row, c00, c01, c02, c03, fresh)
        _take(row[across:], c10, c11, c12, c13, fresh)
        _take(row[2 * across :], c20, c21, c22, c23, fresh)
        _take(row[3 * across :], c30, c31, c32, c33, fresh)
    else:
        tile = ((c00, c01, c02, c03), (c10, c11, c12, c13), (c20, c21, c22, c23), (c30, c31, c32, c33))
        for r in range(high):
            for c in range(min(wide, i + r - j + 1)):
                row[r * across + c] = -tile[r][c] if fresh else row[r * across + c] - tile[r][c]


@numba.njit(cache=True, error_model="numpy", nogil=True, inline="always")
def _take(row: FloatArray, a: float, b: float, c: float, d: float, fresh: bool) -> None:
    if fresh:
        row[0], row[1], row[2], row[3] = -a, -b, -c, -d
    else:
        row[0] -= a
        row[1] -= b
        row[2] -= c
        row[3] -= d


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _forward_parts(
    parts: IntArray, tree: Supernodes, panels: FloatArray, x: FloatArray, beyond: FloatArray, carried: FloatArray
) -> None:
    """Solve L y = x in these parts, and write into `carried` what they add to the rows above; beyond (k, n) is left zero."""
    for k in range(len(parts)):
        part = int(parts[k])
        last = int(tree.part_last[part])
        mine = np.arange(int(tree.part_first[part]), last + 1)
        _forward(mine, tree, panels, x, beyond, tree.start[last] + tree.width[last])
        for at in range(tree.reach[part], tree.reach[part + 1]):
            for c in range(len(x)):
                carried[c, at] = beyond[c, tree.reached[at]]
                beyond[c, tree.reached[at]] = 0.0


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _forward_top(tree: Supernodes, panels: FloatArray, x: FloatArray, carried: FloatArray) -> None:
    for at in range(len(tree.reached)):
        for c in range(len(x)):
            x[c, tree.reached[at]] += carried[c, at]
    _forward(tree.top, tree, panels, x, x, x.shape[1])


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _forward(fronts: IntArray, tree: Supernodes, panels: FloatArray, x: FloatArray, beyond: FloatArray, end: int) -> None:
    """Solve L y = x (k, n) in these fronts; what rows from `end` on lose is added to `beyond`."""
    for k in range(len(fronts)):
        s = int(fronts[k])
        width, rows, start = tree.width[s], tree.rows[s], tree.start[s]
        below = tree.below[tree.at[s] : tree.at[s + 1]]
        panel = panels[tree.panel[s] : tree.panel[s + 1]].reshape(rows, width)
        for c in range(len(x)):
            column, other = x[c], beyond[c]
            own = column[start : start + width]
            for i in range(width):
                row, value = panel[i], 0.0
                for j in range(np.uint64(i)):
                    value += row[j] * own[j]
                own[i] = (own[i] - value) / row[i]
            for i in range(len(below)):
                row, value = panel[width + i], 0.0
                for j in range(np.uint64(width)):
                    value += row[j] * own[j]
                if below[i] < end:
                    column[below[i]] -= value
                else:
                    other[below[i]] -= value


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _backward_parts(parts: IntArray, tree: Supernodes, panels: FloatArray, x: FloatArray) -> None:
    for k in range(len(parts)):
        part = int(parts[k])
        mine = np.arange(int(tree.part_first[part]), int(tree.part_last[part]) + 1)
        _backward(mine, tree, panels, x)


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _backward(fronts: IntArray, tree: Supernodes, panels: FloatArray, x: FloatArray) -> None:
    """Solve L^T y = x in these fronts, the last first."""
    for k in range(len(fronts) - 1, -1, -1):
        s = int(fronts[k])
        width, rows, start = tree.width[s], tree.rows[s], tree.start[s]
        below = tree.below[tree.at[s] : tree.at[s + 1]]
        panel = panels[tree.panel[s] : tree.panel[s + 1]].reshape(rows, width)
        for c in range(len(x)):
            column = x[c]
            own = column[start : start + width]
            for i in range(len(below)):
                row, value = panel[width + i], column[below[i]]
                for j in range(np.uint64(width)):
                    own[j] -= value * row[j]
            for i in range(width - 1, -1, -1):
                row = panel[i]
                own[i] /= row[i]
                for j in range(np.uint64(i)):
                    own[j] -= own[i] * row[j]
