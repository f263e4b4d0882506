"""Where the joists of floors lose their seats on a capacity curve."""

from collections.abc import Sequence

import numpy as np

from churchpipe.large_displacements.poses import Poses, screw
from churchpipe.large_displacements.travelling_ties import travelling_ties
from churchpipe.model.arguments import check_kind, listed
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.lost_seat import LostSeat
from churchpipe.model.ties import Tie


def lost_seat(curve: BlockCapacityCurve, stones: Assemblage, ties: Sequence[Tie]) -> LostSeat | None:
    """Return where the first of the joists among ties (`Tie.seated`) loses its seat on a curve of these stones; None: none does.

    It is pulled off its bearing where it has become longer by its ultimate elongation, between two steps in proportion, or falls
    with a stone that bears it.

    Raises
    ------
    InputError: arguments of the wrong kind.
    """
    check_kind("lost_seat: curve", curve, BlockCapacityCurve)
    check_kind("lost_seat: stones", stones, Assemblage)
    joists = [tie for tie in listed("lost_seat: ties", ties, Tie) if tie.seated]
    if not joists or not len(curve.displacement):
        return None
    travelling = travelling_ties(stones, joists)
    at = np.full(len(joists), np.inf)
    last = np.zeros(len(joists))
    for step, (centroid, rotation) in enumerate(zip(curve.position, curve.rotation, strict=True)):
        longer = travelling.lengths(Poses(centroid, screw(rotation)[0])) - travelling.drawn
        off = np.flatnonzero((longer >= travelling.ultimate) & np.isinf(at))
        at[off] = step - (longer[off] - travelling.ultimate[off]) / np.maximum(longer[off] - last[off], 1e-300)
        last = longer
    for part in curve.fallen:
        torn = np.unique(travelling.owner[np.isin(travelling.stone, part.stones)])
        at[torn] = np.minimum(at[torn], float(part.step))
    first = int(at.argmin())
    return LostSeat(joists[first].name, max(float(at[first]), 0.0)) if np.isfinite(at[first]) else None
