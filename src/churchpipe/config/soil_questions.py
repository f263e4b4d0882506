"""Questions about fill, soil and water: what they press on, how high, and what an earthquake makes of it."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from churchpipe.code_check import is_horizontal
from churchpipe.config.carries import Carries
from churchpipe.errors import InputError
from churchpipe.geometry.charts import lift
from churchpipe.loading.ends import unpressed_ends
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Panel
from churchpipe.model.carried import SURFACE

if TYPE_CHECKING:
    from churchpipe.config.case import Case

# Surfaces that are higher than a wall by more, m, are questioned.
_LEVEL = 0.01


def of_soil(case: "Case") -> Iterator[str]:
    """Yield what to ask about the fills and the pressures of a case."""
    yield from _of_fills(case)
    yield from _of_pressures(case)
    yield from _of_shaken_soil(case)


def end_questions(carries: Carries, stones: Assemblage) -> list[str]:
    """Return what to ask of stones on which soil or water presses: on which walls that stand in it does it not act?"""
    return [text for load in carries.pressures for text in unpressed_ends(stones, load)]


def _of_shaken_soil(case: "Case") -> Iterator[str]:
    """Yield what to ask where an earthquake is checked of walls on which soil or water presses: it presses harder then."""
    pushed = case.check is not None and any(is_horizontal(load.direction) for load in case.loads)
    if case.carries.pressures and pushed:
        names = ", ".join(dict.fromkeys(pressure.name or pressure.wall for pressure in case.carries.pressures))
        yield (
            f"An earthquake is checked, and [[pressures]] ({names}) are what the case gives, however hard it shakes: soil and "
            "water are not pushed, and press harder on a wall that falls away from them. Their coefficient has to be that of the "
            "earthquake (Mononobe and Okabe; NTC 2018, 7.11.6.2.1). Is it?"
        )


def _of_fills(case: "Case") -> Iterator[str]:
    """Yield what to ask where fill lies in other fill, not on the backing of its vault, or between walls that nothing presses
    on."""
    for (number, one), (later, other) in combinations(enumerate(case.carries.fills), 2):
        shared = [name for name in one.on if name in other.on]
        if shared and one != other:
            level = f"{min(one.top, other.top):g} m"
            yield (
                f"fills.{number} and fills.{later} both lie on {' and '.join(shared)}, and below z = {level} both count. "
                "Is it meant? In two layers the lower one has the difference of the unit weights."
            )
    parts: Sequence[str] = ()
    if case.carries.fills and hasattr(case.source, "generator"):
        with suppress(InputError):  # Told, with its line, where the building is made.
            parts = case.laid().macro_elements
    covered = {name for fill in case.carries.fills for name in fill.on}
    # Of a vault alone the backing has no name before it.
    bare = [part for part in parts if "backing" in part and part not in covered]
    bare = [part for part in bare if (part.partition("backing")[0].rstrip("_") or "vault") in covered]
    if bare:
        yield (
            f"[[fills]] lie on a vault and not on its backing, {', '.join(bare)}: what is above the backing is left out. "
            'Is it meant? "on" takes the names of all parts that fill lies on.'
        )
    given: dict[str, Any] = getattr(case.source, "parameters", {})
    alone = getattr(case.source, "generator", "") in ("vault", "dome") and not {"wall_height", "drum_height"} & given.keys()
    if case.carries.fills and not case.carries.pressures and not alone:
        yield (
            "[[fills]] press on what they lie on, and on nothing beside it. Loose fill pushes the walls of its vault outwards as "
            "well, and without that they come out too strong: [[pressures]] on each of them say it. Is it left out on purpose?"
        )


def _of_pressures(case: "Case") -> Iterator[str]:
    """Yield what to ask about soil or water whose surface is above the wall that it presses on."""
    panels: Sequence[Panel] = ()
    if case.carries.pressures and hasattr(case.source, "generator"):
        with suppress(InputError):  # Told, with its line, where the building is made.
            panels = case.laid().panels
    tops = {panel.name: float(lift(panel.chart, panel.outline)[:, 2].max()) for panel in panels}
    upper = case.storeys_above()
    pressed = {(pressure.wall, tuple(pressure.toward.tolist())) for pressure in case.carries.pressures}
    for number, pressure in enumerate(case.carries.pressures):
        top = tops.get(pressure.wall, np.inf)
        above, _ = upper.get(pressure.wall, ("", top))
        # Higher ones are questioned by themselves.
        if not top + _LEVEL < pressure.top <= SURFACE.high:
            continue
        if not above:
            yield (
                f"pressures.{number}.top_m is {pressure.top:g}, and {pressure.wall} ends at z = {top:.4g} m: what is higher "
                "would spill over the wall, and its weight is taken as one on the surface of what is below. Is it meant?"
            )
        elif (above, tuple(pressure.toward.tolist())) not in pressed:
            yield (
                f"pressures.{number}.top_m is {pressure.top:g}, and {pressure.wall} ends at z = {top:.4g} m, where {above} "
                f'begins: what presses on that is left out. Is it meant? [[pressures]] with wall = "{above}" say it.'
            )
