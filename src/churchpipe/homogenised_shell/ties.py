"""Ties in the limit analysis of a shell: the tensions with the largest load factor, by cutting planes.

A tension is a dead load on the facets under the anchors. The load factor alpha(T) that a shell carries with given tensions T is
concave, and the mechanism found at T_k bounds it everywhere by virtual work:

    alpha(T) <= alpha_k + e_k . (T - T_k) / W,

e_k the rates at which that mechanism lengthens the ties, W the weight. The largest value that all these planes allow within
0 <= T <= T_max is an upper bound of the load factor with ties, the largest alpha_k a lower one. Ties that a mechanism lengthens
yield: with all of them at T_max one analysis is often enough.

The next tensions are not those of the upper bound, which lie at a corner of the planes and leap from one analysis to the next,
but the nearest to the best ones for which the planes promise a share of what may still be gained (the level method: Lemarechal,
Nemirovskii and Nesterov, New variants of bundle methods, Mathematical Programming 69, 1995).

A shell may stand neither without its ties nor with their whole strength, which pulls its walls down. A mechanism under which it
falls with T_k, at a share g_k < 1 of its dead load and of T_k, tells which tensions cannot hold it:

    e_k . (T - T_k) / W >= 1 - g_k.

The next tensions are those in the middle of what all such mechanisms leave. Where they leave nothing, no tensions hold the shell.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import clarabel
import numpy as np
import scipy.sparse as sp
from scipy.optimize import linprog

from churchpipe.homogenised_shell.loads import nodal_forces
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.loading.facets import bodies_of
from churchpipe.loading.wrenches import wrenches_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase, replaced
from churchpipe.model.results import ShellLimitState
from churchpipe.model.shell import ShellModel
from churchpipe.model.ties import Tie

# Analyses at most; bounds that have not met by then are reported as they are. Where several ties stay below their strengths the
# largest load factor may be as flat as each analysis is sharp: after so many the bounds need not meet to all digits.
MOST_ANALYSES = 60
ALL_DIGITS = 30
# Share of the gap between the bounds that the next analysis aims at.
_LEVEL = 0.7
# Tensions left to choose from that differ by less than this share of the strengths are none.
_SMALLEST = 1e-6


@dataclass(frozen=True, slots=True)
class _Cut:
    """An analysis with given tensions (nt,), N: its state, what each newton more of each tie would add (nt,), 1/N, and the share
    of the dead load under which it falls at most, NaN where it stands."""

    tension: FloatArray
    state: ShellLimitState
    rate: FloatArray
    share: float


def unit_tension(shell: ShellModel, tie: Tie) -> FloatArray:
    """Return the wrenches (nt + nm, 6) on facets and beams, about their centroids, of a tension of one newton."""
    point, force, wall = [tie.start[None], tie.end[None]], [tie.axis[None], -tie.axis[None]], [np.array([""]), np.array([""])]
    if tie.anchors is not None:
        point, wall = [anchor.point for anchor in tie.anchors], [anchor.wall for anchor in tie.anchors]
        force = [sign * anchor.share[:, None] * tie.axis for anchor, sign in zip(tie.anchors, (1, -1), strict=True)]
    places = np.concatenate(point)
    return wrenches_of(shell.body_centroid, places, np.concatenate(force), bodies_of(shell, places, np.concatenate(wall)))


def tied_analysis(
    shell: ShellModel, load: LoadCase, ties: Sequence[Tie], analysed: Callable[[LoadCase, bool], tuple[ShellLimitState, float]]
) -> ShellLimitState:
    """Return the limit state of a shell with ties; analysed: the analysis of a load case without them, by whether to look first
    if the dead load stands: the state, and the largest share of the dead load where that does not stand.

    Status "not-converged": the bounds, which the state has, did not meet.
    """
    pull = np.array([unit_tension(shell, tie) for tie in ties])
    nodes = np.array([nodal_forces(shell, wrench[: len(shell.triangles)]) for wrench in pull])
    beams = pull[:, len(shell.triangles) :]
    most = np.array([tie.strength for tie in ties])
    weight = float(shell.body_weight.sum())
    dead = np.zeros(pull.shape[1:]) if load.dead is None else load.dead
    cuts: list[_Cut] = []

    def at(tension: FloatArray) -> _Cut:
        case = replaced(load, dead=dead + np.einsum("t,tfc->fc", tension, pull))
        # Once a structure stands with its ties, a load factor is enough; what has none is looked at again from its dead load on.
        state, share = analysed(case, not cuts)
        if cuts and state.status != "optimal":
            state, share = analysed(case, True)
        shortening = np.einsum("tnc,nc->t", nodes, state.velocities) + np.einsum("tmc,mc->t", beams, state.beam_velocities)
        return _Cut(tension, state, -shortening / weight, share)

    first = _standing(at, most)
    if first.state.status != "optimal":
        return replace(first.state, tie_forces=first.tension, tie_sensitivity=np.full(len(ties), np.nan))
    cuts.append(first)
    seconds = first.state.seconds
    upper, target, gain = _highest(cuts, most)
    while upper - _best(cuts).state.load_factor > _enough(cuts, upper) and len(cuts) < MOST_ANALYSES:
        tried = at(target)
        seconds += tried.state.seconds
        while tried.state.status == "unstable" and np.abs(target - _best(cuts).tension).max() > 1e-9 * most.max():
            target = 0.5 * (target + _best(cuts).tension)
            tried = at(target)
        if tried.state.status != "optimal":
            break
        cuts.append(tried)
        upper, target, gain = _highest(cuts, most)
    best = _best(cuts)
    gap = upper - best.state.load_factor
    met = gap <= _enough(cuts, upper)
    if not met:
        message = f"tensions of the ties not found in {len(cuts)} analyses; {best.state.message}"
    elif gap > _tolerance(upper):
        message = f"bounds {best.state.load_factor:.8g} and {upper:.8g}"
    else:
        message = ""
    return replace(
        best.state,
        status="optimal" if met else "not-converged",
        upper_bound=max(upper, best.state.load_factor),
        tie_forces=best.tension,
        tie_sensitivity=gain,
        seconds=seconds,
        message=message,
    )


def _standing(at: Callable[[FloatArray], _Cut], most: FloatArray) -> _Cut:
    """Return an analysis with tensions under which the dead load stands; where it falls with all, the one without tensions."""
    first = at(most)
    if first.state.status not in ("unstable", "failed"):
        return first
    # Ties that are too strong may pull the walls down themselves.
    slack = at(np.zeros_like(most))
    falls = [cut for cut in (first, slack) if cut.state.status == "unstable"]
    tried = slack
    while tried.state.status == "unstable":
        if (middle := _middle(falls, most)) is None:
            return slack
        if len(falls) == MOST_ANALYSES:
            message = f"no tensions of the ties with which the dead load stands were found in {len(falls)} analyses"
            return replace(slack, state=replace(slack.state, status="failed", message=message))
        tried = at(middle)
        falls.append(tried)
    return tried


def _middle(falls: Sequence[_Cut], most: FloatArray) -> FloatArray | None:
    """Return the middle of the largest ball of tensions (nt,), over their strengths, that no mechanism tells to fall; None: there
    are none."""
    slopes = np.array([cut.rate * most for cut in falls])
    least = np.array([cut.rate @ cut.tension + 1 - cut.share for cut in falls])
    unit, one = np.identity(len(most)), np.ones((len(most), 1))
    found = linprog(
        np.append(np.zeros(len(most)), -1.0),
        A_ub=np.block([[-slopes, np.linalg.norm(slopes, axis=1)[:, None]], [unit, one], [-unit, one]]),
        b_ub=np.concatenate([-least, np.ones(len(most)), np.zeros(len(most))]),
        bounds=[(0.0, 1.0)] * len(most) + [(0.0, None)],
        method="highs",
    )
    if found.x is None or found.x[-1] < _SMALLEST:
        return None
    return np.asarray(found.x[:-1]) * most


def _best(cuts: Sequence[_Cut]) -> _Cut:
    return max(cuts, key=lambda cut: cut.state.load_factor)


def _enough(cuts: Sequence[_Cut], upper: float) -> float:
    """Return how far apart the bounds may be after so many analyses."""
    return _tolerance(upper, SOLVER.duality_gap if len(cuts) < ALL_DIGITS else SOLVER.last_digits)


def _tolerance(upper: float, share: float = SOLVER.duality_gap) -> float:
    return share * max(abs(upper), SOLVER.least_load_factor)


def _highest(cuts: Sequence[_Cut], most: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Return the largest load factor that all planes allow, the tensions (nt,) to try next, and what each newton more of a tie's
    strength adds to that load factor (nt,), 1/N: nothing where a tension below it serves best, whatever the one mechanism that
    was found there lengthens.
    """
    # Tensions over their strengths, so that all variables are of order one.
    slopes = np.array([cut.rate * most for cut in cuts])
    level = np.array([cut.state.upper_bound - cut.rate @ cut.tension for cut in cuts])
    count = len(most)
    found = linprog(
        np.append(np.zeros(count), -1.0),
        A_ub=np.column_stack([-slopes, np.ones(len(cuts))]),
        b_ub=level,
        bounds=[(0.0, 1.0)] * count + [(None, None)],
        method="highs",
    )
    ends: FloatArray = np.asarray(found.x)
    upper, farthest = float(ends[-1]), ends[:-1]
    # The mechanisms of the planes that meet there, in shares: together they lengthen the ties that limit them.
    share: FloatArray = -np.asarray(found.ineqlin.marginals)
    added = np.maximum(share @ np.array([cut.rate for cut in cuts]), 0.0)
    best = _best(cuts)
    gain = upper - best.state.load_factor
    if gain <= _tolerance(upper):
        return upper, farthest * most, added
    aimed = upper - (1 - _LEVEL) * gain
    place = np.divide(best.tension, most, out=np.zeros(count), where=most > 0)
    near = _nearest(place, slopes / gain, (aimed - level) / gain)
    return upper, (farthest if near is None else near) * most, added


def _nearest(place: FloatArray, slopes: FloatArray, least: FloatArray) -> FloatArray | None:
    """Return the point (nt,) nearest to a place with slopes . point >= least (k,) and all 0 <= point <= 1; None: not found."""
    count = len(place)
    unit = sp.identity(count, format="csc")
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    answer = clarabel.DefaultSolver(
        unit,
        -place,
        sp.vstack([sp.csc_matrix(-slopes), -unit, unit], format="csc"),
        np.concatenate([-least, np.zeros(count), np.ones(count)]),
        [clarabel.NonnegativeConeT(len(least) + 2 * count)],
        settings,
    ).solve()
    return np.clip(answer.x, 0.0, 1.0) if str(answer.status) == "Solved" else None
