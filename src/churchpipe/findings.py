"""What is wrong or worth knowing in a file of stones: collected, never one at a time."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from churchpipe.errors import InputError
from churchpipe.wording import counted

# E stops the import, W does not; the same number is the same subject.
CODES: Final = {
    "E01": "the file cannot be read in its format",
    "E02": "the file is a DWG",
    "E03": "the file is truncated or damaged, or entities were lost on reading",
    "E04": "no units, or units that are no length",
    "W04": "the units passed override the drawing's",
    "E05": "the units contradict the size of the stones",
    "W05": "the size of the stones is unusual in the units passed",
    "E06": "an insert of a block that is not defined",
    "E07": "an attribute that cannot be understood",
    "W07": "an attribute that could not be understood was recomputed (--repair)",
    "E08": "a block that contains itself, or blocks nested too deep",
    "E09": "an insert that skews its stone",
    "W09": "an insert that stretches its stone",
    "E10": "a body that is missing or open",
    "W10": "warped faces, taken as triangles",
    "E11": "a stone drawn twice",
    "W11": "a stone drawn twice was dropped (--repair)",
    "E12": "no support",
    "W12": "a support was put under the lowest faces (support = base)",
    "W13": "an attribute of the layout of churchpipe is missing",
    "W14": "an attribute or tag contradicts the geometry, which is used",
    "W15": "an ID that is not unique was changed",
    "E16": "a stored material or load that cannot be understood",
    "E17": "no stones",
    "W18": "entities left out",
    "W19": "no unit weight",
    "E20": "the drawing was written by a later version",
    "E21": "a solid in a form that is not read",
    "W22": "stones without name and material",
    "E23": "more inserts than can be followed",
    "E24": "outlines of stones without a thickness",
    "W24": "outlines were taken for stones",
    "E25": "an outline that crosses itself or encloses nothing",
    "W25": "an outline that is not closed was closed, or lines of a net that miss each other were joined",
    "E26": "gaps between most stones, or a stone that cannot be grown into its joints",
    "W26": "stones were grown to meet in the joints",
    "W27": "curved sides were taken as chords",
    "E28": "a whole wall in which no stones can be laid",
    "W28": "stones were laid in whole walls",
    "E29": "an outline inside another",
    "W29": "voids were cut out of stones",
    "W30": "an insert that is clipped",
    "W40": "bodies were mended without a change of shape",
    "W41": "bodies were mended (--repair)",
    "W42": "several solids under one name",
    "W43": "supports known by their names",
    "W44": "hulls of one stone were united",
    "W45": "the unit or the axis that points up was assumed",
    "W46": "bytes that are no text in the encoding of the file",
    "E47": "coordinates rounded by more than a hundredth of a stone",
    "W47": "coordinates rounded by more than a thousandth of a stone",
    "W48": "a stone far thinner than the others",
    "W49": "stones that lie in each other, so that their weight is too large",
}

_MORE_DIGITS = (
    "The digits are not in the file, and no option brings them back: in the program that made it, move the model near the "
    "origin, or export it in a format with more digits, such as OBJ or DXF."
)

# What to do about a finding, where nothing nearer is known. A warning is nothing to mend if what it says is meant.
REMEDIES: Final = {
    "E01": "Check the path, and export the file again.",
    "E02": "Save it as DXF (R2010 or newer) in the CAD program.",
    "E03": "Run AUDIT in the CAD program and export the file again.",
    "E04": "Set the units (UNITS) in the drawing, or pass --units mm, cm or m.",
    "W04": "Leave --units out if the file is right.",
    "E05": "Pass --units with the unit in which the file was drawn.",
    "W05": "Pass other --units if the stones are not as large as that.",
    "E06": "Insert the block again, or delete the insert.",
    "E07": "Correct the attribute, or pass --repair.",
    "W07": "Correct it in the drawing if another value is meant.",
    "E08": "Explode the outer block.",
    "E09": "Explode the block, or scale it evenly.",
    "W09": "Scale it evenly if that is not meant.",
    "E10": "Draw it again as one closed body; churchpipe check FILE -o DIR marks the place.",
    "W10": "Put the corners into one plane if the face is meant to be plane.",
    "E11": "Delete one of the two, or pass --repair.",
    "W11": "Delete the copy in the file, and this warning no longer appears.",
    "E12": "Draw the ground, or pass --support base.",
    "W12": "If some of these faces do not stand on the ground, draw the ground and leave --support out.",
    "W13": "Add it to the drawing if another value is meant.",
    "W14": "Correct it in the drawing if another value is meant.",
    "W15": "Give each stone an ID of its own if the case is to name it.",
    "E16": "Correct it among the properties of the drawing.",
    "E17": "Draw the stones as closed bodies or closed outlines.",
    "W18": "Look whether a stone is among them: it must be a closed body, or a closed outline, on a visible layer.",
    "W19": "Pass --unit-weight-kN-m3 to churchpipe import, or put it in the case.",
    "E20": "Read it with the version of churchpipe that wrote it.",
    "E21": "Convert it to a mesh.",
    "W22": "Draw them as inserts of blocks with the attributes ID and MATERIAL if the case is to name them.",
    "E23": "Correct the counts of the arrays.",
    "E24": "Pass --thickness with the depth of the stones, such as 0.3m.",
    "W24": "Put outlines that are no stones on a layer that is off, or on OPENING.",
    "E25": "Draw the outline again.",
    "W25": "Close it in the drawing if that is not its outline.",
    "E26": "Pass --joint with the width of the joints, such as 10mm.",
    "W26": "Compare the volumes; --joint-mode keep leaves stones as drawn, --mortar ignored leaves out what mortar weighs.",
    "W27": "Draw the side with more corners if that is too coarse.",
    "E28": "Mend the body as it says, or cut it into walls.",
    "W28": "Look whether they are as you meant; --course and --stone change them.",
    "E29": "Put the inner outline on a layer OPENING if it is a void, or the outer one on a layer that is off if it is no stone.",
    "W29": "If it is no void, draw the outline of a stone in it.",
    "W30": "Remove the clip if all of it is to be read; else draw the part that is, and delete the insert.",
    "W40": "Nothing to mend: the shape is the same.",
    "W41": "Compare the volumes, and look at the stone: churchpipe check FILE -o DIR shows it.",
    "W42": "Give each a name of its own if the case is to name them.",
    "W43": "Give another name to those that are no ground.",
    "W44": "Compare the volumes; draw the stone as one body if they differ.",
    "W45": "Pass --units or --up if that is wrong.",
    "W46": "Look at the names of layers and stones; export the drawing again if they are wrong.",
    "E47": _MORE_DIGITS,
    "W47": _MORE_DIGITS,
    "W48": "Delete it if it is an offcut: it comes out first, and its load factor is not that of the building.",
    "W49": "Draw each stone to the middle of the joint, so that no two overlap, or lower the unit weight by that share.",
}

# Places named after the first of a kind.
MORE_PLACES: Final = 3
PLACE_FIELDS: Final = ("entity", "handle", "block", "position", "unit")


@dataclass(frozen=True, slots=True)
class Finding:
    """One finding: code of `CODES`, what was found and expected, the remedy (by default that of its code), and where it is.

    entity: what it is in the file ("INSERT", "group"); handle, block: its handle and the name of its definition;
    position: (x, y, z) in `unit`, None for the file. `found` holds `{}` for each of `lengths`, which are in `unit` too.
    """

    code: str
    found: str
    expected: str = ""
    remedy: str = ""
    entity: str = ""
    handle: str = ""
    block: str = ""
    position: tuple[float, float, float] | None = None
    unit: str = "drawing units"
    lengths: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not self.remedy:
            object.__setattr__(self, "remedy", REMEDIES[self.code])

    @property
    def severity(self) -> str:
        """ "error" or "warning"."""
        return "error" if self.code.startswith("E") else "warning"

    @property
    def place(self) -> str:
        """Where it is: type, handle, name of the definition, position; "" for the file."""
        place = self.entity
        place += f" #{self.handle}" if self.handle else ""
        place += f' "{self.block}"' if self.block else ""
        if self.position is not None:
            place += f" at ({', '.join(map(_coordinate, self.position))}) {self.unit}"
        return place.strip()

    @property
    def what(self) -> str:
        """What was found, its lengths filled in."""
        text = self.found
        for length in self.lengths:
            text = text.replace("{}", f"{length:.3g} {self.unit}", 1)
        return text

    @property
    def kind(self) -> tuple[str, ...]:
        """What findings have in common that differ in names, numbers and places alone."""
        return tuple(
            re.sub(r'"[^"]*"|\(?#\w+\)?|\S*\d\S*', "#", text) for text in (self.code, self.found, self.expected, self.remedy)
        )

    def in_metres(self, unit: float) -> "Finding":
        """Return the finding with its position and lengths in m; unit: the length of a drawing unit, m."""
        if self.unit == "m":
            return self
        x, y, z = (value * unit for value in self.position or (0.0, 0.0, 0.0))
        lengths = tuple(value * unit for value in self.lengths)
        return replace(self, position=(x, y, z) if self.position else None, lengths=lengths, unit="m")


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is in a file: type, handle, name of the definition, position in drawing units."""

    entity: str
    handle: str
    block: str = ""
    position: tuple[float, float, float] | None = None

    def finding(self, code: str, found: str, *, expected: str = "", remedy: str = "", lengths: tuple[float, ...] = ()) -> Finding:
        """Return a finding at this place."""
        return Finding(code, found, expected, remedy, self.entity, self.handle, self.block, self.position, lengths=lengths)


