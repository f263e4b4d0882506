"""PLY, text and binary: one set of vertices and polygons."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.findings import FindingsError
from churchpipe.meshes.source import Body, Face, Source, face_colours, number, read_bytes, refused
from churchpipe.wording import counted

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_COLOURS = ("red", "green", "blue")
_INDICES = ("vertex_indices", "vertex_index")


@dataclass(slots=True)
class _Element:
    """An element of the header: its properties as (name, type, type of the count or "" for a single value)."""

    name: str
    count: int
    properties: list[tuple[str, str, str]] = field(default_factory=list)


def read_ply(path: Path) -> Source:
    """Read a PLY; a file of the format holds one set of faces, whose closed parts are stones."""
    data = read_bytes(path, "ply")
    order, elements, start = _header(path, data)
    rows: dict[str, list[list[Any]]] = {}
    try:
        tokens = data[start:].split() if order == "" else []
        position = 0 if order == "" else start
        for element in elements:
            table: list[list[Any]] = []
            for _ in range(element.count):
                row, position = _row(element, tokens, position) if order == "" else _binary_row(element, data, position, order)
                table.append(row)
            rows[element.name] = table
        end = len(tokens) if order == "" else len(data)
        columns = [name for name, _, _ in next(e for e in elements if e.name == "vertex").properties]
        places = [columns.index(axis) for axis in "xyz"]
        points = np.array([[row[k] for k in places] for row in rows["vertex"]], dtype=np.float64).reshape(-1, 3)
        names = [name for name, _, _ in next(e for e in elements if e.name == "face").properties]
        column = next(names.index(name) for name in _INDICES if name in names)
        faces: list[Face] = [tuple(map(int, row[column])) for row in rows["face"]]
    except StopIteration:
        raise _damaged(path, "there are no vertices with x, y, z, or no faces with vertex_indices") from None
    except (ValueError, IndexError) as error:
        raise _damaged(path, f"it ends or breaks off among its numbers ({error})") from None
    if position != end:
        raise _damaged(path, f"{end - position} {'numbers' if order == '' else 'bytes'} follow the last element")
    wrong = [face for face in faces if len(face) < 3 or min(face) < 0 or max(face) >= len(points)]
    if wrong:
        found = counted(len(wrong), "face has", "faces have")
        raise _damaged(path, f"{found} fewer than 3 corners, or one beyond the {len(points)} vertices")
    if not faces:
        return Source([], "ply")
    colours = None
    if all(name in columns for name in _COLOURS):
        places = [columns.index(name) for name in _COLOURS]
        colours = face_colours(np.array([[row[k] for k in places] for row in rows["vertex"]], dtype=np.float64), faces)
    elif all(name in names for name in _COLOURS):
        places = [names.index(name) for name in _COLOURS]
        colours = np.array([[row[k] for k in places] for row in rows["face"]], dtype=np.int64)
    return Source([Body(points, faces, "mesh", colours=colours)], "ply")


def _header(path: Path, data: bytes) -> tuple[str, list[_Element], int]:
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or end < 0:
        raise refused(path, "ply", "E01", "this is no PLY file", expected="ply ... end_header", remedy="Export it again.")
    elements: list[_Element] = []
    order = None
    for line in data[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", word, _] if word in _ORDERS:
                order = _ORDERS[word]
            case ["element", name, count] if count.isascii() and count.isdigit() and int(count) <= len(data):
                elements.append(_Element(name, int(count)))
            case ["property", "list", length, kind, name] if elements and length in _TYPES and kind in _TYPES:
                elements[-1].properties.append((name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append((name, _TYPES[kind], ""))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise _damaged(path, f'the line "{line[:60]}" of its header cannot be understood')
    if order is None:
        raise _damaged(path, "its header names no format")
    newline = data.find(b"\n", end)
    return order, elements, newline + 1 if newline >= 0 else len(data)


def _row(element: _Element, tokens: list[bytes], position: int) -> tuple[list[Any], int]:
    row: list[Any] = []
    for _, kind, length in element.properties:
        count = int(tokens[position]) if length else 1
        position += 1 if length else 0
        if count < 0 or position + count > len(tokens):
            raise ValueError(f"a list of {count}")
        read = number if kind[0] == "f" else int
        values = [read(token.decode("latin-1")) for token in tokens[position : position + count]]
        row.append(values if length else values[0])
        position += count
    return row, position


def _binary_row(element: _Element, data: bytes, position: int, order: str) -> tuple[list[Any], int]:
    row: list[Any] = []
    for _, kind, length in element.properties:
        count = 1
        if length:
            size = np.dtype(length).itemsize
            count = int(np.frombuffer(data[position : position + size], order + length)[0])
            position += size
        size = np.dtype(kind).itemsize * count
        if count < 0 or position + size > len(data):
            raise ValueError(f"a list of {count}")
        values = np.frombuffer(data[position : position + size], order + kind).tolist()
        row.append(values if length else values[0])
        position += size
    return row, position


def _damaged(path: Path, found: str) -> FindingsError:
    return refused(path, "ply", "E03", f"the file is damaged: {found}", remedy="Export it again.")
