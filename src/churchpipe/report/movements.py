"""Supports that move: reaction against movement, and crack maps, for the report."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.io.movement_record import ENDINGS, Movement
from churchpipe.large_displacements.cracks import path_cracks
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.quantities import in_unit
from churchpipe.model.settlement import SettlementPath
from churchpipe.report import colours
from churchpipe.report.cracks import counted_on, crack_map_svg
from churchpipe.report.plots import WIDTH, new_plot, svg_of
from churchpipe.report.table import figure, minus, named_of
from churchpipe.wording import three_figures

Moved = tuple[Movement, Assemblage, Contacts, SettlementPath]
# Walls with cracks of this share of the widest have a map, and so many of them.
_SHOWN, _MAPS = 0.05, 8


@dataclass(frozen=True, slots=True)
class MovementShown:
    """A movement as the report shows it: its name, a sentence, the plot of its reaction, rows of walls, maps (words, SVG)."""

    name: str
    sentence: str
    plot: str
    rows: list[list[str]]
    maps: list[tuple[str, str]]


def movements_shown(moved: Sequence[Moved]) -> list[MovementShown]:
    """Return the movements of a report, each with its record in summary.json, its stones, joints and path."""
    return [_shown(*one) for one in moved]


def _shown(record: Movement, stones: Assemblage, contacts: Contacts, path: SettlementPath) -> MovementShown:
    name = named_of(record.movement, record.variant, record.swept)
    if not len(path.movement):
        return MovementShown(name, f"It could not be moved: {path.message or path.status}.", "", [], [])
    rows = [[crack.place, figure(1e3 * crack.opening, 1), figure(1e3 * crack.slip, 1)] for crack in record.cracks]
    maps = _maps(record, stones, contacts, path)
    return MovementShown(name, _sentence(record, path), _reaction_svg(record), rows, maps)


def _sentence(record: Movement, path: SettlementPath) -> str:
    (movement, length), (reaction, force) = in_unit(record, "displacement"), in_unit(record, "reaction")
    least, _ = in_unit(record, "least_reaction")
    if max(least, reaction[0]) >= 0:
        # Of two values of what the support must resist with, the larger comes first.
        pushed = ", below zero: it must be pushed along" if least < 0 else ""
        words = (
            f"As it begins to move the support must resist with {max(least, reaction[0]):.4g} {force}, without dilatancy; other "
            f"forces may fit the same motion. The least of all equilibria is {minus(f'{least:.4g}')} {force}{pushed}, with "
            "associative friction: the value to take where the question is how much the rest of the building then carries. "
            "A support that does not give way may bear many times as much"
        )
    else:
        words = (
            f"As it begins to move the support must be pushed along with {-least:.4g} {force} at most "
            f"({-reaction[0]:.4g} {force} without dilatancy)"
        )
    end = f". At {movement[-1]:.4g} {length} {ENDINGS[path.status]}"
    fallen = f". Stones that fell on the way: {', '.join(record.fallen_stones)}" if record.fallen_stones else ""
    return " ".join([f"{words}{end}{fallen}.", *(f"{remark[0].upper()}{remark[1:]}." for remark in record.left_out)])


def _reaction_svg(record: Movement) -> str:
    (movement, length), (reaction, force) = in_unit(record, "displacement"), in_unit(record, "reaction")
    plot, (axes,) = new_plot(1, (WIDTH, 2.6))
    axes.plot(movement, reaction, "-o", ms=2.5, lw=1.4, color=colours.PUSH)
    axes.set_xlabel(f"movement, {length}", fontsize=8)
    axes.set_ylabel(f"reaction, {force}", fontsize=8)
    axes.set_xlim(left=0)
    # Room for the marks at the edges, also of a reaction that hardly changes.
    room = 0.06 * max(map(abs, reaction))
    axes.set_ylim(min(0.0, min(reaction) - room), max(0.0, max(reaction) + room) or 1.0)
    return svg_of(plot)


def _maps(record: Movement, stones: Assemblage, contacts: Contacts, path: SettlementPath) -> list[tuple[str, str]]:
    """Return crack maps of the walls that crack most, at the first step and at the last one."""
    movement, length = in_unit(record, "displacement")
    widest = max((crack.opening for crack in record.cracks), default=0.0)
    walls = [crack.wall for crack in record.cracks if crack.opening > _SHOWN * widest][:_MAPS]
    bears = ~stones.fixed[contacts.blocks].all(axis=1)
    maps: list[tuple[str, str]] = []
    for wall in walls:
        for step in dict.fromkeys((min(1, len(path.movement) - 1), len(path.movement) - 1)):
            opening, _ = path_cracks(stones, contacts, path, step)
            drawn = crack_map_svg(stones, contacts, np.where(bears, opening, 0.0), wall)
            if drawn:
                words = f"{wall or 'Stones of no wall'}, movement {three_figures(movement[step])} {length}"
                maps.append((f"{words}; lengths {counted_on(stones, wall)}", drawn))
    return maps
