"""A capacity curve followed again with steps half as long: what it owes to its steps, and the check that takes both.

Without dilatancy more than one motion may fit the same stones. Where little decides between them, a curve with other steps goes
another way, and may end much earlier. One curve alone does not tell.
"""

from dataclasses import replace

import numpy as np

from churchpipe.code_check import Site
from churchpipe.displacement_check import displacement_check
from churchpipe.large_displacements.seats import lost_seat
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import ALIKE, BlockCapacityCurve, step_difference
from churchpipe.model.checks import UNRELIABLE, DisplacementCheck
from churchpipe.model.loads import LoadCase
from churchpipe.model.placed_loads import Applied
from churchpipe.wording import three_figures

# Curves further apart than this share of the first load factor are not one curve.
APART = 0.1
_WHOLE = "the curve with whole steps"


def careful_check(
    curve: BlockCapacityCurve,
    halved: BlockCapacityCurve | None,
    stones: Assemblage,
    load: LoadCase,
    site: Site | None,
    placed: Applied | None = None,
    *,
    crushing: bool = False,
) -> DisplacementCheck:
    """Return the displacement-based check of the curve, of the two, that withstands less, and in `halved` how they differ.

    halved: None where the curve was followed once. placed: what the stones carry, and their ties, of which joists may lose their
    seats; the rest as in `displacement_check`.
    """
    loads, ties = (placed.loads, placed.ties) if placed else (None, ())

    def checked(one: BlockCapacityCurve) -> DisplacementCheck:
        return displacement_check(one, stones, load, site, loads, crushing=crushing, seat=lost_seat(one, stones, ties))

    if halved is None:
        return checked(curve)
    found, other = checked(curve), checked(halved)
    if found.message or other.message:
        lead = other if found.message else found
    else:
        lead = min(found, other, key=lambda check: check.a_g_slv if np.isfinite(check.a_g_slv) else check.d0)
    which, left, why = ("it", "that with whole steps", found.message) if lead is other else (_WHOLE, "it", other.message)
    because = f"; of {left} there is none: {why.removeprefix('check: ')}" if why else ", which withstands no more."
    end, before = _end(halved), _end(curve)
    ends = f"It ends at {end}, too." if end == before else f"It ends at {end} instead of {before}."
    taken = "" if lead.message else f" The check takes {which}{because}"
    unproved = f"Of the curve with steps half as long: {lead.unproved}" if lead is other and lead.unproved else lead.unproved
    return replace(lead, unproved=unproved, halved=f"{_apart(curve, halved)} {ends}{taken}")


def _apart(curve: BlockCapacityCurve, halved: BlockCapacityCurve) -> str:
    share, place = step_difference(curve, halved)
    if not np.isfinite(share):
        return "With steps half as long the curve has no steps."
    if share < ALIKE:
        return "With steps half as long the curve is the same."
    at = f"at {three_figures(1e3 * place)} mm"
    told = f"With steps half as long the curve is up to {100 * share:.2g} % of its first load factor away, {at}."
    if share <= APART:
        return told
    return f"{told} More than one motion fits these stones, and little decides between them: {UNRELIABLE}."


def _end(curve: BlockCapacityCurve) -> str:
    end = curve.d0 if np.isfinite(curve.d0) else float(curve.displacement[-1]) if len(curve.displacement) else 0.0
    return f"{1e3 * end:.4g} mm"
