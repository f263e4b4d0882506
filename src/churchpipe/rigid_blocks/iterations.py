"""Sequences of convex programs that approach sliding without dilatancy.

`paper_iteration` is eq. (3) of Malena et al. (2019) as printed. `certified_iteration` ends at a state whose gap g (`coulomb`)
proves it. Symbols are those of `coulomb`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from churchpipe.conic.interior_point.settings import WARM_ITERATIONS
from churchpipe.conic.program import ConeProgram, ConeSolution, WarmStart
from churchpipe.conic.solve import Proves, Solve, SolveProgress
from churchpipe.model.arrays import FloatArray
from churchpipe.model.progress import Progress
from churchpipe.model.results import Iteration
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import (
    EXACT,
    CoulombState,
    Near,
    bipotential_gap,
    friction_violation,
    gap_shares,
    nearest_forces,
    sliding_velocities,
)
from churchpipe.rigid_blocks.equilibrium import Balanced, Equilibrium
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP, PaperSettings, SchemeSettings

# Greatest factor by which a point of the gap may count more. Beyond it the programs would lose digits.
_MOST_STRESS = 1e4
# Forces near known ones are solved so many times more exactly than velocities: at the price of an iteration. An error of a motion
# ends with its step, that of the forces is handed on.
_FORCES = 0.1


@dataclass(frozen=True, slots=True)
class SlidingRun(CoulombState):
    """One run of an iteration from one start: the state it ended at, and its history.

    converged: whether the run was certified or came to rest. solves: convex programs solved; iterations: factorisations, one an
    iteration of a program. balanced: the load factor that the forces balance, where `load_factor` is a mean of the last ones.
    """

    converged: bool
    history: tuple[Iteration, ...]
    solves: int = 0
    iterations: int = 0
    balanced: float | None = None


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

    |t_k| <= c_k - xi mu n_k with c_k = (beta n + (1 - beta) n_before) (1 + xi) mu + c0 max(n): the shear of a point k is limited
    by the normal forces of the two steps before, mixed by beta, and by c0 of the largest. xi is a small slope against its own
    normal force (`PaperSettings`). The stop test as printed lacks the absolute value. Here it must hold twice in succession,
    after at least three iterations. An iteration that does not settle reports the mean of its last ten load factors.

    The forces of a step are not unique, and the result depends on which of them the solver returns. An interior-point method
    returns the analytic centre of the optimal ones, which reproduces the published values (docs/development.md).
    """
    settings = settings or PaperSettings()
    mu, n = strength.friction, n0
    history: list[Iteration] = []
    latest = None
    calm = spent = 0
    for _ in range(settings.iterations):
        floor = settings.cohesion * float(n.max())
        mixed = settings.beta * n + (1 - settings.beta) * n_before
        limit = mixed * (1 + settings.slope) * mu + strength.cohesion + floor
        answer = solve(balance.program(limit, -settings.slope * mu, strength.bound), duality_gap=EXACT)
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
    converged = calm >= 2
    value = latest.tau if converged else float(np.mean([step.load_factor for step in history[-10:]]))
    return SlidingRun(latest.x, value, latest.y, np.nan, converged, tuple(history), len(history), spent, latest.tau)


def certified_iteration(
    balance: Equilibrium,
    strength: Strength,
    n: FloatArray,
    solve: Solve,
    settings: SchemeSettings | None = None,
    progress: Progress | None = None,
    *,
    below: float = np.inf,
) -> SlidingRun | None:
    """Search for a collapse state without dilatancy from normal forces n (nc,), until the gap certifies it.

    Stage A, `approached_forces`, approaches forces that hardly exceed friction. Stage B, `closed_gap`, closes the gap. Only a
    load factor `below` this is wanted: a search that comes close to a state above it is left, with the gap that it then has.
    """
    settings = settings or SchemeSettings()
    count = SolveCount(solve)
    n, history = approached_forces(balance, strength, n, count, settings)
    run = closed_gap(balance, strength, n, count, settings, progress, below=below)
    if run is None:
        return None
    return replace(run, history=(*history, *run.history), solves=count.solves, iterations=count.iterations)


def approached_forces(
    balance: Balanced, strength: Strength, n: FloatArray, solve: Solve, settings: SchemeSettings, *, rough: bool = False
) -> tuple[FloatArray, list[Iteration]]:
    """Return normal forces (nc,) that hardly exceed friction, sought from forces n (nc,), and the steps towards them: stage A.

    A step maximises alpha - 1/2 sum R_k (mu n - mu n_hat)^2 with shear limited by mu n_hat, where alpha is the load factor,
    n_hat are the normal forces of the step before and R_k proximal weights.

    rough: whether each program may begin near the one before, and stop before its forces balance.
    """
    history: list[Iteration] = []
    last: ConeSolution | None = None
    for _ in range(settings.stage_a):
        last = _stage_a(balance, strength, n, solve, settings, last, rough=rough)
        if last is None:
            break
        n, iteration = np.maximum(last.x[:, 0], 0.0), Iteration(last.tau, friction_violation(strength, last.x))
        change = abs(iteration.load_factor / history[-1].load_factor - 1) if history else np.inf
        history.append(iteration)
        if iteration.violation < settings.violation or change <= settings.change:
            break
    return n, history


