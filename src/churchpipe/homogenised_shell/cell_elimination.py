"""What a cell of rigid stones contributes to the stiffness of the shell, and its own unknowns found from those of the shell.

With W the scaling of the cones at the current iterate and G the cones' rows, A A^T = (G^T W^-2 G)^-1 is the compliance of the
corner forces, known in closed form. Let Y = A^T times the transposed coefficients of the sums, its columns those of the stones'
motions first, then those of the six strains. Y = O R with orthonormal columns O gives a triangle

    R = [ R_m  R_me ]      R_e^T R_e: stress for a strain of the joints, the stones free to move.
        [  0   R_e  ]

In an elastic step the strain of the joints, e, is not that of the shell, eps: stones and joints deform by eps - e, and their
stress is E (eps - e). Then D = ((R_e^T R_e)^-1 + E^-1)^-1 is the stress for a strain of the shell.

Why a triangle: along directions that flow R^T R is up to 1e20 times smaller than across them. As a matrix it would lose the small
entries to the rounding of the large ones.
"""

from dataclasses import dataclass

import numba
import numpy as np

from churchpipe.conic.interior_point.coulomb import CoulombCompliance
from churchpipe.conic.threads import bounds_of, in_shares
from churchpipe.homogenised_shell.cell_forces import CellForces
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of


