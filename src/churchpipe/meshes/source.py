"""What a file of bodies says, before anything is judged or mended; and the opening of files."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from churchpipe.dxf.reading import Up
from churchpipe.dxf.schema import LARGEST_COORDINATE
from churchpipe.findings import Finding, Findings, FindingsError, Place
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.wording import counted

Face = tuple[int, ...]

# How names begin by which a body is ground. The ground floor is a storey of the building.
GROUND: Final = re.compile(r"(?!ground[\s_.-]*(floor|stor))(ground|support|foundation)s?(?![a-z])", re.IGNORECASE)
# Kinds of lines, or files, that one finding names.
MOST_NAMED: Final = 12


@dataclass(frozen=True, slots=True)
class Body:
    """What a file holds under one name: points (n, 3) in units of the file, faces in any state.

    entity: what it is in the file ("group", "object"); fixed: the file says that it is ground. whole: one stone, even where its
    faces are several closed parts, which are then united; else each closed part is a stone. loose: the format gives each face
    vertices of its own, so that welding them is no news. colours (nf, 3): red, green and blue of each face, 0 to 255, -1 where
    its corners differ; None without any. within: names of what it belongs to, such as the groups of an object.
    """

    points: FloatArray
    faces: list[Face]
    entity: str
    name: str = ""
    material: str = "default"
    fixed: bool = False
    whole: bool = False
    loose: bool = False
    colours: IntArray | None = None
    within: tuple[str, ...] = ()

    @property
    def place(self) -> Place:
        """Where it is, as findings say it."""
        sound = len(self.points) > 0 and bool((np.abs(self.points) <= LARGEST_COORDINATE).all())
        x, y, z = self.points.mean(axis=0).tolist() if sound else (math.nan, math.nan, math.nan)
        return Place(self.entity, "", self.name, (x, y, z) if sound else None)


@dataclass(slots=True)
class Source:
    """A file's bodies, in its order; unit: the name of its unit, None when it says none; up: the axis that points up.

    flat: the bodies are outlines, one face each, in the plane of x and z, that want a thickness.
    """

    bodies: list[Body]
    reader: str
    unit: str | None = None
    up: Up = "z"
    findings: list[Finding] = field(default_factory=list)
    flat: bool = False


def face_colours(colours: FloatArray, faces: Sequence[Face]) -> IntArray:
    """Return `Body.colours` from the colours (n, 3) of the vertices, 0 to 1 or 0 to 255."""
    scaled = np.rint(np.clip(colours, -1.0, 256.0) * (255.0 if colours.max(initial=0.0) <= 1.0 else 1.0))
    corners = np.concatenate([scaled[list(face)] for face in faces])
    start = np.cumsum([0, *(len(face) for face in faces)])[:-1]
    low, high = np.minimum.reduceat(corners, start), np.maximum.reduceat(corners, start)
    sound = (low == high).all(axis=1) & (low >= 0).all(axis=1) & (high <= 255).all(axis=1)
    return np.where(sound[:, None], low, -1.0).astype(np.int64)


def mixed(faces: int) -> list[Finding]:
    """Return the finding of so many faces with another material than the body that they belong to."""
    found = f"{counted(faces, 'face has', 'faces have')} another material than the body, which has that of its first face"
    return [Finding("W18", found, remedy="Give each body one material, and a name of its own.")] if faces else []


def refused(path: Path, reader: str, code: str, found: str, *, expected: str = "", remedy: str = "") -> FindingsError:
    """Return the error of a file that cannot be read on."""
    return FindingsError(Findings(path.name, (Finding(code, found, expected, remedy),), reader))


def read_bytes(path: Path, reader: str) -> bytes:
    """Return what is in a file that is not empty."""
    try:
        data = path.read_bytes()
    except OSError as error:
        found = f"the file cannot be read ({error.strerror or error})"
        raise refused(path, reader, "E01", found, remedy="Check the path and the rights.") from error
    if not data.strip(b"\0 \t\r\n"):
        raise refused(path, reader, "E01", "the file is empty", remedy="Export it again.")
    return data


def read_lines(path: Path, reader: str) -> list[str]:
    """Return the lines of a text file, the last one empty unless the file breaks off; not UTF-8 is taken as Western European."""
    data = read_bytes(path, reader)
    if b"\0" in data:
        raise refused(path, reader, "E01", "this is no text file", remedy="Give it the suffix of its format, or export it again.")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    return text.split("\n")


def number(text: str) -> float:
    """Return a finite number; exponents may be written with D, as Fortran does.

    Raises
    ------
    ValueError: none.
    """
    if "_" in text:
        raise ValueError(text)
    value = float(text.replace("D", "E").replace("d", "e"))
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def damaged(line: int, text: str, expected: str) -> Finding:
    """Return the finding of a line that cannot be understood."""
    shown = text.strip()
    shown = shown if len(shown) <= 60 else shown[:57] + "..."
    remedy = "Export the file again, or correct the line."
    return Finding("E03", f'the file is damaged at line {line}: "{shown}"', expected, remedy)


def left_out(counts: dict[str, int]) -> list[Finding]:
    """Return the finding of what a file has besides bodies; of very many kinds the most frequent ones."""
    kinds = [(count, what) for what, count in counts.items() if count]
    kinds = sorted(kinds, key=lambda kind: -kind[0]) if len(kinds) > MOST_NAMED else kinds
    rest = sum(count for count, _ in kinds[MOST_NAMED:])
    listed = ", ".join(f"{count} {what}" for count, what in kinds[:MOST_NAMED])
    listed += f" and {rest} of {len(kinds) - MOST_NAMED} more kinds" if rest else ""
    return [Finding("W18", f"left out: {listed}")] if listed else []
