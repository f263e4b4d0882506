"""The blocks of a 3DEC data file: `poly ... face`, `poly brick` (up to version 5), `block create polyhedron` and `brick` (7)."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from churchpipe.findings import Finding
from churchpipe.meshes.source import Body, Face, Source, damaged, left_out, number, read_lines

_CREATE = re.compile(r"\s*(block\s+create\s+)?poly(hedron)?\b", re.IGNORECASE)
_BRICK = re.compile(r"\s*(block\s+create|poly(hedron)?)\s+brick\b", re.IGNORECASE)
_OTHERS = re.compile(r"\s*(block\s+create\s+|poly\s+)(prism|tunnel|tetrahedron|cube)\b", re.IGNORECASE)
# Commands that leave other blocks than those that were made before them, or take them from another file.
_SHAPING = re.compile(
    r"\s*(jset|del(ete)?|split|tunnel|excavate|call|program\s+call|rest(ore)?|model\s+restore|import"
    r"|block\s+(cut|del(ete)?|split|excavate|generate|import|densify))\b",
    re.IGNORECASE,
)
_NEW = re.compile(r"\s*block\s+cr", re.IGNORECASE)
_FACE = re.compile(r"\bface[\s(]+[-+.\d]", re.IGNORECASE)
_FIX = re.compile(r"\s*(block\s+)?fix\b", re.IGNORECASE)
_JOIN = re.compile(r"\s*(block\s+)?join\b", re.IGNORECASE)
_REGION = re.compile(r"\b(?:region|reg|r)\s*=?\s*(\d+)", re.IGNORECASE)
_GROUP = re.compile(r"""\bgroup\s*=?\s*(?:"([^"]*)"|'([^']*)'|([^\s"']+))""", re.IGNORECASE)
_MATERIAL = re.compile(r"\b(?:material|mat|m)\s*=?\s*(\d+)", re.IGNORECASE)
_WORDS = re.compile(rf"({_REGION.pattern}|{_GROUP.pattern}|{_MATERIAL.pattern}|\bid\s*=?\s*\d+|\s)*", re.IGNORECASE)
_SHAPE = "face with the coordinates of three corners or more"
_SIZES = "x, y and z from the lower to the higher end: six numbers, or two for a cube"
_OWN = "Give each a group of its own if the case is to name them."
# Faces of a brick, counterclockwise from outside; x, y and z of its corners 0 to 7 are the digits of a binary number.
_SIDES: list[Face] = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


@dataclass(frozen=True, slots=True)
class _Block:
    """A polyhedron: corners of its faces one after the other, and what its command says besides."""

    points: list[tuple[float, float, float]]
    faces: list[Face]
    region: str
    group: str
    material: str


def read_3dec(path: Path) -> Source:
    """Read the polyhedra of a 3DEC data file; `fix` makes ground of a region or group, `join` one stone of a region."""
    source = Source([], "3dec")
    blocks: list[_Block] = []
    fixed: set[tuple[str, str]] = set()
    joined: set[str] = set()
    others: Counter[str] = Counter()
    for row, line in _commands(read_lines(path, "3dec")):
        region, group = _first(_REGION, line), _first(_GROUP, line)
        if _OTHERS.match(line):
            others["blocks that are no polyhedra"] += 1
        elif _CREATE.match(line) or _BRICK.match(line):
            brick = _BRICK.match(line) is not None
            if (block := _brick(line) if brick else _block(line)) is None:
                source.findings.append(damaged(row, line, _SIZES if brick else _SHAPE))
            else:
                blocks.append(block)
        elif _NEW.match(line):
            others["blocks that are no polyhedra"] += 1
        elif _FACE.search(line):
            source.findings.append(damaged(row, line, "poly or block create polyhedron before its faces"))
        elif _SHAPING.match(line):
            source.findings.append(_shaping(row, line))
        elif _FIX.match(line) and (region or group):
            fixed.add(("region", region) if region else ("group", group))
        elif _JOIN.match(line) and region:
            joined.add(region)
        elif _FIX.match(line) or _JOIN.match(line):
            others["fix and join commands whose range is neither a region nor a group"] += 1
    source.findings += left_out(others)
    counted = Counter(block.region for block in blocks)
    stones: dict[str, list[_Block]] = {}
    for index, block in enumerate(blocks, 1):
        one = block.region and (block.region in joined or counted[block.region] == 1)
        stones.setdefault(f"region-{block.region}" if one else f"block-{index}", []).append(block)
    sharing, numbered = Counter(parts[0].group for parts in stones.values()), Counter[str]()
    for name, parts in stones.items():
        ground = any({("region", part.region), ("group", part.group)} & fixed for part in parts)
        if group := parts[0].group:
            numbered[group] += 1
            name = f"{group}.{numbered[group]}" if sharing[group] > 1 else group
        source.bodies.append(_body(name, parts, ground))
    source.findings += [
        Finding("W42", f'the group "{group}" has {count} blocks: "{group}.1" to "{group}.{count}"', remedy=_OWN)
        for group, count in sharing.items()
        if group and count > 1
    ]
    return source


