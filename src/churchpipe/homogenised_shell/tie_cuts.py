"""Tensions of the ties in a step of a capacity curve where they are no part of its program: by cutting planes.

The least energy phi(T) of a step under given tensions T is convex, and its slope is by how much the motion shortens the ties.
Yielding only makes a shell softer, so that phi curves at least as much as that of a shell that does not yield, whose flexibility
is A. With phi_k and its slope g_k of an analysis under T_k, everywhere

    phi(T) >= phi_k + g_k . (T - T_k) + 1/2 (T - T_k) . A (T - T_k).

The next tensions are those of least energy, of the ties and of the largest of these parabolas together. A shell that does not
yield has them after one analysis; the others after some more, however stiff the ties are.
"""

from collections.abc import Callable
from dataclasses import replace

import clarabel
import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.condensed import StressState
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.homogenised_shell.step_ties import StepTies
from churchpipe.model.arrays import FloatArray

# Tensions below this share of the weight need not be found to as many digits as larger ones: they hardly change the load factor.
_SMALL = 0.01

Solved = Callable[[FloatArray], tuple[StressState, FloatArray, float]]


def tensions_by_cuts(ties: StepTies, flexibility: FloatArray, solved: Solved) -> tuple[StressState, FloatArray]:
    """Return the state of a step and the tensions (nt,) that fit it, in the units of `StepTies`.

    flexibility: A (nt, nt). solved: state, motion (m,) and energy phi of the step with these tensions. A state that does not hold
    is returned as it is; one whose tensions were not found is "failed".
    """
    tension = ties.before
    # Of phi - 1/2 T A T, planes: their slopes (nt,) and their values where all ties are slack.
    slopes: list[FloatArray] = []
    values: list[float] = []
    for _ in range(SOLVER.tie_rounds):
        state, motion, energy = solved(tension)
        if not state.holds:
            return state, tension
        shortened = ties.pull @ motion
        # To where the slope points, by the least curvature that there is: no nearer than the tensions that fit.
        away = (ties.compliance * tension - ties.length + shortened) / (ties.compliance + np.diag(flexibility))
        apart = np.abs(tension - np.clip(tension - away, 0.0, ties.most)).max()
        if apart <= SOLVER.tie_tension * max(tension.max(), _SMALL):
            return state, tension
        slopes.append(shortened - flexibility @ tension)
        values.append(energy - float(tension @ (shortened - 0.5 * flexibility @ tension)))
        following = _least(ties, flexibility, np.array(slopes), np.array(values), max(tension.max(), np.abs(away).max()))
        if following is None:
            break
        tension = following
    return replace(solved(tension)[0], status="failed", message="the tensions of the ties were not found"), tension


def _least(ties: StepTies, flexibility: FloatArray, slopes: FloatArray, values: FloatArray, unit: float) -> FloatArray | None:
    """Return the tensions (nt,) of least energy, by their own and the largest of the planes; None: not found.

    unit: a tension of the order of these.
    """
    count = len(ties.most)
    curved = flexibility + np.diag(ties.compliance)
    # The solver's tolerances are absolute: tensions are counted in their unit, and energies in that which it has.
    size = unit * float(np.diag(curved).max())
    one = sp.identity(count)
    bounds = sp.hstack([sp.vstack([-one, one]), sp.csc_matrix((2 * count, 1))])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    answer = clarabel.DefaultSolver(
        sp.csc_matrix(np.triu(np.pad(unit / size * curved, (0, 1)))),
        np.append(-ties.length / size, 1.0),
        sp.vstack([sp.csc_matrix(np.column_stack([slopes / size, -np.ones(len(slopes))])), bounds], format="csc"),
        np.concatenate([(values.max() - values) / (size * unit), np.zeros(count), ties.most / unit]),
        [clarabel.NonnegativeConeT(len(slopes) + 2 * count)],
        settings,
    ).solve()
    return np.clip(unit * np.asarray(answer.x[:-1]), 0.0, ties.most) if str(answer.status) == "Solved" else None
