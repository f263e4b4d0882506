"""From model space to stones: nested, arrayed and mirrored inserts followed down to the bodies they place."""

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from ezdxf.entities.insert import Insert
from ezdxf.entities.polyline import Polymesh
from ezdxf.entities.solid import Solid
from ezdxf.xclip import XClip

from churchpipe.dxf import schema
from churchpipe.dxf.attributes import read_labels
from churchpipe.dxf.bodies import BAD_ENTITY, NOT_SANE, Faces, ground_plate, is_sane, repaired
from churchpipe.dxf.carried import Drawn
from churchpipe.dxf.definitions import Definition, Matrix, read_content, read_definition, transformed, warped
from churchpipe.dxf.inserts import (
    DEEPEST,
    DRAWN,
    MOST_INSERTS,
    Hidden,
    TooDeepError,
    array_offsets,
    array_size,
    count_inserts,
    entity_layer,
)
from churchpipe.dxf.traces import KINDS, Trace, traces_of
from churchpipe.findings import Finding, Place
from churchpipe.geometry.mending import signed_volume
from churchpipe.geometry.warped import split_warped
from churchpipe.model.arrays import FloatArray
from churchpipe.wording import counted

IDENTITY: Matrix = (np.eye(3), np.zeros(3))
HIDDEN = "hidden or on frozen or off layers"
# Parts of an insert or polyline: alone in a drawing they show that something else was lost.
ORPHANS = ("ATTRIB", "VERTEX", "SEQEND")
# Axes of an insert at angles whose cosine is below this are at right angles.
SKEW_TOLERANCE = 1e-9
# Two lengths of the axes of an insert that differ by less are one scale.
STRETCH_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class Stone:
    """One stone as drawn, in drawing units: points (n, 3), outward faces, and its labels.

    size: side of the square as large as its outline, when that alone was drawn. layer: of a solid without labels. tagged: of the
    layout that churchpipe writes.
    """

    points: FloatArray
    faces: Faces
    fixed: bool
    place: Place
    name: str
    material: str
    panel: str = ""
    course: int = -1
    butts: bool = False
    size: float | None = None
    layer: str = ""
    tagged: bool = False


@dataclass(frozen=True, slots=True)
class _Branch:
    """The way down to an insert: matrix, layer that "0" stands for, ground or not, names of inserts and blocks passed."""

    matrix: Matrix = IDENTITY
    layer: str = "0"
    fixed: bool = False
    names: tuple[str, ...] = ()
    blocks: tuple[str, ...] = ()


@dataclass(slots=True)
class Survey:
    """What a walk through model space gathers; flawed: the sizes of the bodies that are no stones, in drawing units; carried:
    ties and line loads."""

    repair: bool
    hidden: Hidden
    stones: list[Stone] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    nameless: list[Place] = field(default_factory=list)
    flawed: list[float] = field(default_factory=list)
    traces: list[Trace] = field(default_factory=list)
    definitions: dict[str, Definition] = field(default_factory=dict)
    carried: list[Drawn] = field(default_factory=list)


def survey(doc: Any, repair: bool) -> Survey:
    """Walk through the model space of an ezdxf document; what is hidden, referenced or on paper is counted."""
    frozen = frozenset(layer.dxf.name.upper() for layer in doc.layers if layer.is_frozen())
    off = frozenset(layer.dxf.name.upper() for layer in doc.layers if layer.is_off())
    found = Survey(repair, Hidden(off | frozen, frozen))
    try:
        asked = count_inserts(doc.modelspace(), {})
        if asked > MOST_INSERTS:
            found.findings.append(Finding("E23", f"nested and arrayed inserts ask for {asked} stones", f"at most {MOST_INSERTS}"))
            return found
        _visit(found, read_content(list(doc.modelspace()), "", "", IDENTITY, found.findings, repair), _Branch())
        for layout in doc.layouts:
            if layout.is_any_paperspace:
                drawn = sum(e.dxftype() in DRAWN for e in layout)
                found.left_out["in paper space"] += drawn
    except TooDeepError as deep:
        what = f"blocks nested more than {DEEPEST} deep, from {deep.trail[0]} on down to {deep.trail[-1]}"
        remedy = f'Explode "{deep.trail[0]}" once or twice.'
        found.findings.append(Finding("E08", what, f"at most {DEEPEST} levels", remedy))
        return found
    except BAD_ENTITY as error:
        found.findings.append(Finding("E03", f"the file is damaged: its layouts cannot be read ({error})"))
    return found


