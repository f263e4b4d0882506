"""Walls of a file made to meet exactly: at right angles, and with their ends on the faces of the walls that they meet.

Coordinates of a file are rounded, to a tenth of a millimetre in a text or to seven digits in binary meshes. Of walls along x and
y equal figures are rounded alike; of walls at an angle each corner is off by an amount of its own, and a wall that should end on
the far face of another one ends a thousandth of a millimetre before or behind it. Stones cannot be laid in such a sliver.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Panel, PlaneChart
from churchpipe.recognition.insets import is_single

# A wall is moved by no more than this share of the thickness of the thinner one of two: faces may be less even than that.
NEAR = 0.005
# What moves by less, m, is rounding of the computer.
_STILL = 1e-9
# Directions whose cosine is below this are at right angles: those that were made so.
RIGHT = 1e-9


def squared(panels: Sequence[Panel]) -> tuple[list[Panel], dict[str, float]]:
    """Return walls at exact right angles, with ends and reveals on the faces of crossing walls, and how far each was moved.

    Lintels go onto the ends and reveals of their walls as well. Only what lies nearly so is moved, by `NEAR` of a thickness at
    most. Walls with rings keep their outlines.

    Parameters
    ----------
    panels
        Plane walls; others stay as they are.

    Returns
    -------
    walls, moved
        moved: by the name of the wall, m; only walls that were moved.
    """
    plane = [number for number, panel in enumerate(panels) if isinstance(panel.chart, PlaneChart)]
    out = list(panels)
    moved: dict[str, float] = {}
    order = sorted(plane, key=lambda one: -_size(panels[one]))
    for place, number in enumerate(order):
        turned, by = _turned(out[number], [out[other] for other in order[:place]])
        out[number] = turned
        moved[turned.name] = by
    # Lintels last, for they go onto the ends of walls as these then are.
    for number in sorted(plane, key=lambda one: is_single(panels[one])):
        ended, by = _ended(out[number], [out[other] for other in plane if other != number])
        out[number] = ended
        moved[ended.name] += by
    return out, {name: by for name, by in moved.items() if by > 0}


def _size(panel: Panel) -> float:
    return float(np.prod(np.ptp(panel.outline, axis=0)))


def _turned(panel: Panel, before: Sequence[Panel]) -> tuple[Panel, float]:
    """Return a wall turned about its middle to be parallel to one of those before it, or at right angles to it, if it nearly is;
    and by how far its ends moved, m."""
    chart = panel.chart
    assert isinstance(chart, PlaneChart)
    low, high = float(panel.outline[:, 0].min()), float(panel.outline[:, 0].max())
    for other in before:
        assert isinstance(other.chart, PlaneChart)
        axis = other.chart.s_axis
        cosine = float(axis @ chart.s_axis)
        exact = axis * np.sign(cosine) if abs(cosine) > 0.5 else np.array([-axis[1], axis[0], 0.0])
        exact = exact * np.sign(exact @ chart.s_axis)
        by = 0.5 * (high - low) * float(np.linalg.norm(exact - chart.s_axis))
        if by < _STILL:
            return panel, 0.0
        if by < NEAR * min(panel.thickness, other.thickness):
            middle = chart.origin + 0.5 * (low + high) * chart.s_axis
            return replace(panel, chart=replace(chart, origin=middle - 0.5 * (low + high) * exact, s_axis=exact)), by
    return panel, 0.0


def _ended(panel: Panel, others: Sequence[Panel]) -> tuple[Panel, float]:
    """Return a wall whose ends and reveals lie on the faces of the walls across it that they nearly reach, or a lintel whose ends
    lie on ends and reveals of its wall; and by how far they moved, m."""
    if any(region.pattern == "voussoir" for region in panel.regions):
        return panel, 0.0
    own = np.unique(np.concatenate([item.outline[:, 0] for item in (panel, *panel.openings)]))
    new = own.copy()
    # The faces of a lintel are those of its wall, rounded once more: of two that lie together those of the larger wall count.
    for other in sorted(others, key=_size):
        near = NEAR * min(panel.thickness, other.thickness)
        marks = _faces(panel, other, near)
        marks += _sides(panel, other) if is_single(panel) and not is_single(other) else []
        for mark in marks:
            # Of several sides near one face only the nearest goes there, so that none falls onto another.
            nearest = int(np.argmin(np.abs(own - mark)))
            if abs(own[nearest] - mark) < near:
                new[nearest] = mark
    by = float(np.abs(new - own).max())
    if by < _STILL or (np.diff(new) <= 0).any():
        return panel, 0.0

    def on_faces(outline: FloatArray) -> FloatArray:
        place = np.clip(np.searchsorted(own, outline[:, 0]), 0, len(own) - 1)
        return np.stack([np.where(own[place] == outline[:, 0], new[place], outline[:, 0]), outline[:, 1]], axis=1)

    return replace(
        panel,
        outline=on_faces(panel.outline),
        openings=tuple(replace(opening, outline=on_faces(opening.outline)) for opening in panel.openings),
        regions=tuple(replace(region, outline=on_faces(region.outline)) for region in panel.regions),
        parts=tuple(replace(part, outline=on_faces(part.outline)) for part in panel.parts),
    ), by


def _faces(panel: Panel, other: Panel, near: float) -> list[float]:
    """Return s of the two faces of a wall that stands across this one, m; none where it does not reach this one."""
    own, cross = panel.chart, other.chart
    assert isinstance(own, PlaneChart)
    assert isinstance(cross, PlaneChart)
    if abs(own.s_axis @ cross.s_axis) > RIGHT:
        return []
    reach = float((own.origin - cross.origin) @ cross.s_axis)
    beyond = 0.5 * panel.thickness + near
    if not other.outline[:, 0].min() - beyond < reach < other.outline[:, 0].max() + beyond:
        return []
    middle = float((cross.origin - own.origin) @ own.s_axis)
    return [middle - 0.5 * other.thickness, middle + 0.5 * other.thickness]


def _sides(lintel: Panel, wall: Panel) -> list[float]:
    """Return s of the ends and reveals of a wall along a lintel that lies in its thickness, m; none of any other wall."""
    own, chart = lintel.chart, wall.chart
    assert isinstance(own, PlaneChart)
    assert isinstance(chart, PlaneChart)
    along = float(own.s_axis @ chart.s_axis)
    apart = chart.origin - own.origin
    aside = float(np.linalg.norm(apart[:2] - (apart @ own.s_axis) * own.s_axis[:2]))
    if abs(abs(along) - 1) > RIGHT or aside > 0.5 * wall.thickness:
        return []
    sides = np.unique(np.concatenate([item.outline[:, 0] for item in (wall, *wall.openings)]))
    return (float(apart @ own.s_axis) + along * sides).tolist()
