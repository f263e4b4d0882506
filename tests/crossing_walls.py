"""Two walls that meet or cross in plan, and what each loses to the other."""

import numpy as np

from churchpipe.bond.junction import wall_junctions
from churchpipe.bond.walls import wall_region
from churchpipe.model.building import BondRegion, Panel, PlaneChart, UnitCell

CELL = UnitCell(a=0.25, b=1.0)
T = 0.5


def wall(name, origin, axis, length, height=1.0, parity=0, cell=CELL, thickness=T, openings=()):
    outline = np.array([[0, 0], [length, 0], [length, height], [0, height]], dtype=float)
    region = BondRegion("bond", outline, "running", cell)
    chart = PlaneChart(origin=np.array([*origin, 0.0]), s_axis=np.array([*axis, 0.0]))
    return Panel(name, chart, outline, thickness, (region,), runs_through=parity, openings=openings)


def along_x(**keywords):
    return wall("x", (0.0, T / 2), (1.0, 0.0), 5.0, **keywords)


def along_y(left=0.0, start=0.0, **keywords):
    return wall("y", (left + T / 2, start), (0.0, 1.0), 4.0, **({"parity": 1} | keywords))


def junctions(*panels):
    return wall_junctions(panels, [wall_region(panel) for panel in panels])


def owned(junction, zone):
    """Return the levels of the bands of the zone that the wall has ceded."""
    rows = junction.ceded[np.isclose(junction.ceded[:, 0], zone[0]) & np.isclose(junction.ceded[:, 2], zone[1])]
    return sorted(np.round(rows[:, 1], 9).tolist())