def summary(found: Survey) -> list[Finding]:
    """Return the findings that count what was left out and what has no name."""
    out: list[Finding] = []
    left_out = ", ".join(f"{count} {what}" for what, count in sorted(found.left_out.items()) if count)
    if left_out:
        out.append(Finding("W18", f"left out: {left_out}"))
    if found.nameless:
        first = found.nameless[0]
        what = (
            f"{counted(len(found.nameless), 'body', 'bodies')} without attributes, this one the first; named by handle, "
            'and walls by layer where each layer holds the stones of one plane wall, or walls to be laid; material "default"'
        )
        out.append(first.finding("W22", what))
    return out


def _visit(found: Survey, content: Definition, branch: _Branch) -> None:
    """Gather everything that one level of the drawing holds."""
    for index, solid in enumerate(content.solids):
        layer = entity_layer(solid.layer, branch.layer)
        if layer in found.hidden.all:
            found.left_out[HIDDEN] += 1
            continue
        if solid.body.flaw and found.repair:
            body, changes = repaired(solid.body)
            found.findings += [solid.place.finding("W41", change) for change in changes]
            solid = replace(solid, body=body)
        if solid.body.flaw:
            expected = "faces that close"
            place = solid.place if solid.body.spot is None else _at(solid.place, branch.matrix, np.array(solid.body.spot))
            remedy = (
                "Close it in the CAD program." if found.repair or not repaired(solid.body)[1] else "Pass --repair to mend it."
            )
            what = f"the body is no solid: {solid.body.flaw}"
            found.findings.append(place.finding("E10", what, expected=expected, remedy=remedy))
            found.flawed.append(solid.body.size)
            continue
        place = _at(solid.place, branch.matrix, solid.body.points[0])
        name = "/".join((*branch.names, place.handle)) + (f".{index}" if _shares_handle(content, index) else "")
        points, faces, warp = _placed(solid.body.points, solid.body.faces, branch.matrix)
        if warp or solid.body.warp:
            found.findings.append(warped(max(warp, solid.body.warp), place))
        found.nameless.append(place)
        ground = _is_ground(found, layer, branch, place)
        found.stones.append(Stone(points, faces, ground, place, name, "default", layer=layer))
    found.left_out[HIDDEN] += content.invisible
    for face in content.loose:
        _visit_loose(found, face, branch, nearly=face.dxf.handle in content.nearly)
    for other in content.others:
        if other.dxftype() in ORPHANS:
            place = Place(other.dxftype(), other.dxf.handle or "", content.name)
            found.findings.append(place.finding("E03", "it has lost the entity it belongs to"))
            continue
        layer = entity_layer(other.dxf.layer, branch.layer)
        if other.dxftype() not in KINDS:
            found.left_out[f"{other.dxftype()} (no solid)"] += 1
        elif isinstance(other, Polymesh):
            found.left_out["polygon meshes (explode them to 3D faces)"] += 1
        elif layer in found.hidden.all or other.dxf.invisible:
            found.left_out[HIDDEN] += 1
        elif isinstance(other, Solid) and len(other.wcs_vertices()) < 4:
            found.left_out[f"{other.dxftype()} of three corners, as arrowheads are"] += 1
        else:
            _gather_traces(found, other, branch, layer)
    for insert in content.inserts:
        try:
            _visit_insert(found, insert, branch)
        except BAD_ENTITY as error:
            place = Place("INSERT", insert.dxf.handle or "", insert.dxf.get("name", ""))
            found.findings.append(place.finding("E03", f"its data cannot be read ({error})"))


def _gather_traces(found: Survey, entity: Any, branch: _Branch, layer: str) -> None:
    place = Place(entity.dxftype(), entity.dxf.handle or "", branch.blocks[-1] if branch.blocks else "")
    try:
        traces = traces_of(entity, branch.matrix, place, layer, branch.fixed)
    except BAD_ENTITY as error:
        found.findings.append(place.finding("E03", f"its data cannot be read ({error})"))
        return
    if not all(is_sane(trace.points) and is_sane(np.array(trace.depth)) for trace in traces):
        found.findings.append(place.finding("E10", NOT_SANE))
    elif traces:
        found.traces += traces
    else:
        found.left_out[f"{entity.dxftype()} without length"] += 1