def _body(name: str, parts: list[_Block], ground: bool) -> Body:
    offsets = np.cumsum([0, *(len(part.points) for part in parts)])
    faces = [tuple(node + int(o) for node in face) for part, o in zip(parts, offsets, strict=False) for face in part.faces]
    points = np.array([point for part in parts for point in part.points], dtype=np.float64).reshape(-1, 3)
    material = f"material-{parts[0].material}" if parts[0].material else "default"
    groups = tuple(dict.fromkeys(part.group for part in parts if part.group))
    return Body(points, faces, "block", name, material, ground, whole=len(parts) > 1, loose=True, within=groups)


def _shaping(row: int, line: str) -> Finding:
    """Return the finding of a command that shapes blocks: without it they are not those of the model."""
    shown = line.strip()
    shown = shown if len(shown) <= 60 else shown[:57] + "..."
    remedy = "Write the blocks out as they are after it, as polyhedra or a mesh; delete the line if they are to stay as they are."
    return Finding("E21", f'a command that shapes blocks, which is not followed, at line {row}: "{shown}"', remedy=remedy)


def _brick(line: str) -> _Block | None:
    """Return the brick of a command, None where its sizes are not numbers in order."""
    rest = _BRICK.sub("", line, count=1)
    end = re.search(r"(?<![\d.])[a-zA-Z].*", rest)
    words, sizes = (end[0], rest[: end.start()]) if end else ("", rest)
    try:
        values = [number(word) for word in re.split(r"[\s,()]+", sizes.strip(" \t,()"))]
    except ValueError:
        return None
    values = values * 3 if len(values) == 2 else values
    if len(values) != 6 or not all(low < high for low, high in zip(values[::2], values[1::2], strict=True)):
        return None
    corners = [(x, y, z) for x in values[:2] for y in values[2:4] for z in values[4:]]
    if not _WORDS.fullmatch(words):
        return None
    return _Block(corners, _SIDES, _first(_REGION, words), _first(_GROUP, words), _first(_MATERIAL, words))


def _block(line: str) -> _Block | None:
    """Return the polyhedron of a command, None where a face is not numbers, three to a corner."""
    head, *around = re.split(r"\bface\b", line, flags=re.IGNORECASE)
    words = _CREATE.sub("", head, count=1)
    end = re.search(r"(?<![\d.])[a-zA-Z].*", around[-1]) if around else None
    if end:
        words, around[-1] = f"{words} {end[0]}", around[-1][: end.start()]
    points: list[tuple[float, float, float]] = []
    faces: list[Face] = []
    for face in around:
        try:
            values = [number(word) for word in re.split(r"[\s,()]+", face.strip(" \t,()"))]
        except ValueError:
            return None
        if len(values) % 3 or len(values) < 9:
            return None
        # The program wants its faces clockwise from outside.
        faces.append(tuple(range(len(points), len(points) + len(values) // 3))[::-1])
        points += [(values[i], values[i + 1], values[i + 2]) for i in range(0, len(values), 3)]
    if not faces or not _WORDS.fullmatch(words):
        return None
    return _Block(points, faces, _first(_REGION, words), _first(_GROUP, words), _first(_MATERIAL, words))


def _commands(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Yield each command with the number of its first line; ; begins a comment, and & or ... goes on with the next line."""
    held, first = "", 0
    for row, line in enumerate(lines, 1):
        text = line.partition(";")[0].rstrip()
        first = row if not held else first
        if text.endswith(("&", "...")):
            held += text.rstrip("&.") + " "
            continue
        yield first, held + text
        held = ""
    if held:
        yield first, held


def _first(pattern: re.Pattern[str], text: str) -> str:
    found = pattern.search(text)
    return next((word for word in found.groups() if word is not None), "") if found else ""
