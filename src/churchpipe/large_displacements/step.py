"""One program of a path: the load factor and the velocities of stones where they are now."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import TypeAlias

import numpy as np

from churchpipe.conic.program import ConeProgram, Outcome
from churchpipe.conic.solve import Solve
from churchpipe.conic.wrenches import Balance, apply, transpose
from churchpipe.large_displacements.settings import PATH, THRIFTY, Demands
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.certificate import Strength, cone_violation
from churchpipe.rigid_blocks.coulomb import CoulombState, Near, bipotential_gap, elastic_pull, nearest_forces
from churchpipe.rigid_blocks.iterations import closed_gap
from churchpipe.rigid_blocks.settings import SchemeSettings

# Whether a motion y (m,) with this misfit is that of a few stones that fall; and whether it has come to rest at this misfit.
Fall: TypeAlias = Callable[[FloatArray, float, bool], bool]


@dataclass(frozen=True, slots=True)
class StepProgram:
    """What a load factor is sought for: the balance of displaced stones, and the strength of their contact points.

    balance A (m, 3 nc): what the forces of the points do to the stones; dead f_D and live f_L (m,) as in `Equilibrium`. closing
    (nc,) >= 0: the rate at which each point may close, its gap over the length of the step. The last points may be ties: their
    strength bounds n, and closing is their slack, negative for one that is stretched; softness (nc,) is the rate at which an
    elastic one lengthens under a unit of n, zero elsewhere. A force acts only where a gap closes within the step, so that
    w + closing stands where w, the rate of opening, would stand without gaps (time-stepping, Anitescu 2006).

    Where joints crush, their rows follow the `rows` of the stones, and their further points the `points` (`conic.pressed`).
    least: a load factor nearer to zero counts as this much where misfits are measured by it.
    """

    balance: Balance
    dead: FloatArray
    live: FloatArray
    strength: Strength
    closing: FloatArray
    points: int
    rows: int
    softness: FloatArray
    least: float = PATH.least

    def residual(self, x: FloatArray, load_factor: float) -> FloatArray:
        """Return what is left of the balance (m,) of forces x (nc, 3)."""
        return apply(self.balance, x) + self.dead + load_factor * self.live

    def rates(self, y: FloatArray) -> FloatArray:
        """Return w + closing and the sliding v (nc, 3) of multipliers y (m,) with f_L . y = 1."""
        rate = transpose(self.balance, y)
        rate[:, 0] += self.closing
        return rate

    def within(self, gap: FloatArray, softness: FloatArray, length: float) -> "StepProgram":
        """Return the program of a step of this length, m per unit of work; gap (nc,) m, softness (nc,) m per unit of force."""
        closing = np.where(softness > 0, gap, np.maximum(gap, 0.0)) / length
        return replace(self, closing=closing, softness=softness / length)

    def motion(self, y: FloatArray) -> FloatArray:
        """Return the rates w and v (points, 3) at which stones open and slide."""
        return transpose(self.balance, np.where(np.arange(len(y)) < self.rows, y, 0.0))[: self.points]

    def program(
        self,
        limit: FloatArray,
        slope: FloatArray,
        bound: FloatArray,
        linear: FloatArray | None = None,
        quadratic: FloatArray | None = None,
    ) -> ConeProgram:
        """Return the cone program of this balance, as `Equilibrium.program`; normal forces pay for the gaps as well."""
        own = np.arange(len(limit)) < self.points
        price, curvature = (np.zeros(len(limit)) if each is None else np.where(own, each, 0.0) for each in (linear, quadratic))
        limit, slope = np.where(own, limit, 0.0), np.where(own, slope, 1.0)
        return ConeProgram(
            self.balance, self.dead, self.live, limit, slope, price + self.closing, curvature + self.softness, bound=bound
        )

    def slip(self, y: FloatArray) -> FloatArray:
        """Return the opening mu |v| (nc,) that sliding at this rate costs in an associative program, zero at further points."""
        rate = transpose(self.balance, y)
        rate[self.points :] = 0.0
        return self.strength.friction * np.hypot(rate[:, 1], rate[:, 2])


@dataclass(frozen=True, slots=True)
class StepAnswer:
    """The answer to one program: forces (nc, 3) over the weight, load factor, multipliers y (m,) with f_L . y = 1.

    residual, violation: of the balance and of the Coulomb cones, over the weight; bound_gap: kinematic against static bound of
    the program, over the load factor; gap: `bipotential_gap` of forces and motion, the gaps of the points included: zero for a
    motion without dilatancy. "infeasible": y is how the stones fall.
    """

    outcome: Outcome
    forces: FloatArray
    load_factor: float
    y: FloatArray
    residual: float = np.nan
    violation: float = np.nan
    bound_gap: float = np.nan
    gap: float = np.nan
    least: float = PATH.least
    message: str = ""

    @property
    def misfit(self) -> float:
        """What the motion lacks of one without dilatancy, over the load factor, or `StepProgram.least` where that is more."""
        return self.gap / max(abs(self.load_factor), self.least)


def solve_step(program: StepProgram, sliding: FloatArray, solve: Solve, duality_gap: float) -> StepAnswer:
    """Return the largest load factor less the work of the normal forces against gaps and sliding, with its motion.

        maximise    tau - sum n_k (closing_k + sliding_k)
        subject to  balance + f_D + tau f_L = 0,   |t_k| <= mu n_k

    sliding (nc,): what the sliding of each point is thought to open, mu |v|. Where that is right the points slide without
    dilating; zeros give the associative motion. Where the program is not solved to `duality_gap`, that of large models will do.
    """
    strength, zero = program.strength, np.zeros_like(sliding)
    cone = program.program(zero, strength.friction, strength.bound, sliding)
    answer = solve(cone, duality_gap=duality_gap)
    if answer.outcome == "failed" and duality_gap < THRIFTY.duality_gap and not falls(program, answer.y):
        # What a rougher answer is worth is measured from its own arrays, as of any other.
        answer = solve(cone, duality_gap=THRIFTY.duality_gap)
    if answer.outcome != "solved":
        outcome = "infeasible" if answer.outcome == "failed" and falls(program, answer.y) else answer.outcome
        return StepAnswer(outcome, answer.x, np.nan, answer.y, message=answer.message)
    y = answer.y / float(program.live @ answer.y)
    return step_answer(program, sliding, answer.x, answer.tau, y, answer.message)


def falls(program: StepProgram, y: FloatArray) -> bool:
    """True for a motion y (m,) that no normal forces of up to `PATH.strongest` weights in all can hold.

    The dead load does more work in it than such forces in their cones could take up where it violates the flow rule, whatever
    the live load. A solver that finds such a motion, and not quite an exact one, calls the program neither solved nor infeasible.
    """
    dead, live = float(program.dead @ y), float(program.live @ y)
    if np.isfinite(program.strength.bound).any() or not dead > 0:
        return False
    rate = program.motion(y)
    against = program.strength.friction[: len(rate)] * np.hypot(rate[:, 1], rate[:, 2]) - rate[:, 0]
    return PATH.strongest * (max(float(against.max(initial=0.0)), 0.0) + abs(live)) < dead


def fallen_alone(program: StepProgram, solve: Solve) -> StepAnswer:
    """Return how stones fall that the dead load alone brings down ("infeasible"), or that none do ("failed").

    That program always has a solution, which the one for the load factor has not where stones fall. Without bounds of strength
    all forces that carry a share of the dead load carry all of it, once multiplied: the share is none or all.
    """
    zero, strength = np.zeros_like(program.closing), program.strength
    share = program.program(zero, strength.friction, strength.bound)
    share = replace(share, constant=np.zeros_like(program.dead), growth=program.dead, linear=zero, quadratic=zero, cap=1.0)
    answer = solve(share)
    falling = answer.outcome == "solved" and answer.tau < 0.5
    return StepAnswer("infeasible" if falling else "failed", answer.x, np.nan, answer.y, message=answer.message)


def without_dilatancy(
    program: StepProgram, answer: StepAnswer, solve: Solve, demands: Demands, pairs: int, fall: Fall
) -> StepAnswer:
    """Return forces and motion without dilatancy, sought from the forces of an answer in pairs of programs, so many at the most.

    Of each pair one finds the velocities that fit the forces, the other the forces that fit the velocities, see `closed_gap`.
    It ends where the misfit is as small as wanted, or small enough and hardly falls any more, or has come to rest, or will not be
    small enough at the rate of the last pair, or a few stones fall, or the first pair goes astray; where the misfit grows
    instead, or no velocities are found, the answer given is returned, which need not have a motion ("failed"). Its multipliers,
    where it has any, are where the search begins; its forces are kept where they are in balance, with a load factor, and fit the
    first velocities found.
    """
    first = answer.outcome != "solved"
    known = 1.0 if first else abs(answer.load_factor)
    share = demands.fitting * max(known, program.least) / max(known, 1e-3)
    settings = SchemeSettings(bipotential_gap=share, stage_b=pairs)
    n = np.maximum(answer.forces[:, 0], 0.0)
    near, begun = None, None
    if answer.forces[:, 1:].any():
        # A motion that goes on from the last one is found from there, or it turns into another.
        near = Near(answer.forces, answer.y if len(answer.y) else None, only=first)
        if len(answer.y) and np.isfinite(answer.load_factor):
            gap = bipotential_gap(program, program.strength, answer.forces, answer.y)
            begun = CoulombState(answer.forces, answer.load_factor, answer.y, gap)

    seen: list[tuple[float, CoulombState]] = []
    resting, fallen = 0, False

    def enough(state: CoulombState) -> bool:
        nonlocal resting, fallen
        y, gap = state.y / float(program.live @ state.y), state.gap / max(abs(state.load_factor), program.least)
        rests = bool(seen) and gap > PATH.rests * seen[-1][0]
        resting = resting + 1 if rests else 0
        seen.append((gap, state))
        fallen = fall(y, gap, rests)
        far = len(seen) > 1 and gap > demands.far * demands.enough
        hopeless = far and _pairs_left(seen, demands.enough) > pairs - len(seen)
        astray = hopeless or (len(seen) == 1 and gap > demands.astray)
        return fallen or astray or (rests and gap <= demands.enough) or resting >= demands.resting

    run = closed_gap(program, program.strength, n, solve, settings, near=near, begun=begun, onward=demands.onward, enough=enough)
    if run is None:
        return answer
    best = run if fallen else min(seen, key=itemgetter(0))[1]
    y = best.y / float(program.live @ best.y)
    found = step_answer(program, program.slip(y), best.x, best.load_factor, y, answer.message)
    if first:
        return found
    given = bipotential_gap(program, program.strength, answer.forces, answer.y)
    return found if found.gap <= given else replace(answer, gap=given)


def _pairs_left(seen: list[tuple[float, CoulombState]], wanted: float) -> float:
    """Return how many more pairs lower a misfit to the one wanted at the rate of the last, infinite where it does not fall."""
    before, gap = seen[-2][0], seen[-1][0]
    return float(np.log(gap / wanted) / np.log(before / gap)) if gap < before else np.inf


def fitting_forces(program: StepProgram, answer: StepAnswer, solve: Solve) -> StepAnswer:
    """Return forces in balance that fit the motion of an answer, near its own, with their load factor ("failed": no motion yet).

    Such forces exist wherever the dead load is carried, and then velocities that fit them. Forces of the last step do not balance
    the stones where they are now, and need not have any.
    """
    settings, n = SchemeSettings(), np.maximum(answer.forces[:, 0], 0.0)
    nearness, duality_gap = settings.weight_b, settings.roughest
    found = nearest_forces(
        program, program.strength, n, answer.y, solve, nearness=nearness, duality_gap=duality_gap, x=answer.forces, only=True
    )
    return answer if found is None else replace(answer, forces=found.x, load_factor=found.tau)


def step_answer(
    program: StepProgram, sliding: FloatArray, x: FloatArray, load_factor: float, y: FloatArray, message: str = ""
) -> StepAnswer:
    """Return the answer of forces x (nc, 3) and a motion y (m,) whose sliding (nc,) the program charges, with what they lack."""
    strength, rate = program.strength, program.rates(y)
    n = np.maximum(x[:, 0], 0.0)
    excess = np.maximum(0.0, strength.friction * np.hypot(rate[:, 1], rate[:, 2]) - rate[:, 0] - sliding)
    # An elastic tie adds to the upper bound what it pulls with where it lengthens so, less the energy that it stores.
    elastic, pull = program.softness > 0, elastic_pull(program, strength, rate)
    upper = float(-program.dead @ y + np.where(elastic, pull, n) @ excess - 0.5 * program.softness @ pull**2)
    lower = load_factor - float(n @ (program.closing + sliding) + 0.5 * program.softness @ n**2)
    return StepAnswer(
        "solved",
        x,
        load_factor,
        y,
        residual=float(np.abs(program.residual(x, load_factor)).max()),
        violation=cone_violation(x, strength),
        bound_gap=abs(upper - lower) / max(abs(load_factor), 1e-3),
        gap=bipotential_gap(program, strength, x, y),
        least=program.least,
        message=message,
    )