def _visit_loose(found: Survey, face: Any, branch: _Branch, *, nearly: bool) -> None:
    layer = entity_layer(face.dxf.layer, branch.layer)
    corner = np.array(face.dxf.vtx0.xyz)
    place = _at(Place("3DFACE", face.dxf.handle or ""), branch.matrix, corner)
    if layer in found.hidden.all:
        found.left_out[HIDDEN] += 1
    elif not _is_ground(found, layer, branch, place):
        close = "Pass --repair to join corners that nearly meet" if nearly else "Close it"
        remedy = f"{close}, or put it on CP-SUPPORT if it is ground."
        found.findings.append(
            place.finding("E10", "a 3D face that belongs to no closed solid", expected="a solid", remedy=remedy)
        )
    else:
        plates = ground_plate(face)
        for index, plate in enumerate(plates):
            if plate.flaw:
                found.findings.append(place.finding("E10", f"the patch of ground is no face: {plate.flaw}"))
                continue
            points, faces, _ = _placed(plate.points, plate.faces, branch.matrix)
            name = "/".join((*branch.names, f"ground-{place.handle}")) + (f".{index}" if len(plates) > 1 else "")
            found.stones.append(Stone(points, faces, True, place, name, "default"))
        if not plates:
            found.findings.append(place.finding("E10", "the patch of ground has no area"))


def _visit_insert(found: Survey, insert: Insert, branch: _Branch) -> None:
    """Follow an insert, each member of an array by itself."""
    layer = entity_layer(insert.dxf.layer, branch.layer)
    name = insert.dxf.name
    place = Place("INSERT", insert.dxf.handle or "", name)
    where = np.array(insert.ocs().to_wcs(insert.dxf.insert).xyz)
    if not is_sane(where):
        found.findings.append(place.finding("E10", f"in the placing of the insert {NOT_SANE}"))
        return
    place = _at(place, branch.matrix, where)
    block = insert.block()
    many = array_size(insert)
    if insert.dxf.invisible or found.hidden.hides(insert, layer):
        found.left_out[HIDDEN] += many
    elif block is None:
        remedy = "Insert the block again from its source, or delete the insert."
        found.findings.append(place.finding("E06", f"the block {name} is not defined", expected="its definition", remedy=remedy))
    elif block.block is not None and (block.block.is_xref or block.block.is_xref_overlay):
        found.left_out["external references (bind them to read them)"] += many
    elif name.upper() in branch.blocks:
        remedy = "Redraw the block without the insert of itself."
        way = " > ".join((*branch.blocks[branch.blocks.index(name.upper()) :], name.upper()))
        found.findings.append(place.finding("E08", f"the block contains itself: {way}", remedy=remedy))
    else:
        rows = np.array(list(insert.matrix44().rows()), dtype=float)
        if XClip(insert).is_clipping_enabled:
            found.findings.append(place.finding("W30", "the insert is clipped (XCLIP): all of its block is read, hidden or not"))
        if layer in (schema.TIES, schema.LOADS):
            found.carried += _carried(insert, branch, layer, place)
            return
        origins = rows[3, :3] + array_offsets(insert)
        if not (is_sane(rows) and is_sane(origins)):
            found.findings.append(place.finding("E10", f"in the placing of the insert {NOT_SANE}"))
            return
        axes, origins = rows[:3, :3] @ branch.matrix[0], transformed(origins, branch.matrix)
        fixed = _is_ground(found, layer, branch, place)
        for index, origin in enumerate(origins):
            suffix = f"[{index}]" if many > 1 else ""
            deeper = _Branch((axes, origin), layer, fixed, branch.names, branch.blocks)
            _visit_member(found, insert, block, deeper, place, suffix)


def _carried(insert: Insert, branch: _Branch, layer: str, place: Place) -> list[Drawn]:
    """Return ties or line loads, one a member of an array: the line in their block, and their attributes."""
    lines = [part for part in insert.virtual_entities() if part.dxftype() == "LINE"]
    ends = np.array([[end.xyz for end in (line.dxf.start, line.dxf.end)] for line in lines[:1]]).reshape(-1, 3)
    texts = {a.dxf.tag.strip().upper(): a.dxf.text.strip() for a in insert.attribs}
    good = len(lines) == 1 and is_sane(ends)
    offsets = array_offsets(insert)
    out: list[Drawn] = []
    for index, offset in enumerate(offsets):
        own = {**texts, "NAME": f"{texts['NAME']}[{index}]"} if texts.get("NAME") and len(offsets) > 1 else texts
        out.append(Drawn(layer, transformed(ends + offset, branch.matrix) if good else None, own, place))
    return out