def closed_gap(
    balance: Balanced,
    strength: Strength,
    n: FloatArray,
    solve: Solve,
    settings: SchemeSettings,
    progress: Progress | None = None,
    *,
    near: Near | None = None,
    begun: CoulombState | None = None,
    onward: bool = False,
    gap: float = np.inf,
    below: float = np.inf,
    enough: Callable[[CoulombState], bool] | None = None,
) -> SlidingRun | None:
    """Close the gap of normal forces n (nc,) that hardly exceed friction: stage B.

    A step finds the velocities of P(n), then the forces in the true cones that do the least work against their sliding. Such
    steps alone converge slowly, so each is extended by a share of the one before (heavy ball, Polyak 1964). After a slow step the
    next is not extended. The share is halved when the gap grows, and doubled, up to its first value, when it falls.

    near: forces and velocities near those sought, if any are known. Programs then begin near the last ones, and those of
    velocities stop before their own forces balance: quicker, and exact to the misfit of a path, not to that of a certified load
    factor. begun: forces that balance and fit velocities near those sought, to go on from; where the first velocities found close
    the gap with them, they are kept. onward: where no velocities are known, all programs but the first two begin near the last.

    The gap is concave in the forces alone, so that stage B can come to rest at a local minimum where a few joints keep what is
    left of it: a hinge, for instance, whose force cannot reach its edge. When a step without extension is slow, the share of
    these joints in the gap is given a larger weight from then on (breakout, Morris 1993). The programs lower this weighted gap,
    so steps are judged by it; a step that frees a joint may raise the gap itself. A gap of zero is zero with any such weights.

    gap: that of the state that it begins near, where one is known. below: see `certified_iteration`. enough: whether a state will
    do although its gap is not closed; it is then returned.
    """
    count = SolveCount(solve)
    history: list[Iteration] = []
    best: CoulombState | None = None
    last = begun
    # Where a start near the last velocities came to nothing, so do later ones: these are then sought from nothing.
    anew, exact = False, near is not None and enough is None
    # The state with the least weighted gap. The search returns to it.
    base: CoulombState | None = None
    ahead, excess, momentum = n, np.zeros_like(n), settings.momentum
    # The step at which the gap was last halved, and the gap then.
    halved, mark = 0, np.inf
    for pair in range(settings.stage_b):
        if pair - halved > settings.patience:
            break
        if progress:
            progress("non-associative", pair / settings.stage_b)
        plain = ahead is n
        if (near is not None or onward) and last is not None:
            near = Near(last.x, last.y, only=near is not None and near.only and not pair)
        gap = gap if last is None else last.relative_gap
        closes = near is not None
        state = pair_of_programs(balance, strength, ahead, last, excess, count, settings, near, gap, closes=closes, anew=anew)
        anew = exact and count.longest > WARM_ITERATIONS
        if state is None and plain:
            break
        if state is None:
            # After a long step there may be no velocities that fit. The search then returns to the forces that were found.
            ahead, momentum = n, 0.5 * momentum
            continue
        history.append(Iteration(state.load_factor, 0.0, state.relative_gap))
        if enough is not None and enough(state):
            best = state
            break
        if best is None or state.gap < best.gap:
            best = state
        if state.gap < 0.5 * mark:
            halved, mark = pair, state.gap
        if state.relative_gap <= (settings.bipotential_gap if state.load_factor < below else settings.close):
            break
        if last is not None and last is not begun and pairs_left(last, state, settings.bipotential_gap) > settings.outlook:
            break
        reached, left, least = (_weighted_gap(balance, strength, each, excess) for each in (state, last, base))
        if base is None or reached < least:
            base = state
        first, worse, slow = last is None, reached > settings.worse * least, reached > settings.slow * left
        stuck = plain and (worse or slow)
        if stuck:
            shares = gap_shares(balance, strength, base.x, base.y)
            most = (shares > settings.stuck * shares.sum()) & (balance.softness == 0)
            excess[most] = np.minimum(settings.stuck_weight * (1.0 + excess[most]), _MOST_STRESS) - 1.0
        if reached > left:
            momentum *= 0.5
        elif not plain:
            momentum = min(2.0 * momentum, settings.momentum)
        last = base if stuck or worse else state
        before, n = n, np.maximum(last.x[:, 0], 0.0)
        ahead = n if first or slow or worse else np.maximum(n + momentum * (n - before), 0.0)
    return None if best is None else sliding_run(best, history, count.solves, count.iterations)


