"""Points of a shell with the strength of the exact unit cell, as local problems of the interior-point solver.

The variables are the forces at the twelve corners of a cell. Equilibrium depends on them only through nine sums: the stress and
the moments on a stone. It is therefore assembled from matrices of nine rows, and the elastic energy of a step, Q, has rank six.

Notation: G x are the cone values of the forces x, and W is the scaling of the cones at the current iterate. A A^T is the
compliance (G^T W^-2 G)^-1 of the corners, known in closed form, and V = A^T (root of Q)^T. Then (Q + G^T W^-2 G)^-1 = A (I + V
V^T)^-1 A^T.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np
import scipy.sparse as sp

from churchpipe.conic.interior_point.cones import Scaling
from churchpipe.conic.interior_point.coulomb import CoulombCompliance, CoulombPoints
from churchpipe.conic.interior_point.coupling import Coupling, touches
from churchpipe.model.arrays import FloatArray, IntArray

CORNERS = 12


class CellCoupling(Coupling):
    """Equilibrium and moments in terms of the corner forces x (36, count): a matrix in nine sums of them, and these sums.

    sums (9, 36, count): stress, then the moments on the stones, which are rows of their own after those of equilibrium.
    """

    def __init__(self, equilibrium: sp.csr_matrix[np.float64], sums: FloatArray) -> None:
        """equilibrium (m, 6 count): columns point first."""
        count = sums.shape[2]
        columns = (9 * np.arange(count)[:, None] + np.arange(9)).astype(np.int64)
        wide = sp.csc_matrix(equilibrium) @ _selection(columns[:, :6].ravel(), 9 * count)
        matrix = sp.csc_matrix(sp.vstack([wide, _selection(columns[:, 6:].ravel(), 9 * count)]))
        super().__init__(touches(matrix, 9, 1, by_point=True))
        self._sums = sums

    def couple(self, x: FloatArray) -> FloatArray:
        """Return B x."""
        return super().couple(self._summed(x))

    def spread(self, y: FloatArray) -> FloatArray:
        """Return B^T y."""
        return np.einsum("aiq,aq->iq", self._sums, super().spread(y).reshape(9, -1)).ravel()

    def touched_units(self, unit: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return for each corner the smallest and the largest unit of the equilibrium rows that its cell enters."""
        smallest, largest = super().touched_units(unit)
        return np.tile(smallest, CORNERS), np.tile(largest, CORNERS)

    def passing(self, x: FloatArray) -> FloatArray:
        """Return the largest stress or moment that passes each row."""
        return super().passing(self._summed(x))

    def matrix(self) -> sp.csr_matrix[np.float64]:
        """Return B (m, 36 count), columns component first."""
        return sp.csr_matrix(super().matrix() @ _diagonals(self._sums))

    def _summed(self, x: FloatArray) -> FloatArray:
        return np.einsum("aiq,iq->aq", self._sums, x.reshape(3 * CORNERS, -1)).ravel()


@dataclass(frozen=True, slots=True)
class CellCompliance:
    """Compliances (Q + G^T W^-2 G)^-1 of the corner forces, in the notation of the module.

    matrix (9, 9, count): seen through the nine sums. The rest exists in an elastic step only. A (count, 12, 3, 3). rows (count,
    36): in the order of their size. Six reflections (count, 6, 36): they turn V into a triangle R. T (count, 6, 6): a triangle
    with T^T T = I + R R^T.
    """

    corners: CoulombCompliance
    matrix: FloatArray
    roots: FloatArray
    order: IntArray
    reflections: FloatArray
    triangle: FloatArray

    def apply(self, force: FloatArray) -> FloatArray:
        """Return S force, (3, 12 count)."""
        if not len(self.order):
            return self.corners.apply(force)
        by_cell = np.ascontiguousarray(force.reshape(3 * CORNERS, -1).T)
        _comply(self.roots, self.order, self.reflections, self.triangle, by_cell)
        return np.ascontiguousarray(by_cell.T).reshape(3, -1)


