"""How long the stones are laid around the facets of a wall."""

import numpy as np

from churchpipe.bond.joints import bays
from churchpipe.bond.patterns import stone_length
from churchpipe.bond.zones import bands_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Panel
from churchpipe.shell_mesh.triangulation import Mesh

# Lengths are rounded to this many decimals of a metre, so that bays that mirror each other have one unit cell.
_DECIMALS = 9


def laid_lengths(panel: Panel, mesh: Mesh, crossed: FloatArray) -> FloatArray:
    """Return how long the stones around each facet of a wall are, along their course (nt,) m.

    Where clear bays are divided evenly (rule "bay") they are a little longer or shorter than the b that was asked for. Up to the
    middle of a junction they are those of the bay beside it. A bay shorter than half a stone has none of its own: there it is b.

    Parameters
    ----------
    panel: the wall. mesh: of its mid-surface. crossed (nc, 4): the rectangles in which other walls cross it, as in
    `WallJunctions`.
    """
    span = (float(panel.outline[:, 0].min()), float(panel.outline[:, 0].max()))
    s, t = mesh.corners.mean(axis=1).T
    found = np.empty(len(s))
    for band in bands_of(crossed):
        clear = np.diff(bays(span, band.zones)).ravel()
        beside = np.searchsorted(band.zones.mean(axis=1), s)
        inside = (band.low <= t) & (t < band.high)
        for number, region in enumerate(panel.regions):
            b = region.cell.b
            laid = np.array([stone_length(region, bay) if bay >= 0.5 * b else b for bay in clear.tolist()])
            own = inside & (mesh.bond == number)
            found[own] = laid[beside[own]]
    return np.round(found, _DECIMALS)
