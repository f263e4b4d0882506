"""Rings of voussoirs: radial joints, straight sides."""

from dataclasses import dataclass

import numpy as np

from churchpipe.bond.field import Field
from churchpipe.bond.tiles import TileSet, tiles_of
from churchpipe.errors import InputError
from churchpipe.geometry.planar import areas, common_areas, polygons_of
from churchpipe.geometry.polygons import TOLERANCE
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
    """A ring of `pieces` voussoirs about `centre` with an outline as `ring_outline` makes it."""

    cell: UnitCell
    outline: FloatArray
    centre: tuple[float, float]
    pieces: int

    def __post_init__(self) -> None:
        corners = 2 * (self.pieces + 1)
        if self.pieces < 1 or len(self.outline) != corners:
            raise InputError(
                "voussoir ring",
                "outline and number of voussoirs do not match",
                found=f"{len(self.outline)} corners for {self.pieces} voussoirs",
                expected="2 (pieces + 1) corners, the extrados first",
                remedy="Make the outline with bond.voussoir.ring_outline.",
            )
        store(self, outline=floats("VoussoirRing.outline", self.outline, (None, 2)))

    def tiles(self, field: Field) -> TileSet:
        """Return the voussoirs, in the order of the ring; their course is -1.

        Raises
        ------
        InputError: an opening, a junction, another ring or the wall's end cuts a voussoir.
        """
        extrados, intrados = self.outline[: self.pieces + 1], self.outline[: self.pieces : -1]
        # One quadrilateral a voussoir: extrados k, k + 1, intrados k + 1, k.
        quads = np.stack([extrados[:-1], extrados[1:], intrados[1:], intrados[:-1]], axis=1)
        stones = polygons_of(quads.reshape(-1, 2), 4 * np.arange(self.pieces + 1))
        ring = float(areas(stones).sum())
        missing = ring - float(common_areas(stones, field.solid).sum())
        if missing > TOLERANCE * ring:
            raise InputError(
                field.name,
                "the ring touches a junction, an opening, another ring or the end of the wall",
                found=f"{100 * missing / ring:.3g} % of the ring cut away",
                expected=f"room for a ring {np.ptp(self.outline[:, 0]):.4g} m wide",
                remedy="Move or narrow the opening, or make the ring thinner.",
            )
        return tiles_of(stones, np.full(self.pieces, -1, dtype=np.int64), field.name, voussoir=True)

    def bed_direction(self, points: FloatArray) -> FloatArray:
        """Return the unit vectors from the centre to points (n, 2): the joints between voussoirs are radial."""
        spoke = points - np.asarray(self.centre)
        length = np.linalg.norm(spoke, axis=1, keepdims=True)
        return np.where(length > 0, spoke / np.where(length > 0, length, 1.0), [1.0, 0.0])