class CellPoints(CoulombPoints):
    """Cells of corners that carry Coulomb friction; with an elastic energy 1/2 |root x|^2 + linear x, if there is one.

    friction (12 count,), corner by corner; sums as of `CellCoupling`; root (6, 36, count): combinations of the first six sums,
    which are the stress; linear and inner (36, count).
    """

    def __init__(
        self, friction: FloatArray, sums: FloatArray, root: FloatArray | None, linear: FloatArray, inner: FloatArray
    ) -> None:
        nothing = np.zeros(len(friction))
        super().__init__(nothing, friction, nothing, nothing)
        self._sums = np.ascontiguousarray(np.moveaxis(sums, 2, 0))
        self._root = np.zeros((0, 6, 3 * CORNERS)) if root is None else np.ascontiguousarray(np.moveaxis(root, 2, 0))
        self._inner = inner
        self.curved = root is not None
        self.linear = linear.reshape(3, -1)

    def quadratic(self, x: FloatArray) -> FloatArray:
        """Return Q x."""
        if not self.curved:
            return np.zeros_like(x)
        strain = np.einsum("qai,iq->qa", self._root, x.reshape(3 * CORNERS, -1))
        return np.einsum("qai,qa->iq", self._root, strain).reshape(3, -1)

    def compliance(self, scalings: Sequence[Scaling]) -> CellCompliance:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Return the compliances, those of the corners in closed form."""
        corners = super().compliance(scalings)
        count, elastic = len(self._sums), len(self._root)
        out = CellCompliance(
            corners,
            np.empty((9, 9, count)),
            np.empty((count, CORNERS, 3, 3)),
            np.empty((elastic, 3 * CORNERS), dtype=np.int64),
            np.empty((elastic, 6, 3 * CORNERS)),
            np.empty((elastic, 6, 6)),
        )
        parts = (corners.normal, corners.lean, corners.along, corners.across, corners.direction)
        _factor(parts, self._sums, self._root, out.roots, out.order, out.reflections, out.triangle, out.matrix)
        return out

    def interior(self, size: FloatArray) -> FloatArray:
        """Return the given interior point in an elastic step, else compression of this size."""
        return self._inner.reshape(3, -1) if self.curved else super().interior(size)


_Corners = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]


@numba.njit(cache=True, error_model="numpy")
def _roots(corners: _Corners, k: int, count: int, out: FloatArray) -> None:
    """Write A (12, 3, 3) with A A^T the compliance of each corner of cell k."""
    normal, lean, along, across, direction = corners
    for c in range(CORNERS):
        at = c * count + k
        u, v = direction[0, at], direction[1, at]
        n, t, b = np.sqrt(normal[at]), np.sqrt(along[at]), np.sqrt(across[at])
        out[c, 0, 0], out[c, 0, 1], out[c, 0, 2] = n, 0.0, 0.0
        out[c, 1, 0], out[c, 1, 1], out[c, 1, 2] = n * lean[at] * u, t * u, -b * v
        out[c, 2, 0], out[c, 2, 1], out[c, 2, 2] = n * lean[at] * v, t * v, b * u


@numba.njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _pull(roots: FloatArray, row: FloatArray, out: FloatArray) -> None:
    """Write A^T row, corner by corner; row (36,) component first."""
    for c in range(CORNERS):
        for b in range(3):
            out[3 * c + b] = roots[c, 0, b] * row[c] + roots[c, 1, b] * row[CORNERS + c] + roots[c, 2, b] * row[2 * CORNERS + c]


@numba.njit(cache=True, error_model="numpy")
def _reflect(a: FloatArray, j: int, vectors: FloatArray) -> None:
    """Clear column j of a (rows, columns) below its diagonal by a reflection I - v v^T of the rows from j on; v: vectors[j]."""
    rows, columns = a.shape
    square = 0.0
    for r in range(j, rows):
        square += a[r, j] * a[r, j]
    length = -np.sqrt(square) if a[j, j] > 0 else np.sqrt(square)
    for r in range(rows):
        vectors[j, r] = a[r, j] if r >= j else 0.0
    vectors[j, j] -= length
    square = 0.0
    for r in range(j, rows):
        square += vectors[j, r] * vectors[j, r]
    scale = np.sqrt(2.0 / square) if square > 0 else 0.0
    for r in range(j, rows):
        vectors[j, r] *= scale
    for i in range(j + 1, columns):
        along = 0.0
        for r in range(j, rows):
            along += vectors[j, r] * a[r, i]
        for r in range(j, rows):
            a[r, i] -= along * vectors[j, r]
    a[j, j] = length
    for r in range(j + 1, rows):
        a[r, j] = 0.0


@numba.njit(cache=True, error_model="numpy")
def _reflect_longest_first(a: FloatArray, vectors: FloatArray) -> None:
    """Make a triangle of a (rows, columns), the longest column left first."""
    rows, columns = a.shape
    for j in range(columns):
        best, longest = j, -1.0
        for i in range(j, columns):
            square = 0.0
            for r in range(j, rows):
                square += a[r, i] * a[r, i]
            if square > longest:
                best, longest = i, square
        if best != j:
            for r in range(rows):
                a[r, j], a[r, best] = a[r, best], a[r, j]
        _reflect(a, j, vectors)


@numba.njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _turn(vectors: FloatArray, j: int, row: FloatArray) -> None:
    """Apply reflection j to a row."""
    along = 0.0
    for r in range(j, len(row)):
        along += vectors[j, r] * row[r]
    for r in range(j, len(row)):
        row[r] -= along * vectors[j, r]


@numba.njit(cache=True, error_model="numpy")
def _divide(triangle: FloatArray, row: FloatArray) -> None:
    """Replace the first six of a row by themselves times T^-1, that is, solve T^T u = row."""
    for i in range(6):
        value = row[i]
        for m in range(i):
            value -= triangle[m, i] * row[m]
        row[i] = value / triangle[i, i]


@numba.njit(cache=True, error_model="numpy")
def _factor(
    corners: _Corners,
    sums: FloatArray,
    root: FloatArray,
    roots: FloatArray,
    order: IntArray,
    reflections: FloatArray,
    triangle: FloatArray,
    matrix: FloatArray,
) -> None:
    count, size = sums.shape[0], 3 * CORNERS
    images, line = np.empty((9, size)), np.empty(size)
    bent, large = np.empty((size, 6)), np.empty(size)
    small, turns = np.empty((12, 6)), np.empty((6, 12))
    for k in range(count):
        _roots(corners, k, count, roots[k])
        for s in range(9):
            _pull(roots[k], sums[k, s], images[s])
        if len(root):
            # Large rows come first. Small rows then keep their digits beside them.
            for a in range(6):
                _pull(roots[k], root[k, a], line)
                for r in range(size):
                    bent[r, a] = line[r]
            for r in range(size):
                most = 0.0
                for a in range(6):
                    most = max(most, abs(bent[r, a]))
                place = r
                while place > 0 and large[place - 1] < most:
                    large[place], order[k, place] = large[place - 1], order[k, place - 1]
                    place -= 1
                large[place], order[k, place] = most, r
            for a in range(6):
                for r in range(size):
                    line[r] = bent[r, a]
                for r in range(size):
                    bent[r, a] = line[order[k, r]]
            _reflect_longest_first(bent, reflections[k])
            for i in range(6):
                for j in range(6):
                    small[i, j] = bent[j, i]
                    small[6 + i, j] = 1.0 if i == j else 0.0
            for j in range(6):
                _reflect(small, j, turns)
            for i in range(6):
                for j in range(6):
                    triangle[k, i, j] = small[i, j]
            for s in range(9):
                for r in range(size):
                    line[r] = images[s, order[k, r]]
                for j in range(6):
                    _turn(reflections[k], j, line)
                _divide(triangle[k], line)
                for r in range(size):
                    # Stress is a combination of the rows of V: the other reflected entries vanish but for rounding.
                    images[s, r] = line[r] if s >= 6 or r < 6 else 0.0
        for s in range(9):
            for t in range(s + 1):
                value = 0.0
                for r in range(size):
                    value += images[s, r] * images[t, r]
                matrix[s, t, k] = value
                matrix[t, s, k] = value


@numba.njit(cache=True, error_model="numpy")
def _comply(roots: FloatArray, order: IntArray, reflections: FloatArray, triangle: FloatArray, force: FloatArray) -> None:
    """Replace the force (count, 36) by the compliance S times the force."""
    size = force.shape[1]
    row, line = np.empty(size), np.empty(size)
    for k in range(len(force)):
        _pull(roots[k], force[k], line)
        for r in range(size):
            row[r] = line[order[k, r]]
        for j in range(6):
            _turn(reflections[k], j, row)
        _divide(triangle[k], row)
        for i in range(5, -1, -1):
            value = row[i]
            for m in range(i + 1, 6):
                value -= triangle[k, i, m] * row[m]
            row[i] = value / triangle[k, i, i]
        for j in range(5, -1, -1):
            _turn(reflections[k], j, row)
        for r in range(size):
            line[order[k, r]] = row[r]
        for c in range(CORNERS):
            for i in range(3):
                value = 0.0
                for b in range(3):
                    value += roots[k, c, i, b] * line[3 * c + b]
                force[k, i * CORNERS + c] = value


def _selection(columns: IntArray, width: int) -> sp.csr_matrix[np.float64]:
    """Return a matrix whose row i picks columns[i]."""
    rows = len(columns)
    return sp.csr_matrix((np.ones(rows), (np.arange(rows), columns)), shape=(rows, width))


def _diagonals(values: FloatArray) -> sp.csr_matrix[np.float64]:
    """Return values_aiq (a, i, q) as a matrix, rows and columns component first."""
    a, i, q = (index.ravel() for index in np.indices(values.shape))
    count = values.shape[2]
    shape = (values.shape[0] * count, values.shape[1] * count)
    return sp.csr_matrix((values.ravel(), (a * count + q, i * count + q)), shape=shape)
