"""The load factor at which a structure with elastic ties begins to move: as drawn these have their pretension alone."""

from collections.abc import Callable, Sequence

import numpy as np

from churchpipe.large_displacements.poses import start_poses
from churchpipe.large_displacements.travelling_ties import travelling_ties
from churchpipe.loading.wrenches import wrenches_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase, replaced
from churchpipe.model.results import LimitState
from churchpipe.model.ties import Tie


def pretensioned(stones: Assemblage, load: LoadCase, ties: Sequence[Tie]) -> tuple[LoadCase, list[Tie]]:
    """Return a load case with the pretensions of elastic ties among its dead loads, and the ties that have no stiffness.

    Raises
    ------
    InputError: as `anchors_of`.
    """
    elastic, rigid = ([tie for tie in ties if (tie.stiffness is None) == stiff] for stiff in (False, True))
    bars = travelling_ties(stones, elastic)
    spans = bars.spans(start_poses(stones))
    pull = bars.pretension[:, None] * spans / np.linalg.norm(spans, axis=1, keepdims=True)
    # The share is negative at the start of a bar, which pulls there along its span.
    force = -bars.share[:, None] * pull[bars.owner]
    wrench = wrenches_of(stones.centroid, stones.centroid[bars.stone] + bars.arm, force, bars.stone)
    return replaced(load, dead=wrench if load.dead is None else load.dead + wrench), rigid


def first_load_factor(
    stones: Assemblage,
    load: LoadCase,
    ties: Sequence[Tie],
    analysed: Callable[..., LimitState],
    *,
    exactly: bool,
) -> float:
    """Return the load factor that ties bear as drawn, infinite where none of them is elastic or no state is known.

    A step of a curve may begin with the tensions that its motion stretches ties to, since only these may fit the motion; then
    its load factor is that of the end of the step. As drawn no more than this one is borne.

    Parameters
    ----------
    analysed
        `limit_analysis`, to be given stones, and load, ties and flow by name.
    exactly
        Whether to ask for the load factor without dilatancy as well; the associative one is no lower.
    """
    if all(tie.stiffness is None for tie in ties):
        return np.inf
    held, rigid = pretensioned(stones, load, ties)
    found: list[float] = []
    for flow in ("associative", "non-associative")[: 1 + exactly]:
        state = analysed(stones, load=held, ties=rigid, flow=flow)
        if state.status not in ("optimal", "converged") or not state.load_factor > 0:
            break
        found.append(state.load_factor)
    return min(found, default=np.inf)
