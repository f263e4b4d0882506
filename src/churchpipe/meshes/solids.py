"""The bodies of a file to stones: parted, mended or refused, and every change told."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.spatial import ConvexHull

from churchpipe.dxf.definitions import hollow
from churchpipe.dxf.reading import Up
from churchpipe.dxf.schema import LARGEST_COORDINATE
from churchpipe.dxf.stones import Stone
from churchpipe.findings import Finding, Place
from churchpipe.geometry.degenerate import degenerate
from churchpipe.geometry.hollows import with_voids
from churchpipe.geometry.manifolds import manifold, polyhedron
from churchpipe.geometry.mending import BARE, REPAIRS, SPLIT, WELDED, Mended, flat, mend
from churchpipe.geometry.parts import parts_of
from churchpipe.meshes.source import GROUND, Body, Face, Source, left_out
from churchpipe.model.arrays import FloatArray
from churchpipe.model.surfaces import CROWDED, DOUBLED, edges
from churchpipe.wording import counted

# Rows: the axes of the model in coordinates of the file.
AXES: Final[dict[str, FloatArray]] = {
    "z": np.eye(3),
    "y": np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]),
    "x": np.array([[0, 0, -1.0], [0, 1.0, 0], [1.0, 0, 0]]),
    "-z": np.array([[1.0, 0, 0], [0, -1.0, 0], [0, 0, -1.0]]),
    "-y": np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]),
    "-x": np.array([[0, 0, 1.0], [0, 1.0, 0], [-1.0, 0, 0]]),
}
CLOSED = "planar faces that close"
APART = " If these are several stones that touch, nothing tells them apart: save each as an object or a file of its own instead."
# A ground of one face gets this part of its size as depth.
PLATE = 0.1
# Materials of stones that have a colour and no material; of more colours than these each stone has its own, which say nothing.
COLOUR, MOST_COLOURS = "colour-", 12


@dataclass(frozen=True, slots=True)
class Parted:
    """A body of a file and its parts: points (n, 3) in units of the file, faces; and the material of each."""

    body: Body
    parts: list[tuple[FloatArray, list[Face]]]
    materials: list[str]

    @property
    def sizes(self) -> list[float]:
        """Geometric mean of the extents of each part, those left out in which it is flat, units of the file."""
        boxes = [np.ptp(points, axis=0) for points, _ in self.parts]
        return [float(np.exp(np.log(box[box > 1e-3 * box.max()]).mean())) for box in boxes if box.any()]


def parted(source: Source) -> list[Parted]:
    """Return the bodies of a file with their parts; what cannot be read joins the findings of the source."""
    out: list[Parted] = []
    unused, without_area = 0, 0
    for given in source.bodies:
        if flaw := _insane(given.points, given.faces):
            source.findings.append(given.place.finding("E10", f"the body cannot be read: {flaw}", expected=CLOSED))
            continue
        body = given if source.flat else _with_areas(given)
        without_area += len(given.faces) - len(body.faces)
        parts: list[tuple[FloatArray, list[Face]]] = []
        materials: list[str] = []
        shells = [[k] for k in range(len(body.faces))] if source.flat else parts_of(body.points, body.faces)
        stones = shells if source.flat else with_voids(body.points, body.faces, shells)
        source.findings += hollow(body.place, len(shells) - len(stones))
        for part in stones:
            used, inverse = np.unique(np.concatenate([body.faces[number] for number in part]), return_inverse=True)
            sizes = np.cumsum([len(body.faces[number]) for number in part])[:-1]
            parts.append((body.points[used], [tuple(face.tolist()) for face in np.split(inverse.ravel(), sizes)]))
            materials.append(_material(body, part))
        out.append(Parted(body, parts, materials))
        unused += len(body.points) - len({node for face in given.faces for node in face})
    source.findings += left_out({"vertices of no face": unused, "faces without an area": without_area})
    colours = {name for item in out for name in item.materials if name.startswith(COLOUR)}
    if len(colours) > MOST_COLOURS:
        source.findings += left_out({"colours, too many for materials": len(colours)})
    if len(colours) > MOST_COLOURS or len({name for item in out for name in item.materials}) == 1:
        out = [replace(item, materials=[item.body.material] * len(item.parts)) for item in out]
    return out


def _with_areas(body: Body) -> Body:
    """Return a body without faces that are lines, as long as others are left."""
    lines = {*degenerate(body.points, body.faces)}
    if not lines or len(lines) == len(body.faces):
        return body
    kept = [number for number in range(len(body.faces)) if number not in lines]
    colours = None if body.colours is None else body.colours[kept]
    return replace(body, faces=[body.faces[number] for number in kept], colours=colours)


def _material(body: Body, faces: Sequence[int]) -> str:
    """Return the material of a part of a body: its name, or that of the one colour of its faces."""
    if body.material != "default" or body.colours is None:
        return body.material
    found = np.unique(body.colours[list(faces)], axis=0)
    red, green, blue = found[0].tolist()
    return f"{COLOUR}{red:02x}{green:02x}{blue:02x}" if len(found) == 1 and red >= 0 else body.material


def to_stones(
    bodies: Sequence[Parted], factor: float, up: Up, thickness: float | None, repair: bool, findings: list[Finding]
) -> list[Stone]:
    """Return stones in m, z up, of bodies; findings, in m too, say what was done to them.

    factor: m of one unit of the file. thickness: m, of outlines; None for solids. A body whose name, group or material begins
    with ground, support or foundation is fixed. What alone it belongs to is its layer; else its own name if it is several.
    """
    stones: list[Stone] = []
    flats, ground = 0, []
    for item in bodies:
        body = item.body
        # A body of one of several files has the name of the file before its own.
        names = (body.name, body.name.rpartition("/")[2], body.material, *body.within)
        by_name = any(map(GROUND.match, names))
        fixed = body.fixed or by_name
        ground += [body.name or body.material] if by_name and not body.fixed else []
        shells: list[tuple[Mended, str]] = []
        for (points, faces), material in zip(item.parts, item.materials, strict=True):
            points = points @ AXES[up].T * factor
            shell = mend(*(_extruded(points, faces, thickness) if thickness else (points, faces)), repair=repair)
            if shell.fault and flat(body.points, body.faces) and flat(points, faces):
                flats += not fixed
                if not fixed:
                    continue
                shell = mend(*_plate(points), repair=False)
            elif shell.fault and len(item.parts) > 1 and not thickness and flat(points, faces):
                # A face that hangs on a stone, or lies loose in it.
                if repair:
                    findings.append(_place(body, points).finding("W41", f"{BARE} ({len(faces)})"))
                    continue
                shell = replace(shell, mendable=True)
            findings += _findings_of(shell, body)
            shells += [] if shell.fault else [(shell, material)]
        if body.whole and len(shells) > 1:
            shells = [(_united([shell for shell, _ in shells], body, findings), shells[0][1])]
        layer = body.within[0] if len(body.within) == 1 else ""
        # What holds several stones names them as a group does. The name of all that is in a file tells no parts.
        layer = body.name if not any(body.within) and len(shells) > 1 and len(bodies) > 1 else layer
        for number, (shell, material) in enumerate(shells, 1):
            name = body.name or f"stone-{len(stones) + 1}"
            name = f"{name}.{number}" if body.name and len(shells) > 1 else name
            place = _place(body, shell.points, name)
            stones.append(Stone(shell.points, tuple(shell.faces), fixed, place, name, material, layer=layer))
        if len(shells) > 1 and body.name:
            place = _place(body, shells[0][0].points)
            findings.append(place.finding("W42", f"{len(shells)} solids under one name; each is a stone"))
    if ground:
        listed = ", ".join(dict.fromkeys(ground[:8])) + (" and more" if len(ground) > 8 else "")
        found = counted(len(ground), "body is ground by its name", "bodies are ground by their names")
        findings.append(Finding("W43", f"{found}: {listed}"))
    findings += left_out({"flat faces that enclose nothing": flats})
    return stones


def _place(body: Body, points: FloatArray, name: str = "") -> Place:
    x, y, z = points.mean(axis=0).tolist() if len(points) else (0.0, 0.0, 0.0)
    return Place(body.entity, "", name or body.name, (x, y, z))


def _insane(points: FloatArray, faces: Sequence[Face]) -> str:
    if not faces:
        return "it has no faces"
    if not (np.abs(points) <= LARGEST_COORDINATE).all():
        return f"a coordinate is no number up to {LARGEST_COORDINATE:g}"
    if min(map(min, faces)) < 0 or max(map(max, faces)) >= len(points):
        return f"a face refers to a vertex beyond the {len(points)} there are"
    return "" if min(map(len, faces)) >= 3 else "a face has fewer than three corners"


def _findings_of(mended: Mended, body: Body) -> list[Finding]:
    """Return what was done to a body, or why it is no solid."""
    place = _place(body, mended.points)
    if mended.fault:
        place = _place(body, mended.points[[mended.fault.vertex]])
        hole = _around_hole(mended) if mended.fault.problem in (DOUBLED, CROWDED) else mended.points[:0]
        if len(hole):
            found = (
                f"a face is missing beside this edge, perhaps where stones touch: {len(hole)} edges have an odd number of faces"
            )
            remedy = "Close the stone in the program that made it, or save each stone as an object or a file of its own."
            return [_place(body, hole[:1]).finding("E10", found, expected="two faces at each edge of each stone", remedy=remedy)]
        remedy = "Pass --repair to mend it." if mended.mendable else "Close it in the program that made it."
        remedy += APART if mended.fault.problem in (DOUBLED, CROWDED) else ""
        # Faces have no numbers that the file would show: their place tells them.
        what = "two faces have the same corners" if mended.fault.problem == DOUBLED else mended.fault.found
        found = f"the body is no solid: {mended.fault.problem}, {what}"
        return [place.finding("E10", found, expected=mended.fault.expected, remedy=remedy)]
    out: list[Finding] = []
    for what, count in mended.changes.items():
        if what == WELDED and body.loose:
            continue
        if what == SPLIT:
            found = f"{counted(count, 'face is', 'faces are')} warped, by {{}} at most, and split into triangles"
            out.append(place.finding("W10", found, lengths=(mended.warp,)))
        elif what in REPAIRS:
            volumes = f"volume {mended.volume_before:.6g} m3 before, {mended.volume:.6g} m3 after"
            out.append(place.finding("W41", f"{what} ({count}); {volumes}"))
        else:
            out.append(place.finding("W40", f"{what} ({count})"))
    return out


def _around_hole(mended: Mended) -> FloatArray:
    """Return the middles (n, 3) of the edges that an odd number of faces share: stones that touch have two faces each there."""
    shared = Counter((min(edge), max(edge)) for face in mended.faces for edge in edges(face))
    odd = [edge for edge, count in shared.items() if count % 2]
    return mended.points[np.array(odd, dtype=np.int64).reshape(-1, 2)].mean(axis=1)


def _united(shells: list[Mended], body: Body, findings: list[Finding]) -> Mended:
    solid = manifold(shells[0].points, shells[0].faces)
    for shell in shells[1:]:
        solid += manifold(shell.points, shell.faces, first=100_000)
    points, faces = polyhedron(solid)
    whole = mend(points, [tuple(face.tolist()) for face in faces], repair=False)
    before = sum(shell.volume for shell in shells)
    found = f"{len(shells)} hulls were united to one stone; volume {before:.6g} m3 together, {whole.volume:.6g} m3 united"
    findings.append(_place(body, points).finding("W44", found))
    return whole


def _extruded(outline: FloatArray, faces: Sequence[Face], thickness: float) -> tuple[FloatArray, list[Face]]:
    """Return prisms over outlines in the plane of x and z, from y = 0."""
    count = len(outline)
    points = np.concatenate([outline, outline + np.array([0.0, thickness, 0.0])])
    out: list[Face] = []
    for face in faces:
        out += [face, tuple(node + count for node in face[::-1])]
        out += [(b, a, a + count, b + count) for a, b in zip(face, (*face[1:], face[0]), strict=True)]
    return points, out


def _plate(points: FloatArray) -> tuple[FloatArray, list[Face]]:
    """Return a solid below flat faces of ground: its outline is their hull."""
    level = points - points.mean(axis=0)
    side, _, normal = np.linalg.svd(level)[2]
    up = normal if normal[2] >= 0 else -normal
    plan = np.column_stack([level @ side, level @ np.cross(up, side)])
    # The corners of a hull in the plane run counter-clockwise.
    top = points[ConvexHull(plan).vertices]
    depth = PLATE * float(np.ptp(level, axis=0).max())
    count = len(top)
    sides: list[Face] = [(i, i + count, (i + 1) % count + count, (i + 1) % count) for i in range(count)]
    return np.concatenate([top, top - depth * up]), [tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1)), *sides]
