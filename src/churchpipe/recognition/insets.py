"""Rings of voussoirs and lintels that lie in a wall: they take their place out of its bond; an opening below a ring follows its
intrados."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.geometry.planar import (
    Polygon,
    Region,
    area,
    common,
    extent,
    hull,
    less,
    mapped,
    pieces,
    polygon,
    rings,
    united,
    vertices,
)
from churchpipe.geometry.polygons import corners, snap_polygons
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Opening, Panel, PlaneChart

# Bodies of one plane that share more than this part of the smaller one lie in each other; a ring lies in a wall that has so much
# of it, for the chords of an opening drawn below it may cut into it.
SHARED, INSIDE = 1e-6, 0.9
# Of the room under an arch so much is open when it is an opening.
OPEN = 0.5
PLANE = 1e-6
# A lintel that is drawn on a face of its wall, or a little off it, may lie so far from the middle of it, m.
ASIDE = 1e-3


def with_insets(panels: Sequence[Panel]) -> list[Panel]:
    """Return the walls with the rings and lintels that lie in them, and the rings and lintels that stand alone.

    Raises
    ------
    InputError: two bodies of one plane that lie in each other and are no wall with a ring or a lintel in it; a lintel that is not
    as thick as its wall.
    """
    walls = list(panels)
    for ring in [panel for panel in panels if _is_ring(panel)]:
        for place, wall in enumerate(walls):
            if _is_inset(wall) or abs(wall.thickness - ring.thickness) > PLANE:
                continue
            laid = _in_chart(ring, wall)
            if laid and _share(united(laid), wall_region(wall)) > INSIDE:
                walls[place] = _with_ring(wall, ring, laid)
                walls.remove(ring)
                break
    for lintel in [panel for panel in panels if is_single(panel)]:
        found = [(place, wall, stone) for place, wall in enumerate(walls) for stone in _beside(lintel, wall)]
        if found:
            place, wall, stone = max(found, key=lambda one: area(common(one[2], wall_region(one[1]))))
            walls[place] = _with_lintel(wall, lintel, stone)
            walls.remove(lintel)
    for number, first in enumerate(walls):
        for second in walls[number + 1 :]:
            _check_apart(first, second)
    return walls


def outline_and_holes(region: Polygon) -> tuple[FloatArray, list[FloatArray]]:
    """Return the outline (n, 2) of a region and those of its holes, counter-clockwise, without corners on straight sides."""
    # Corners that an overlay left a rounding apart are one: each alone looks like a corner on a straight side.
    whole = (snap_polygons(np.array([polygon(ring)], dtype=np.object_))[0] for ring in rings(region))
    outer, *inner = (corners(one)[0] for one in whole)
    return outer, inner


def openings_of(holes: Sequence[FloatArray]) -> tuple[Opening, ...]:
    """Return the holes of a wall as its openings."""
    return tuple(Opening(f"opening-{number}", hole, _kind(hole)) for number, hole in enumerate(holes, 1))


def _kind(hole: FloatArray) -> Literal["rectangular", "arched"]:
    side = np.abs(np.roll(hole, -1, axis=0) - hole)
    return "arched" if side.min(axis=1).max() > PLANE else "rectangular"


def is_single(panel: Panel) -> bool:
    """Return whether a panel is one stone: a lintel that lies in no wall."""
    return all(region.pattern == "single" for region in panel.regions)


def _is_ring(panel: Panel) -> bool:
    return all(region.pattern == "voussoir" for region in panel.regions)


def _is_inset(panel: Panel) -> bool:
    return _is_ring(panel) or is_single(panel)


def _chart(panel: Panel) -> PlaneChart:
    if not isinstance(panel.chart, PlaneChart):
        raise InputError(f"wall {panel.name}.chart", "curved", expected="a plane wall")
    return panel.chart


def _moved(outline: FloatArray, panel: Panel, other: Panel) -> FloatArray | None:
    """Return points (n, 2) of a panel in the chart of another one, None where the two lie in different planes."""
    own, chart = _chart(panel), _chart(other)
    normal = np.cross(chart.s_axis, chart.t_axis)
    apart = abs((own.origin - chart.origin) @ normal)
    if np.linalg.norm(np.cross(own.s_axis, chart.s_axis)) > PLANE or apart > 0.5 * (panel.thickness + other.thickness) - PLANE:
        return None
    place = own.origin + outline[:, :1] * own.s_axis + outline[:, 1:] * own.t_axis - chart.origin
    return np.stack([place @ chart.s_axis, place @ chart.t_axis], axis=1)


def _in_chart(inset: Panel, wall: Panel) -> list[Polygon]:
    found = [_moved(region.outline, inset, wall) for region in inset.regions]
    return [polygon(outline) for outline in found if outline is not None]


def _share(part: Region, whole: Region) -> float:
    return area(common(part, whole)) / area(part)


def _beside(lintel: Panel, wall: Panel) -> list[Polygon]:
    """Return the lintel in the chart of a wall in which it lies, or which it touches; nothing of any other wall.

    Raises
    ------
    InputError: it lies in the wall, and is not as thick.
    """
    laid = [] if _is_inset(wall) else _in_chart(lintel, wall)
    if not laid or len(pieces(united([wall_region(wall), laid[0]]))) > 1:
        return []
    normal = np.cross(_chart(wall).s_axis, _chart(wall).t_axis)
    aside = abs((_chart(lintel).origin - _chart(wall).origin) @ normal)
    if abs(lintel.thickness - wall.thickness) < ASIDE and aside < ASIDE:
        return laid
    if area(common(laid[0], wall_region(wall))) <= SHARED * area(laid[0]):
        return []
    raise InputError(
        lintel.name,
        "a lintel not as thick as its wall",
        found=f"{lintel.thickness:.4g} m thick, its middle {aside:.3g} m from that of {wall.name}",
        expected=f"{wall.thickness:.4g} m, from face to face",
        remedy="Draw it as deep as the wall; a lintel without a thickness of its own is as deep as the wall that it is drawn on.",
    )


def _with_lintel(wall: Panel, lintel: Panel, stone: Polygon) -> Panel:
    for other in wall.regions:
        if other.pattern == "single" and area(common(stone, polygon(other.outline))) > SHARED * area(stone):
            remedy = "Delete one of them, or draw them end to end."
            raise InputError(
                lintel.name, "it lies in another lintel", found=other.name, expected="each drawn once", remedy=remedy
            )
    region = replace(lintel.regions[0], name=lintel.name, outline=corners(np.array([stone]))[0], material=lintel.material)
    return _reshaped(wall, united([wall_region(wall), stone]), [region])


def _with_ring(wall: Panel, ring: Panel, laid: Sequence[Polygon]) -> Panel:
    whole, solid = united(laid), wall_region(wall)
    under = less(hull(vertices(whole)), [whole])
    solid = united([solid, whole])
    if area(under) > 0 and _share(under, solid) < 1 - OPEN:
        solid = less(solid, [under])
    names = [f"{ring.name}-{region.name}" for region in ring.regions]
    return _reshaped(wall, solid, [_region(name, region, ring, wall) for name, region in zip(names, ring.regions, strict=True)])


def _reshaped(wall: Panel, solid: Region, insets: Sequence[BondRegion]) -> Panel:
    """Return a wall of another outline, with further regions in its bond."""
    # Between the chords of an opening and those of the intrados slivers may be left that hang on nothing.
    outer, inner = outline_and_holes(max(pieces(solid), key=area))
    regions = [own if own.pattern in ("voussoir", "single") else replace(own, outline=outer) for own in wall.regions]
    return replace(wall, outline=outer, openings=openings_of(inner), regions=(*regions, *insets))


def _region(name: str, region: BondRegion, ring: Panel, wall: Panel) -> BondRegion:
    outline = _moved(region.outline, ring, wall)
    centre = _moved(np.array([region.centre]), ring, wall)
    if outline is None or centre is None:
        raise InputError(ring.name, "not in the plane of its wall", found=wall.name)
    return replace(region, name=name, outline=outline, centre=(float(centre[0, 0]), float(centre[0, 1])), material=ring.material)


def _check_apart(one: Panel, other: Panel) -> None:
    """Raise InputError for two bodies of one plane that lie in each other."""
    shift = _moved(np.zeros((1, 2)), other, one)
    if shift is None:
        return
    turned = float(np.sign(_chart(one).s_axis @ _chart(other).s_axis))
    first, second = wall_region(one), mapped(wall_region(other), np.diag([turned, 1.0]), shift[0])
    shared = common(first, second)
    if area(shared) > SHARED * min(area(first), area(second)):
        low_s, low_t, high_s, high_t = extent(shared)
        raise InputError(
            other.name,
            f"it lies in {one.name}",
            found=f"{area(shared):.4g} m2 in common, {high_s - low_s:.4g} x {high_t - low_t:.4g} m",
            expected="each wall drawn once",
            remedy="Openings are drawn on a layer OPENING, or as holes through the body; lintels have a name or a layer LINTEL.",
        )
