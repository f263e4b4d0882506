"""The interior-point loop: iterates of forces and multipliers inside their cones, whose products fall together to zero.

Each step is a Newton step of the homogeneous embedding, in which an infeasible or unbounded program has a solution too, its
certificate (Andersen, Roos and Terlaky 2003). A predictor aims at products of zero; its length says how much of the products the
corrector keeps, the centring (Mehrotra 1992), in coordinates that the Nesterov-Todd scaling chooses for each cone. Centrality
correctors, which use the same factorisation, then lengthen the step (Gondzio 1996).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.conic.interior_point.info import Info, Progress, Status
from churchpipe.conic.interior_point.iterate import Iterate, inner
from churchpipe.conic.interior_point.kkt import KktSystem
from churchpipe.conic.interior_point.newton import NewtonSystem, centrality_target
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.problem import CoupledProblem, largest
from churchpipe.conic.interior_point.residuals import Residuals, residuals
from churchpipe.conic.interior_point.settings import CLOSE, Settings

# Centrality correctors aim at a step this much longer, and count when they win this share of it (Gondzio 1996).
_REACH = 0.5
_WIN = 0.01
# More centring than this only makes a solve longer, because the correctors keep the complementarity products together.
_MOST_CENTRING = 0.03
# Correctors aim at this share of the mean product at the least.
_TARGET = 0.3
# A corrector is added with the weight that reaches farthest (Colombo and Gondzio 2008).
_WEIGHTS = np.array([1.0, 0.7, 0.4])
# A few cones of many would end a step long before the others. They are ignored when directions are judged, unless the last step
# was shorter than this and the forces are to balance.
_BLOCKED = 0.1
# A solution is balanced in so many sweeps, to this residual, and may leave its cones by this share of the largest slack.
_SWEEPS = 8
_BALANCED = 1e-9
_OUTSIDE = 1e-13
# Where that fails, several mechanisms compete for one load: the loop goes on to this share of the residual tolerance.
_COMPETING = 1e-3
# Three steps in succession that are shorter end the loop, and so do `_PATIENCE` iterations in which neither the error nor the
# residual has fallen below this share of the least one before: where joints bear next to nothing one may wait for the other.
_STALLED_STEP = 1e-3
# So many of the first steps may be that short: a sliver of a mesh starts far from all other facets.
_FIRST_STEPS = 8
_PATIENCE = 12
_FALLEN = 0.9
_VANISHED = 1e-8
_ROUGH = 1e-4


@dataclass(frozen=True, slots=True)
class Ending:
    """How a loop ended: the best iterate, its status and errors, why it went no further, and what it cost."""

    status: Status
    at: Iterate
    info: Info
    message: str
    factorisations: int


def solve_coupled(
    problem: CoupledProblem,
    normal: NormalMatrix,
    cholesky: Cholesky,
    start: Iterate,
    settings: Settings,
    progress: Progress | None = None,
    enough: Callable[[Iterate], bool] | None = None,
) -> Ending:
    """Run the interior-point loop from an interior iterate; the residual tolerance is in the units of the rows.

    enough: what an iterate must satisfy beside the tolerances where the multipliers alone are wanted.
    """
    kkt = KktSystem(problem, normal, cholesky)
    at = start
    best: tuple[Iterate, Info] | None = None
    step_length, correctors, stalled = 0.0, 0, 0
    least, progressed = np.full(2, np.inf), 0
    message = "iteration limit"
    for iteration in range(settings.iterations + 1):
        found = residuals(problem, at)
        info = _measure(problem, at, found, settings, iteration, step_length, correctors)
        near = (
            settings.balanced
            and iteration > 0
            and info.error <= settings.duality_gap
            and info.residual <= max(settings.nearly, settings.residual)
        )
        exact = _balanced(problem, kkt, at) if near else None
        if exact is not None and info.residual > settings.residual:
            info = _measure(problem, exact, residuals(problem, exact), settings, iteration, step_length, correctors)
        if progress:
            progress(info)
        if best is None or _distance(info, settings) < _distance(best[1], settings):
            best = exact or at, info
        errors = np.array([info.error, info.residual])
        if (errors < _FALLEN * least).any():
            least, progressed = np.minimum(least, errors), iteration
        status = _status(problem, at, found, info, settings)
        if status == "solved" and not settings.balanced:
            if enough is None or enough(at):
                return Ending(status, at, info, "", kkt.factorisations)
            if settings.duality_gap <= CLOSE:
                # What is left is what points that stopped short lack.
                settings = replace(settings, ignored=0.0)
        elif status == "solved" and iteration:
            if exact is not None or info.residual <= _COMPETING * settings.residual:
                return Ending(status, exact or at, info, "", kkt.factorisations)
        elif status != "running":
            return Ending(status, at, info, "", kkt.factorisations)
        stalled = stalled + 1 if iteration > _FIRST_STEPS and step_length < _STALLED_STEP else 0
        if stalled >= 3 or iteration - progressed > _PATIENCE:
            message = "no further progress"
            break
        if at.theta < settings.nearest:
            message = "no solution near the start"
            break
        if iteration == settings.iterations:
            break
        try:
            # Overflow ends the loop below, so no warning is needed.
            with np.errstate(all="ignore"):
                at, step_length, correctors = _advance(problem, kkt, at, found, settings, step_length if iteration else 1.0)
        except NotDefiniteError:
            message = "normal matrix lost its definiteness"
            break
        if not at.finite():
            message = "overflow"
            break
    at, info = best if best is not None else (start, _measure(problem, start, residuals(problem, start), settings, 0, 0.0, 0))
    accepted = info.error <= max(settings.duality_gap, settings.acceptable) and info.residual <= max(
        settings.residual, settings.acceptable
    )
    return Ending("solved" if accepted else "failed", at, info, f"{message}; error {info.error:.1e}", kkt.factorisations)


def _advance(
    problem: CoupledProblem, kkt: KktSystem, at: Iterate, found: Residuals, settings: Settings, last: float
) -> tuple[Iterate, float, int]:
    """Return the next iterate, the step length and the number of centrality correctors that helped."""
    system = NewtonSystem(problem, kkt, at, found, settings)
    affine = system.predictor.move
    ignored = int(settings.ignored * problem.cone.degree) if last > _BLOCKED or not settings.balanced else 0
    reach = min(1.0, at.longest_step(problem, affine, ignored))
    mean = at.mean_product(problem)
    centring = min((1.0 - reach) ** 3, _MOST_CENTRING)
    target = centring * mean
    product = system.second_order(affine) + problem.cone.product(system.point, system.point)
    product -= target * problem.cone.identity()
    pair = affine.theta * affine.kappa + at.theta * at.kappa - target
    step = system.direction(1.0 - centring, product, pair)
    length = at.longest_step(problem, step.move, ignored)
    helped = 0
    while helped < settings.correctors and settings.fraction * length < 1.0:
        fix, fix_pair = centrality_target(problem, system, at, step.move, min(1.0, length + _REACH), max(target, _TARGET * mean))
        corrector = system.corrector(-fix, -fix_pair)
        lengths = at.longest_steps(problem, step.move, corrector.move, _WEIGHTS, ignored)
        best = int(lengths.argmax())
        longer, weight = float(lengths[best]), float(_WEIGHTS[best])
        if longer < length + _WIN * _REACH:
            break
        step, length = step.corrected(corrector, weight), longer
        helped += 1
    move = system.refined(step)
    at, length = at.stepped(problem, move, settings.fraction, ignored, slack=not settings.balanced)
    return at, length, helped


def _balanced(problem: CoupledProblem, kkt: KktSystem, at: Iterate) -> Iterate | None:
    """Return the iterate with the last digits of its coupling rows put right, None where that leads out of the cones."""
    x, load = kkt.balance(at.x / at.theta, at.load / at.theta, _SWEEPS)
    s = problem.right - problem.constrain(x, load)
    lack = problem.rounded_imbalance(problem.couple(x) + problem.constant + load * problem.growth, x)
    if not lack <= _BALANCED or problem.cone.margin(s) < -_OUTSIDE * largest(s):
        return None
    return replace(at, x=x * at.theta, load=load * at.theta, s=s * at.theta)


def _distance(info: Info, settings: Settings) -> float:
    """Return how far an iterate is from the tolerances; at most 1 is solved."""
    return max(info.error / settings.duality_gap, info.residual / settings.residual)


def _measure(
    problem: CoupledProblem, at: Iterate, found: Residuals, settings: Settings, iteration: int, step: float, correctors: int
) -> Info:
    # Errors of the objective are relative to it, or to a thousandth of the reward's unit if that is larger.
    size = max(abs(found.primal), abs(found.dual), 1e-3 * abs(problem.reward)) * at.theta**2
    work = (
        abs(found.primal - found.dual) * at.theta**2,
        inner(at.s, at.z),
        abs(inner(found.y, at.y)),
        abs(inner(found.x, at.x)) + abs(found.load * at.load),
    )
    error = max(work) / max(size, 1e-300)
    residual = problem.imbalance(found.y) / at.theta
    if error <= settings.duality_gap and residual > settings.residual:
        residual = problem.rounded_imbalance(found.y / at.theta, at.x / at.theta)
    return Info(
        iteration=iteration,
        primal=found.primal,
        dual=found.dual,
        error=error,
        residual=residual,
        product=at.mean_product(problem),
        step=step,
        correctors=correctors,
    )


def _status(problem: CoupledProblem, at: Iterate, found: Residuals, info: Info, settings: Settings) -> Status:
    if info.error <= settings.duality_gap and info.residual <= settings.residual:
        return "solved"
    # A scale that has vanished is as good a sign as the last digits of a certificate, which a singular matrix may spoil.
    vanished = at.theta <= _VANISHED * at.kappa
    allowed = max(settings.certificate, _ROUGH) if vanished else settings.certificate
    # What is left of each residual without the terms of theta is the error of a certificate.
    price = inner(problem.right, at.z) - inner(problem.constant, at.y)
    if price < 0:
        error = largest(found.x - found.curvature - problem.linear * at.theta)
        error = max(error, abs(found.load + problem.reward * at.theta))
        if error <= -price * allowed:
            return "infeasible"
    gain = problem.reward * at.load - inner(problem.linear, at.x)
    if gain > 0:
        error = max(
            largest(found.curvature),
            largest(found.y - problem.constant * at.theta),
            largest(problem.constrain(at.x, at.load) + at.s),
        )
        if error * max(abs(problem.reward), 1.0) <= gain * allowed:
            return "unbounded"
    return "running"


def interior_start(problem: CoupledProblem, settings: Settings, *, heavy: bool = False) -> Iterate:
    """Return a start without load: local interior points, and multipliers that make all complementarity products equal.

    heavy: with forces in the load of the heaviest body that each touches, instead of the lightest.
    """
    x = problem.interior(settings.force, heavy=heavy)
    s = problem.right - problem.constrain(x, 0.0)
    product = settings.rate * settings.force * max(abs(problem.reward), 1.0)
    return Iterate(x, 0.0, np.zeros(problem.rows), s, product * problem.cone.inverse(s), 1.0, product)
