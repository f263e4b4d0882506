"""Constants of the analyses without dilatancy, checked. How they were chosen: docs/development.md."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_constants

# The gap g / alpha at which a state is certified.
BIPOTENTIAL_GAP = 1e-5
# Searches of one model whose starts differ by rounding end up to 1.3 % of the load factor apart (S22, docs/validation.md).
SEARCH_SPREAD = 1.5e-2


@dataclass(frozen=True, slots=True)
class PaperSettings:
    """Constants of the paper's iteration, its eq. (3).

    beta: share of the newest normal forces in the mixture that limits friction. cohesion: fictitious, c0, as a share of the
    largest normal force; slope: fictitious friction, xi. The paper prints c0 = 1e-4 and xi up to 1e-2; the values here are as
    robust and ten times less biased. xi caps compression at c / (xi mu), so c0 / xi must be 1e-2 or more. tolerance: change of
    the load factor, relative, at which the iteration ends. iterations: at most.

    Raises
    ------
    InputError: a constant that is not positive, beta or slope of one or more, c0 / xi below 1e-2.
    """

    beta: float = 0.6
    cohesion: float = 1e-5
    slope: float = 1e-3
    tolerance: float = 1e-3
    iterations: int = 40

    def __post_init__(self) -> None:
        check_constants(self, below_one=("beta", "slope", "tolerance"))
        if self.cohesion / self.slope < 0.01 * (1.0 - 1e-9):
            found = f"{self.cohesion:g} / {self.slope:g}"
            raise InputError(
                "PaperSettings.cohesion", "compression would be capped", found=found, expected="cohesion / slope >= 0.01"
            )


@dataclass(frozen=True, slots=True)
class CentralSettings:
    """Constants of the run from the centre of the cones (`central.py`, `contact_newton.py`).

    force: the first normal force of a point, over the mean weight that a point would carry alone. roundness: how round the
    multipliers are where a point neither opens nor slides; other_roundness: that of the second run.
    damping: of the steps, least and most. pull: towards low load factors, over the sum of the products. correctors: of
    centrality, at most. inner, inner_steps: error and steps of the conjugate gradients. clip: a correction of the second order
    counts at most this share of the mean product. fraction: of the way to the boundary of the cones that a step goes. steps: at
    most; patience: steps without half the gap after which a run stops, less patient once the gap is below `near`: then stage B
    may close it from there, its programs solved to `duality_gap`, so that velocities overlap nowhere, with a proximal weight
    `nearness` times the gap and a `momentum` of its own (`SchemeSettings`), for at most `polish` steps, and while at the rate of
    the last one no more than `light_outlook` others are needed. The gap is concave in the forces, so that a step that nothing
    holds back lowers it most. A run whose gap is below `foreseen` is left where at the rate of its last steps it would need
    more than `outlook` others, which cost what a pair of programs costs that closes it from there. Where the pair does not, the
    run goes on if it needs no more than `resumed` others, and may be left again where the gap has fallen to the share `again`.
    whole_patience: of the last run, in which no point stops short and stage B has the constants of other searches.
    blocked, held, ignored: after a step shorter than the first, points that are left behind are released from their rates
    (`central_steps.py`). From so many short steps on, the second number where points were released, far from a state as yet,
    this share of the points is left out of account when directions are judged, most_ignored points at most, since a few joints
    hold a step however large the model. They stop short and leave errors, so that such a run is handed on to stage B where its
    gap falls below `handed_on`.

    roundness, damping and clip were chosen on the walls of Ferris and Tin-Loi, S5 and S22, pull on these for the lowest load
    factors, with the facade of one storey at friction .7 as a check.
    """

    force: float = 10.0
    roundness: float = 0.5
    other_roundness: float = 1.0
    damping: tuple[float, float] = (0.01, 0.1)
    pull: float = 0.2
    correctors: int = 5
    inner: float = 1e-2
    inner_steps: int = 40
    clip: float = 0.5
    fraction: float = 0.95
    steps: int = 120
    patience: tuple[int, int] = (15, 5)
    whole_patience: tuple[int, int] = (15, 8)
    blocked: float = 0.25
    held: tuple[int, int] = (2, 4)
    ignored: float = 1e-3
    most_ignored: int = 16
    handed_on: float = 3e-3
    outlook: float = 10.0
    resumed: float = 40.0
    again: float = 0.1
    foreseen: float = 1e-3
    near: float = 1e-2
    polish: int = 12
    nearness: float = 0.02
    momentum: float = 0.1
    light_outlook: float = 4.0
    duality_gap: float = 5e-7

    def __post_init__(self) -> None:
        shares = ("pull", "inner", "clip", "fraction", "blocked", "ignored", "handed_on", "foreseen", "near", "momentum")
        check_constants(self, below_one=shares)


@dataclass(frozen=True, slots=True)
class SchemeSettings:
    """Constants of the certified scheme.

    Stage A looks for normal forces that hardly overdraw friction. stage_a: its steps, at most. violation, change: it ends when
        no more than this share of the friction is overdrawn, or when the load factor changes by no more than this share.
        weight_a: its proximal weight, which keeps a step near the forces before it. cohesion: fictitious, over the largest
        normal force; more_cohesion: over the largest load, tried in turn where the start carries too little of the dead load.
    Stage B alternates between velocities and forces. stage_b: its steps, at most; patience: steps without half the gap after
        which it gives up; outlook: it gives up where it needs more further steps at the rate of the last one. weight_b: its
        proximal weight, at most `nearness` times the gap, so that keeping near costs less than what is left to gain. momentum:
        share of its last step that a step goes on by, at most. slow: a weighted gap above this share of the last one is slow.
        worse: above so many times the least gap the search returns to where that was found. stuck, stuck_weight: where the gap
        no longer falls, points that add more than the first share of it count so many times more from then on.
    Convex programs are solved to `share` of the gap that is left, at least to `roughest` and at most to `duality_gap`: the gap
        is computed from the arrays, whatever made them.
    close: a search for a state lower than a known one is left where its gap falls below this at a load factor that is not lower.
    bipotential_gap: g / alpha at which the search ends.

    stage_b, momentum, weight_a, weight_b, stuck, stuck_weight and nearness were chosen on S5, S22, the walls of Ferris and
    Tin-Loi and the church. `tests/validation/test_untuned_models.py` holds the scheme on models that had no part in the choice.

    Raises
    ------
    InputError: a constant that is not positive, or a share of one or more.
    """

    stage_a: int = 15
    stage_b: int = 60
    patience: int = 60
    outlook: float = np.inf
    violation: float = 1e-4
    change: float = 5e-3
    bipotential_gap: float = BIPOTENTIAL_GAP
    weight_a: float = 0.3
    weight_b: float = 0.003
    nearness: float = 5.0
    cohesion: float = 1e-5
    more_cohesion: tuple[float, ...] = (1e-3, 1e-1)
    momentum: float = 0.6
    slow: float = 0.9
    worse: float = 1.5
    stuck: float = 0.03
    stuck_weight: float = 10.0
    duality_gap: float = 1e-6
    share: float = 0.03
    roughest: float = 1e-3
    close: float = 1e-3

    def __post_init__(self) -> None:
        shares = ("violation", "change", "momentum", "slow", "stuck", "share", "roughest", "close")
        check_constants(self, below_one=("bipotential_gap", "duality_gap", *shares))
