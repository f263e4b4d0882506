"""STL, text and binary: facets in the order they were written, each solid a body."""

import re
from pathlib import Path

import numpy as np

from churchpipe.meshes.source import Body, Source, damaged, number, read_bytes, read_lines, refused

HEADER = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("colour", "<u2")])


def read_stl(path: Path) -> Source:
    """Read an STL. Of each three corners of a facet the place is known alone: those at one place are welded later on."""
    data = read_bytes(path, "stl")
    facets = int.from_bytes(data[HEADER - 4 : HEADER], "little")
    if len(data) >= HEADER and len(data) == HEADER + _FACET.itemsize * facets:
        corners = np.frombuffer(data, dtype=_FACET, offset=HEADER)["corner"].astype(np.float64)
        return Source([_body(corners.reshape(-1, 3), "")] if facets else [], "stl")
    if re.match(rb"\s*solid\b", data, re.IGNORECASE) and b"\0" not in data:
        return _read_text(path)
    held = max(len(data) - HEADER, 0) / _FACET.itemsize
    found = f"the file announces {facets} facets and holds {held:g}"
    raise refused(path, "stl", "E03", found, expected="a text that begins with solid, or all facets", remedy="Export it again.")


def _read_text(path: Path) -> Source:
    source = Source([], "stl")
    corners: list[tuple[float, float, float]] = []
    name, inside, before = "", False, 0
    for row, line in enumerate(read_lines(path, "stl"), 1):
        word, *parts = line.split() or [""]
        word = word.lower()
        if word == "vertex":
            try:
                x, y, z = map(number, parts)
                corners.append((x, y, z))
            except ValueError:
                source.findings.append(damaged(row, line, "vertex with three numbers"))
                corners.append((0.0, 0.0, 0.0))
        elif word == "facet":
            before = len(corners)
        elif word == "endfacet" and len(corners) != before + 3:
            source.findings.append(damaged(row, line, f"three vertices in the facet, not {len(corners) - before}"))
            corners = [*corners[:before], *[(0.0, 0.0, 0.0)] * 3]
        elif word == "solid":
            if inside:
                source.findings.append(damaged(row, line, "endsolid before the next solid"))
            name, inside, corners = " ".join(parts), True, []
        elif word == "endsolid" and inside:
            source.bodies += [_body(np.array(corners), name)] if corners else []
            inside, corners = False, []
        elif word not in ("", "outer", "endloop", "endfacet"):
            source.findings.append(damaged(row, line, "a word of STL: facet, vertex, endfacet ..."))
    if inside:
        source.findings.append(damaged(row, line, "endsolid as the last line: the file is truncated"))
    return source


def _body(corners: np.ndarray, name: str) -> Body:
    facets = np.arange(len(corners) // 3 * 3).reshape(-1, 3)
    return Body(corners[: facets.size], [(a, b, c) for a, b, c in facets.tolist()], "solid", name, loose=True)
