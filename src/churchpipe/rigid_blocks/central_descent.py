"""The steps of a run from the centre one after another, until a state is certified, or programs may close the gap sooner.

A run that was left may go on later from where it was.
"""

import numpy as np

from churchpipe.conic.cholesky import NotDefiniteError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.progress import Progress
from churchpipe.model.results import Iteration
from churchpipe.rigid_blocks.central_start import first_rates
from churchpipe.rigid_blocks.central_steps import advance
from churchpipe.rigid_blocks.certificate import FLOW_TOLERANCE, RESIDUAL_TOLERANCE, Strength
from churchpipe.rigid_blocks.contact_newton import ContactState, ContactSystem
from churchpipe.rigid_blocks.coulomb import CoulombState, bipotential_gap
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.iterations import SlidingRun, sliding_run
from churchpipe.rigid_blocks.settings import CentralSettings

# Steps whose mean tells how fast the gap falls.
_LAST_STEPS = 3


class Descent:
    """A run from the centre, and how far it has come.

    nearest: the state with the least gap, exact or not, None without one.
    """

    def __init__(
        self,
        balance: Equilibrium,
        strength: Strength,
        wanted: float,
        settings: CentralSettings,
        progress: Progress | None = None,
        *,
        short: bool,
    ) -> None:
        """wanted: g / alpha at which the run ends; short: whether a few points may stop short where they hold the steps."""
        self._balance, self._strength, self._wanted = balance, strength, wanted
        self._settings, self._progress, self._short = settings, progress, short
        self._system = ContactSystem(balance, strength, settings)
        self._at: ContactState | None = None
        self._damping, self._ignored = settings.damping[0], 0
        self._steps = 0
        # Short steps so far, whether the last one was, and the points left behind that are not to be released.
        self._shorts, self._blocked, self._kept = 0, False, np.zeros(self._system.points, bool)
        self._gaps: list[float] = []
        self._history: list[Iteration] = []
        self._best: CoulombState | None = None
        # The step at which the gap was last halved, and the gap then; the gap at which the run was last left.
        self._halved, self._mark, self._left = 0, np.inf, np.inf
        self.nearest: CoulombState | None = None

    @property
    def factorisations(self) -> int:
        """Number of factorisations so far."""
        return self._system.factorisations

    @property
    def run(self) -> SlidingRun | None:
        """The run to its best exact state, None without one."""
        return None if self._best is None else sliding_run(self._best, self._history, 0, self.factorisations)

    def lower(self) -> bool:
        """Lower the products until the run arrives, stops or is to be left; say whether it is worth going on with."""
        settings = self._settings
        try:
            if self._at is None:
                self._at = first_rates(self._system)
                self._look(self._at)
            while self._steps < settings.steps and not self._arrived():
                near = self.nearest is not None and self.nearest.relative_gap <= settings.near
                if self._steps - self._halved > settings.patience[near]:
                    return False
                if self._short and self._to_be_left():
                    self._left = self._gaps[-1]
                    return steps_left(self._gaps, self._wanted) <= settings.resumed
                if self._progress:
                    self._progress("non-associative", self._steps / settings.steps)
                with np.errstate(all="ignore"):
                    move = advance(self._system, self._at, self._damping, self._ignored, self._kept if self._blocked else None)
                self._damping = min(max(self._damping * move.stiffer, settings.damping[0]), settings.damping[1])
                blocked = move.length < settings.blocked
                self._shorts += blocked
                self._blocked, self._kept = blocked, move.kept
                if self._short and blocked and self._shorts >= settings.held[move.released > 0] and not near:
                    self._ignored = min(int(settings.ignored * self._system.points), settings.most_ignored)
                if not (np.isfinite(move.at.forces).all() and np.isfinite(move.at.rates).all()):
                    return False
                self._at, self._steps = move.at, self._steps + 1
                self._look(self._at)
        except NotDefiniteError:
            pass
        return False

    def _look(self, at: ContactState) -> None:
        """Measure a state and remember it where it is the best."""
        state = _coulomb_state(self._balance, self._strength, at)
        self._gaps.append(state.relative_gap)
        exact = _exact(self._system, at)
        if not exact and not self._ignored:
            return
        self._history.append(Iteration(state.load_factor, 0.0, state.relative_gap))
        if state.gap < 0.5 * self._mark:
            self._halved, self._mark = self._steps, state.gap
        if self.nearest is None or state.gap < self.nearest.gap:
            self.nearest = state
        if exact and (self._best is None or state.gap < self._best.gap):
            self._best = state

    def _arrived(self) -> bool:
        """Say whether the gap is closed, by forces and velocities that are exact or, where points stop short, nearly."""
        state = self.nearest if self._ignored else self._best
        return state is not None and state.relative_gap <= self._wanted

    def _to_be_left(self) -> bool:
        """Say whether a pair of programs may close the gap sooner, which must have fallen since it was last tried."""
        settings, gap = self._settings, self._gaps[-1]
        if gap > settings.again * self._left:
            return False
        handed_on = self._ignored and gap <= settings.handed_on
        return bool(handed_on) or falls_too_slowly(self._gaps, self._wanted, settings)


def falls_too_slowly(gaps: list[float], wanted: float, settings: CentralSettings) -> bool:
    """Say whether at the rate of the last steps the gap would be closed later than a pair of programs closes it."""
    return wanted < gaps[-1] <= settings.foreseen and len(gaps) > _LAST_STEPS and steps_left(gaps, wanted) > settings.outlook


def steps_left(gaps: list[float], wanted: float) -> float:
    """Return how many steps close the gap at the rate of the last ones, infinite where it does not fall."""
    if len(gaps) <= _LAST_STEPS or gaps[-1] >= gaps[-1 - _LAST_STEPS]:
        return np.inf
    return float(_LAST_STEPS * np.log(gaps[-1] / wanted) / np.log(gaps[-1 - _LAST_STEPS] / gaps[-1]))


def _coulomb_state(balance: Equilibrium, strength: Strength, at: ContactState) -> CoulombState:
    """Return the state in the units of the certificate."""
    x: FloatArray = np.ascontiguousarray(np.stack([at.forces[0] / strength.friction, at.forces[1], at.forces[2]], axis=1))
    y = at.y / float(balance.live @ at.y)
    return CoulombState(x, at.load_factor, y, bipotential_gap(balance, strength, x, y))


def _exact(system: ContactSystem, at: ContactState) -> bool:
    """Say whether the forces balance and no point closes."""
    closing = -float(system.rates(at.y)[0].min(initial=0.0))
    return float(np.abs(system.residual(at)).max()) <= RESIDUAL_TOLERANCE and closing <= FLOW_TOLERANCE
