"""What the facets of a curved wall carry: its stones are straight from joint to joint."""

import numpy as np

from churchpipe.bond.junction import WallJunctions
from churchpipe.bond.walls import lay_wall
from churchpipe.geometry.planar import Region
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import CylinderChart, Panel
from churchpipe.shell_mesh.triangulation import Mesh
from churchpipe.stones.prisms import stations_of


def stations_along(panel: Panel, solid: Region, junctions: WallJunctions) -> FloatArray:
    """Return s of all head joints of a curved wall as it is laid (n,) m; none of a plane wall.

    They are laid, because no rule tells them: the joints of all courses count, and beside an opening some are left out.
    """
    if not isinstance(panel.chart, CylinderChart):
        return np.empty(0)
    return stations_of(panel.chart, lay_wall(panel, solid, junctions))


def arc_filled(chart: CylinderChart, mesh: Mesh, stations: FloatArray) -> FloatArray:
    """Return the share (nt,) of the curved wall behind each facet that its stones fill: sin(x) / x of each sector of angle x.

    Parameters
    ----------
    chart, mesh: of the wall. stations (n,): where its head joints are, m; the wall is straight from one to the next.
    """
    bent = stations if chart.sweep >= 2 * np.pi else np.clip(stations, 0.0, chart.radius * chart.sweep)
    missing = 1.0 - np.sinc(np.diff(bent) / chart.radius / np.pi)
    return 1.0 - np.diff(_below(mesh.corners[:, :, 0], stations), axis=1) @ missing


def _below(s: FloatArray, stations: FloatArray) -> FloatArray:
    """Return the shares (nt, n) of the areas of triangles with corners at s (nt, 3) that lie before each station (n,)."""
    first, middle, last = np.sort(s, axis=1).T[:, :, None]
    place = np.clip(stations[None], first, last)
    # A side that stands upright in the chart leaves no room before or behind it.
    before, behind = (middle - first) * (last - first), (last - middle) * (last - first)
    rising = (place - first) ** 2 / np.where(before > 0, before, 1.0)
    falling = 1.0 - (last - place) ** 2 / np.where(behind > 0, behind, 1.0)
    return np.where(place < middle, rising, falling)
