"""How many elements the mesh of a building will have, counted before it is made."""

from collections.abc import Sequence

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.building import Building, Panel
from churchpipe.model.vault import Vault

# Far more than can be solved. Such a mesh takes minutes and some gigabytes.
MOST_ELEMENTS = 1_000_000


def element_count(building: Building, size: float) -> float:
    """Return about how many elements of a size, m, the walls and the vaults of a building will have."""
    # One that is above zero in millimetres may be zero in metres.
    size = max(size, float(np.finfo(float).tiny))
    return wall_elements(building.panels, [size] * len(building.panels)) + vault_elements(building.vaults, size)


def wall_elements(panels: Sequence[Panel], sizes: Sequence[float]) -> float:
    """Return the number for walls, each with a size: two triangles fill a square of it."""
    return sum(2 * float(np.ptp(panel.outline, axis=0).prod()) / size / size for panel, size in zip(panels, sizes, strict=True))


def vault_elements(vaults: Sequence[Vault], size: float) -> float:
    """Return the number for vaults. The area of a mid-surface is about the volume over the thickness."""
    runs = [run for vault in vaults if vault.shell != "bodies" for run in vault.runs]
    return sum(4 * float(run.volume.sum()) * run.section.height / run.section.area for run in runs) / size / size


def check_elements(count: float, size: float) -> None:
    """Raise InputError where there are more elements than can be solved."""
    if count > MOST_ELEMENTS:
        raise InputError(
            "element size",
            "too small for this building",
            found=f"about {count:,.0f} elements of {size:g} m",
            expected=f"at most {MOST_ELEMENTS:,}",
            remedy="Make it larger, or look whether a length is in another unit (mm for m).",
        )


def check_longest(panels: Sequence[Panel], size: float, where: str = "element size") -> None:
    """Raise InputError where elements are longer than every wall."""
    longest = max((float(np.ptp(panel.outline, axis=0).max()) for panel in panels), default=np.inf)
    if size > longest:
        raise InputError(where, "longer than every wall", found=size, expected=f"at most {longest:g} m")
