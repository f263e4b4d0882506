"""How long the stones are laid around the facets of a wall."""

from dataclasses import dataclass

import numpy as np

from churchpipe.bond.joints import bays
from churchpipe.bond.junction import wall_junctions
from churchpipe.bond.patterns import stone_length
from churchpipe.bond.walls import wall_region
from churchpipe.bond.zones import bands_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Building, Panel
from churchpipe.shell_mesh.straight_stones import stations_along
from churchpipe.shell_mesh.triangulation import Mesh

# Lengths are rounded to this many decimals of a metre, so that bays that mirror each other have one unit cell.
_DECIMALS = 9


@dataclass(frozen=True, slots=True)
class LaidWall:
    """How the courses of a whole wall are divided: s of its two ends (span), m; the rectangles (nc, 4) in which other walls cross
    it, as in `WallJunctions`; and s of all head joints of a curved wall (stations), m, none of a plane one."""

    span: tuple[float, float]
    crossed: FloatArray
    stations: FloatArray


def laid_walls(building: Building) -> dict[str, LaidWall]:
    """Return how each wall of a building is laid, by its name."""
    solids = [wall_region(panel) for panel in building.panels]
    junctions = wall_junctions(building.panels, solids, building.junctions)
    return {
        panel.name: LaidWall(
            (float(panel.outline[:, 0].min()), float(panel.outline[:, 0].max())), own.crossed, stations_along(panel, solid, own)
        )
        for panel, solid, own in zip(building.panels, solids, junctions, strict=True)
    }


def laid_lengths(panel: Panel, mesh: Mesh, whole: LaidWall) -> FloatArray:
    """Return how long the stones around each facet of a wall are, along their course (nt,) m.

    Where clear bays are divided evenly (rule "bay") they are a little longer or shorter than the b that was asked for. Up to the
    middle of a junction they are those of the bay beside it. A bay shorter than half a stone has none of its own: there it is b.

    Parameters
    ----------
    panel: the wall, or a tier of it. mesh: of its mid-surface. whole: the whole wall, which may be longer than a tier of
    it, such as the upper part of a buttress that slopes.
    """
    s, t = mesh.corners.mean(axis=1).T
    found = np.empty(len(s))
    for band in bands_of(whole.crossed):
        clear = np.diff(bays(whole.span, band.zones)).ravel()
        beside = np.searchsorted(band.zones.mean(axis=1), s)
        inside = (band.low <= t) & (t < band.high)
        for number, region in enumerate(panel.regions):
            b = region.cell.b
            laid = np.array([stone_length(region, bay) if bay >= 0.5 * b else b for bay in clear.tolist()])
            own = inside & (mesh.bond == number)
            found[own] = laid[beside[own]]
    return np.round(found, _DECIMALS)
