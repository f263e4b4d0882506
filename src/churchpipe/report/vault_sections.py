"""Sections of vaults with the line of thrust of an analysis, and the hoop and meridian forces of domes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.report.plots import svg_of
from churchpipe.report.table import Row, figure
from churchpipe.report.thrust import HINGE, section_figure
from churchpipe.thrust_lines import ThrustLine, ring_forces, ringed, thrust_line, vaulted
from churchpipe.wording import counted

# A dome's beds look to all sides: least share of them across the main direction.
_ALL_ROUND = 0.25
# Two barrels that cross look to all sides, too. Their beds look along the way to the middle with less than this share, those of a
# pavilion with .8.
_INWARDS = 0.5
# No more sections are drawn.
_MOST = 8


@dataclass(frozen=True, slots=True)
class VaultSection:
    """A section as the report shows it: label, drawing (svg), words, rows of ring forces, () of what is no dome."""

    label: str
    drawing: str
    words: str
    rings: tuple[tuple[str, ...], ...]


def vault_sections(stones: Assemblage, contacts: Contacts, rows: Sequence[Row]) -> list[VaultSection]:
    """Return the sections of all vaults, arches and domes under the first load, without dilatancy if it was analysed so."""
    analysed = [row for row in rows if row.state is not None and len(row.state.forces) == len(contacts.point)]
    # What does not stand has no forces, or none but zeros.
    carried = [row for row in analysed if row.state is not None and 0 < np.abs(row.state.forces).sum() < np.inf]
    if not carried:
        return []
    first = [row for row in carried if (row.variant, row.load) == (carried[0].variant, carried[0].load)]
    row = next((row for row in first if row.record.flow == "non-associative"), first[0])
    found: list[VaultSection] = []
    for panel, across in (vaulted(stones, contacts) | ringed(stones, contacts)).items():
        if len(found) < _MOST and (section := _section(stones, contacts, row, panel, across)):
            found.append(section)
    return found


def _section(stones: Assemblage, contacts: Contacts, row: Row, panel: str, across: FloatArray) -> VaultSection | None:
    assert row.state is not None
    size, axes = np.linalg.eigh(across)
    dome = bool(size[0] > _ALL_ROUND * size[1])
    # Across a barrel; of a dome along x.
    direction = (1.0, 0.0) if dome else (float(abs(axes[0, 1])), float(axes[1, 1] * np.sign(axes[0, 1] or 1.0)))
    mine = stones.panel == panel
    through = _middle(stones, mine)
    span = _crossed(stones, contacts, mine, through) if dome else None
    if span is not None:
        dome, direction = False, (float(span[0]), float(span[1]))
    beside = np.array([-direction[1], direction[0]])
    # Stones of a dome are long around its middle.
    arm = stones.centroid[:, :2] - through
    round_it = dome & (np.linalg.norm(arm, axis=1) > 1e-6 * stones.size)
    width = _stone_length(stones, mine, np.where(round_it[:, None], np.stack([-arm[:, 1], arm[:, 0]], axis=1), beside))
    if span is not None:
        # Along its middle a barrel has hardly a bed; at its end it is a whole arch.
        through = through + (np.max((_corners(stones, mine) - through) @ beside) - width / 2) * beside
    place = (float(through[0]), float(through[1]))
    try:
        line = thrust_line(stones, contacts, row.state.forces, panel, place, direction, width)
    except InputError:
        # A part of a vault may end short of its own middle: an annex of a half dome, say.
        return None
    if not len(line.force):
        return None
    everything = tuple(np.unique(stones.panel[~stones.fixed]).tolist())
    drawing = svg_of(section_figure(stones, line, everything, place, direction, width))
    rings: tuple[tuple[str, ...], ...] = ()
    if dome:
        force = ring_forces(stones, contacts, row.state.forces, panel)
        columns = (force.height, force.meridian / 1e3, force.vertical / 1e3, force.hoop / 1e3)
        rings = tuple(
            (str(number), *(figure(value, 2) for value in values))
            for number, *values in zip(force.course.tolist(), *columns, strict=True)
        )
    return VaultSection(f"{panel}: {row.label}", drawing, _words(line, width), rings)


def _words(line: ThrustLine, width: float) -> str:
    share = np.abs(line.eccentricity) / np.maximum(line.half, np.finfo(float).tiny)
    hinges = int((share > HINGE).sum())
    edge = (
        f"{counted(hinges, 'joint is a hinge', 'joints are hinges')}, at whose edge it passes"
        if hinges
        else f"it comes within {100 * (1 - share.max()):.0f} % of an edge"
    )
    joints = counted(len(line.force), "joint")
    most = f"{figure(line.force.max() / 1e3, 2)} kN at most in a strip of {figure(width, 2)} m"
    return f"Thrust in {joints} of the section, {most}; {edge}."


def _crossed(stones: Assemblage, contacts: Contacts, mine: BoolArray, middle: FloatArray) -> FloatArray | None:
    """Return the direction in plan (2,) in which one of two barrels that cross spans, the one more along x; None of a dome."""
    beds = mine[contacts.blocks].all(axis=1) & (stones.course[contacts.blocks[:, 0]] != stones.course[contacts.blocks[:, 1]])
    normal, area = contacts.frame[beds, 0, :2], contacts.area[beds]
    place = np.add.reduceat(contacts.point[:, :2], contacts.point_ptr[:-1])[beds] / contacts.points_per_interface[beds, None]
    way = place - middle
    inwards = (normal * way).sum(axis=1) ** 2 / np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    if area @ inwards >= _INWARDS * (area @ (normal**2).sum(axis=1)):
        return None
    slope = np.linalg.norm(normal, axis=1)
    steep = normal[slope > 0.9 * slope.max()]
    found = steep[np.argmax(np.abs(steep[:, 0]))]
    return found / np.linalg.norm(found) * (1.0 if found[0] >= 0 else -1.0)


def _middle(stones: Assemblage, mine: BoolArray) -> FloatArray:
    corner = _corners(stones, mine)
    return (corner.min(axis=0) + corner.max(axis=0)) / 2


def _corners(stones: Assemblage, mine: BoolArray) -> FloatArray:
    return stones.points[np.repeat(mine, np.diff(stones.block_point_ptr)), :2]


def _stone_length(stones: Assemblage, mine: BoolArray, way: FloatArray) -> float:
    """Return the median length, m, of some stones (nb,), each along its own way in plan (nb, 2)."""
    first = stones.block_point_ptr[:-1]
    unit = way / np.linalg.norm(way, axis=1, keepdims=True)
    place = (stones.points[:, :2] * np.repeat(unit, np.diff(stones.block_point_ptr), axis=0)).sum(axis=1)
    size = np.maximum.reduceat(place, first) - np.minimum.reduceat(place, first)
    return float(np.median(size[mine]))
