"""Sequences of convex programs that approach sliding without dilatancy: eq. (3) as printed, and a scheme with a certificate."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from churchpipe.conic.program import ConeProgram, ConeSolution
from churchpipe.conic.solve import Solve
from churchpipe.model.arrays import FloatArray
from churchpipe.model.results import Iteration
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import (
    CoulombState,
    bipotential_gap,
    friction_violation,
    nearest_forces,
    sliding_velocities,
)
from churchpipe.rigid_blocks.equilibrium import Equilibrium

# The gap g / alpha at which a state is certified.
GAP_TOLERANCE = 1e-5
Progress = Callable[[str, float], None]


@dataclass(frozen=True, slots=True)
class PaperSettings:
    """Constants of eq. (3): mixing beta, fictitious cohesion c0 (share of the largest n), fictitious slope xi, tolerance.

    The paper prints c0 = 1e-4 and xi up to 1e-2; these are as robust and ten times less biased. xi caps compression at
    c / (xi mu), so that c0 / xi must stay at 1e-2 or more.
    """

    beta: float = 0.6
    cohesion: float = 1e-5
    slope: float = 1e-3
    tolerance: float = 1e-3
    iterations: int = 40


@dataclass(frozen=True, slots=True)
class SchemeSettings:
    """Constants of the certified scheme.

    rounds: of stages A and B, at most; stage_a, stage_b: steps of each in a round, at most.
    violation, settled: stage A ends when no more than this share of the friction is overdrawn, or (in the first round) when
    the load factor changes by no more than this share. mixing: share of the new normal forces that stage A takes from the
    second round on; the first takes all, which leads closest to where it started from but swings to and fro for ever on
    some walls. weight_a, weight_b: proximal weights. cohesion: fictitious, in stage A, over the largest normal force.
    momentum: share of its last step that stage B goes on by. stall: stage B gives up when four steps have not brought the
    gap below this share. gap: g / alpha at which the search ends.
    Convex programs are solved to `share` of the gap that is left, at least to `roughest` and at most to `error`: the gap is
    computed from the arrays, whatever made them.
    """

    rounds: int = 3
    stage_a: int = 15
    stage_b: int = 25
    violation: float = 1e-4
    settled: float = 5e-3
    gap: float = GAP_TOLERANCE
    mixing: float = 0.6
    weight_a: float = 0.3
    weight_b: float = 0.003
    cohesion: float = 1e-5
    momentum: float = 0.9
    stall: float = 0.8
    error: float = 1e-6
    share: float = 0.1
    roughest: float = 1e-3


@dataclass(frozen=True, slots=True)
class SlidingRun:
    """One run of an iteration from one start: its last forces x (nc, 3), load factor, velocities y (6 nf,), history.

    carried: the load factor that the forces balance, `load_factor` unless that is a mean. settled: certified, or come to rest.
    solves: convex programs solved; iterations: interior-point iterations in all of them.
    """

    x: FloatArray
    load_factor: float
    carried: float
    y: FloatArray
    settled: bool
    history: tuple[Iteration, ...]
    gap: float = np.nan
    solves: int = 0
    iterations: int = 0


def paper_iteration(
    balance: Equilibrium,
    strength: Strength,
    n0: FloatArray,
    n_before: FloatArray,
    solve: Solve,
    settings: PaperSettings | None = None,
    progress: Progress | None = None,
) -> SlidingRun | None:
    """Iterate eq. (3) from normal forces n0 (nc,) and n_before (nc,) at iteration -1; None when the first step is infeasible.

    |t_k| <= c_k - xi mu n_k with c_k = (beta n + (1 - beta) n_before) (1 + xi) mu + c0 max(n). The printed stop test lacks
    the absolute value; it must hold twice running here, after three iterations at the least. An iteration that does not
    settle reports the mean of its last ten load factors.

    The forces of a step are not unique, and the result hangs on which the solver returns: an interior point ends at the
    analytic centre of the optimal ones, which reproduces the published values. One redundant constraint in the program
    moves that centre (wall 2 of Ferris and Tin-Loi by 0.6 %), a least-squares selection makes S22 swing from .155 to .182.
    """
    settings = settings or PaperSettings()
    mu, n, zero = strength.friction, n0, np.zeros_like(n0)
    history: list[Iteration] = []
    latest = None
    calm = spent = 0
    for _ in range(settings.iterations):
        floor = settings.cohesion * float(n.max())
        mixed = settings.beta * n + (1 - settings.beta) * n_before
        limit = mixed * (1 + settings.slope) * mu + strength.cohesion + floor
        program = ConeProgram(balance.matrix, balance.dead, balance.live, limit, -settings.slope * mu, zero, zero)
        answer = solve(program)
        if answer.outcome != "solved":
            break
        latest = answer
        spent += answer.iterations
        n_before, n = n, np.maximum(answer.x[:, 0], 0.0)
        history.append(Iteration(answer.tau, friction_violation(strength, answer.x, settings.cohesion * float(n.max()))))
        if progress:
            progress("non-associative", len(history) / settings.iterations)
        change = abs(history[-1].load_factor - history[-2].load_factor) / abs(answer.tau) if len(history) > 1 else np.inf
        calm = calm + 1 if change <= settings.tolerance else 0
        if calm >= 2 and len(history) >= 3:
            break
    if latest is None:
        return None
    settled = calm >= 2
    value = latest.tau if settled else float(np.mean([step.load_factor for step in history[-10:]]))
    return SlidingRun(latest.x, value, latest.tau, latest.y, settled, tuple(history), solves=len(history), iterations=spent)


def certified_iteration(
    balance: Equilibrium,
    strength: Strength,
    n: FloatArray,
    solve: Solve,
    settings: SchemeSettings | None = None,
    progress: Progress | None = None,
) -> SlidingRun | None:
    """Search for a zero-dilatancy collapse state from normal forces n (nc,), until the gap certifies it.

    Stage A walks to forces that hardly overdraw friction: maximise alpha - 1/2 sum R_k (mu n - mu n_hat)^2 with shear limited
    by mu n_hat. Stage B closes the gap: velocities from P(n), then forces in the true cones that do the least work
    against their sliding. By itself it creeps along a valley of the gap, so each step goes on by a share of the one before
    (heavy ball, Polyak 1964), and starts afresh when the gap grows.
    """
    settings = settings or SchemeSettings()
    count = SolveCount(solve)
    history: list[Iteration] = []
    best: CoulombState | None = None
    for round_number in range(settings.rounds):
        mixing = settings.mixing if round_number else 1.0
        for _ in range(settings.stage_a):
            step = _stage_a(balance, strength, n, count, settings, mixing)
            if step is None:
                break
            n, iteration = step
            change = abs(iteration.load_factor / history[-1].load_factor - 1) if history else np.inf
            history.append(iteration)
            if iteration.violation < settings.violation or (not round_number and change <= settings.settled):
                break
        gaps: list[float] = []
        ahead, before = n, None
        for pair in range(settings.stage_b):
            if progress:
                progress("non-associative", (round_number + pair / settings.stage_b) / settings.rounds)
            # No better than a tenth of the gap that is left: it is computed from the arrays, whatever made them.
            last = gaps[-1] if gaps else np.inf
            error = min(max(settings.error, settings.share * last), settings.roughest)
            state = _stage_b(balance, strength, ahead, count, settings.weight_b, error)
            if state is None and before is not None and ahead is not before:
                # So far on, no velocities may fit: back to the forces that were found.
                ahead = before
                continue
            if state is None:
                break
            history.append(Iteration(state.load_factor, 0.0, state.relative_gap))
            if best is None or state.gap < best.gap:
                best = state
            if state.relative_gap <= settings.gap:
                return _run(state, True, history, count)
            n = np.maximum(state.x[:, 0], 0.0)
            grown = bool(gaps) and state.relative_gap > gaps[-1]
            ahead = n if before is None or grown else np.maximum(n + settings.momentum * (n - before), 0.0)
            before = n
            gaps.append(state.relative_gap)
            if len(gaps) > 4 and min(gaps[-4:]) > settings.stall * min(gaps[:-4]):
                break
    return None if best is None else _run(best, best.relative_gap <= GAP_TOLERANCE, history, count)


class SolveCount:
    """A solver that counts the programs it has solved and its iterations."""

    def __init__(self, solve: Solve) -> None:
        self._solve = solve
        self.solves = self.iterations = 0

    def __call__(self, program: ConeProgram, /, *, error: float | None = None) -> ConeSolution:
        """Solve a program, and count it."""
        answer = self._solve(program, error=error)
        self.solves += 1
        self.iterations += answer.iterations
        return answer


def _run(state: CoulombState, settled: bool, history: list[Iteration], count: SolveCount) -> SlidingRun:
    return SlidingRun(
        state.x, state.load_factor, state.load_factor, state.y, settled, tuple(history), state.gap, count.solves, count.iterations
    )


def _stage_b(
    balance: Equilibrium, strength: Strength, n: FloatArray, solve: Solve, nearness: float, error: float
) -> CoulombState | None:
    """Return the next state: velocities from P(n), then the forces that do the least work against them."""
    y = sliding_velocities(balance, strength, n, solve, error=error)
    if y is None:
        return None
    found = nearest_forces(balance, strength, n, y, solve, nearness=nearness, error=error)
    if found is None:
        return None
    x, load_factor = found
    return CoulombState(x, load_factor, y, bipotential_gap(balance, strength, x, y))


def _stage_a(
    balance: Equilibrium, strength: Strength, n: FloatArray, solve: Solve, settings: SchemeSettings, mixing: float
) -> tuple[FloatArray, Iteration] | None:
    mu = strength.friction
    shear = mu * n
    mean = max(float(shear.mean()), 1e-12)
    curvature = settings.weight_a / (len(n) * mean * (shear + 0.1 * mean)) * mu**2
    limit = shear + strength.cohesion + settings.cohesion * float(shear.max())
    program = ConeProgram(balance.matrix, balance.dead, balance.live, limit, np.zeros_like(n), -curvature * n, curvature)
    answer = solve(program, error=settings.roughest)
    if answer.outcome != "solved":
        return None
    mixed = mixing * np.maximum(answer.x[:, 0], 0.0) + (1 - mixing) * n
    return mixed, Iteration(answer.tau, friction_violation(strength, answer.x))
