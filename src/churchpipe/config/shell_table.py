"""The [shell] table of an imported drawing."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.planar import area, polygon
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Panel
from churchpipe.model.vault import Vault
from churchpipe.recognition.panels import FittedPanels, fit_panels
from churchpipe.recognition.stone_walls import cut_stones
from churchpipe.wording import counted

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


def shell_table(stones: Assemblage, elastic: Mapping[str, bool], joint: float | None = None) -> ShellTable:
    """Return the [shell] table for the stones of a drawing.

    elastic: whether each material has elastic constants, by its name. Without them the table asks for the limit load alone.
    joint: nominal width, m, of mortar joints that the stones leave open.
    """
    try:
        fitted = fit_panels(stones, joint=joint)
        fitted.building()
    except InputError as error:
        # Of all stones alike there is no place to name.
        where = "" if error.where == "stones" else f"{error.where}: "
        return ShellTable({}, f"No shell: {where}{error.problem}; the rigid blocks stand alone. {error.remedy}".rstrip())
    size = vault_size(fitted.vaults) if fitted.vaults else element_size(fitted.panels)
    used = {panel.material for panel in fitted.panels} | {vault.material for vault in fitted.vaults}
    complete = all(elastic[name] for name in used)
    keys = {"element_size_mm": float(f"{1e3 * size:g}"), "analyses": ["limit", "pushover"] if complete else ["limit"]}
    comment = "" if complete else '"pushover" besides: give each material its elastic constants'
    parts = [part for vault in fitted.vaults for part in vault.parts] or [panel.name for panel in fitted.panels]
    what = "A vault" if fitted.vaults else counted(len(parts), "wall")
    note = f"{what} fitted for the shell: {', '.join(parts)}."
    # Walls of one name that do not touch: it is the name of their stones that loads go by.
    if unnamed := [] if fitted.vaults else [name for name in parts if name not in fitted.panel]:
        note += f" No stones are called {', '.join(unnamed)}: a load on the name in the drawing reaches all walls that have it."
    if fitted.moved:
        note += f" {fitted.moved_words}"
    if len(fitted.unfit):
        few = ", ".join(fitted.unfit[:8])
        note += f" {counted(len(fitted.unfit), 'stone fits', 'stones fit')} none: {few}{' ...' if len(fitted.unfit) > 8 else ''}."
        cut = cut_stones(fitted.stones, fitted.panels, np.flatnonzero(np.isin(fitted.stones.block_id, fitted.unfit)))
        if len(cut):
            note += f" {len(cut)} of them lie in a round wall with corners off its two circles, as around an arched opening."
    return ShellTable(keys, note, comment, fitted)


def element_size(panels: Sequence[Panel]) -> float:
    """Return the size of elements, m, to begin with: three quarters of a stone, or more where the walls are large."""
    covered = sum(area(polygon(panel.outline)) for panel in panels)
    stone = min(region.cell.b for panel in panels for region in panel.regions)
    size = max(0.75 * stone, math.sqrt(3 * covered / ELEMENTS))
    return _rounded(size)


def vault_size(vaults: Sequence[Vault]) -> float:
    """Return the size of elements of vaults, m, to begin with: their lowest course, or more where they are large."""
    runs = [run for vault in vaults for run in vault.runs]
    covered = sum(run.volume.sum() * run.section.height / run.section.area for run in runs)
    # A rectangle of courses is four triangles.
    return _rounded(max(min(run.section.height for run in runs), math.sqrt(4 * covered / ELEMENTS)))


def _rounded(size: float) -> float:
    return round(size, 1 - math.floor(math.log10(size)))
