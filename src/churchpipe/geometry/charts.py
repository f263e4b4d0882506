"""From chart coordinates (s, t) to space, and walls seen in plan."""

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.geometry.planar import Region, polygons_of, united
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Chart, CylinderChart, Panel, PlaneChart

# Angle of each chord of a curved wall whose head joints are not known yet.
PLAN_STEP = np.radians(2.0)
# How messages call a place s of a wall; those that do say as well what it is counted from.
ALONG = "m along the wall"


def normals(chart: Chart, points: FloatArray) -> FloatArray:
    """Return the unit normals (n, 3) of a chart at points (n, 2), m: s_axis x t_axis, outward for a cylinder."""
    if isinstance(chart, PlaneChart):
        return np.tile(np.cross(chart.s_axis, chart.t_axis), (len(points), 1))
    angle = chart.start + _on_arc(chart, points[:, 0]) / chart.radius
    return np.stack([np.cos(angle), np.sin(angle), np.zeros(len(points))], axis=1)


def lift(chart: Chart, points: FloatArray, offset: npt.ArrayLike = 0.0) -> FloatArray:
    """Return the places (n, 3) in space of points (n, 2) at a distance `offset` along the normal, all in m."""
    distance = np.broadcast_to(np.asarray(offset, dtype=np.float64), (len(points),))[:, None]
    normal = normals(chart, points)
    if isinstance(chart, PlaneChart):
        return chart.origin + points[:, :1] * chart.s_axis + points[:, 1:] * chart.t_axis + distance * normal
    beyond = (points[:, 0] - _on_arc(chart, points[:, 0]))[:, None]
    tangent = np.cross([0.0, 0.0, 1.0], normal)
    return chart.centre + (chart.radius + distance) * normal + beyond * tangent + points[:, 1:] * np.array([0.0, 0.0, 1.0])


def _on_arc(chart: CylinderChart, s: FloatArray) -> FloatArray:
    """Return s (n,) m. The straight legs at the ends of an arc have the s of the arc's end."""
    return np.clip(s, 0.0, chart.radius * chart.sweep) if chart.sweep < 2 * np.pi else s


def counted_from(chart: Chart) -> str:
    """Return how messages say from where, and which way, places s along a wall are counted."""
    start = lift(chart, np.zeros((1, 2)))[0]
    return counted_towards(start, chart.s_axis if isinstance(chart, PlaneChart) else None)


def counted_towards(start: FloatArray, axis: FloatArray | None) -> str:
    """Return how messages say that lengths are counted from a point (2,) or (3,) m along an axis; None: of a round wall."""
    x, y = (np.round(start[:2], 3) + 0.0).tolist()
    return f"counted from x = {x:.9g}, y = {y:.9g} m " + ("counter-clockwise in plan" if axis is None else f"towards {way(axis)}")


def way(axis: FloatArray) -> str:
    """Return how messages call a level direction, (2,) or (3,)."""
    east, north = (np.round(axis[:2], 3) + 0.0).tolist()
    named = {(1.0, 0.0): "+x", (-1.0, 0.0): "-x", (0.0, 1.0): "+y", (0.0, -1.0): "-y"}
    return named.get((east, north), f"({east:g}, {north:g})")


def base_level(chart: Chart) -> float:
    """Return the height z of t = 0, m."""
    return float(chart.origin[2] if isinstance(chart, PlaneChart) else chart.centre[2])


def closes(chart: Chart, start: float, stop: float) -> bool:
    """Return whether a wall from s = start to s = stop, m, ends where it starts."""
    return isinstance(chart, CylinderChart) and abs(stop - start - 2 * np.pi * chart.radius) < TOLERANCE


def check_upright(name: str, chart: Chart) -> None:
    """Raise InputError unless t is height."""
    if isinstance(chart, PlaneChart) and abs(chart.t_axis[2] - 1) > TOLERANCE:
        raise InputError(
            f"wall {name}.chart", "the wall is not upright", found=chart.t_axis.tolist(), expected="t_axis = (0, 0, 1)"
        )


def footprint(chart: Chart, thickness: float, start: float, stop: float, stations: FloatArray | None = None) -> Region:
    """Return in plan (x, y in m) the part of a wall between s = start and s = stop.

    A curved wall is a chain of chords between its `stations` (s in m; default: every two degrees).
    """
    s = np.array([start, stop])
    if not isinstance(chart, PlaneChart):
        if stations is None:
            bend = _on_arc(chart, s)
            first, last = float(bend[0]), float(bend[1])
            stations = np.linspace(first, last, int(np.ceil((last - first) / (chart.radius * PLAN_STEP))) + 1)
        s = np.unique(np.concatenate((s, stations[(stations > start) & (stations < stop)])))
    line = np.stack([s, np.zeros(len(s))], axis=1)
    near, far = (lift(chart, line, side * 0.5 * thickness)[:, :2] for side in (-1.0, 1.0))
    # One quadrilateral for each chord: the outline of a closed ring would touch itself.
    chords = np.stack([near[:-1], near[1:], far[1:], far[:-1]], axis=1)
    return united(polygons_of(chords.reshape(-1, 2), 4 * np.arange(len(s))))


def footprint_of(panel: Panel) -> Region:
    """Return in plan (x, y in m) all of a wall."""
    s = panel.outline[:, 0]
    return footprint(panel.chart, panel.thickness, float(s.min()), float(s.max()))


def along(chart: Chart, plan: FloatArray) -> FloatArray:
    """Return s (n,) m of points in plan (n, 2) m."""
    if isinstance(chart, PlaneChart):
        return (plan - chart.origin[:2]) @ chart.s_axis[:2]
    spoke = plan - chart.centre[:2]
    turn = np.mod(np.arctan2(spoke[:, 1], spoke[:, 0]) - chart.start + TOLERANCE, 2 * np.pi) - TOLERANCE
    # Points beyond the arc belong to the nearer leg.
    last = turn - chart.sweep < 2 * np.pi - turn
    end = np.where(last, chart.sweep, 0.0)
    tangent = np.stack([-np.sin(chart.start + end), np.cos(chart.start + end)], axis=1)
    leg = chart.radius * end + np.einsum("nc,nc->n", spoke, tangent)
    return np.where(turn > chart.sweep, leg, chart.radius * turn)
