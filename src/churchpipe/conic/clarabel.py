"""Clarabel as a solver of cone programs, in their kinematic (dual) form: velocities as unknowns, forces as multipliers."""

from time import perf_counter

import clarabel
import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram, ConeSolution, Outcome
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray

_OUTCOMES: dict[str, Outcome] = {
    "Solved": "solved",
    "AlmostSolved": "solved",
    "PrimalInfeasible": "unbounded",
    "DualInfeasible": "infeasible",
}


def solve_clarabel(
    program: ConeProgram, duality_gap: float = 1e-9, settings: clarabel.DefaultSettings | None = None
) -> ConeSolution:
    """Solve a cone program with Clarabel, aiming at `duality_gap`; a hundred times that is still accepted, no more.

    settings: Clarabel's own, instead of ours and of `duality_gap`.

    minimise  -constant . y + sum (limit r + p^2 / (2 quadratic) + bound q) + cap k
    over y, r >= |v_t|, p, q >= 0, k >= 0  s.t.  growth . y + k = 1,   v_n + linear - slope r + p + q >= 0,   v = balance^T y

    The velocity q, at which a point yields under its bound on n, exists where that is finite. With a negative slope r may
    exceed |v_t|: it then stands for the penetration that its cap on n allows. Points with a plain Coulomb cone (no limit, no
    quadratic cost, no bound) need no r: v_n + linear >= slope |v_t| is one cone. No redundant constraint is added: it would
    move the analytic centre of the optimal forces, on which iterations build.
    """
    begin = perf_counter()
    layout = _Layout(program)
    # The unit of force is the largest single load. Relative to the total weight, errors that matter would look like zero.
    scale = 1.0 / program.force
    solver = clarabel.DefaultSolver(
        layout.quadratic * scale,
        layout.cost * scale,
        layout.matrix,
        layout.right,
        layout.cones,
        settings or _settings(duality_gap),
    )
    answer = solver.solve()
    status = str(answer.status)
    x, tau = layout.forces(np.asarray(answer.z))
    return ConeSolution(
        x=x / scale,
        tau=tau / scale,
        y=np.asarray(answer.x)[: layout.rows],
        outcome=_OUTCOMES.get(status, "failed"),
        iterations=int(answer.iterations),
        seconds=perf_counter() - begin,
        solver="clarabel",
        message=status,
    )


def _settings(duality_gap: float) -> clarabel.DefaultSettings:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = duality_gap
    settings.reduced_tol_gap_abs = settings.reduced_tol_gap_rel = settings.reduced_tol_feas = 100 * duality_gap
    settings.max_iter = 300
    # The program is well scaled already. Scaling it again loses the last digits of thin arches.
    settings.equilibrate_enable = False
    return settings