def pairs_left(before: CoulombState, state: CoulombState, wanted: float) -> float:
    """Return how many more steps a search needs at the rate of the last one, infinite where the gap did not fall."""
    if state.relative_gap >= before.relative_gap:
        return np.inf
    return float(np.log(state.relative_gap / wanted) / np.log(before.relative_gap / state.relative_gap))


def sliding_run(state: CoulombState, history: list[Iteration], solves: int, iterations: int) -> SlidingRun:
    """Return the run that ended at a state."""
    converged = state.relative_gap <= BIPOTENTIAL_GAP
    return SlidingRun(state.x, state.load_factor, state.y, state.gap, converged, tuple(history), solves, iterations)


class SolveCount:
    """A solver that counts the programs it has solved, its iterations, and those of the longest program of velocities alone."""

    def __init__(self, solve: Solve) -> None:
        self._solve = solve
        self.solves = self.iterations = self.longest = 0

    def __call__(
        self,
        program: ConeProgram,
        /,
        *,
        duality_gap: float | None = None,
        proves: Proves | None = None,
        progress: SolveProgress | None = None,
        near: WarmStart | None = None,
        velocities: bool = False,
    ) -> ConeSolution:
        """Solve a program, and count it."""
        answer = self._solve(program, duality_gap=duality_gap, proves=proves, progress=progress, near=near, velocities=velocities)
        self.solves += 1
        self.iterations += answer.iterations
        self.longest = max(self.longest, answer.iterations if velocities else 0)
        return answer


def pair_of_programs(
    balance: Balanced,
    strength: Strength,
    n: FloatArray,
    last: CoulombState | None,
    excess: FloatArray,
    solve: Solve,
    settings: SchemeSettings,
    near: Near | None,
    gap: float,
    *,
    closes: bool,
    anew: bool = False,
) -> CoulombState | None:
    """Return the next state: velocities from P(n), then the forces that do the least work against them.

    closes: whether the last forces are kept where the velocities alone close the gap. anew: whether these start from nothing.
    """
    duality_gap = min(max(settings.duality_gap, settings.share * gap), settings.roughest)
    stressed = None if last is None or not excess.any() else (excess, last.x)
    start = None if anew else near
    alone = start is not None
    y = sliding_velocities(balance, strength, n, solve, duality_gap=duality_gap, stressed=stressed, alone=alone, near=start)
    if y is None:
        return None
    if last is not None and closes:
        # Often the last forces will do.
        moved = CoulombState(last.x, last.load_factor, y, bipotential_gap(balance, strength, last.x, y))
        if moved.relative_gap <= settings.bipotential_gap:
            return moved
    nearness = min(settings.weight_b, settings.nearness * gap)
    x = None if near is None else near.forces
    if near is not None:
        duality_gap = min(duality_gap, max(_FORCES * duality_gap, settings.duality_gap))
    found = nearest_forces(balance, strength, n, y, solve, nearness=nearness, duality_gap=duality_gap, excess=excess, x=x)
    if found is None:
        return None
    return CoulombState(found.x, found.tau, y, bipotential_gap(balance, strength, found.x, y))


def _weighted_gap(balance: Balanced, strength: Strength, state: CoulombState | None, excess: FloatArray) -> float:
    """Return what stage B lowers: g / alpha, where what each point adds to g counts `excess` (nc,) times more."""
    if state is None:
        return np.inf
    shares = gap_shares(balance, strength, state.x, state.y)
    return replace(state, gap=float((1.0 + excess) @ shares)).relative_gap


def _stage_a(
    balance: Balanced,
    strength: Strength,
    n: FloatArray,
    solve: Solve,
    settings: SchemeSettings,
    last: ConeSolution | None,
    *,
    rough: bool,
) -> ConeSolution | None:
    mu = strength.friction
    shear = mu * n
    load = float(np.abs(balance.dead).max())
    mean = max(float(shear.mean()), 1e-3 * load)
    curvature = settings.weight_a / (len(n) * mean * (shear + 0.1 * mean)) * mu**2
    near = WarmStart(last.x, last.tau, last.y) if rough and last is not None else None
    for cohesion in (settings.cohesion * float(shear.max()), *(load * share for share in settings.more_cohesion)):
        limit = shear + strength.cohesion + cohesion
        program = balance.program(limit, np.zeros_like(n), strength.bound, -curvature * n, curvature)
        answer = solve(program, duality_gap=settings.roughest, near=near, velocities=rough)
        if answer.outcome == "solved":
            return answer
    return None
