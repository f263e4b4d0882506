"""Models of LMGC90: BODIES.DAT, with the places of DOF.INI and the driven bodies of DRV_DOF.DAT beside it."""

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from churchpipe.findings import Finding
from churchpipe.meshes.source import Body, Face, Source, damaged, left_out, number, read_lines, refused
from churchpipe.model.arrays import FloatArray
from churchpipe.model.polyhedra import solid_properties
from churchpipe.wording import counted

# "coo1=", "ver2=", "a(1)=", "nb_vertex=": a word, then a number in columns or not.
_VALUE = re.compile(r"([a-zA-Z_]+\(?\d*\)?)\s*=\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?)(?=\s|$)")
END = "$$$$$$"
_RECORD = re.compile(r"\s(RBDY[23])\s+(\d+)")
_BOX = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


@dataclass(slots=True)
class _Record:
    """A body: kind (RBDY2 or RBDY3) and number; node: centre and, in the plane, angle; solids: contactors, or outlines."""

    kind: str
    index: int
    material: str = "default"
    node: list[float] = field(default_factory=list)
    solids: list[tuple[FloatArray, list[Face]]] = field(default_factory=list)
    driven: bool = False


def read_lmgc90(path: Path) -> Source:
    """Read BODIES.DAT, or the folder that holds it; POLYR, POLYG, PLANx and JONCx are bodies, the last two ground."""
    path = path / "BODIES.DAT" if path.is_dir() else path
    source = Source([], "lmgc90")
    others: Counter[str] = Counter()
    records = _bodies(path, source, others)
    displaced = _moves(path.with_name("DOF.INI"), source)
    lost = [record for record in records if displaced and (record.kind, record.index) not in displaced]
    if lost:
        found = f"DOF.INI has no place for {counted(len(lost), 'body', 'bodies')}, the first {lost[0].kind} {lost[0].index}"
        source.findings.append(Finding("E03", found, remedy="Take the DOF.INI of this model, or delete it."))
    driven = _driven(path.with_name("DRV_DOF.DAT"), others)
    source.flat = any(record.kind == "RBDY2" for record in records)
    if source.flat and any(record.kind == "RBDY3" for record in records):
        raise refused(path, "lmgc90", "E21", "bodies of the plane (RBDY2) and of space (RBDY3) in one file")
    for record in records:
        if not record.solids:
            others["bodies without POLYR, POLYG, PLANx or JONCx"] += 1
            continue
        ground = record.driven or (record.kind, record.index) in driven
        points, faces = _placed(record, displaced.get((record.kind, record.index)))
        name = f"{record.kind}-{record.index}"
        source.bodies.append(Body(points, faces, record.kind, name, record.material, ground, whole=True))
    source.findings += left_out(others)
    return source


def _bodies(path: Path, source: Source, others: Counter[str]) -> list[_Record]:
    records: list[_Record] = []
    lines = [line for line in enumerate(read_lines(path, "lmgc90"), 1) if line[1].strip() and line[1].lstrip()[0] not in "!#"]
    position, section = 0, ""
    ends = sum(line.strip() == END for _, line in lines)
    if (begins := sum(line.split()[0] == "$bdyty" for _, line in lines)) != ends:
        found = f"{counted(begins, 'body begins', 'bodies begin')} and {counted(ends, 'ends', 'end')}"
        source.findings.append(Finding("E03", f"the file is damaged: {found}", f"{END} after each", "Export it again."))
    while position < len(lines):
        row, line = lines[position]
        position += 1
        words = line.split()
        if line.lstrip().startswith("$"):
            section = words[0].strip("$")
        elif found := _RECORD.match(f" {line.lstrip()}"):
            records.append(_Record(found[1], int(found[2])))
        elif not records or section == "bdyty":
            source.findings.append(damaged(row, line, "RBDY2 or RBDY3 with a number before the body"))
        elif section == "blmty" and "behav" in words[:-1]:
            records[-1].material = words[words.index("behav") + 1]
        elif section == "nodty":
            records[-1].node += _values(row, line, source).values()
        elif section == "tacty":
            position = _contactor(records[-1], lines, position - 1, source, others)
    return records


