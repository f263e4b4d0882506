"""What the tags of a text drawing say against themselves: damage that a parser reads over."""

import re
from dataclasses import dataclass
from itertools import pairwise

from churchpipe.dxf.traces import KINDS
from churchpipe.findings import Finding

# Entities that can be stones, or parts of them; lines among them, which are read as `KINDS`.
SOLIDS = ("INSERT", "ATTRIB", "ATTDEF", "POINT", "MESH", "VERTEX", "3DFACE", "3DSOLID", "BODY", "BLOCK")
COUNTED = frozenset(kind.encode() for kind in (*SOLIDS, *KINDS))
# What may stand before one of them and swallow it.
OTHERS = frozenset({b"SEQEND", b"ENDBLK", b"TEXT", b"MTEXT"})
# Group codes that an entity has once: its handle, its layer.
HANDLE, LAYER = b"5", b"8"
# What outlines and hatches consist of: its name, the group code that begins each, the one that says how many there are.
COUNTS = {"LWPOLYLINE": ("corners", b"10", b"90"), **dict.fromkeys(("HATCH", "MPOLYGON"), ("boundaries", b"92", b"91"))}
# The group codes of x and y of the four corners of a filled area; one that is missing is read as the origin.
FOUR_CORNERS = frozenset({b"10", b"11", b"12", b"13", b"20", b"21", b"22", b"23"})
_ZERO = re.compile(rb"[+-]?0*\.?0*([eE].*)?")


@dataclass(frozen=True, slots=True)
class Entity:
    """One entity as it stands in the file: its kind, its group codes, and their values, in order."""

    kind: str
    codes: list[bytes]
    values: list[bytes]

    def first(self, code: bytes, default: bytes = b"") -> bytes:
        """Return the first value of a group code."""
        return self.values[self.codes.index(code)].strip() if code in self.codes else default


def entities(data: bytes) -> list[Entity]:
    """Return the entities of a text drawing whose kind is counted, and `OTHERS`, wherever they stand in it."""
    lines = data.splitlines()
    codes, values = list(map(bytes.strip, lines[::2])), lines[1::2]
    starts = [index for index, code in enumerate(codes[: len(values)]) if code == b"0"]
    return [
        Entity(kind.decode(), codes[start + 1 : end], values[start + 1 : end])
        for start, end in pairwise((*starts, len(values)))
        if (kind := values[start].strip()) in COUNTED or kind in OTHERS
    ]


def damage(entity: Entity) -> Finding | None:
    """Return what is wrong with the tags of an entity, as a finding."""
    found, expected = "", ""
    parts, of_parts, of_number = COUNTS.get(entity.kind, ("", b"", b""))
    count, said = entity.codes.count(of_parts), entity.first(of_number).decode(errors="replace") or "none"
    handle = entity.first(HANDLE).decode(errors="replace")
    if entity.codes.count(HANDLE) > 1 or entity.codes.count(LAYER) > 1:
        found, expected = "two entities run into each other here", "one handle and one layer"
    elif parts and said != str(count):
        found = f"it has {count} {parts}, and says that there are {said}"
        expected = f"the same number in its group {of_number.decode()}"
    elif entity.kind in ("SOLID", "TRACE") and not set(entity.codes) >= FOUR_CORNERS:
        found, expected = "it lacks a coordinate of a corner", "four corners"
    elif entity.kind == "INSERT" and any(_ZERO.fullmatch(entity.first(code, b"1")) for code in (b"41", b"42", b"43")):
        # The parser reads such a scale as 1.
        found, expected = "the insert has the scale 0 along an axis", "a scale that leaves a body"
        return Finding("E10", found, expected, "Scale it to its height again, or delete it.", "INSERT", handle)
    return Finding("E03", found, expected, "", entity.kind, handle) if found else None