@dataclass(frozen=True, slots=True)
class Body:
    """A body of a file with errors, to be drawn: its name, points (n, 3) m, faces in any state, whether it is fixed."""

    name: str
    points: Any
    faces: Sequence[tuple[int, ...]]
    fixed: bool


@dataclass(frozen=True, slots=True)
class Findings:
    """All findings of one file, in the order they were met. `str()` is the list to show, one line a kind.

    file: its name; reader: what read it ("dxf", "obj"), the first word of each line.
    """

    file: str
    items: tuple[Finding, ...] = ()
    reader: str = "dxf"

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.items)

    def __len__(self) -> int:
        return len(self.items)

    @property
    def errors(self) -> tuple[Finding, ...]:
        """The findings that stop the import."""
        return tuple(f for f in self.items if f.severity == "error")

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """The findings that do not."""
        return tuple(f for f in self.items if f.severity == "warning")

    @property
    def stood_up(self) -> bool:
        """Whether outlines drawn in x-y were taken for an elevation, so that y of a place is z of the stones."""
        return any(f.code == "W24" and "elevation" in f.found for f in self.items)

    @property
    def codes(self) -> tuple[str, ...]:
        """The codes met, each once, in order of appearance."""
        return tuple(dict.fromkeys(f.code for f in self.items))

    @property
    def kinds(self) -> tuple[tuple[Finding, ...], ...]:
        """The findings sorted by code, those of one kind together."""
        groups: dict[tuple[str, ...], list[Finding]] = {}
        for finding in sorted(self.items, key=lambda f: f.code):
            groups.setdefault(finding.kind, []).append(finding)
        return tuple(map(tuple, groups.values()))

    def records(self) -> list[dict[str, Any]]:
        """Return the kinds as records for JSON, every place of theirs included."""
        out: list[dict[str, Any]] = []
        for kind in self.kinds:
            first = kind[0]
            record = {"code": first.code, "severity": first.severity, "subject": CODES[first.code], "count": len(kind)}
            places = [{"found": f.what, **{name: getattr(f, name) for name in PLACE_FIELDS}} for f in kind]
            out.append({**record, "expected": first.expected, "remedy": first.remedy, "places": places})
        return out

    def __str__(self) -> str:
        return "\n".join(f"{self.reader}/{kind[0].code} {self.file}: {_line(kind)}" for kind in self.kinds)


