"""3MF: the objects of the build plate, with their names, placed; triangles, in the unit of the file."""

import zipfile
import zlib
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from churchpipe.findings import FindingsError
from churchpipe.meshes.source import Body, Face, Source, left_out, number, read_bytes, refused
from churchpipe.model.arrays import FloatArray

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
UNITS = {"micron": "mm", "millimeter": "mm", "centimeter": "cm", "inch": "in", "foot": "ft", "meter": "m"}
MICRON = 1e-3
# A model of this many bytes is none of a building.
LARGEST_MODEL = 2_000_000_000
DEEPEST = 20
# What a damaged archive, or a damaged model in it, lets out.
BAD_ARCHIVE = (
    zipfile.BadZipFile,
    ElementTree.ParseError,
    NotImplementedError,
    OSError,
    EOFError,
    RuntimeError,
    ValueError,
    zlib.error,
)

Matrix = tuple[FloatArray, FloatArray]


def read_3mf(path: Path) -> Source:
    """Read a 3MF: each object on the build plate is a body, its components followed.

    A component without a name, or the only one of its object, has the name of the object.
    """
    read_bytes(path, "3mf")
    try:
        with zipfile.ZipFile(path) as archive:
            names = [info for info in archive.infolist() if info.filename.lower().endswith(".model")]
            if not names:
                raise _damaged(path, "there is no model in it")
            if sum(info.file_size for info in names) > LARGEST_MODEL:
                raise _damaged(path, f"its model has more than {LARGEST_MODEL:.0e} bytes")
            roots = [ElementTree.fromstring(archive.read(info)) for info in names]
    except FindingsError:
        raise
    except BAD_ARCHIVE as error:
        raise _damaged(path, str(error)) from error
    said = roots[0].get("unit", "millimeter")
    if said not in UNITS:
        raise _damaged(path, f"it says that its unit is {said!r}, of which 3MF knows nothing")
    source = Source([], "3mf", unit=UNITS[said])
    objects = {item.get("id", ""): item for root in roots for item in root.iter(f"{CORE}object")}
    bases = {
        group.get("id", ""): [base.get("name", "") for base in group.iter(f"{CORE}base")]
        for root in roots
        for group in root.iter(f"{CORE}basematerials")
    }
    others: Counter[str] = Counter()
    try:
        for item in (item for root in roots for item in root.iter(f"{CORE}item")):
            if item.get("printable") == "0":
                others["objects that are not to be printed"] += 1
            else:
                turn, shift = _matrix(item.get("transform"))
                factor = MICRON if said == "micron" else 1.0
                _place(source, objects, bases, item, (factor * turn, factor * shift), "", 0)
    except (ValueError, KeyError) as error:
        raise _damaged(path, f"an object, a vertex, a triangle or a transform cannot be understood ({error})") from error
    source.findings += left_out(others)
    return source


def _place(
    source: Source,
    objects: dict[str, ElementTree.Element],
    bases: dict[str, list[str]],
    item: ElementTree.Element,
    matrix: Matrix,
    name: str,
    depth: int,
    *,
    sole: bool = False,
) -> None:
    """Add the bodies of an item or a component to the source.

    name: of the object that it is a component of; sole: whether it is the only one.
    """
    if depth > DEEPEST:
        raise ValueError("components nested too deep")
    thing = objects[item.get("objectid", "")]
    name = name if sole and name else thing.get("name") or name
    components = [*thing.iter(f"{CORE}component")]
    for component in components:
        inner = _matrix(component.get("transform"))
        placed = inner[0] @ matrix[0], inner[1] @ matrix[0] + matrix[1]
        _place(source, objects, bases, component, placed, name, depth + 1, sole=len(components) == 1)
    mesh = thing.find(f"{CORE}mesh")
    if mesh is None:
        return
    rows = [[number(vertex.attrib[axis]) for axis in "xyz"] for vertex in mesh.iter(f"{CORE}vertex")]
    points = np.array(rows, dtype=np.float64).reshape(-1, 3) @ matrix[0] + matrix[1]
    faces: list[Face] = [(int(t.attrib["v1"]), int(t.attrib["v2"]), int(t.attrib["v3"])) for t in mesh.iter(f"{CORE}triangle")]
    if any(min(face) < 0 or max(face) >= len(points) for face in faces):
        raise ValueError(f"a triangle with a vertex beyond the {len(points)} there are")
    group = bases.get(thing.get("pid", ""), [])
    index = thing.get("pindex", "")
    material = (group[int(index)] if index.isdecimal() and int(index) < len(group) else "") or "default"
    # A support structure of the printer is no support of the building.
    source.bodies.append(Body(points, faces, "object", name or f"object-{item.get('objectid')}", material))


def _matrix(text: str | None) -> Matrix:
    """Return the 3 x 3 part, by rows the images of the axes, and the shift of a transform of 12 numbers."""
    values = [number(word) for word in text.split()] if text else [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0, 0, 0, 0]
    table = np.array(values, dtype=np.float64).reshape(4, 3)
    return table[:3], table[3]


def _damaged(path: Path, found: str) -> FindingsError:
    return refused(path, "3mf", "E03", f"the file is damaged: {found}", remedy="Export it again.")
