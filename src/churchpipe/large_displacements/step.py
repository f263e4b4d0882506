"""One program of a path: the load factor and the velocities of stones where they are now."""

from dataclasses import dataclass, field, replace

import numpy as np

from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram, Outcome
from churchpipe.conic.solve import Solve
from churchpipe.conic.wrenches import Balance, transpose
from churchpipe.model.arrays import FloatArray

# Error of the programs, whose velocities move the stones.
_DUALITY_GAP = 1e-7


@dataclass(frozen=True, slots=True)
class StepProgram:
    """What a load factor is sought for: the balance of displaced stones and the friction of their contact points.

    balance (m, 3 nc): what the forces of the points do to the stones; dead and live (m,) as in `Equilibrium`; friction (nc,).
    tie (nt,): the largest tension of the last points, which are ties, over the weight.
    """

    balance: Balance
    dead: FloatArray
    live: FloatArray
    friction: FloatArray
    tie: FloatArray = field(default_factory=lambda: np.zeros(0))

    def rates(self, y: FloatArray) -> FloatArray:
        """Return the rates (nc, 3) n, t1, t2 of multipliers y (m,)."""
        return transpose(self.balance, y)

    def slip(self, y: FloatArray) -> FloatArray:
        """Return the opening mu |v| (nc,) that sliding at this rate costs in the program."""
        rate = self.rates(y)
        return self.friction * np.hypot(rate[:, 1], rate[:, 2])


@dataclass(frozen=True, slots=True)
class StepAnswer:
    """The answer to one program: forces (nc, 3) over the weight, load factor, multipliers y (m,) with f_L . y = 1.

    residual, violation: of the balance and of the Coulomb cones, over the weight; bound_gap: kinematic against static bound of
    the program, over the load factor; gap: what the point forces would do against openings and against sliding that does not
    dissipate, per unit of work of the load: zero for a motion without dilatancy. "infeasible": y is how the stones fall.
    """

    outcome: Outcome
    forces: FloatArray
    load_factor: float
    y: FloatArray
    residual: float = np.nan
    violation: float = np.nan
    bound_gap: float = np.nan
    gap: float = np.nan
    message: str = ""


def solve_step(program: StepProgram, opening: FloatArray, closing: FloatArray, solve: Solve) -> StepAnswer:
    """Return the largest load factor less the work of the normal forces against `opening`, with its motion.

        maximise    tau - sum n_k opening_k
        subject to  balance + f_D + tau f_L = 0,   |t_k| <= mu n_k

    opening (nc,) >= 0: the rate at which a point may close, and what its sliding may open; closing (nc,): the former alone, the
    gap over the length of the step. So a point that stays open bears nothing (time-stepping, Anitescu 2006), and stones whose
    sliding is known slide without dilating.
    """
    zero = np.zeros_like(opening)
    first = len(zero) - len(program.tie)
    bound = np.append(np.full(first, np.inf), program.tie)
    cone = ConeProgram(program.balance, program.dead, program.live, zero, program.friction, opening, zero, bound=bound)
    answer = solve(cone, duality_gap=_DUALITY_GAP)
    if answer.outcome != "solved":
        return StepAnswer(answer.outcome, answer.x, np.nan, answer.y, message=answer.message)
    x, tau = restore_balance(cone, answer.x, answer.tau)
    power = float(program.live @ answer.y)
    y = answer.y / power
    rate = program.rates(y)
    slip = np.hypot(rate[:, 1], rate[:, 2])
    n, shear = np.maximum(x[:, 0], 0.0), np.hypot(x[:, 1], x[:, 2])
    excess = np.maximum(0.0, program.friction * slip - rate[:, 0] - opening)
    upper = float(-program.dead @ y + n @ excess)
    undissipated = np.maximum(program.friction * n * slip + (x[:, 1:] * rate[:, 1:]).sum(axis=1), 0.0)
    opened = n * np.minimum(np.abs(rate[:, 0]), np.abs(rate[:, 0] + closing))
    # A tie pulls at its strength while it lengthens, and not at all while it shortens or hangs slack.
    lengthens = -(rate[first:, 0] + closing[first:])
    opened[first:] = n[first:] * np.maximum(-lengthens, 0.0) + (program.tie - n[first:]) * np.maximum(lengthens, 0.0)
    return replace(
        StepAnswer("solved", x, tau, y, message=answer.message),
        residual=float(np.abs(cone.residual(x, tau)).max()),
        violation=float(
            max(
                (shear - program.friction * n).max(initial=0.0),
                (-x[:, 0]).max(initial=0.0),
                (x[first:, 0] - program.tie).max(initial=0.0),
            )
        ),
        bound_gap=abs(upper - (tau - float(n @ opening))) / max(abs(tau), 1e-3),
        gap=float((opened + undissipated).sum()),
    )