def _visit_member(found: Survey, insert: Insert, block: Any, branch: _Branch, place: Place, suffix: str) -> None:
    base = np.array(block.block.dxf.base_point.xyz)
    if not (is_sane(branch.matrix[0]) and is_sane(branch.matrix[1]) and is_sane(base)):
        found.findings.append(place.finding("E10", f"in the placing of the insert {NOT_SANE}"))
        return
    place = _at(place, branch.matrix, base)
    content = found.definitions.get(place.block.upper())
    if content is None:
        content = found.definitions[place.block.upper()] = read_definition(block, branch.matrix, found.findings, found.repair)
    if not _is_rigid(found, branch.matrix, place):
        return
    texts = {a.dxf.tag.strip().upper(): a.dxf.text.strip() for a in insert.attribs}
    own = texts.get(schema.ID) or place.handle
    before = len(found.stones) + len(found.traces)
    labelled = content.tagged or (len(content.solids) == 1 and bool(texts))
    if labelled and content.solids:
        if entity_layer(content.solids[0].layer, branch.layer) in found.hidden.all:
            found.left_out[HIDDEN] += 1
        else:
            _add_stone(found, content, texts, branch, place, suffix)
        content = Definition(tagged=True, inserts=content.inserts)
    deeper = _Branch(
        branch.matrix, branch.layer, branch.fixed, (*branch.names, own + suffix), (*branch.blocks, place.block.upper())
    )
    _visit(found, content, deeper)
    if (
        len(found.stones) + len(found.traces) == before
        and not content.tagged
        and not (content.solids or content.inserts or content.loose)
    ):
        if branch.layer in (schema.BLOCKS, *schema.GROUND):
            expected = "a MESH or polyface on CP-SOLID, or points F<face>.<corner> on CP-INTERFACE"
            found.findings.append(place.finding("E10", "no body in the block", expected=expected))
        else:
            found.left_out["INSERT (no solid)"] += 1


def _is_rigid(found: Survey, matrix: Matrix, place: Place) -> bool:
    """Report an insert that skews (an error) or stretches (a warning); return whether its stone can be used."""
    gram = matrix[0] @ matrix[0].T
    length = np.sqrt(np.diag(gram))
    if length.min() <= 0:
        found.findings.append(place.finding("E10", f"the insert has the scale {np.round(length, 6).tolist()}", expected="no 0"))
        return False
    cosine = np.abs(gram / np.outer(length, length) - np.eye(3)).max()
    if cosine > SKEW_TOLERANCE:
        angle = float(np.degrees(np.arccos(min(cosine, 1.0))))
        remedy = "Explode the outer block, or scale it evenly."
        found.findings.append(
            place.finding("E09", f"the insert skews its stone to {angle:.2f} degrees", expected="right angles", remedy=remedy)
        )
        return False
    if np.ptp(length) > STRETCH_TOLERANCE * length.max():
        scale = " x ".join(f"{s:.6g}" for s in length)
        found.findings.append(place.finding("W09", f"the insert stretches its stone by {scale}; volume and faces follow"))
    return True


def _add_stone(found: Survey, content: Definition, texts: dict[str, str], branch: _Branch, place: Place, suffix: str) -> None:
    body = content.solids[0].body
    points, faces, warp = _placed(body.points, body.faces, branch.matrix)
    if warp:
        found.findings.append(warped(warp, place))
    labels = read_labels(
        texts,
        content.constants,
        content.defaults,
        place,
        volume=signed_volume(points, faces) if schema.VOLUME in texts else 0.0,
        required=content.tagged,
        repair=found.repair,
    )
    found.findings += labels.findings
    name = "/".join((*branch.names, labels.name + suffix))
    own = (labels.material, labels.panel, labels.course, labels.butts)
    found.stones.append(Stone(points, faces, branch.fixed, place, name, *own, tagged=content.tagged))


def _placed(points: FloatArray, faces: Faces, matrix: Matrix) -> tuple[FloatArray, Faces, float]:
    """Move a body; a mirrored one gets its faces turned so that they look outwards again.

    Faces that were just flat enough in their block may be warped in an insert that stretches them: those are split into
    triangles. Also returned is how far they are warped at most, drawing units, 0 where none is.
    """
    place = transformed(points, matrix)
    turned = tuple(face[::-1] for face in faces) if np.linalg.det(matrix[0]) < 0 else faces
    if (matrix[0] ** 2).sum(axis=1).max() <= (1.0 + STRETCH_TOLERANCE) ** 2:
        return place, turned, 0.0
    split, count, warp = split_warped(place, turned)
    return place, tuple(split) if count else turned, warp


def _is_ground(found: Survey, layer: str, branch: _Branch, place: Place) -> bool:
    """Return whether what lies on a layer is ground; that a layer is known by its name alone is said."""
    if not branch.fixed and layer in schema.GROUND and layer != schema.SUPPORT:
        found.findings.append(place.finding("W43", f"ground by its layer, {layer}"))
    return branch.fixed or layer in schema.GROUND


def _at(place: Place, matrix: Matrix, point: FloatArray) -> Place:
    x, y, z = transformed(point[None], matrix)[0].tolist()
    return Place(place.entity, place.handle, place.block, (x, y, z))


def _shares_handle(content: Definition, index: int) -> bool:
    return sum(s.place.handle == content.solids[index].place.handle for s in content.solids) > 1