class CellElimination:
    """The own unknowns of all cells, eliminated from the linear system of one iteration: strains e and motions of the stones.

    root (nq, 6, 6): triangle with root^T root = E, none in a limit analysis, where e = eps is no unknown.
    """

    def __init__(self, forces: CellForces, root: FloatArray | None) -> None:
        self._forces = forces
        self.elastic = root is not None
        nq = len(forces.points)
        self._root = np.zeros((0, 6, 6)) if root is None else root
        width = 6 + forces.still
        sizes = np.diff(forces.first)
        counts = (sizes * width**2, 3 * forces.corners * width, sizes * width)
        start, table, columns = (pointer_of(count) for count in counts)
        strain_triangle = np.empty((nq if self.elastic else 0, 6, 6))
        sizes_of = (forces.points, forces.first, forces.corners, forces.still, forces.corner, forces.row)
        self._kinds = (*sizes_of, start, table, columns)
        self._state = (np.empty(int(start[-1])), np.empty(int(columns[-1]), dtype=np.int64), strain_triangle)

    def factor(self, corners: CoulombCompliance) -> FloatArray:
        """Factorise at the compliances of the corners and return D (6, 6, nq)."""
        parts = (corners.normal, corners.lean, corners.along, corners.across, corners.direction)
        out = np.empty((len(self._forces.points), 6, 6))
        in_shares(_factor, self._forces.count, self._kinds, self._forces.table, parts, self._root, self._state, out)
        return out.T

    def reduce(self, strain: FloatArray, still: FloatArray) -> "Reduced":
        """Return what right sides for e (6, nq; empty in a limit analysis) and for the stones (rows,) leave to the shell."""
        pushed, stress = np.empty_like(still), np.empty((6, len(self._forces.points)))
        in_shares(_reduce, self._forces.count, self._kinds, self._state, self._root, strain, still, pushed, stress)
        return Reduced(pushed, strain, stress)

    def recover(self, reduced: "Reduced", strain: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return e (6, nq; empty in a limit analysis) and the motions of the stones (rows,) for strains of the shell (6, nq)."""
        e = np.empty((6, len(self._forces.points) if self.elastic else 0))
        still = np.empty_like(reduced.pushed)
        right = (reduced.strain, reduced.pushed, strain)
        in_shares(_recover, self._forces.count, self._kinds, self._state, self._root, *right, e, still)
        return e, still


@dataclass(frozen=True, slots=True)
class Reduced:
    """A right side after the elimination. stress (6, nq): its part for the shell. pushed, strain: its parts for the cells."""

    pushed: FloatArray
    strain: FloatArray
    stress: FloatArray


_Kinds = tuple[IntArray, IntArray, IntArray, IntArray, IntArray, IntArray, IntArray, IntArray, IntArray]
_Corners = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
_State = tuple[FloatArray, IntArray, FloatArray]


@numba.njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _images(
    corners: _Corners, at: IntArray, closing: FloatArray, rows: FloatArray, size: FloatArray, rank: IntArray, a: FloatArray
) -> None:
    """Write Y^T into a (columns, rows): columns of the stones first, the largest rows first; the rest is work space."""
    normal, lean, along, across, direction = corners
    width = closing.shape[2]
    for c in range(len(at)):
        k = at[c]
        u, v = direction[0, k], direction[1, k]
        n, t, b = np.sqrt(normal[k]), np.sqrt(along[k]), np.sqrt(across[k])
        for s in range(width):
            x, y, z = closing[c, 0, s], closing[c, 1, s], closing[c, 2, s]
            slide = u * y + v * z
            rows[3 * c, s] = n * (x + lean[k] * slide)
            rows[3 * c + 1, s] = t * slide
            rows[3 * c + 2, s] = b * (u * z - v * y)
    for r in range(rows.shape[0]):
        most, place = 0.0, 0
        for s in range(width):
            most = max(most, abs(rows[r, s]))
        # A count of the larger ones takes half as long as moving them: it is a loop of vector instructions.
        for k in range(np.uint64(r)):
            ahead = np.int64(size[k] >= most)
            place += ahead
            rank[k] += 1 - ahead
        size[r], rank[r] = most, place
    for s in range(width):
        column = a[s + width - 6 if s < 6 else s - 6]
        for r in range(rows.shape[0]):
            column[rank[r]] = rows[r, s]


@numba.njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _reflect(a: FloatArray, j: int, stop: int) -> None:
    """Clear column j of a (columns, rows) below its diagonal by a reflection, and carry the columns up to `stop` along.

    Two columns at a time, as slices: loops that the compiler makes vector instructions of.
    """
    mirror = a[j, j:]
    square = 0.0
    for r in range(len(mirror)):
        square += mirror[r] * mirror[r]
    length = -np.sqrt(square) if mirror[0] > 0 else np.sqrt(square)
    square -= length * mirror[0]
    mirror[0] -= length
    scale = 1.0 / square if square > 0 else 0.0
    for i in range(j + 1, stop, 2):
        first, second = a[i, j:], a[min(i + 1, stop - 1), j:]
        along, beside = 0.0, 0.0
        for r in range(len(mirror)):
            along += mirror[r] * first[r]
            beside += mirror[r] * second[r]
        along *= scale
        # An odd column has itself for a neighbour.
        beside *= scale if i + 1 < stop else 0.0
        for r in range(len(mirror)):
            first[r] -= along * mirror[r]
            second[r] -= beside * mirror[r]
    mirror[0] = length


@numba.njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})
def _square(column: FloatArray) -> float:
    square = 0.0
    for r in range(len(column)):
        square += column[r] * column[r]
    return square


@numba.njit(cache=True, error_model="numpy")
def _triangle(a: FloatArray, m: int, order: IntArray, left: FloatArray, known: FloatArray) -> None:
    """Make a triangle of the columns of a, the longest left first, but those of the stones before those of the strains.

    left (columns,): what is left of the square of each, brought down from `known` as long as it keeps its digits.
    """
    width = len(order)
    for i in range(width):
        left[i] = _square(a[i])
        known[i] = left[i]
    for j in range(width):
        best = j
        for i in range(j + 1, m if j < m else width):
            if left[i] > left[best]:
                best = i
        if best != j:
            order[j], order[best] = order[best], order[j]
            left[best], known[best] = left[j], known[j]
            for r in range(a.shape[1]):
                a[j, r], a[best, r] = a[best, r], a[j, r]
        _reflect(a, j, width)
        for i in range(j + 1, width):
            left[i] -= a[i, j] ** 2
            if left[i] <= 1e-3 * known[i]:
                left[i] = _square(a[i, j + 1 :])
                known[i] = left[i]


@numba.njit(cache=True, error_model="numpy")
def _in_series(a: FloatArray, m: int, order: IntArray, root: FloatArray, both: FloatArray) -> None:
    """Triangle of [R_e; root] into the first six columns of `both` (12, 12), and X with X^T X = D into its last corner.

    The columns that follow [R_e; root] are [0; root]: what is left of them below the triangle is X.
    """
    upper, lower = 0, 0
    for place in range(12):
        above = 0.0
        below = 0.0
        if upper < 6:
            for s in range(upper, 6):
                above = max(above, abs(a[m + s, m + upper]))
        if lower < 6:
            for s in range(lower, 6):
                below = max(below, abs(root[lower, s]))
        if lower >= 6 or (upper < 6 and above >= below):
            for s in range(6):
                both[s, place] = a[m + s, m + upper] if s >= upper else 0.0
                both[6 + s, place] = 0.0
            upper += 1
        else:
            for s in range(6):
                both[s, place] = root[lower, order[m + s]]
                both[6 + s, place] = both[s, place]
            lower += 1
    for j in range(6):
        _reflect(both, j, 12)


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _factor(
    share: int,
    shares: int,
    kinds: _Kinds,
    table: FloatArray,
    corners: _Corners,
    root: FloatArray,
    state: _State,
    out: FloatArray,
) -> None:
    points, first, cell_corners, still, corner, _, start, at_table, columns = kinds
    triangle, orders, strain_triangle = state
    both = np.empty((12, 12))
    for g in range(len(first) - 1):
        n, m = first[g + 1] - first[g], still[g]
        width, rows = m + 6, 3 * cell_corners[g]
        closing = table[at_table[g] : at_table[g + 1]].reshape(cell_corners[g], 3, width)
        wide, a = np.empty((rows, width)), np.empty((width, rows))
        left, known = np.empty(width), np.empty(width)
        size, rank = np.empty(rows), np.empty(rows, dtype=np.int64)
        at = np.empty(cell_corners[g], dtype=np.int64)
        begin, end = bounds_of(n, share, shares)
        for j in range(begin, end):
            q = points[first[g] + j]
            order = orders[columns[g] + j * width : columns[g] + (j + 1) * width]
            for s in range(width):
                order[s] = s if s < m else s - m
            for c in range(len(at)):
                at[c] = corner[g] + c * n + j
            _images(corners, at, closing, wide, size, rank, a)
            _triangle(a, m, order, left, known)
            kept = triangle[start[g] + j * width**2 : start[g] + (j + 1) * width**2].reshape(width, width)
            for s in range(width):
                for r in range(s):
                    kept[s, r] = a[s, r]
                kept[s, s] = 1.0 / a[s, s]
            if len(root):
                _in_series(a, m, order, root[q], both)
                for s in range(6):
                    for r in range(s):
                        strain_triangle[q, s, r] = both[s, r]
                    strain_triangle[q, s, s] = 1.0 / both[s, s]
            for s in range(6):
                for t in range(s + 1):
                    value = 0.0
                    if len(root):
                        for r in range(6):
                            value += both[6 + s, 6 + r] * both[6 + t, 6 + r]
                    else:
                        for r in range(t + 1):
                            value += a[m + s, m + r] * a[m + t, m + r]
                    x, y = order[m + s], order[m + t]
                    out[q, x, y], out[q, y, x] = value, value


@numba.njit(cache=True, error_model="numpy", inline="always")
def _forward(triangle: FloatArray, u: FloatArray, size: int) -> None:
    """Solve R^T u = u; triangle_sr = R_rs, with 1 / R_ss on the diagonal."""
    for s in range(size):
        value = u[s]
        for r in range(s):
            value -= triangle[s, r] * u[r]
        u[s] = value * triangle[s, s]


@numba.njit(cache=True, error_model="numpy", inline="always")
def _backward(triangle: FloatArray, u: FloatArray, size: int) -> None:
    """Solve R u = u."""
    for s in range(size - 1, -1, -1):
        value = u[s]
        for r in range(s + 1, size):
            value -= triangle[r, s] * u[r]
        u[s] = value * triangle[s, s]


@numba.njit(cache=True, error_model="numpy", inline="always")
def _elastic(root: FloatArray, v: FloatArray, half: FloatArray) -> None:
    """Replace v by E v."""
    for r in range(6):
        value = 0.0
        for s in range(r, 6):
            value += root[r, s] * v[s]
        half[r] = value
    for s in range(6):
        value = 0.0
        for r in range(s + 1):
            value += root[r, s] * half[r]
        v[s] = value


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _reduce(
    share: int,
    shares: int,
    kinds: _Kinds,
    state: _State,
    root: FloatArray,
    strain: FloatArray,
    still: FloatArray,
    pushed: FloatArray,
    stress: FloatArray,
) -> None:
    """Write u = R_m^-T right, and the stress: E e in a step, with e what the right sides alone would make, else -R_me^T u."""
    points, first, _, stills, _, row, start, _, columns = kinds
    triangle, orders, strain_triangle = state
    e, v, half = np.empty(6), np.empty(6), np.empty(6)
    for g in range(len(first) - 1):
        n, m = first[g + 1] - first[g], stills[g]
        width = m + 6
        u = np.empty(m)
        begin, end = bounds_of(n, share, shares)
        for j in range(begin, end):
            q = points[first[g] + j]
            kept = triangle[start[g] + j * width**2 : start[g] + (j + 1) * width**2].reshape(width, width)
            order = orders[columns[g] + j * width : columns[g] + (j + 1) * width]
            for s in range(m):
                u[s] = still[row[g] + order[s] * n + j]
            _forward(kept, u, m)
            for s in range(m):
                pushed[row[g] + s * n + j] = u[s]
            for s in range(6):
                value = strain[order[m + s], q] if len(root) else 0.0
                for r in range(m):
                    value -= kept[m + s, r] * u[r]
                e[s] = value
            if len(root):
                _forward(strain_triangle[q], e, 6)
                _backward(strain_triangle[q], e, 6)
            for s in range(6):
                v[order[m + s]] = e[s]
            if len(root):
                _elastic(root[q], v, half)
            for s in range(6):
                stress[s, q] = v[s]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _recover(
    share: int,
    shares: int,
    kinds: _Kinds,
    state: _State,
    root: FloatArray,
    right: FloatArray,
    pushed: FloatArray,
    strain: FloatArray,
    out: FloatArray,
    still: FloatArray,
) -> None:
    """Write e, from its own right side and from E eps, and the motions of the stones."""
    points, first, _, stills, _, row, start, _, columns = kinds
    triangle, orders, strain_triangle = state
    e, v, half = np.empty(6), np.empty(6), np.empty(6)
    for g in range(len(first) - 1):
        n, m = first[g + 1] - first[g], stills[g]
        width = m + 6
        u = np.empty(m)
        begin, end = bounds_of(n, share, shares)
        for j in range(begin, end):
            q = points[first[g] + j]
            kept = triangle[start[g] + j * width**2 : start[g] + (j + 1) * width**2].reshape(width, width)
            order = orders[columns[g] + j * width : columns[g] + (j + 1) * width]
            for s in range(m):
                u[s] = pushed[row[g] + s * n + j]
            for s in range(6):
                v[s] = strain[s, q]
            if len(root):
                _elastic(root[q], v, half)
                for s in range(6):
                    value = right[order[m + s], q] + v[order[m + s]]
                    for r in range(m):
                        value -= kept[m + s, r] * u[r]
                    e[s] = value
                _forward(strain_triangle[q], e, 6)
                _backward(strain_triangle[q], e, 6)
                for s in range(6):
                    out[order[m + s], q] = e[s]
            else:
                for s in range(6):
                    e[s] = v[order[m + s]]
            for r in range(m):
                value = u[r]
                for s in range(6):
                    value -= kept[m + s, r] * e[s]
                u[r] = value
            _backward(kept, u, m)
            for s in range(m):
                still[row[g] + order[s] * n + j] = u[s]