class FindingsError(InputError):
    """A file that cannot become stones: `findings` says all that is wrong with it, `bodies` are what was read before."""

    def __init__(self, findings: Findings, bodies: tuple[Body, ...] = ()) -> None:
        count = len(findings.errors)
        super().__init__(findings.file, f"{counted(count, 'error')} in the file")
        self.findings, self.bodies = findings, bodies
        self.args = (f"{self.args[0]}\n{findings}",)


def _line(kind: tuple[Finding, ...]) -> str:
    """Return the findings of one kind as one line: the first whole, the places of some more, how many there are."""
    first = kind[0]
    line = (f"{first.place}: " if first.place else "") + first.what
    line += f": expected {first.expected}." if first.expected else "."
    line += f" {first.remedy}" if first.remedy else ""
    if len(kind) == 1:
        return line
    # What begins with the name of a wall says what no place does, such as how many stones were laid in it.
    more = "; ".join(f.what if f.what.startswith('"') or not f.place else f.place for f in kind[1 : 1 + MORE_PLACES])
    rest = len(kind) - 1 - MORE_PLACES
    return f"{len(kind)} times: {line} Also: {more}" + (f"; and {rest} more." if rest > 0 else ".")


def _coordinate(value: float) -> str:
    """Three decimals, the last left out when it is 0: 3.42, 0.00, 0.035."""
    text = f"{value + 0.0:.3f}"
    text = text.replace("-0.000", "0.000") if float(text) == 0 else text
    return text[:-1] if text.endswith("0") else text