class _Layout:
    """Columns y | r | p | q | k and the rows of the kinematic form, for one program."""

    def __init__(self, program: ConeProgram) -> None:
        self.rows = program.balance.shape[0]
        damped = program.quadratic > 0
        bounded = np.isfinite(program.bound)
        general = (program.limit > 0) | (program.slope < 0) | damped | (bounded & (program.slope > 0))
        smooth = ~general & (program.slope == 0)
        self.plain = np.flatnonzero(~general & ~smooth)
        self.smooth = np.flatnonzero(smooth)
        self.general = np.flatnonzero(general)
        capped = np.isfinite(program.cap)
        r = _columns(self.rows, general)
        p = _columns(self.rows + general.sum(), damped)
        q = _columns(self.rows + general.sum() + damped.sum(), bounded)
        width = int(self.rows + general.sum() + damped.sum() + bounded.sum() + capped)
        rate = sp.csr_matrix(program.matrix().T)
        self._slope = program.slope

        growth = sp.csr_matrix(program.growth[None, :])
        balance_row = [growth, sp.csr_matrix((1, width - self.rows - capped)), sp.csr_matrix(np.ones((1, 1)))]
        equality = sp.hstack(balance_row if capped else balance_row[:2], format="csr")
        signs = [_at(np.array([width - 1]), width)] if capped else []
        signs += [_at(q[bounded], width)] if bounded.any() else []
        smooth_rows = _pad(rate[3 * self.smooth], width) + _at(q[smooth], width, bounded[smooth])
        normal_rows = _pad(rate[3 * self.general], width) - sp.diags(program.slope[general]) @ _at(r[general], width)
        normal_rows = normal_rows + _at(p[general], width, damped[general]) + _at(q[general], width, bounded[general])
        plain_rows = sp.diags(np.repeat(program.slope[self.plain], 3) ** np.tile([0, 1, 1], len(self.plain))) @ _pad(
            rate[_triples(self.plain)], width
        )
        # Rows r, v_t1, v_t2 of each general point.
        tangent_rows = sp.diags(np.tile([0.0, 1.0, 1.0], len(self.general))) @ _pad(rate[_triples(self.general)], width)
        tangent_rows = tangent_rows + sp.kron(_at(r[general], width), sp.csr_matrix([[1.0], [0.0], [0.0]]))
        zeros = np.zeros
        self.matrix = sp.csc_matrix(
            sp.vstack([equality, *(-m for m in (*signs, smooth_rows, normal_rows, plain_rows, tangent_rows))])
        )
        self.right = np.concatenate(
            [
                [1.0],
                zeros(int(capped) + int(bounded.sum())),
                program.linear[self.smooth],
                program.linear[self.general],
                np.kron(program.linear[self.plain], [1.0, 0.0, 0.0]),
                zeros(3 * len(self.general)),
            ]
        )
        nonnegative = int(capped) + int(bounded.sum()) + len(self.smooth) + len(self.general)
        self.cones: list[clarabel.Cone] = [clarabel.ZeroConeT(1)]
        if nonnegative:
            self.cones.append(clarabel.NonnegativeConeT(nonnegative))
        self.cones += [clarabel.SecondOrderConeT(3) for _ in range(len(self.plain) + len(self.general))]
        self._first_normal = 1 + int(capped) + int(bounded.sum())
        self.cost = zeros(width)
        self.cost[: self.rows] = -program.constant
        self.cost[r[general]] = program.limit[general]
        self.cost[q[bounded]] = program.bound[bounded]
        if capped:
            self.cost[-1] = program.cap
        diagonal = zeros(width)
        diagonal[p[damped]] = 1.0 / program.quadratic[damped]
        self.quadratic = sp.csc_matrix(sp.diags(diagonal))
        self.quadratic.eliminate_zeros()

    def forces(self, z: FloatArray) -> tuple[FloatArray, float]:
        """Return the forces x (c, 3) and tau from the multipliers of all rows."""
        x = np.zeros((len(self._slope), 3))
        start = self._first_normal
        x[self.smooth, 0] = z[start : start + len(self.smooth)]
        start += len(self.smooth)
        x[self.general, 0] = z[start : start + len(self.general)]
        start += len(self.general)
        plain = z[start : start + 3 * len(self.plain)].reshape(-1, 3)
        x[self.plain] = plain * np.stack([np.ones(len(self.plain)), *[self._slope[self.plain]] * 2], axis=1)
        start += 3 * len(self.plain)
        x[self.general, 1:] = z[start:].reshape(-1, 3)[:, 1:]
        return x, -float(z[0])


def _columns(start: int, chosen: BoolArray) -> IntArray:
    """Number the chosen points from `start` on; the rest get -1."""
    out = np.full(len(chosen), -1, dtype=np.int64)
    out[chosen] = start + np.arange(int(chosen.sum()))
    return out


def _triples(points: IntArray) -> IntArray:
    return (3 * points[:, None] + np.arange(3)).ravel()


def _pad(matrix: sp.csr_matrix, width: int) -> sp.csr_matrix:
    rows, columns = matrix.shape
    return sp.csr_matrix((matrix.data, matrix.indices, matrix.indptr), shape=(rows, width)) if columns <= width else matrix


def _at(columns: IntArray, width: int, chosen: BoolArray | None = None) -> sp.csr_matrix:
    """One row for each column number, with a one there (only where chosen)."""
    row = np.arange(len(columns)) if chosen is None else np.flatnonzero(chosen)
    return sp.csr_matrix((np.ones(len(row)), (row, columns[row])), shape=(len(columns), width))
