"""Stones of curved walls with arched openings: solids of the curved wall, cut by the prisms of the openings."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import manifold3d
import numpy as np

from churchpipe.bond.tiles import TileSet, tiles_of
from churchpipe.bond.voids import Void, to_view
from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG, counted_from, lift, normals
from churchpipe.geometry.manifolds import manifold, polyhedron
from churchpipe.geometry.planar import bounds, boxes
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.building import CylinderChart, Panel
from churchpipe.stones.prisms import Solids, solids_of, stations_of, thicken

# Number of the first face of a prism. The faces of a stone are numbered from 0.
OF_PRISM = 1_000_000
# A voussoir is cut from a solid that is larger by this on all sides, m. Faces that both have in common would be cut into pieces.
MARGIN = 1e-3


def pierced_solids(panel: Panel, chart: CylinderChart, tiles: TileSet, voids: Sequence[Void]) -> Solids:
    """Return one closed solid for each tile of a curved wall with arched openings.

    The sides of openings and voussoirs are planes parallel to the wall's normal in the middle of their opening. Sides that
    follow the radius at each place, as the developed surface would give them, would be twisted. Stones of the wall are laid as
    if there were no opening, and the prism of the opening with its voussoirs is subtracted. Each voussoir is the intersection of
    the wall with its own prism.

    Raises
    ------
    InputError: voussoirs around no opening, an opening that leaves two pieces of a stone or none.
    """
    stations = stations_of(chart, tiles)
    of_void = {ring: void for void in voids for ring in void.rings}
    view = {int(number): _view(panel, chart, tiles, int(number), of_void) for number in np.flatnonzero(tiles.voussoir)}
    base = _with_blanks(chart, tiles, view, stations)
    solids = thicken(chart, panel.thickness, base)
    bounded = bounds(base.polygons)
    out: list[tuple[FloatArray, list[IntArray]]] = []
    for number in range(tiles.count):
        points = solids.points[slice(*solids.block_point_ptr[number : number + 2])]
        faces = [
            solids.face_nodes[slice(*solids.face_ptr[face : face + 2])] - solids.block_point_ptr[number]
            for face in range(*solids.block_face_ptr[number : number + 2])
        ]
        if number in view:
            void, outline = view[number]
            points, faces = polyhedron(manifold(points, faces) ^ _prism(chart, void, outline))
        for void in voids if number not in view else ():
            if _meet(chart, void, bounded[number]):
                left = manifold(points, faces) - _prism(chart, void, void.outer)
                if len(left.decompose()) != 1:
                    low, up, high, _ = bounded[number]
                    place = f"from {low:.4g} to {high:.4g} {ALONG} and {up:.4g} m up, {counted_from(chart)}"
                    raise InputError(
                        f"wall {panel.name}",
                        "an arched opening cuts a stone in two, or away",
                        found=f"course {tiles.course[number]}, {place}",
                        remedy="Move or change the opening, or use shorter stones.",
                    )
                points, faces = polyhedron(left)
        out.append((points, faces))
    return solids_of(out)


def _meet(chart: CylinderChart, void: Void, bounded: FloatArray) -> bool:
    """Return whether an opening, with its voussoirs, may reach into a stone with the bounds s0, t0, s1, t1, m."""
    low_s, low_t, high_s, high_t = bounded
    (x0, t0), (x1, t1) = void.outer.min(axis=0), void.outer.max(axis=0)
    start, stop = void.reach(chart.radius, (float(x0), float(x1)))
    # A stone that crosses the seam of a ring is given at its start, with s below the first value.
    turns = 2 * np.pi * chart.radius * np.array([0.0, 1.0])
    return bool(low_t < t1 and high_t > t0 and ((low_s + turns < stop) & (high_s + turns > start)).any())


def _view(
    panel: Panel, chart: CylinderChart, tiles: TileSet, number: int, of_void: Mapping[str, Void]
) -> tuple[Void, FloatArray]:
    """Return the opening that a voussoir belongs to, and its outline in the view of that. of_void: ring -> its opening."""
    ring = str(tiles.region[number])
    if ring not in of_void:
        raise InputError(
            f"wall {panel.name}, {ring}", "voussoirs of a curved wall around no opening", expected="an opening with this ring"
        )
    void = of_void[ring]
    return void, to_view(chart, void.middle, tiles.corner[tiles.corner_ptr[number] : tiles.corner_ptr[number + 1]])


def _with_blanks(
    chart: CylinderChart, tiles: TileSet, view: Mapping[int, tuple[Void, FloatArray]], stations: FloatArray
) -> TileSet:
    """Return the tiles, each voussoir replaced by the rectangle between stations that it is cut from."""
    blanks: list[FloatArray] = []
    for void, outline in view.values():
        start, stop = void.reach(chart.radius, (float(outline[:, 0].min()), float(outline[:, 0].max())))
        first = stations[max(np.searchsorted(stations, start - MARGIN) - 1, 0)]
        last = stations[min(np.searchsorted(stations, stop + MARGIN), len(stations) - 1)]
        blanks.append(np.array([first, outline[:, 1].min() - MARGIN, last, outline[:, 1].max() + MARGIN]))
    polygons = tiles.polygons
    polygons[tiles.voussoir] = boxes(np.array(blanks).reshape(-1, 4))
    return replace(tiles_of(polygons, tiles.course, ""), voussoir=tiles.voussoir)


def _prism(chart: CylinderChart, void: Void, outline: FloatArray) -> manifold3d.Manifold:
    """Return the prism over an outline (n, 2) in the view of an opening, from the wall's axis to beyond its outer face."""
    middle = np.array([[void.middle, 0.0]])
    normal = normals(chart, middle)[0]
    across = np.cross([0.0, 0.0, 1.0], normal)
    foot = lift(chart, middle)[0] - chart.radius * normal
    flat = foot + outline[:, :1] * across + outline[:, 1:] * np.array([0.0, 0.0, 1.0])
    count = len(outline)
    near, far = np.arange(count), count + np.arange(count)
    sides = np.stack([near, np.roll(near, -1), np.roll(far, -1), far], axis=1)
    return manifold(np.concatenate([flat, flat + 2 * void.radii[1] * normal]), [near[::-1], far, *sides], OF_PRISM)
