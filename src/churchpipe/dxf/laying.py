"""Whole walls of a file to stones, where the person asked for a bond to be laid in them."""

import re
from collections import Counter
from collections.abc import Sequence
from itertools import count

import numpy as np

from churchpipe.dxf.stones import Stone
from churchpipe.errors import InputError
from churchpipe.findings import Finding, Place
from churchpipe.geometry.charts import ALONG, counted_from
from churchpipe.model.arrays import FloatArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building, Panel
from churchpipe.model.materials import UnitWeight
from churchpipe.recognition.insets import is_single
from churchpipe.recognition.laying import LaidBond, Volume, joined, laid_panel, lowest
from churchpipe.recognition.lintels import LEVEL, SEAT, LaidLintel, bare_heads, bearings, beyond, slight, with_lintels
from churchpipe.recognition.overhangs import FREE, overhangs
from churchpipe.recognition.slanted import slanted_meetings
from churchpipe.recognition.squaring import squared
from churchpipe.stones.blocks import derive_blocks
from churchpipe.wording import counted

# Walls that are moved by less, m, so that they meet are not spoken of: it is what rounding leaves in a file.
SAID = 1e-4


def laid_stones(bodies: Sequence[Stone], bond: LaidBond, unit: float, findings: list[Finding]) -> list[Stone]:
    """Return the stones laid in the free bodies of a file, after the fixed ones, which stay as they are.

    unit: of the file, m. What keeps a body from being a wall joins the findings, and so does what was laid.
    """
    fixed = [body for body in bodies if body.fixed]
    free = [body for body in bodies if not body.fixed]
    if not free:
        return fixed
    names = _names(free)
    volumes = [Volume(name, body.material, body.points * unit, list(body.faces)) for name, body in zip(names, free, strict=True)]
    place = {name: body.place for name, body in zip(names, free, strict=True)}
    base = lowest(volumes)
    panels: list[Panel] = []
    for volume in volumes:
        try:
            panels.append(laid_panel(volume, base, bond))
        except InputError as error:
            findings.append(_refused(error, place))
    if len(panels) < len(volumes):
        return fixed
    lintels: list[LaidLintel] = []
    try:
        panels, moved = squared(panels)
        findings += [_moved(name, by, place[name]) for name, by in moved.items() if by > SAID]
        panels = joined(panels)
        if bond.lintel_bearing:
            panels, lintels = with_lintels(panels, bond.lintel_bearing)
        materials = tuple(UnitWeight(name, 1.0) for name in dict.fromkeys(body.material for body in free))
        stones = derive_blocks(Building("walls", tuple(panels), materials, ground=None))
    except InputError as error:
        findings.append(_refused(error, place))
        return fixed
    findings += [_finding(panel, stones, place[panel.name]) for panel in panels]
    findings += [_alone(panel, place[panel.name]) for panel in panels if is_single(panel)]
    asked = bond.lintel_bearing or 0.0
    findings += [said for panel in panels for said in _bearings(panel, lintels, asked, place[panel.name])]
    findings += [said for panel in panels for said in _unborne(panel, place[panel.name])]
    findings += [said for panel in panels for said in _slight(panel, place[panel.name])]
    findings += [said for panel in panels for said in _beyond(panel, place[panel.name])]
    findings += [said for panel in panels for said in _bare_heads(panel, place[panel.name])]
    findings += [_slanted(*meeting, place[meeting[0].name]) for meeting in slanted_meetings(panels)]
    supports = [body.points * unit for body in fixed]
    findings += [said for panel in panels for said in _overhangs(panel, panels, supports, place[panel.name])]
    return [*fixed, *_stones(stones, place, unit)]


