"""How many stones a building will have, counted before any is laid."""

from collections.abc import Mapping

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.building import BondRegion, Building

# In one ring. The largest masonry arches have some hundreds of voussoirs.
MOST_VOUSSOIRS = 1_000
TOO_MANY = "too many stones"


def check_count(building: Building) -> None:
    """Raise InputError for a building of too many stones. Their number is estimated from the size of the walls before any is
    laid.
    """
    counts = {panel.name: sum(map(_stones_about, panel.regions)) for panel in building.panels}
    counts |= {vault.name: float(vault.stone_count) for vault in building.vaults}
    check_counts(building.name, counts, building.most_stones)


def check_counts(name: str, counts: Mapping[str, float], most_stones: int) -> None:
    """Raise InputError where the walls and vaults of a building, by name, have more stones in all than it may have."""
    total = sum(counts.values())
    if total > most_stones:
        most = max(counts, key=counts.__getitem__)
        raise InputError(
            f"building {name}",
            TOO_MANY,
            found=f"about {total:,.0f}, of them {counts[most]:,.0f} in {most}",
            expected=f"at most {most_stones:,}",
            remedy="Look whether a length is in another unit (mm for m), or take larger stones. Where so many are meant, raise "
            "most_stones.",
        )


def _stones_about(region: BondRegion) -> float:
    if region.pieces or region.pattern == "single":
        return max(region.pieces, 1)
    length, height = np.ptp(region.outline, axis=0)
    return float(np.ceil(height / region.cell.a) * np.ceil(length / region.cell.b))
