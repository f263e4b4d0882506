"""How many stones a building will have, counted before any is laid."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.building import BondRegion, Building

# The model of a building of this size takes about three gigabytes of memory before the first solve.
MOST_STONES = 500_000
# In one ring. The largest masonry arches have some hundreds of voussoirs.
MOST_VOUSSOIRS = 1_000


def check_count(building: Building) -> None:
    """Raise InputError for a building of too many stones. Their number is estimated from the size of the walls before any is
    laid.
    """
    counts = {panel.name: sum(map(_stones_about, panel.regions)) for panel in building.panels}
    counts |= {vault.name: float(vault.stone_count) for vault in building.vaults}
    total = sum(counts.values())
    if total > MOST_STONES:
        most = max(counts, key=counts.__getitem__)
        raise InputError(
            f"building {building.name}",
            "too many stones",
            found=f"about {total:,.0f}, of them {counts[most]:,.0f} in {most}",
            expected=f"at most {MOST_STONES:,}",
            remedy="Look whether a length is in another unit (mm for m), or take larger stones.",
        )


def _stones_about(region: BondRegion) -> float:
    if region.pieces or region.pattern == "single":
        return max(region.pieces, 1)
    length, height = np.ptp(region.outline, axis=0)
    return float(np.ceil(height / region.cell.a) * np.ceil(length / region.cell.b))
