"""Variants of a building that come out weaker than it for no other reason than that states without dilatancy are not unique."""

import math
from collections.abc import Sequence

from churchpipe.io.records import Analysis
from churchpipe.wording import counted

# A load factor is lower from this share on: intervals of states without dilatancy are as wide.
_LOWER = 0.01
# So many sentences.
_FEW_LINES = 2


def weaker_variants(analyses: Sequence[Analysis]) -> list[str]:
    """Return sentences on variants whose load factor is below that of the building as it is without dilatancy alone.

    By the associative analysis, whose load factor is unique, they are no weaker.
    """
    found: dict[str, dict[tuple[str | None, str | None], float]] = {}
    for one in analyses:
        if one.stands:
            asked = found.setdefault(f"{one.load} {one.contact_model} {one.swept}", {})
            asked[one.variant, one.flow] = one.load_factor
    said: list[str] = []
    for one in analyses:
        of = found.get(f"{one.load} {one.contact_model} {one.swept}", {})
        if one.variant is None or one.flow != "non-associative" or not one.stands:
            continue
        bound, least = (of.get((name, "associative"), math.nan) for name in (one.variant, None))
        whole = of.get((None, "non-associative"), math.nan)
        if one.load_factor < whole * (1 - _LOWER) and bound > least * (1 - _LOWER):
            said.append(
                f"{one.variant}, load {one.load}: without dilatancy {one.load_factor:z.4f} is below the {whole:z.4f} of the "
                "building as it is, and the associative load factor is not. Values without dilatancy are not unique: the "
                "building as it is may have states as low. Where the variant only adds to it, use the lower value for both."
            )
    more = len(said) - _FEW_LINES
    return said[:_FEW_LINES] + (
        [f"So it is with {counted(more, 'other variant or load', 'other variants or loads')}."] if more > 0 else []
    )
