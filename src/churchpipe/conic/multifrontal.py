"""Multifrontal Cholesky factorisation of many matrices with one sparsity pattern, on all cores (Duff and Reid 1983; Liu 1992).

A front begins with the entries of the matrix in its columns and with the update matrices of its children. Dense algebra
factorises its columns and leaves an update matrix to its parent. Disjoint subtrees know nothing of each other. Sums are made in
one order, whatever the number of threads. The dense algebra is our own, because a BLAS has threads of its own, which
would wait for each other: no faster, and on a busy machine a hundred times slower.
"""

import numba
import numpy as np
import scipy.sparse as sp

from churchpipe.conic.supernodes import SPARE, Supernodes, supernodes
from churchpipe.conic.threads import threads, together
from churchpipe.conic.tiles import COLUMNS, padded, subtract_products
from churchpipe.model.arrays import FloatArray, IntArray


class Multifrontal:
    """Factor of matrices with one sparsity pattern: symbolic analysis once, then `take(values)`, `factor` and `solve`."""

    def __init__(self, pattern: sp.csc_matrix[np.float64], order: IntArray) -> None:
        """Analyse a lower triangle (n, n) with sorted indices, to be eliminated about in this order (n,)."""
        self._tree = supernodes(pattern, order)
        self._panels, self._updates = np.empty(int(self._tree.panel[-1])), np.empty(int(self._tree.space[0]))
        self._values = np.zeros(0)
        self._shared: dict[int, list[IntArray]] = {}

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
        if len(shares) == 1:
            _solve_alone(shares[0], *work, beyond[0], carried)
        else:
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
        count = threads()
        if count not in self._shared:
            shares: list[list[int]] = [[] for _ in range(count)]
            busy = np.zeros(count)
            for part in np.argsort(-self._tree.part_work, kind="stable").tolist():
                least = int(busy.argmin())
                shares[least].append(part)
                busy[least] += self._tree.part_work[part]
            self._shared[count] = [np.array(share, dtype=np.int64) for share in shares if share]
        return self._shared[count]


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
    work = np.empty(((tree.width + SPARE) * (tree.rows + SPARE)).max())
    for k in range(len(fronts)):
        s = int(fronts[k])
        width, rows = tree.width[s], tree.rows[s]
        deep = rows - width
        # Columns of the front one after the other, and room for what tiles have beyond the last column and row.
        line, across = rows + SPARE, padded(deep)
        columns = work[: (width + SPARE) * line]
        update = updates[tree.update[s] : tree.update[s] + across * across]
        _assemble(s, tree, values, columns, updates)
        column = _eliminate(columns, width, rows)
        if column > 0:
            failed[0] = tree.start[s] + column
            return
        panel = panels[tree.panel[s] : tree.panel[s + 1]].reshape(rows, width)
        for i in range(rows):
            row = panel[i]
            for j in range(np.uint64(width)):
                row[j] = columns[j * np.uint64(line) + np.uint64(i)]
        for j in range(0, deep, COLUMNS):
            subtract_products(columns[width:], update, j, deep, j, j, line, width, across, True)
        _extend(s, tree, update, updates)


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _assemble(s: int, tree: Supernodes, values: FloatArray, columns: FloatArray, updates: FloatArray) -> None:
    """Add up the columns of a front, of the matrix and of the update matrices of its children."""
    width, line = tree.width[s], tree.rows[s] + SPARE
    columns[:] = 0.0
    for p in range(tree.entry[s], tree.entry[s + 1]):
        columns[tree.put[p]] = values[tree.taken[p]]
    for k in range(tree.child[s], tree.child[s + 1]):
        c = tree.children[k]
        place = tree.place[tree.at[c] : tree.at[c + 1]]
        deep, across = len(place), padded(len(place))
        for j in range(_inside(place, width)):
            source, column = updates[tree.update[c] + j * across :], columns[place[j] * line :]
            for i in range(np.uint64(j), np.uint64(deep)):
                column[np.uint64(place[i])] += source[i]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _extend(s: int, tree: Supernodes, update: FloatArray, updates: FloatArray) -> None:
    """Add to the lower triangle of the update matrix of a front what its children leave to it."""
    width = tree.width[s]
    own = padded(tree.rows[s] - width)
    for k in range(tree.child[s], tree.child[s + 1]):
        c = tree.children[k]
        place = tree.place[tree.at[c] : tree.at[c + 1]]
        deep, across = len(place), padded(len(place))
        for j in range(_inside(place, width), deep):
            source, column = updates[tree.update[c] + j * across :], update[(place[j] - width) * own :]
            for i in range(np.uint64(j), np.uint64(deep)):
                column[np.uint64(place[i] - width)] += source[i]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _inside(place: IntArray, width: int) -> int:
    """Return how many of the rows of a child are columns of its parent."""
    inside = 0
    while inside < len(place) and place[inside] < width:
        inside += 1
    return inside


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _eliminate(columns: FloatArray, width: int, rows: int) -> int:
    """Factorise the columns of a front, and return one more than the one that is not positive, or 0."""
    line = rows + SPARE
    for first in range(0, width, COLUMNS):
        last = min(first + COLUMNS, width)
        if first > 0:
            subtract_products(columns, columns, first, rows, first, first, line, first, line, False)
        if last - first == COLUMNS:
            failed = _eliminate_tile(columns[first * line :], first, rows, line)
        else:
            failed = _eliminate_rest(columns, first, last, rows)
        if failed > 0:
            return failed
    return 0


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _eliminate_tile(columns: FloatArray, j: int, rows: int, line: int) -> int:
    """Factorise four columns in one pass over their rows, less the products with those before; j: row of the first pivot."""
    a0, a1, a2, a3 = columns, columns[line:], columns[2 * line :], columns[3 * line :]
    # A number that is none fails here as well.
    if not a0[j] > 0.0:
        return j + 1
    d0 = 1.0 / np.sqrt(a0[j])
    l10, l20, l30 = a0[j + 1] * d0, a0[j + 2] * d0, a0[j + 3] * d0
    pivot = a1[j + 1] - l10 * l10
    if not pivot > 0.0:
        return j + 2
    d1 = 1.0 / np.sqrt(pivot)
    l21, l31 = (a1[j + 2] - l10 * l20) * d1, (a1[j + 3] - l10 * l30) * d1
    pivot = a2[j + 2] - l20 * l20 - l21 * l21
    if not pivot > 0.0:
        return j + 3
    d2 = 1.0 / np.sqrt(pivot)
    l32 = (a2[j + 3] - l20 * l30 - l21 * l31) * d2
    pivot = a3[j + 3] - l30 * l30 - l31 * l31 - l32 * l32
    if not pivot > 0.0:
        return j + 4
    d3 = 1.0 / np.sqrt(pivot)
    for i in range(np.uint64(j), np.uint64(rows)):
        x0 = a0[i] * d0
        x1 = (a1[i] - x0 * l10) * d1
        x2 = (a2[i] - x0 * l20 - x1 * l21) * d2
        a3[i] = (a3[i] - x0 * l30 - x1 * l31 - x2 * l32) * d3
        a0[i], a1[i], a2[i] = x0, x1, x2
    return 0


@numba.njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def _eliminate_rest(columns: FloatArray, first: int, last: int, rows: int) -> int:
    """Do the same with the last columns of a front, fewer than a tile has."""
    line = rows + SPARE
    for j in range(first, last):
        column = columns[j * line : j * line + rows]
        for k in range(first, j):
            other = columns[k * line : k * line + rows]
            factor = other[j]
            for i in range(np.uint64(j), np.uint64(rows)):
                column[i] -= factor * other[i]
        if not column[j] > 0.0:
            return j + 1
        column[j] = np.sqrt(column[j])
        inverse = 1.0 / column[j]
        for i in range(np.uint64(j + 1), np.uint64(rows)):
            column[i] *= inverse
    return 0


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


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _solve_alone(
    parts: IntArray, tree: Supernodes, panels: FloatArray, x: FloatArray, beyond: FloatArray, carried: FloatArray
) -> None:
    """Solve L L^T y = x with one thread: in a single call, which takes a tenth of the time of a small solve."""
    _forward_parts(parts, tree, panels, x, beyond, carried)
    _forward_top(tree, panels, x, carried)
    _backward(tree.top, tree, panels, x)
    _backward_parts(parts, tree, panels, x)
