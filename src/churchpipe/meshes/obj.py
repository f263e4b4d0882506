"""Wavefront OBJ: a body for each object or group, polygons as they are."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from churchpipe.findings import Finding
from churchpipe.meshes.source import Body, Face, Source, damaged, face_colours, left_out, mixed, number, read_lines

_SILENT = {"vt", "vn", "s", "mtllib", "usemap", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"}
_LEFT_OUT = {"l": "lines", "p": "points", "curv": "curves", "curv2": "curves", "surf": "surfaces", "vp": "surface parameters"}


def read_obj(path: Path) -> Source:
    """Read an OBJ; bodies are its objects (o) or its groups (g), whichever are more; usemtl names materials.

    What is in a group, or an object, called ground is ground as well.
    """
    source = Source([], "obj")
    points: list[tuple[float, float, float]] = []
    colours: list[Sequence[float]] = []
    faces: list[Face] = []
    labels: list[tuple[str, str, str]] = []
    others: Counter[str] = Counter()
    objects: set[str] = set()
    name = group = ""
    material = "default"
    row, line, word = 0, "", ""
    lines = iter(enumerate(read_lines(path, "obj"), 1))
    for row, line in lines:
        text = line.partition("#")[0].rstrip()
        while text.endswith("\\"):
            text = text[:-1] + " " + next(lines, (row, ""))[1].partition("#")[0].rstrip()
        word, _, rest = text.strip().partition(" ")
        parts = rest.split()
        if word == "v":
            try:
                x, y, z, *more = [number(part) for part in parts]
                if len(parts) not in (3, 4, 6, 7):
                    raise ValueError(line)
            except ValueError:
                source.findings.append(damaged(row, line, "v with three numbers"))
                x, y, z, *more = 0.0, 0.0, 0.0
            points.append((x, y, z))
            colours.append(more[-3:] if len(more) >= 3 else (-1.0, -1.0, -1.0))
        elif word == "f":
            face = _face(parts, len(points))
            if face is None:
                source.findings.append(damaged(row, line, f"f with three or more of the {len(points)} vertices before it"))
            else:
                faces.append(face)
                labels.append((name, group, material))
        elif word == "o":
            name = rest.strip()
            objects.add(name)
        elif word == "g":
            group = rest.strip()
        elif word == "usemtl":
            material = rest.strip() or "default"
        elif word and word not in _SILENT:
            others[_LEFT_OUT.get(word, f'lines that begin with "{word[:20]}"')] += 1
    if row > 1 and line and word != "f":
        source.findings.append(damaged(row, line, "the faces that follow: the file is truncated"))
    used = max((node for face in faces for node in face), default=-1) + 1
    if used < len(points):
        found = f"no face has the last {len(points) - used} of {len(points)} vertices: the file is truncated"
        source.findings.append(Finding("E03", found, remedy="Export it again, or delete these vertices."))
    others["objects without faces"] += len(objects - {label[0] for label in labels})
    others["vertices of no face"] += used - len({node for face in faces for node in face})
    by_object = len({label[0] for label in labels}) >= len({label[1] for label in labels})
    bodies: dict[str, tuple[list[Face], str, set[str]]] = {}
    unlike = 0
    for face, (name, group, material) in zip(faces, labels, strict=True):
        key, other = (name, group) if by_object else (group, name)
        around, stuff, within = bodies.setdefault(key, ([], material, set()))
        around.append(face)
        within.add(other)
        unlike += material != stuff
    corners = np.array(points, dtype=np.float64).reshape(-1, 3)
    entity = "object" if by_object else "group"
    shades = np.array(colours, dtype=np.float64).reshape(-1, 3)
    source.findings += mixed(unlike) + left_out(others)
    for key, (around, stuff, within) in bodies.items():
        own = face_colours(shades, around) if (shades >= 0).any() else None
        used, inverse = np.unique(np.concatenate(around), return_inverse=True)
        renamed = np.split(inverse, np.cumsum([len(face) for face in around])[:-1])
        own_faces: list[Face] = [tuple(face.tolist()) for face in renamed]
        source.bodies.append(Body(corners[used], own_faces, entity, key, stuff, colours=own, within=tuple(sorted(within))))
    return source


def _face(parts: list[str], count: int) -> Face | None:
    """Return the vertices of "1/2/3 4/5/6 ...", counted from 1, or backwards from the last one before."""
    try:
        nodes = [int(part.split("/")[0]) for part in parts]
    except ValueError:
        return None
    face = tuple(node - 1 if node > 0 else count + node for node in nodes)
    sound = len(face) >= 3 and min(face) >= 0 and max(face) < count and 0 not in nodes
    return face if sound else None
