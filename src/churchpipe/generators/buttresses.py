"""Buttresses and pilasters: short walls square to a straight wall, bonded with it or built against it."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry import planar
from churchpipe.geometry.charts import ALONG, counted_towards, footprint_of, lift
from churchpipe.model.arguments import check_kind, listed
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Building, Junction, Panel, PlaneChart
from churchpipe.model.buttress import Buttress, numbered
from churchpipe.model.load_places import TOWARD

_WHOLE = 1e-6


def with_buttresses(building: Building, buttresses: Iterable[Buttress]) -> Building:
    """Return a building with buttresses: a panel each, named "NAME buttress 1" and so on.

    Parameters
    ----------
    building
        The building whose walls they stand at.
    buttresses
        What to add.

    Returns
    -------
    Building
        With the panels of the buttresses after its own.

    Raises
    ------
    InputError
        A wall that is not there, is curved, or has no such side; a place beyond it, in an opening or in another one; a height
        that is no whole number of courses.
    """
    check_kind("with_buttresses: building", building, Building)
    for buttress in listed("with_buttresses: buttresses", buttresses, Buttress):
        where = f"buttress of {buttress.wall}"
        panels = {panel.name: panel for panel in building.panels}
        wall = panels.get(buttress.wall)
        if wall is None:
            raise InputError(where, "no such wall", found=buttress.wall, expected=", ".join(panels))
        names = [numbered(buttress.name or wall.name, number + 1) for number in range(len(buttress.along))]
        if taken := [name for name in names if name in panels]:
            remedy = 'Give them a name of their own: name = "west", say. Buttresses alike may be one table with several places.'
            raise InputError(f"{where}: name", "not the only ones of their name", found=taken[0], remedy=remedy)
        made = tuple(_panel(where, wall, buttress, *one) for one in zip(buttress.along, names, strict=True))
        nearest = min((after - before for before, after in pairwise(sorted(buttress.along))), default=np.inf)
        if nearest < buttress.width - _WHOLE:
            found, expected = f"middles {nearest:.4g} m apart", f"at least {buttress.width:g} m, the width of each"
            raise InputError(f"{where}: along", "two in one place", found=found, expected=expected)
        for along, panel in zip(buttress.along, made, strict=True):
            others = [other for other in building.panels if other is not wall]
            _check_clear(f"{where}: along", wall, panel, along, others)
            _check_corner(f"{where}: along", panel, along, others)
        loose = () if buttress.bonded else tuple(Junction((wall.name, name)) for name in names)
        building = replace(building, panels=(*building.panels, *made), junctions=(*building.junctions, *loose))
    return building


def _panel(where: str, wall: Panel, buttress: Buttress, along: float, name: str) -> Panel:
    chart = wall.chart
    if not isinstance(chart, PlaneChart):
        raise InputError(where, f"the wall {wall.name} is not straight", expected="a straight wall")
    outward = np.array(TOWARD[buttress.toward])
    if abs(float(outward @ chart.s_axis)) > 1e-6:
        raise InputError(
            f"{where}: toward", f"it runs along the wall {wall.name}", found=buttress.toward, expected="one of its sides"
        )
    place = _place(where, wall, chart, along, buttress.width)
    cell = wall.regions[0].cell
    corner = wall.outline[:, 0].min(), wall.outline[:, 0].max()
    eaves = min(float(wall.outline[np.abs(wall.outline[:, 0] - s) < _WHOLE, 1].max()) for s in corner)
    height = eaves if buttress.height is None else buttress.height
    courses = height / cell.a
    if abs(courses - round(courses)) > _WHOLE or height > float(wall.outline[:, 1].max()) + _WHOLE:
        expected = f"a whole number of courses of {cell.a:g} m, at most {float(wall.outline[:, 1].max()):g} m"
        raise InputError(f"{where}: height", "does not fit the wall", found=f"{height:g} m", expected=expected)
    _check_openings(f"{where}: along", wall, along, float((place - chart.origin) @ chart.s_axis), buttress.width, height)
    length = wall.thickness + buttress.depth
    outline = np.array([[0.0, 0.0], [length, 0.0], [length, height], [0.0, height]])
    # It reaches through the wall; toothed, it runs through on the courses on which the wall does not.
    return Panel(
        name,
        PlaneChart(place - outward * wall.thickness / 2, outward),
        outline,
        buttress.width,
        (BondRegion("bond", outline, "running", cell, joints="bay"),),
        material=buttress.material or wall.material,
        runs_through=1 if wall.runs_through == 0 else 0,
    )


def _check_corner(where: str, buttress: Panel, along: float, others: Sequence[Panel]) -> None:
    """Refuse a buttress that stands partly before a wall which meets its own there: the two have no bond."""
    chart, own = buttress.chart, footprint_of(buttress)
    for other in others:
        if not isinstance(other.chart, PlaneChart) or not isinstance(chart, PlaneChart):
            continue
        normal = np.cross(chart.s_axis, chart.t_axis)
        aside = abs(float((other.chart.origin - chart.origin) @ normal))
        alike = aside < _WHOLE and abs(other.thickness - buttress.thickness) < _WHOLE
        parallel = abs(float(other.chart.s_axis @ normal)) < _WHOLE
        if parallel and not alike and planar.area(planar.common(own, footprint_of(other))) > _WHOLE:
            expected = f"a place clear of that wall, {(other.thickness + buttress.thickness) / 2:g} m from its middle or more"
            expected += f"; or, over its middle, a buttress {other.thickness:g} m wide"
            raise InputError(where, f"stands partly in the wall {other.name}", found=f"{along:g} m", expected=expected)


def _check_clear(where: str, wall: Panel, buttress: Panel, along: float, others: Sequence[Panel]) -> None:
    """Refuse a buttress that stands in another one, or in another wall, beside the wall that it is of."""
    beside = planar.less(footprint_of(buttress), [footprint_of(wall)])
    low, high = _levels(buttress)
    for other in others:
        bottom, top = _levels(other)
        if not isinstance(other.chart, PlaneChart) or min(top, high) - max(bottom, low) < _WHOLE:
            continue
        if planar.area(planar.common(beside, footprint_of(other))) > _WHOLE:
            expected = f"a place clear of it, {(other.thickness + buttress.thickness) / 2:g} m from its middle or more"
            raise InputError(where, f"stands where {other.name} stands", found=f"{along:g} m", expected=expected)


def _levels(panel: Panel) -> tuple[float, float]:
    """Return the heights of the foot and the top of a panel, m."""
    height = lift(panel.chart, panel.outline)[:, 2]
    return float(height.min()), float(height.max())


def _check_openings(where: str, wall: Panel, along: float, s: float, width: float, height: float) -> None:
    """Refuse a buttress with its middle at s (m, in the wall's chart) that would stand in an opening."""
    foot = planar.polygon([[s - width / 2, 0.0], [s + width / 2, 0.0], [s + width / 2, height], [s - width / 2, height]])
    for opening in wall.openings:
        if planar.area(planar.common(foot, planar.polygon(opening.outline))) > _WHOLE:
            clear = opening.outline[:, 0].max() - opening.outline[:, 0].min()
            expected = f"a place beside it, or a buttress lower than it: it is {clear:g} m wide"
            raise InputError(
                where, f"in the opening {opening.name} of the wall {wall.name}", found=f"{along:g} m", expected=expected
            )


def _place(where: str, wall: Panel, chart: PlaneChart, along: float, width: float) -> FloatArray:
    """Return the point on the foot of a wall's middle plane at a distance along it, from its end with the smaller x, or y."""
    s = wall.outline[:, 0].min(), wall.outline[:, 0].max()
    axis = chart.s_axis if chart.s_axis[0] > 1e-9 or (abs(chart.s_axis[0]) <= 1e-9 and chart.s_axis[1] > 0) else -chart.s_axis
    start = chart.origin + (s[0] if float(axis @ chart.s_axis) > 0 else s[1]) * chart.s_axis
    if width > s[1] - s[0] + _WHOLE:
        raise InputError(
            f"{where}: width", f"wider than the wall {wall.name}", found=f"{width:g} m", expected=f"at most {s[1] - s[0]:g} m"
        )
    if not width / 2 - _WHOLE <= along <= s[1] - s[0] - width / 2 + _WHOLE:
        expected = f"{width / 2:g} to {s[1] - s[0] - width / 2:g} {ALONG}, {counted_towards(start, axis)}"
        raise InputError(f"{where}: along", f"beyond the wall {wall.name}", found=f"{along:g} m", expected=expected)
    return start + along * axis