def _refused(error: InputError, place: dict[str, Place]) -> Finding:
    # Of a junction the place is that of its first wall; a wall may be named as part of another one is, and the whole name counts.
    # The word before the name is none: a drawing without layers has a wall that is called so.
    words = error.where.removeprefix("wall ")
    named = [found for name in place if (found := re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", words))]
    first = min(named, key=lambda found: (found.start(), -len(found.group())), default=None)
    at = place[first.group()] if first else Place("", "")
    found = f"no stones can be laid in {error.where}: {error.problem}" + (f", {error.found}" if error.found else "")
    return at.finding("E28", found, expected=error.expected, remedy=error.remedy)


def _names(bodies: Sequence[Stone]) -> list[str]:
    """Return names for the walls: those of their layers or bodies, numbered where several bear one."""
    # A solid without attributes is known by its layer; all that is drawn without care lies on layer 0.
    names = [body.panel or (body.name if body.layer == "0" else body.layer or body.name) for body in bodies]
    shared = {name: count(1) for name, times in Counter(names).items() if times > 1}
    return [f"{name}-{next(shared[name])}" if name in shared else name for name in names]


def _finding(panel: Panel, stones: Assemblage, place: Place) -> Finding:
    own = stones.panel == panel.name
    bonds = [region for region in panel.regions if region.pattern not in ("voussoir", "single")]
    rings = [region for region in panel.regions if region.pattern == "voussoir"]
    lintels = sum(region.pattern == "single" for region in panel.regions)
    voussoirs = sum(region.pieces for region in rings)
    laid: list[str] = []
    for region in bonds:
        sizes = f"courses of {region.cell.a:.3g} m{_top(panel, stones, region.cell.a)}, about {region.cell.b:.3g} m long"
        laid.append(f"{counted(int(own.sum()) - voussoirs - lintels, 'stone')} in {region.pattern} bond, {sizes}")
    laid += [f"{voussoirs} voussoirs, about {rings[0].cell.a:.3g} m wide"] if rings else []
    laid += [counted(lintels, "lintel")] if lintels else []
    return place.finding("W28", f'"{panel.name}": laid {", and ".join(laid)}; {stones.volume[own].sum():.6g} m3')


def _top(panel: Panel, stones: Assemblage, course: float) -> str:
    """Return how high the top course of a wall with a level top is, where that is no whole course; "" where it is."""
    level = panel.outline[:, 1] >= panel.outline[:, 1].max() - LEVEL
    own = np.flatnonzero((stones.panel == panel.name) & stones.coursed)
    if np.ptp(panel.outline[level, 0]) <= LEVEL or not len(own):
        return ""
    top = own[stones.course[own] == stones.course[own].max()].tolist()
    height = max(float(np.ptp(stones.points[slice(*stones.block_point_ptr[stone : stone + 2]), 2])) for stone in top)
    return "" if abs(height - course) <= 0.01 * course else f", the top one of {height:.3g} m"


def _moved(name: str, by: float, place: Place) -> Finding:
    found = f'"{name}": moved by {1e3 * by:.2g} mm at most, to meet other walls at right angles and at their faces'
    remedy = "Draw it so that it ends on the face of the other wall, at a right angle, or further away from it than that."
    return place.finding("W28", found, remedy=remedy)


def _alone(lintel: Panel, place: Place) -> Finding:
    found = f'"{lintel.name}": a lintel that neither lies in a wall nor touches one in its plane: it stands alone'
    remedy = "Draw it on a face of its wall, as deep as the wall; or give it another name or layer if it is a wall."
    return place.finding("W28", found, remedy=remedy)


def _bearings(panel: Panel, lintels: Sequence[LaidLintel], asked: float, place: Place) -> list[Finding]:
    """Return what is to be said of lintels of a wall that do not bear as far as was asked."""
    other = [one for one in lintels if one.wall == panel.name and np.abs(np.array(one.bearing) - asked).max() > LEVEL]
    if not other:
        return []
    listed = "; ".join(
        f"{one.bearing[0]:.3g} m on the left and {one.bearing[1]:.3g} m on the right of the opening from {one.head.start:.4g} to "
        f"{one.head.stop:.4g} {ALONG}, {one.head.level:.4g} m high"
        for one in other
    )
    found = f'"{panel.name}": lintels do not bear {asked:.3g} m where other openings, walls or ends are near: {listed}'
    found += f", {counted_from(panel.chart)}"
    return [place.finding("W28", found, remedy="Draw the lintel as an outline on a layer LINTEL if it is another.")]


def _unborne(panel: Panel, place: Place) -> list[Finding]:
    """Return what is to be said of lintels that do not rest on their wall on both sides: friction at their ends holds them."""
    loose = [(name, left, right) for name, left, right in bearings(panel) if min(left, right) <= LEVEL]
    if is_single(panel) or not loose:
        return []
    listed = "; ".join(
        f"{name} on neither side" if max(left, right) <= LEVEL else f"{name} only on the {'left' if left > right else 'right'}"
        for name, left, right in loose
    )
    found = f'"{panel.name}": lintels that do not rest on the wall on both sides: {listed}'
    remedy = "Draw them longer than the opening; friction at their ends alone holds them, and the shell takes them for held."
    return [place.finding("W28", found, remedy=remedy)]


def _slight(panel: Panel, place: Place) -> list[Finding]:
    """Return what is to be said of lintels so low, or so little borne, that a slip is likely."""
    if is_single(panel) or not (found := slight(panel)):
        return []
    listed = "; ".join(
        f"{name}, {1e3 * high:.3g} mm high and {long:.3g} m long, bears {1e3 * rests:.3g} mm at one end"
        for name, high, long, rests in found
    )
    few = f"borne by less than {1e3 * SEAT:g} mm, or lower, or borne by less, than a fiftieth of their length"
    what = f'"{panel.name}": lintels {few}: {listed}'
    return [place.finding("W28", what, remedy="Draw them as they are, or ask for more bearing, if that is not meant.")]


def _beyond(panel: Panel, place: Place) -> list[Finding]:
    """Return what is to be said of lintels that reach beyond the ends or the top of their wall."""
    if is_single(panel) or not (found := [f"{name} by {reach:.3g} m" for name, reach in beyond(panel)]):
        return []
    what = f'"{panel.name}": lintels that reach beyond the ends or the top of their wall: {"; ".join(found)}'
    return [place.finding("W28", what, remedy="Draw them shorter if that is not meant.")]


def _bare_heads(panel: Panel, place: Place) -> list[Finding]:
    """Return what is to be said of openings without lintel or arch: the friction of head joints holds the stones over it."""
    heads = bare_heads(panel)
    if not heads:
        return []
    flat = sum(head.flat for head in heads)
    kinds = [f"openings with a flat head and no lintel ({flat})"] if flat else []
    kinds += [f"openings with a curved head and no arch ({len(heads) - flat})"] if flat < len(heads) else []
    found = f'"{panel.name}": {", ".join(kinds)}: friction of head joints holds the stones over it'
    remedy = (
        "No shell stands over it without cohesion: shear dies out towards its free edge, nothing else holds what hangs there. "
        "Draw the lintel on a layer LINTEL, or an arch over it as a ring of its own"
    )
    # Over a curved head none is laid, whatever is asked.
    remedy += "; --lintel-bearing lays lintels over flat heads." if flat else "."
    return [place.finding("W28", found, remedy=remedy)]


def _overhangs(panel: Panel, walls: Sequence[Panel], supports: Sequence[FloatArray], place: Place) -> list[Finding]:
    """Return what is to be said of masonry over openings that has a free end: no lintel can be laid there."""
    if is_single(panel) or not (found := overhangs(panel, walls, supports)):
        return []
    what = (
        f'"{panel.name}": masonry that is {FREE}: {"; ".join(map(str, found))}, {counted_from(panel.chart)}. Friction of head '
        "joints and the weight of the wall on its other end hold it, and a lintel on it bears on what hangs"
    )
    remedy = "Draw what bears its free end, such as a pier, or one head at one height from side to side with a lintel over it."
    return [place.finding("W28", what, remedy=remedy)]


def _slanted(one: Panel, other: Panel, angle: float, place: Place) -> Finding:
    found = (
        f'"{one.name}" and "{other.name}" meet at {angle:.3g} degrees: no junction is laid there, and nothing holds them together'
    )
    return place.finding("W28", found, remedy="Draw the stones where they meet if they are bonded there.")


def _stones(stones: Assemblage, place: dict[str, Place], unit: float) -> list[Stone]:
    out: list[Stone] = []
    corners = np.diff(stones.face_ptr)
    for block in range(stones.count):
        first, last = stones.block_point_ptr[block : block + 2]
        faces = np.arange(*stones.block_face_ptr[block : block + 2])
        sizes = corners[faces]
        nodes = stones.face_nodes[ragged_indices(stones.face_ptr[faces], sizes)] - first
        rings = tuple(tuple(ring.tolist()) for ring in np.split(nodes, np.cumsum(sizes)[:-1]))
        name, panel = str(stones.block_id[block]), str(stones.panel[block])
        points = stones.points[first:last] / unit
        out.append(Stone(points, rings, False, place[panel], name, str(stones.material[block]), panel, int(stones.course[block])))
    return out
