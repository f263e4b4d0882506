"""Walls on a circle with arched openings. The openings are designed in the view along the wall's normal in their middle."""

import math
from dataclasses import replace
from itertools import combinations
from typing import Literal

import numpy as np

from churchpipe.bond.voids import check_width, from_view, voids_of
from churchpipe.errors import InputError
from churchpipe.generators.arched import Hole, holes
from churchpipe.generators.layout import CLOSE
from churchpipe.generators.wall_bonds import Bonding
from churchpipe.geometry.charts import closes
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, CylinderChart, Panel


def curved_panel(
    name: str,
    chart: CylinderChart,
    outline: FloatArray,
    thickness: float,
    bonding: Bonding,
    *,
    bond: BondRegion,
    middle: float,
    runs_through: Literal[0, 1] = 0,
) -> Panel:
    """Return a curved wall with its openings. Their `centre` is a length along the mid-surface from s = middle, m.

    On a full circle it may be negative, or longer than the circle.

    Raises
    ------
    InputError: an opening too wide for the curve, beyond the arc or the top, across the seam of a full circle; two that overlap.
    """
    closed = closes(chart, float(outline[:, 0].min()), float(outline[:, 0].max()))
    found = [_bent(hole, name, chart, thickness, middle, closed) for hole in holes(bonding.openings, name)]
    panel = Panel(
        name,
        chart,
        outline,
        thickness,
        (bond, *(ring for hole in found for ring in hole.rings)),
        material=bonding.material_of(name),
        openings=tuple(hole.opening for hole in found),
        runs_through=runs_through,
    )
    _check_places(panel, found, bond.cell.b / 4, closed)
    return panel


def _bent(hole: Hole, wall: str, chart: CylinderChart, thickness: float, middle: float, closed: bool) -> Hole:
    """Return an opening of a straight wall transferred to a curved one. Its middle stays, and its width is that of the view."""
    s0, t0, s1, t1 = hole.outer
    centre = 0.5 * (s0 + s1)
    if closed:
        # The same place on the circle, between the start and the end of the wall.
        middle -= 2 * math.pi * chart.radius * math.floor((middle + centre) / (2 * math.pi * chart.radius))
    check_width(f"wall {wall}: opening {hole.opening.name}", 0.5 * (s1 - s0), chart.radius - thickness / 2)

    def bend(outline: FloatArray) -> FloatArray:
        return from_view(chart, middle + centre, outline - [centre, 0.0])

    rings = tuple(
        replace(ring, outline=bend(ring.outline), centre=(middle + ring.centre[0], ring.centre[1]) if ring.centre else None)
        for ring in hole.rings
    )
    reach = bend(np.array([[s0, t0], [s1, t1]]))
    return Hole(replace(hole.opening, outline=bend(hole.opening.outline)), rings, (*reach[0].tolist(), *reach[1].tolist()))


def _check_places(panel: Panel, found: list[Hole], margin: float, closed: bool) -> None:
    chart = panel.chart
    assert isinstance(chart, CylinderChart)
    arc, top = chart.radius * chart.sweep, float(panel.outline[:, 1].max())
    voids = voids_of(panel)
    reach = [void.reach(chart.radius, (float(void.outer[:, 0].min()), float(void.outer[:, 0].max()))) for void in voids]
    for hole, (start, stop) in zip(found, reach, strict=True):
        where = f"wall {panel.name}: opening {hole.opening.name}"
        if hole.outer[1] < -CLOSE or hole.outer[3] > top + CLOSE:
            raise InputError(
                where,
                "reaches beyond the top or the foot of its wall",
                found=f"z = {hole.outer[1]:.4g} to {hole.outer[3]:.4g} m with its voussoirs",
                expected=f"within 0 to {top:.4g} m",
            )
        if start < margin - CLOSE or stop > arc - margin + CLOSE:
            raise InputError(
                where,
                "reaches over the start of the circle" if closed else "reaches beyond the arc of its wall",
                found=f"{_degrees(chart, start, stop)} with its voussoirs",
                expected=_degrees(chart, margin, arc - margin),
                remedy="Move or narrow it.",
            )
    for (i, first), (j, second) in combinations(enumerate(found), 2):
        apart = reach[i][1] + margin <= reach[j][0] + CLOSE or reach[j][1] + margin <= reach[i][0] + CLOSE
        above = first.outer[3] <= second.outer[1] + CLOSE or second.outer[3] <= first.outer[1] + CLOSE
        if not (apart or above):
            raise InputError(
                f"wall {panel.name}: openings {first.opening.name} and {second.opening.name}",
                "too near to each other with their voussoirs",
                found=f"{1e3 * (max(reach[i][0], reach[j][0]) - min(reach[i][1], reach[j][1])):.4g} mm apart on the inner face",
                expected=f"at least {1e3 * margin:.4g} mm, a quarter of a stone",
                remedy="Move one of them, or make it smaller.",
            )


def _degrees(chart: CylinderChart, start: float, stop: float) -> str:
    return f"{math.degrees(start / chart.radius):.4g} to {math.degrees(stop / chart.radius):.4g} degrees"
