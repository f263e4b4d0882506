"""Sequences of convex programs that approach sliding without dilatancy: eq. (3) as printed, and a scheme with a certificate."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from churchpipe.conic.program import ConeProgram
from churchpipe.conic.solve import Solve
from churchpipe.model.arrays import FloatArray
from churchpipe.model.results import Iteration
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import (
    CoulombState,
    coulomb_step,
    friction_violation,
    sliding_velocities,
)
from churchpipe.rigid_blocks.equilibrium import Equilibrium

Start = Literal["associative", "uniform"]
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
    """Constants of the certified scheme: rounds of stages A and B, their tolerances and proximal weights.

    `mixing`: share of the new normal forces that stage A takes from the second round on; the first round takes all, which
    leads closest to where it started from but swings to and fro for ever on some walls.
    """

    rounds: int = 3
    stage_a: int = 15
    stage_b: int = 12
    violation: float = 1e-4
    gap: float = 1e-5
    mixing: float = 0.6
    weight_a: float = 0.3
    weight_b: float = 0.003
    cohesion: float = 1e-5


@dataclass(frozen=True, slots=True)
class SlidingRun:
    """One run of an iteration from one start: its last forces x (nc, 3), load factor, velocities y (6 nf,), history."""

    x: FloatArray
    load_factor: float
    y: FloatArray
    settled: bool
    history: tuple[Iteration, ...]
    gap: float = np.nan
    solves: int = 0


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
    calm = 0
    for _ in range(settings.iterations):
        floor = settings.cohesion * float(n.max())
        mixed = settings.beta * n + (1 - settings.beta) * n_before
        limit = mixed * (1 + settings.slope) * mu + strength.cohesion + floor
        program = ConeProgram(balance.matrix, balance.dead, balance.live, limit, -settings.slope * mu, zero, zero)
        answer = solve(program)
        if answer.outcome != "solved":
            break
        latest = answer
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
    return SlidingRun(latest.x, value, latest.y, settled, tuple(history), solves=len(history))


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
    against their sliding.
    """
    settings = settings or SchemeSettings()
    history: list[Iteration] = []
    best: CoulombState | None = None
    solves = 0
    for round_number in range(settings.rounds):
        for _ in range(settings.stage_a):
            step = _stage_a(balance, strength, n, solve, settings, settings.mixing if round_number else 1.0)
            solves += 1
            if step is None:
                break
            n, iteration = step
            history.append(iteration)
            if iteration.violation < settings.violation:
                break
        y = sliding_velocities(balance, strength, n, solve)
        solves += 1
        for pair in range(settings.stage_b):
            if progress:
                progress("non-associative", (round_number + pair / settings.stage_b) / settings.rounds)
            state = None if y is None else coulomb_step(balance, strength, n, y, solve, nearness=settings.weight_b)
            solves += 2
            if state is None:
                break
            n, y = np.maximum(state.x[:, 0], 0.0), state.y
            history.append(Iteration(state.load_factor, 0.0, state.relative_gap))
            if best is None or state.gap < best.gap:
                best = state
            if state.relative_gap <= settings.gap:
                return _run(state, True, history, solves)
    return None if best is None else _run(best, False, history, solves)


def _run(state: CoulombState, settled: bool, history: list[Iteration], solves: int) -> SlidingRun:
    return SlidingRun(state.x, state.load_factor, state.y, settled, tuple(history), state.gap, solves)


def _stage_a(
    balance: Equilibrium, strength: Strength, n: FloatArray, solve: Solve, settings: SchemeSettings, mixing: float
) -> tuple[FloatArray, Iteration] | None:
    mu = strength.friction
    shear = mu * n
    mean = max(float(shear.mean()), 1e-12)
    curvature = settings.weight_a / (len(n) * mean * (shear + 0.1 * mean)) * mu**2
    limit = shear + strength.cohesion + settings.cohesion * float(shear.max())
    program = ConeProgram(balance.matrix, balance.dead, balance.live, limit, np.zeros_like(n), -curvature * n, curvature)
    answer = solve(program)
    if answer.outcome != "solved":
        return None
    mixed = mixing * np.maximum(answer.x[:, 0], 0.0) + (1 - mixing) * n
    return mixed, Iteration(answer.tau, friction_violation(strength, answer.x))
