"""Supports that move: reaction against movement, and crack maps, for the report."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.large_displacements.cracks import joint_cracks
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.settlement import SettlementPath
from churchpipe.report import colours
from churchpipe.report.cracks import crack_map_svg
from churchpipe.report.plots import new_plot, svg_of
from churchpipe.report.table import figure

Moved = tuple[Mapping[str, Any], Assemblage, Contacts, SettlementPath]
_ENDINGS = {
    "collapsed": "the structure collapses",
    "free": "nothing rests on the support any more and the structure stands without it",
    "unfinished": "it was not followed further",
    "unbounded": "the stones hold the support fast",
    "not-converged": "a step was not solved",
}
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


def _shown(record: Mapping[str, Any], stones: Assemblage, contacts: Contacts, path: SettlementPath) -> MovementShown:
    name = str(record["movement"])
    if not len(path.movement):
        return MovementShown(name, f"It could not be moved: {path.message or path.status}.", "", [], [])
    rows = [[wall["wall"], figure(wall["opening_mm"], 1), figure(wall["slip_mm"], 1)] for wall in record["cracks"]]
    maps = _maps(record, stones, contacts, path)
    return MovementShown(name, _sentence(record, path), _reaction_svg(record), rows, maps)


def _keys(record: Mapping[str, Any]) -> tuple[str, str, str, str]:
    """Return the keys of movement and reaction, and their units."""
    return ("movement_deg", "reaction_kNm", "degrees", "kNm") if record["turns"] else ("movement_mm", "reaction_kN", "mm", "kN")


def _sentence(record: Mapping[str, Any], path: SettlementPath) -> str:
    movement, reaction, length, force = _keys(record)
    least, first = record[f"least_{reaction}"], record[reaction][0]
    kept = f"keeps {least:.4g} {force} at least" if least >= 0 else f"must be pushed along with {-least:.4g} {force} at most"
    words = f"The support {kept} as it begins to move ({abs(first):.4g} {force} without dilatancy)"
    end = f"; at {record[movement][-1]:.4g} {length} {_ENDINGS[path.status]}"
    fallen = f". Stones that fell on the way: {', '.join(record['fallen_stones'])}" if record["fallen_stones"] else ""
    return f"{words}{end}{fallen}." + (" Ties are left out." if "ties are left out" in record["message"] else "")


def _reaction_svg(record: Mapping[str, Any]) -> str:
    movement, reaction, length, force = _keys(record)
    plot, (axes,) = new_plot(1, (7.2, 2.8))
    axes.plot(record[movement], record[reaction], "-o", ms=2.5, lw=1.4, color=colours.PUSH)
    axes.set_xlabel(f"movement, {length}", fontsize=8)
    axes.set_ylabel(f"reaction, {force}", fontsize=8)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=min(0.0, *record[reaction]))
    return svg_of(plot)


def _maps(record: Mapping[str, Any], stones: Assemblage, contacts: Contacts, path: SettlementPath) -> list[tuple[str, str]]:
    """Return crack maps of the walls that crack most, at the first step and at the last one."""
    movement, _, length, _ = _keys(record)
    widest = max((wall["opening_mm"] for wall in record["cracks"]), default=0.0)
    walls = [wall["wall"] for wall in record["cracks"] if wall["opening_mm"] > _SHOWN * widest][:_MAPS]
    bears = ~stones.fixed[contacts.blocks].all(axis=1)
    maps: list[tuple[str, str]] = []
    for wall in walls:
        for step in dict.fromkeys((min(1, len(path.movement) - 1), len(path.movement) - 1)):
            opening, _ = joint_cracks(stones, contacts, path.position[step], path.rotation[step])
            drawn = crack_map_svg(stones, contacts, np.where(bears, opening, 0.0), wall)
            if drawn:
                maps.append((f"{wall or 'Stones of no wall'}, movement {record[movement][step]:.3g} {length}", drawn))
    return maps
