"""Rings of voussoirs: radial joints, straight sides."""

from dataclasses import dataclass

import numpy as np

from churchpipe.bond.field import Field
from churchpipe.bond.tiles import TileSet, tiles_of
from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG
from churchpipe.geometry.planar import (
    Polygons,
    area,
    areas,
    centroids,
    clip,
    common_areas,
    extent,
    less,
    polygon,
    polygons_of,
    united,
)
from churchpipe.geometry.polygons import TOLERANCE, snap_polygons
from churchpipe.model.arrays import FloatArray, floats, store
from churchpipe.model.building import UnitCell


def ring_outline(centre: tuple[float, float], inner: float, outer: float, start: float, stop: float, pieces: int) -> FloatArray:
    """Return the outline (2 (pieces + 1), 2) m of a ring of straight-sided voussoirs, counter-clockwise.

    The corners of the extrados come first, from angle `start` to `stop` (rad, counter-clockwise from the s axis), then those
    of the intrados, backwards. Sides are chords between the joints, so that faces on them are planar. A full circle takes
    two half rings.

    Parameters
    ----------
    centre, inner, outer: m; the corners lie on circles of these radii. pieces: number of voussoirs.
    """
    angle = np.linspace(start, stop, pieces + 1)
    spoke = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.asarray(centre) + np.concatenate([outer * spoke, inner * spoke[::-1]])


@dataclass(frozen=True, slots=True)
class VoussoirRing:
    """A ring of `pieces` voussoirs about `centre`.

    An outline as `ring_outline` makes it has a corner at each end of each joint. Any other outline about the centre, such as one
    with more chords than voussoirs, is divided by evenly turned radial joints, and its voussoirs have bent sides.
    """

    cell: UnitCell
    outline: FloatArray
    centre: tuple[float, float]
    pieces: int

    def __post_init__(self) -> None:
        if self.pieces < 1:
            raise InputError("voussoir ring", "no voussoirs", found=self.pieces, expected="at least one")
        store(self, outline=floats("VoussoirRing.outline", self.outline, (None, 2)))

    def tiles(self, field: Field) -> TileSet:
        """Return the voussoirs, in the order of the ring; their course is -1.

        Raises
        ------
        InputError: an opening, a junction, another ring or the wall's end cuts a voussoir.
        """
        stones = self._between_corners()
        if stones is None:
            stones = self._between_rays(field.name)
        ring = float(areas(stones).sum())
        missing = ring - float(common_areas(stones, field.solid).sum())
        if missing > TOLERANCE * ring:
            low_s, low_t, high_s, high_t = extent(less(united(stones), [field.solid]))
            place = f"from {low_s:.4g} to {high_s:.4g} {ALONG} and from {low_t:.4g} to {high_t:.4g} m up"
            raise InputError(
                field.name,
                "the ring touches a junction (also of a buttress), an opening, a lintel, another ring or the end of the wall",
                found=f"{100 * missing / ring:.3g} % of the ring cut away, {place}",
                expected=f"room for a ring {np.ptp(self.outline[:, 0]):.4g} m wide",
                remedy="Move or narrow the opening or the lintel, or make the ring thinner.",
            )
        return tiles_of(stones, np.full(self.pieces, -1, dtype=np.int64), field.name, voussoir=True)

    def _between_corners(self) -> Polygons | None:
        """Return one quadrilateral a voussoir: extrados k, k + 1, intrados k + 1, k; None where these do not fill the outline."""
        if len(self.outline) != 2 * (self.pieces + 1):
            return None
        extrados, intrados = self.outline[: self.pieces + 1], self.outline[: self.pieces : -1]
        quads = np.stack([extrados[:-1], extrados[1:], intrados[1:], intrados[:-1]], axis=1)
        stones = polygons_of(quads.reshape(-1, 2), 4 * np.arange(self.pieces + 1))
        whole = area(polygon(self.outline))
        return stones if abs(float(areas(stones).sum()) - whole) < TOLERANCE * whole else None

    def _between_rays(self, where: str) -> Polygons:
        """Return the parts of the outline between rays that divide the angle at the centre evenly."""
        whole = polygon(self.outline)
        spoke = self.outline - np.asarray(self.centre)
        middle = centroids(np.array([whole], dtype=np.object_))[0] - np.asarray(self.centre)
        turn = np.arctan2(middle[0] * spoke[:, 1] - middle[1] * spoke[:, 0], spoke @ middle)
        first, last = float(turn.min()), float(turn.max())
        angle: FloatArray = np.arctan2(middle[1], middle[0]) + np.linspace(first, last, self.pieces + 1)
        reach = 2.0 * float(np.linalg.norm(spoke, axis=1).max()) / np.cos(0.5 * (last - first) / self.pieces)
        ray = np.asarray(self.centre) + reach * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        wedges = np.stack([np.tile(self.centre, (self.pieces, 1)), ray[:-1], ray[1:]], axis=1)
        found, owner = clip(polygons_of(wedges.reshape(-1, 2), 3 * np.arange(self.pieces + 1)), whole)
        if (np.bincount(owner, minlength=self.pieces) != 1).any():
            raise InputError(
                where,
                "its joints do not divide it into voussoirs",
                found=f"{len(found)} parts between {self.pieces + 1} joints",
                expected="a ring about its centre",
                remedy="Ask for wider voussoirs, or draw the ring as arcs about one centre.",
            )
        return snap_polygons(found)[0]

    def bed_direction(self, points: FloatArray) -> FloatArray:
        """Return the unit vectors from the centre to points (n, 2): the joints between voussoirs are radial."""
        spoke = points - np.asarray(self.centre)
        length = np.linalg.norm(spoke, axis=1, keepdims=True)
        return np.where(length > 0, spoke / np.where(length > 0, length, 1.0), [1.0, 0.0])
