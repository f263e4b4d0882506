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
        capped = bool(np.isfinite(program.cap))
        count = int(general.sum())
        r = _columns(self.rows, general)
        p = _columns(self.rows + count, damped)
        q = _columns(self.rows + count + damped.sum(), bounded)
        width = int(self.rows + count + damped.sum() + bounded.sum() + capped)
        self._slope = program.slope
        # First row of each kind: growth . y + k = 1, k and q >= 0, smooth points, normal rates, plain points, r and v_t.
        signs = int(capped) + int(bounded.sum())
        kinds = [1, signs, len(self.smooth), count, 3 * len(self.plain), 3 * count]
        _, _, smooth_row, normal_row, plain_row, tangent_row, height = (int(end) for end in np.cumsum([0, *kinds]))
        smooth_rows, normal_rows = _columns(smooth_row, smooth), _columns(normal_row, general)

        rate = sp.coo_matrix(program.matrix())
        point, component = rate.col // 3, rate.col % 3
        normal, plain = component == 0, _columns(0, ~general & ~smooth)[point]
        # Of a plain point the tangential rates count as much as its slope says.
        weight = np.where(normal, 1.0, program.slope[point])
        tangent = tangent_row + 3 * _columns(0, general)[point] + component
        entries = [
            (np.zeros(self.rows, dtype=np.int64), np.arange(self.rows, dtype=np.int64), program.growth),
            _rates(rate, np.where(normal, smooth_rows[point], -1)),
            _rates(rate, np.where(normal, normal_rows[point], -1)),
            _rates(rate, np.where(plain >= 0, plain_row + 3 * plain + component, -1), weight),
            _rates(rate, np.where(general[point] & ~normal, tangent, -1)),
            _ones(1 + int(capped) + np.arange(signs - capped), q[bounded]),
            _ones(smooth_rows[smooth & bounded], q[smooth & bounded]),
            _ones(normal_rows[general & damped], p[general & damped]),
            _ones(normal_rows[general & bounded], q[general & bounded]),
            (normal_rows[general], r[general], program.slope[general]),
            _ones(tangent_row + 3 * np.arange(count), r[general]),
        ]
        if capped:
            last = np.array([width - 1])
            entries += [(0 * last, last, np.ones(1)), _ones(0 * last + 1, last)]
        place, column, value = (np.concatenate(part) for part in zip(*entries, strict=True))
        kept = value != 0
        self.matrix = sp.csc_matrix((value[kept], (place[kept], column[kept])), shape=(height, width))
        zeros = np.zeros
        self.right = np.concatenate(
            [
                [1.0],
                zeros(signs),
                program.linear[self.smooth],
                program.linear[self.general],
                np.kron(program.linear[self.plain], [1.0, 0.0, 0.0]),
                zeros(3 * count),
            ]
        )
        nonnegative = signs + len(self.smooth) + count
        self.cones: list[clarabel.Cone] = [clarabel.ZeroConeT(1)]
        if nonnegative:
            self.cones.append(clarabel.NonnegativeConeT(nonnegative))
        self.cones += [clarabel.SecondOrderConeT(3) for _ in range(len(self.plain) + count)]
        self._first_normal = 1 + signs
        self.cost = zeros(width)
        self.cost[: self.rows] = -program.constant
        self.cost[r[general]] = program.limit[general]
        self.cost[q[bounded]] = program.bound[bounded]
        if capped:
            self.cost[-1] = program.cap
        found = p[damped]
        self.quadratic = sp.csc_matrix((1.0 / program.quadratic[damped], (found, found)), shape=(width, width))

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


def _rates(rate: sp.coo_matrix, place: IntArray, weight: FloatArray | float = 1.0) -> tuple[IntArray, IntArray, FloatArray]:
    """Return rows, columns and values of minus these rates of points, in these rows; row -1: left out.

    rate: of the balance matrix, whose columns are the components of the points.
    """
    chosen = place >= 0
    return place[chosen], rate.row[chosen].astype(np.int64), (-rate.data * weight)[chosen]


def _ones(place: IntArray, column: IntArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Return rows, columns and values of what is added to rates, or must not be negative by itself."""
    return place, column, np.full(len(column), -1.0)