def _contactor(record: _Record, lines: list[tuple[int, str]], position: int, source: Source, others: Counter[str]) -> int:
    """Read the contactor that begins at a line; return the line after it."""
    row, line = lines[position]
    kind, sizes = line.split()[0], _values(row, line, source)
    position += 1
    if kind in ("POLYR", "POLYG"):
        vertices, faces = int(sizes.get("nb_vertex", 0)), int(sizes.get("nb_face", sizes.get("nb_faces", 0)))
        held = [_values(*numbered, source) for numbered in lines[position : position + vertices + faces]]
        axes = ("coo1", "coo2", "coo3") if kind == "POLYR" else ("coo1", "coo2")
        sound = len(held) == vertices + faces and all(axis in row for row in held[:vertices] for axis in axes)
        corners = [tuple(int(row.get(f"ver{k}", 0)) - 1 for k in (1, 2, 3)) for row in held[vertices:]]
        if (
            not sound
            or any(min(face) < 0 or max(face) >= vertices for face in corners)
            or vertices < 3
            or (kind == "POLYR" and not faces)
        ):
            source.findings.append(damaged(row, line, "as many vertices and faces as it announces"))
            return position
        points = np.array([[row[axis] for axis in axes] for row in held[:vertices]])
        ring: list[Face] = [tuple(range(vertices))]
        record.solids.append((points, ring if kind == "POLYG" else [(a, b, c) for a, b, c in corners]))
        return position + vertices + faces
    if kind in ("PLANx", "JONCx"):
        half = dict(sizes)
        while position < len(lines) and not lines[position][1].lstrip().startswith("$") and lines[position][1][:1] == " ":
            more = _values(*lines[position], source)
            if not any(key.startswith("ax") for key in more):
                break
            half |= more
            position += 1
        axes = [half.get(f"axe{k}", half.get(f"ax{k}", 0.0)) for k in ((1, 2, 3) if kind == "PLANx" else (1, 2))]
        if min(axes) <= 0:
            source.findings.append(damaged(row, line, "its half axes, all above 0"))
            return position
        record.driven = True
        if kind == "PLANx":
            corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
            record.solids.append((corners * axes, [tuple(face) for face in _BOX]))
        else:
            record.solids.append((np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array(axes), [(0, 1, 2, 3)]))
        return position
    if re.fullmatch(r"[A-Z]{4}[A-Zx]", kind):
        others[f"contactors {kind}"] += 1
    return position


def _placed(record: _Record, move: dict[str, float] | None) -> tuple[FloatArray, list[Face]]:
    """Return the points (n, 3) and faces of a record in space: turned about its centre, and moved."""
    offsets = np.cumsum([0, *(len(points) for points, _ in record.solids)])
    points = np.concatenate([points for points, _ in record.solids])
    faces = [
        tuple(node + int(offset) for node in face)
        for (_, around), offset in zip(record.solids, offsets, strict=False)
        for face in around
    ]
    move = move or {}
    size = points.shape[1]
    node = np.array([*record.node, 0.0, 0.0, 0.0])[:size]
    shift = np.array([move.get(f"X({k})", 0.0) for k in range(1, size + 1)])
    if size == 2:
        angle = (record.node[2] if len(record.node) > 2 else 0.0) + move.get("X(3)", 0.0)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    else:
        turn = np.array([[move.get(f"{axis}({k})", float(row + 1 == k)) for k in (1, 2, 3)] for row, axis in enumerate("abg")])
    # A body whose centre the program has yet to compute is drawn around the origin of all, and turns about its centroid.
    centre = np.zeros(size) if node.any() or size == 2 else _centroid(points, faces)
    placed = (points - centre) @ turn + centre + node + shift
    return (placed if size == 3 else np.insert(placed, 1, 0.0, axis=1)), faces


def _centroid(points: FloatArray, faces: list[Face]) -> FloatArray:
    pointer = np.cumsum([0, *(len(face) for face in faces)])
    return solid_properties(points, np.concatenate(faces), pointer, np.array([0, len(faces)]))[1][0]


def _moves(path: Path, source: Source) -> dict[tuple[str, int], dict[str, float]]:
    """Return the displacement X and the axes a, b, g of each body of DOF.INI, if there is one."""
    out: dict[tuple[str, int], dict[str, float]] = {}
    if path.is_file():
        current: dict[str, float] = {}
        for row, line in enumerate(read_lines(path, "lmgc90"), 1):
            if found := _RECORD.match(f" {line.lstrip()}"):
                current = out.setdefault((found[1], int(found[2])), {})
            elif line.lstrip()[:1] not in ("!", "$", "#"):
                current |= _values(row, line, source)
    return out


def _driven(path: Path, others: Counter[str]) -> set[tuple[str, int]]:
    """Return the bodies of DRV_DOF.DAT whose velocity is given in every direction: the ground."""
    directions: dict[tuple[str, int], set[int]] = {}
    if path.is_file():
        current: set[int] = set()
        for line in read_lines(path, "lmgc90"):
            words = line.split()
            if found := _RECORD.match(f" {line.lstrip()}"):
                current = directions.setdefault((found[1], int(found[2])), set())
            elif words[:1] == ["vlocy"] and len(words) > 1 and words[1].isdigit():
                current.add(int(words[1]))
            elif words[:1] == ["force"]:
                others["forces (give them as loads)"] += 1
    full = {key for key, given in directions.items() if len(given) >= (6 if key[0] == "RBDY3" else 3)}
    others["bodies driven in some directions alone, taken as free"] += sum(
        bool(v) for k, v in directions.items() if k not in full
    )
    return full


def _values(row: int, line: str, source: Source) -> dict[str, float]:
    """Return the values of a line; a finding where a = has no number behind it."""
    found = _VALUE.findall(line)
    try:
        if len(found) == line.count("="):
            return {key: number(text) for key, text in found}
    except ValueError:
        pass
    source.findings.append(damaged(row, line, "a number behind each ="))
    return {}
