"""Which tie would help most: what each candidate adds to the load factor, from the mechanism, and from new analyses."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.loading.ties import anchors_of
from churchpipe.model.arguments import check_kind, listed, whole
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.motion import velocity_at
from churchpipe.model.results import LimitState
from churchpipe.model.ties import RankedTie, Tie
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.rigid_blocks.sensitivity import check_state_of


def elongation_rate(stones: Assemblage, velocities: FloatArray, tie: Tie) -> float:
    """Return how fast velocities (nb, 6) lengthen a tie, in their unit of length."""
    ends: list[float] = []
    for anchor in anchors_of(stones, tie):
        moved = velocity_at(stones, velocities, anchor.stone, anchor.point)
        ends.append(float(anchor.share @ moved @ tie.axis))
    return ends[1] - ends[0]


def rank_ties(
    state: LimitState,
    candidates: Sequence[Tie],
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    friction: npt.ArrayLike = 0.6,
    cohesion: npt.ArrayLike = 0.0,
    *,
    verify: int = 3,
    ties: Sequence[Tie] = (),
    **options: Any,
) -> tuple[RankedTie, ...]:
    """Return candidate ties by what they add to the load factor, best first.

    The rates need no new analysis: by virtual work a newton of strength adds as much as the mechanism found lengthens the tie.
    The best few are then analysed with the tie in place.

    Parameters
    ----------
    state
        The limit state of the structure without the candidates.
    candidates
        Ties that may be added, one at a time.
    stones, contacts, load, friction, cohesion
        The analysis of that state.
    verify
        How many of the best are analysed again.
    ties
        Ties that are there already.
    options
        Further arguments of `limit_analysis`.

    Returns
    -------
    tuple[RankedTie, ...]
        Verified ones first, by their load factor, the others by what they add at their rates.

    Raises
    ------
    InputError
        A state of other stones or of another load, or without a mechanism of the lateral load; candidates that are anchored in no
        stone.
    """
    check_kind("rank_ties: state", state, LimitState)
    check_kind("rank_ties: stones", stones, Assemblage)
    check_kind("rank_ties: contacts", contacts, Contacts)
    check_kind("rank_ties: load", load, LoadCase)
    candidates = listed("rank_ties: candidates", candidates, Tie)
    verify, ties = whole("rank_ties: verify", verify, least=0), listed("rank_ties: ties", ties, Tie)
    check_state_of("rank_ties", state, stones, contacts, load)
    if not np.isfinite(state.load_factor) or not np.isfinite(state.velocities).all():
        raise InputError("rank_ties: state", "no mechanism", found=state.status, expected="a state with a load factor")
    weight = float(stones.weight.sum())
    found: list[RankedTie] = []
    for tie in candidates:
        rate = max(0.0, elongation_rate(stones, state.velocities, tie)) / weight
        most = state.load_factor + rate * tie.strength if state.flow == "associative" else np.nan
        found.append(RankedTie(tie, rate, most))
    found.sort(key=lambda one: -one.rate * one.tie.strength)
    for number, one in enumerate(found[:verify]):
        with_it = limit_analysis(stones, contacts, load, friction, cohesion, ties=[*ties, one.tie], **options)
        found[number] = replace(one, load_factor=with_it.load_factor)
    best = sorted(found[:verify], key=lambda one: -np.nan_to_num(one.load_factor, nan=-np.inf))
    return (*best, *found[verify:])
