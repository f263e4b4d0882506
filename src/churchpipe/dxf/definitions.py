"""Block definitions: the body of a recurrent stone, its position tags and constant attributes, checked against each other."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from ezdxf.entities.attrib import AttDef
from ezdxf.entities.insert import Insert
from ezdxf.entities.point import Point
from ezdxf.entities.solid import Face3d

from churchpipe.dxf import schema
from churchpipe.dxf.attributes import check_volume
from churchpipe.dxf.bodies import (
    BAD_ENTITY,
    NOT_SANE,
    Body,
    bag_bodies,
    entity_bodies,
    face_corners,
    is_sane,
    is_solid,
    make_body,
    nearly_closed,
    repaired,
    smoothness,
)
from churchpipe.findings import Finding, Place
from churchpipe.geometry.mending import CLOSE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.wording import counted

Matrix = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, slots=True)
class Solid:
    """A body with the place and the layer it is drawn on."""

    body: Body
    place: Place
    layer: str


@dataclass(slots=True)
class Definition:
    """What a block (or model space) holds: solids, patches of ground, nested inserts, attributes and position tags.

    tagged: drawn by the schema, so it is one stone and `solids` is that stone, or empty when it has a flaw. nearly: handles of
    loose 3D faces that close a solid once corners are joined that nearly meet.
    """

    name: str = ""
    handle: str = ""
    tagged: bool = False
    solids: list[Solid] = field(default_factory=list)
    loose: list[Face3d] = field(default_factory=list)
    nearly: set[str] = field(default_factory=set)
    inserts: list[Insert] = field(default_factory=list)
    constants: dict[str, str] = field(default_factory=dict)
    defaults: dict[str, str] = field(default_factory=dict)
    tags: dict[str, list[FloatArray]] = field(default_factory=dict)
    invisible: int = 0
    others: list[Any] = field(default_factory=list)


def read_content(
    entities: Iterable[Any], name: str, handle: str, matrix: Matrix, findings: list[Finding], repair: bool = False
) -> Definition:
    """Sort the entities of a block or of model space; findings are placed in the world through `matrix`."""
    content = Definition(name, handle)
    points: list[Point] = []
    bags: dict[str, list[Face3d]] = {}
    for entity in entities:
        if isinstance(entity, Insert):
            content.inserts.append(entity)
        elif isinstance(entity, AttDef):
            (content.constants if entity.is_const else content.defaults)[entity.dxf.tag.strip().upper()] = entity.dxf.text.strip()
        elif isinstance(entity, Point):
            points.append(entity)
        elif isinstance(entity, Face3d) and not is_sane(face_corners(entity)):
            findings.append(Place("3DFACE", entity.dxf.handle or "", name).finding("E10", NOT_SANE))
        elif isinstance(entity, Face3d):
            bags.setdefault(entity.dxf.layer.upper(), []).append(entity)
        elif is_solid(entity) and entity.dxf.invisible:
            content.invisible += 1
        elif is_solid(entity):
            content.solids += _solids(entity, name, matrix, findings)
        else:
            content.others.append(entity)
    for bag in bags.values():
        closed, loose = bag_bodies(bag)
        content.solids += [Solid(body, _place(face, name, matrix, body.points[0]), face.dxf.layer) for face, body in closed]
        mended, left = nearly_closed(loose)
        if repair:
            loose = left
            for face, body, moved in mended:
                place = _place(face, name, matrix, body.points[0])
                content.solids.append(Solid(body, place, face.dxf.layer))
                findings.append(place.finding("W41", f"{CLOSE}, moved by {{}} at most", lengths=(moved,)))
        content.nearly |= {face.dxf.handle for face in loose} - {face.dxf.handle for face in left}
        content.loose += loose
    if handle:
        content.tags = _position_tags(points, [e for e in entities if isinstance(e, AttDef)])
    content.tagged = bool(content.tags) or bool({schema.ID, schema.VOLUME} & (content.constants.keys() | content.defaults.keys()))
    return content


def read_definition(block: Any, matrix: Matrix, findings: list[Finding], repair: bool) -> Definition:
    """Read a block definition; if it follows the schema its body, tags and constant attributes are checked once, here."""
    content = read_content(list(block), block.name, block.block_record_handle, matrix, findings, repair)
    if not content.tagged:
        return content
    place = Place("BLOCK", content.handle, content.name, _world(matrix, np.array(block.block.dxf.base_point.xyz)))
    drawn = [s for s in content.solids if s.layer.upper() == schema.SOLID] or content.solids
    if not drawn and content.inserts and not content.tags:
        content.tagged = False
        return content
    content.loose = []
    if len(drawn) > 1:
        findings.append(
            place.finding("E10", f"{len(drawn)} bodies in one definition", expected="one MESH or polyface on CP-SOLID")
        )
        content.solids = []
        return content
    body = drawn[0].body if drawn else _interface_body(content.tags)
    mendable = bool(body.flaw and repaired(body)[1])
    if repair and mendable:
        body, changes = repaired(body)
        findings += [place.finding("W41", change) for change in changes]
    if not body.flaw:
        tagged = _with_tagged_vertices(body, content.tags)
        mendable = bool(tagged.flaw)
        if repair and mendable:
            findings.append(place.finding("W41", f"{tagged.flaw}: the corners of the body are used"))
        else:
            body = tagged
    if body.flaw:
        spot = place if body.spot is None else replace(place, position=_world(matrix, np.array(body.spot)))
        remedy = "Pass --repair to mend it." if mendable else "Redraw the block."
        expected = "one closed body, its corners on V0, V1, ..."
        findings.append(spot.finding("E10", f"the body is no solid: {body.flaw}", expected=expected, remedy=remedy))
        content.solids = []
        return content
    if body.warp:
        findings.append(warped(body.warp, place))
    content.solids = [Solid(body, place, drawn[0].layer if drawn else "0")]
    findings += _check_constants(content, body, place, repair)
    return content


def warped(warp: float, place: Place) -> Finding:
    """Return what is to be said of a body with faces that are warped by so much at most."""
    found = "warped faces, with corners up to {} out of their plane, are taken as triangles"
    return place.finding("W10", found, lengths=(warp,))


def hollow(place: Place, voids: int) -> list[Finding]:
    """Return what is to be said of so many bodies within stones whose faces look the other way."""
    if not voids:
        return []
    found = f"{counted(voids, 'body', 'bodies')} within a stone, with faces that look the other way, taken for voids in it"
    return [place.finding("W29", found, remedy="Turn the faces, and make room for it, if it is a stone.")]


def transformed(points: FloatArray, matrix: Matrix) -> FloatArray:
    """Return points (n, 3) moved by a matrix: rows of its 3 x 3 part are the images of the axes."""
    # Where a number becomes too large, whoever takes the points says so.
    with np.errstate(over="ignore", invalid="ignore"):
        return points @ matrix[0] + matrix[1]


def _solids(entity: Any, block: str, matrix: Matrix, findings: list[Finding]) -> list[Solid]:
    place = Place(entity.dxftype(), entity.dxf.handle or "", block)
    try:
        bodies = entity_bodies(entity)
    except BAD_ENTITY as error:
        bodies = []
        findings.append(place.finding("E21", f"its data cannot be read ({error})", remedy="Convert it to a MESH or explode it."))
    else:
        if not bodies:
            findings.append(place.finding("E21", "no planar faces in it", remedy="Convert it to a MESH with planar faces."))
        if len(bodies) > 1:
            found = f"{len(bodies)} solids in one entity; each is a stone"
            where = _place(entity, block, matrix, bodies[0].points[0])
            findings.append(where.finding("W42", found, remedy="Draw each as an entity of its own if the case is to name them."))
        findings += hollow(place, sum(body.voids for body in bodies))
        if level := smoothness(entity):
            found = f"the mesh is shown smoothed, to level {level}: what is seen is rounder and smaller than its faces"
            remedy = "Set its smoothness to none if its faces are those of the stone, or convert it to a solid."
            findings.append(place.finding("E21", found, expected="a mesh without smoothing", remedy=remedy))
    return [Solid(b, _place(entity, block, matrix, b.points[0]) if len(b.points) else place, entity.dxf.layer) for b in bodies]


def _place(entity: Any, block: str, matrix: Matrix, point: FloatArray) -> Place:
    return Place(entity.dxftype(), entity.dxf.handle or "", block, _world(matrix, point))


def _world(matrix: Matrix, point: FloatArray) -> tuple[float, float, float]:
    x, y, z = transformed(point[None], matrix)[0].tolist()
    return x, y, z


def _position_tags(points: list[Point], attdefs: list[AttDef]) -> dict[str, list[FloatArray]]:
    """Return tag -> places of the POINTs that carry it, as XDATA or as an attribute definition lying on them."""
    named = [(a, a.dxf.tag.strip().upper()) for a in attdefs]
    lying = {tuple(np.round(a.dxf.insert.xyz, 9)): tag for a, tag in named if schema.is_position_tag(tag)}
    out: dict[str, list[FloatArray]] = {}
    for point in points:
        where = point.dxf.location
        if point.has_xdata(schema.APPID):
            texts = [str(tag.value).strip().upper() for tag in point.get_xdata(schema.APPID) if tag.code == 1000]
        else:
            texts = [lying.get(tuple(np.round(where.xyz, 9)), "")]
        for text in texts:
            if schema.is_position_tag(text):
                out.setdefault(text, []).append(np.array(where.xyz))
    return out


def _interface_body(tags: dict[str, list[FloatArray]]) -> Body:
    """Return the body whose faces are the polygons F<face>.<corner>."""
    corners = {
        tuple(map(int, m.groups())): places[0] for tag, places in tags.items() if (m := schema.INTERFACE_TAG.fullmatch(tag))
    }
    order = sorted(corners)
    if not order:
        return Body(np.zeros((0, 3)), (), "neither a MESH or polyface on CP-SOLID nor points F<face>.<corner> on CP-INTERFACE")
    faces: dict[int, list[int]] = {}
    for index, (face, _) in enumerate(order):
        faces.setdefault(face, []).append(index)
    return make_body(np.array([corners[key] for key in order]), faces.values())


def _with_tagged_vertices(body: Body, tags: dict[str, list[FloatArray]]) -> Body:
    """Return the body with its points where the tags V0, V1 ... are and in their order; a flaw when the two disagree."""
    tagged = {int(m[1]): places for tag, places in tags.items() if (m := schema.VERTEX_TAG.fullmatch(tag))}
    if not tagged:
        return body
    for index in range(max(len(body.points), max(tagged) + 1)):
        if len(tagged.get(index, [])) != 1:
            state = "is missing" if index not in tagged else "is there more than once"
            return replace(body, flaw=f"position tag V{index} {state}, the body has {len(body.points)} corners")
    points = np.array([tagged[i][0] for i in range(len(tagged))])
    if not is_sane(points):
        return replace(body, flaw=f"of a vertex point {NOT_SANE}")
    if len(points) != len(body.points):
        return replace(body, flaw=f"{len(points)} vertex points, but the body has {len(body.points)} corners")
    distance = np.linalg.norm(points[:, None] - body.points[None], axis=2)
    nearest = distance.argmin(axis=0)
    off = distance.min(axis=0)
    if off.max() > schema.CORNER_TOLERANCE * np.linalg.norm(np.ptp(points, axis=0)) or len(set(nearest)) != len(points):
        worst = body.points[int(off.argmax())]
        return replace(body, flaw="a corner has no vertex point on it", spot=(float(worst[0]), float(worst[1]), float(worst[2])))
    return replace(make_body(points, [[int(nearest[i]) for i in face] for face in body.faces]), warp=body.warp)


def _check_constants(content: Definition, body: Body, place: Place, repair: bool) -> list[Finding]:
    """Compare VOLUME, NFACES and the centroid of a definition with its body."""
    stone = Assemblage.from_polyhedra([(body.points, body.faces)], unit_weight=1.0)
    volume, centroid = float(stone.volume[0]), stone.centroid[0]
    out: list[Finding] = []
    if (text := content.constants.get(schema.VOLUME)) is None:
        # An attribute that varies is read from the inserts.
        if schema.VOLUME not in content.defaults:
            out.append(place.finding("W13", "no attribute VOLUME; it was computed from the faces"))
    else:
        out += check_volume(text, volume, place, repair)
    if (text := content.constants.get(schema.NFACES)) is not None and not body.warp and text != str(len(body.faces)):
        out.append(place.finding("W14", f'attribute NFACES = "{text}"', expected=f"{len(body.faces)} as drawn, which is used"))
    if not any(schema.VERTEX_TAG.fullmatch(tag) for tag in content.tags):
        out.append(place.finding("W13", "no vertex points V0, V1, ...; the corners of the body are used"))
    drawn = content.tags.get(schema.CENTROID_TAG, [])
    if not drawn:
        out.append(place.finding("W13", "no centroid point G; it was computed from the faces"))
    elif not is_sane(drawn[0]) or not np.linalg.norm(drawn[0] - centroid) <= schema.VOLUME_TOLERANCE * np.linalg.norm(
        np.ptp(body.points, axis=0)
    ):
        out.append(place.finding("W14", "the centroid point G is off", expected="the centroid of the faces, which is used"))
    return out
