"""What is wrong or worth knowing in a drawing: collected, never one at a time."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from churchpipe.errors import InputError

# E stops the import, W does not; the same number is the same subject.
CODES: Final = {
    "E01": "the file cannot be read as DXF",
    "E02": "the file is a DWG",
    "E03": "the file is truncated or damaged, or entities were lost on reading",
    "E04": "no units, or units that are no length",
    "W04": "the units passed override the drawing's",
    "E05": "the units contradict the size of the stones",
    "W05": "the size of the stones is unusual, the units were passed",
    "E06": "insert of an undefined block",
    "E07": "an attribute that cannot be understood",
    "W07": "an attribute that could not be understood was recomputed (--repair)",
    "E08": "a block that contains itself",
    "E09": "an insert that skews its stone",
    "W09": "an insert that stretches its stone",
    "E10": "a body that is missing, open or not planar",
    "E11": "a stone drawn twice",
    "W11": "a stone drawn twice was dropped (--repair)",
    "E12": "no support",
    "W12": "the lowest stones were fixed (support = base)",
    "W13": "an attribute is missing",
    "W14": "an attribute or tag contradicts the geometry, which is used",
    "W15": "an ID that is not unique was changed",
    "E16": "a stored material or load that cannot be understood",
    "E17": "no stones",
    "W18": "entities left out",
    "W19": "no unit weight",
    "E20": "a newer version of the schema",
    "E21": "a solid in a form that is not read",
    "E23": "more inserts than can be followed",
    "W22": "stones without name and material",
}

SHOWN_PER_CODE: Final = 20


@dataclass(frozen=True, slots=True)
class Finding:
    """One finding: code of `CODES`, what was found and expected, the remedy, and where in the drawing it is.

    entity: DXF type ("INSERT"); handle; block: name of the definition; position: (x, y, z) in `unit`, None for the file.
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

    @property
    def severity(self) -> str:
        """ "error" or "warning"."""
        return "error" if self.code.startswith("E") else "warning"

    def text(self, file: str) -> str:
        """Return the finding as one line."""
        place = self.entity
        place += f" #{self.handle}" if self.handle else ""
        place += f' "{self.block}"' if self.block else ""
        if self.position is not None:
            place += f" at ({', '.join(map(_coordinate, self.position))}) {self.unit}"
        line = f"dxf/{self.code} {file}: " + (f"{place.strip()}: " if place else "") + self.found
        line += f": expected {self.expected}." if self.expected else "."
        return f"{line} {self.remedy}".rstrip()


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is in the drawing: DXF type, handle, name of the definition, position in drawing units."""

    entity: str
    handle: str
    block: str = ""
    position: tuple[float, float, float] | None = None

    def finding(self, code: str, found: str, *, expected: str = "", remedy: str = "") -> Finding:
        """Return a finding at this place."""
        return Finding(code, found, expected, remedy, self.entity, self.handle, self.block, self.position)


@dataclass(frozen=True, slots=True)
class Findings:
    """All findings of one drawing, in the order they were met. `str()` is the list to show."""

    file: str
    items: tuple[Finding, ...] = ()

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
    def codes(self) -> tuple[str, ...]:
        """The codes met, each once, in order of appearance."""
        return tuple(dict.fromkeys(f.code for f in self.items))

    def __str__(self) -> str:
        lines: list[str] = []
        for code in sorted(self.codes):
            same = [f for f in self.items if f.code == code]
            lines += [f.text(self.file) for f in same[:SHOWN_PER_CODE]]
            if len(same) > SHOWN_PER_CODE:
                lines.append(f"dxf/{code} {self.file}: {len(same) - SHOWN_PER_CODE} more: {CODES[code]}.")
        return "\n".join(lines)


class DrawingError(InputError):
    """A drawing that cannot become stones: `findings` says all that is wrong with it."""

    def __init__(self, findings: Findings) -> None:
        count = len(findings.errors)
        super().__init__(findings.file, f"{count} error{'s' if count != 1 else ''} in the drawing")
        self.findings = findings
        self.args = (f"{self.args[0]}\n{findings}",)


def _coordinate(value: float) -> str:
    """Three decimals, the last left out when it is 0: 3.42, 0.00, 0.035."""
    text = f"{value + 0.0:.3f}"
    text = text.replace("-0.000", "0.000") if float(text) == 0 else text
    return text[:-1] if text.endswith("0") else text
