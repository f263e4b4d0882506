"""Tolerances and limits of the interior-point loop, checked."""

from dataclasses import dataclass, replace

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_constants


@dataclass(frozen=True, slots=True)
class Settings:
    """How far to go, and how.

    duality_gap: relative error of the objective aimed at (gap, complementarity and the work of residuals); acceptable: error at
    which a solve that got stuck still counts as solved; residual: of the balance, relative to the loads on each body;
    certificate: residual of a certificate of infeasibility or of a ray, relative to what it proves; iterations: at most;
    correctors: centrality correctors tried at an iteration (Gondzio 1996); ignored: share of the cones, those that
    would end a step first, that are left out of account when directions are judged; fraction: share of the way to the boundary;
    regularisation: of the normal matrix, relative to its diagonal; refinements: of each linear solve, at most;
    balanced: whether the forces are wanted in balance, or the multipliers alone, which then close no point that cannot close
    faster than `duality_gap` times the fastest rate; nearly: forces near enough to the optimum that are out of balance by no
    more than this share of the loads are balanced at once, which costs a few solves where steps towards the balance cost as many
    iterations; nearest: a solve is given up where the homogenising variable falls below this, 0 for never, since the solution,
    if there is one, is then larger than where the solve began by one over this;
    force, rate: size of the starting forces (in the load of a body that each touches) and of the multipliers (in those
    that earn the reward).
    """

    duality_gap: float = 5e-7
    acceptable: float = 5e-7
    residual: float = 1e-7
    certificate: float = 1e-7
    iterations: int = 150
    correctors: int = 4
    ignored: float = 1e-3
    fraction: float = 0.99
    regularisation: float = 1e-14
    refinements: int = 3
    balanced: bool = True
    nearly: float = 0.0
    nearest: float = 0.0
    force: float = 10.0
    rate: float = 0.01

    def __post_init__(self) -> None:
        zero = ("correctors", "ignored", "refinements", "regularisation", "nearly", "nearest")
        check_constants(self, may_be_zero=zero, below_one=("fraction", "ignored", "nearest"))
        if not self.regularisation < 1e-4:
            raise InputError("Settings.regularisation", "out of range", found=self.regularisation, expected="< 1e-4")


# For programs whose forces and velocities are wanted, not only their value: iterates that keep to the central path.
CENTRAL = Settings(acceptable=2e-7, correctors=12, ignored=0.0, rate=1.0)
# For programs of which the velocities alone are wanted: the balance of the forces may lag behind.
VELOCITIES = replace(CENTRAL, residual=0.03, balanced=False, correctors=2, ignored=2e-3)
# Points that stop short leave errors of the multipliers that later steps hardly remove: no more such points than this share, over
# the duality gap wanted. Where they are fewer, centrality correctors have to lengthen the steps.
_ERROR_LEFT = 200.0
# A solve that was begun near a solution is given up after so many iterations, unless it is to be exact and nearly is. One that is
# to be begun there only is also given up where the solution, if there is one, is ten times larger.
WARM_ITERATIONS = 30
FAR = 0.1
# What is out of balance by less is balanced at once, in a rough solve that was begun near a solution. Others need what the steps
# towards the balance do for the centre of all optimal forces.
NEARLY = 0.05
# The duality gap of an exact solve, at most.
CLOSE = 1e-5


def with_duality_gap(settings: Settings, duality_gap: float) -> Settings:
    """Return settings with this duality gap, where a small one lets fewer points stop short and has more correctors."""
    ignored = min(settings.ignored, _ERROR_LEFT * duality_gap)
    correctors = settings.correctors if ignored == settings.ignored else CENTRAL.correctors
    return replace(settings, duality_gap=duality_gap, ignored=ignored, correctors=correctors)
