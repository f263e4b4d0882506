"""The [shell] table of an imported drawing."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from churchpipe.errors import InputError
from churchpipe.geometry.planar import area, polygon
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Panel
from churchpipe.recognition.panels import FittedPanels, fit_panels

# Elements of a first mesh: enough to see the mechanism; a limit load takes half a minute, a capacity curve some minutes.
ELEMENTS = 3000


@dataclass(frozen=True, slots=True)
class ShellTable:
    """The keys of a [shell] table (none when no wall fits the stones), what the user should know, a comment on `analyses`, and
    the panels that were fitted, None where there is no shell."""

    keys: Mapping[str, Any]
    note: str
    comment: str = ""
    fitted: FittedPanels | None = None


def shell_table(stones: Assemblage, elastic: Mapping[str, bool]) -> ShellTable:
    """Return the [shell] table for the stones of a drawing.

    elastic: whether each material has elastic constants, by its name. Without them the table asks for the limit load alone.
    """
    try:
        fitted = fit_panels(stones)
    except InputError as error:
        return ShellTable({}, f"No shell: {error.problem}; the rigid blocks stand alone. {error.remedy}")
    size = element_size(fitted.panels)
    used = {panel.material for panel in fitted.panels}
    complete = all(elastic[name] for name in used)
    keys = {"element_size_mm": float(f"{1e3 * size:g}"), "analyses": ["limit", "pushover"] if complete else ["limit"]}
    comment = "" if complete else '"pushover" besides: give each material its elastic constants'
    note = f"{len(fitted.panels)} walls fitted for the shell: {', '.join(panel.name for panel in fitted.panels)}."
    if len(fitted.unfit):
        few = ", ".join(fitted.unfit[:8])
        note += f" {len(fitted.unfit)} stones fit none: {few}{' ...' if len(fitted.unfit) > 8 else ''}."
    return ShellTable(keys, note, comment, fitted)


def element_size(panels: Sequence[Panel]) -> float:
    """Return the size of elements, m, to begin with: three quarters of a stone, or more where the walls are large."""
    covered = sum(area(polygon(panel.outline)) for panel in panels)
    stone = min(region.cell.b for panel in panels for region in panel.regions)
    size = max(0.75 * stone, math.sqrt(3 * covered / ELEMENTS))
    digits = 1 - math.floor(math.log10(size))
    return round(size, digits)
