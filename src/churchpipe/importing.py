"""From a drawing, or another file of stones, to a case file."""

import importlib.util
import json
import math
import re
import shlex
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Final

from churchpipe.config.case import Case, read_case
from churchpipe.config.case import Drawing as DrawingSource
from churchpipe.config.imported import MANY_STONES, imported_case, material_names
from churchpipe.config.json_schema import FILE_NAME, write_case
from churchpipe.config.picked import check_picked, ground_questions, picks
from churchpipe.config.shell_table import ShellTable, shell_table
from churchpipe.config.soil_questions import end_questions
from churchpipe.dxf.annotated import write_findings
from churchpipe.dxf.elevation import laid_down
from churchpipe.dxf.reader import Drawing
from churchpipe.dxf.reading import AS_DRAWN, Reading
from churchpipe.dxf.schema import metres
from churchpipe.errors import InputError, UsageError
from churchpipe.findings import Body, Finding, Findings
from churchpipe.io.atomic import all_or_none, replacing, write_text
from churchpipe.match import match_models
from churchpipe.meshes.reader import files_of, read_file
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOLERANCES, Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.sizes import size_questions
from churchpipe.recognition.panels import wall_names
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.account import joint_account, joint_lines, twice_words
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.counted_twice import counted_twice
from churchpipe.stones.histogram import histogram_lines
from churchpipe.stones.ring_beams import add_beams
from churchpipe.stones.soundness import check_soundness
from churchpipe.wording import counted

# Processor time of the associative limit load (docs/benchmarks_shell.md, docs/benchmarks_limit_analysis.md), how many times
# that of an element a capacity curve takes besides, and how many times that of a stone an analysis without dilatancy takes.
SECONDS_PER_ELEMENT, SECONDS_PER_STONE, CURVE, DILATANCY = 0.003, 0.001, 4, 100
NONE_GIVEN: Final[Mapping[str, float | None]] = {}
# What is written beside a case, or into the folder of a check.
FINDINGS = ("findings.html", "findings.json", "findings.dxf")
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True, slots=True)
class Imported:
    """What an import made: the case file, how many stones and their volume (m3), how many more are fixed, the findings
    (warnings), the keys of the case that nobody gave, and what is to be said of the shell and of the joints, asked of
    the sizes, and said of loads and ties that are on no wall."""

    case: Path
    stones: int
    volume: float
    fixed: int
    findings: Findings
    missing: tuple[str, ...]
    shell: str
    joints: tuple[str, ...]
    asked: tuple[str, ...] = ()
    misplaced: str = ""


class UnsoundError(InputError):
    """Stones that were read but float, overlap or nearly meet. drawing: what was read; its findings are part of the message."""

    def __init__(self, error: InputError, drawing: Drawing) -> None:
        super().__init__(error.where, error.problem, found=error.found, expected=error.expected, remedy=error.remedy)
        self.drawing, self.fault = drawing, str(error)
        # What was left out of the file, or mended in it, may be the very reason.
        self.args = ("\n".join(filter(None, (str(error), str(drawing.findings)))),)


def check_drawing(
    path: Path,
    reading: Reading = AS_DRAWN,
    unit_weight: float | Mapping[str, float] | None = None,
    tolerances: Mapping[str, float | None] = NONE_GIVEN,
) -> tuple[Drawing, Contacts]:
    """Read a file of stones, find its joints, and look for stones that float or overlap.

    unit_weight: N/m3, of all stones or by material. tolerances: `TOLERANCES` of `churchpipe.find_contacts`, m and rad.

    Raises
    ------
    InputError: the file has errors, all of them listed; `UnsoundError` where its stones can be read and are not sound.
    """
    drawing = read_file(path, unit_weight=unit_weight, **asdict(reading))
    try:
        contacts = find_contacts(drawing.stones, **reading.tolerances(tolerances))
        check_soundness(drawing.stones, contacts)
    except InputError as error:
        raise UnsoundError(error.at(f"{path}: {error.where}"), drawing) from error
    items = (*drawing.findings.items, *_counted_twice(drawing, contacts))
    return replace(drawing, findings=replace(drawing.findings, items=items)), contacts


def _counted_twice(drawing: Drawing, contacts: Contacts) -> list[Finding]:
    """Return the finding of stones that lie in each other, placed where they share most."""
    found = counted_twice(drawing.stones, contacts)
    if found is None:
        return []
    pairs = counted(found.pairs, "pair of stones lies in each other", "pairs of stones lie in each other")
    what = f"{pairs}, by up to {1e3 * found.depth:.3g} mm: {' and '.join(found.stones)} share most, here"
    x, y, z = (laid_down(found.place) if drawing.findings.stood_up else found.place).tolist()
    return [Finding("W49", f"{what}. {twice_words(found.volume, found.share)}", position=(x, y, z), unit="m")]


def check_carried(case: Case, stones: Assemblage, contacts: Contacts | None = None) -> list[str]:
    """Look for the walls of a drawing that a case names: those pushed alone, and those that bear loads, ties and beams.

    contacts: of the stones, where they are known, to look for the joints, the ground and the point that the case names. Returns
    what there is to ask about that ground, and about soil on walls.

    Raises
    ------
    InputError: with the line of the case.
    """
    reading = case.source.reading if isinstance(case.source, DrawingSource) else AS_DRAWN
    named = replace(stones, panel=wall_names(stones, reading.kept_joint))
    case.check_named(sorted({*named.panel[~named.fixed].tolist()} - {""}))
    case.check_applied(named)
    ends = end_questions(case.carries, named)
    if contacts is None or not picks(case):
        return ends
    if case.ring_beams:
        weights = {material.name: material.unit_weight for material in case.materials}
        named = add_beams(named, case.ring_beams, weights)
        contacts = find_contacts(named, **case.tolerances)
    check_picked(case, named, contacts)
    return [*ground_questions(case, named, contacts), *ends]


def import_drawing(
    path: Path,
    folder: Path,
    reading: Reading = AS_DRAWN,
    *,
    unit_weight: float | None = None,
    friction: float | None = None,
    loads: Sequence[str] = (),
    tolerances: Mapping[str, float | None] = NONE_GIVEN,
) -> Imported:
    """Write FOLDER/case.toml, its schema and a copy of the file beside it; findings.json and findings.dxf when there are any.

    Parameters
    ----------
    reading: how the drawing is read; the case keeps it.
    unit_weight: N/m3, of all stones; friction: of all joints; loads: directions. All override what the drawing stores.
    tolerances: `TOLERANCES` of `churchpipe.find_contacts`, m and rad; the case keeps them.

    Raises
    ------
    InputError: the drawing has errors (nothing is written), the folder has a case already, a direction is none.
    OSError: a file cannot be written; nothing is left of the others.
    """
    directions = _directions(loads)
    if not path.name.isprintable():
        raise UsageError(repr(path.name), "a case file cannot hold this name", expected="printable characters in UTF-8")
    _check_range("--unit-weight-kN-m3", None if unit_weight is None else unit_weight / 1e3, above_zero=True)
    _check_range("--friction", friction, above_zero=False)
    case = folder / "case.toml"
    if case.exists():
        raise UsageError(str(case), "exists already", remedy="Choose another folder, or delete it first.")
    drawing, contacts = check_drawing(path, reading, unit_weight, tolerances)
    copies = _copies(path, folder)
    check_findings_apart(copies.values(), folder)
    for file, copy in copies.items():
        if copy.exists() and not copy.samefile(file):
            raise UsageError(str(copy), "exists already", remedy="Choose another folder, or delete it first.")
    elastic = {material.name: material.elastic is not None for material in drawing.materials}
    elastic = {name: elastic.get(name, False) for name in material_names(drawing)}
    shell = shell_table(drawing.stones, elastic, reading.kept_joint)
    text, missing = imported_case(
        path,
        drawing,
        reading,
        unit_weight=unit_weight,
        friction=friction,
        loads=[LoadCase(direction) for direction in directions] or drawing.loads,
        tolerances=reading.tolerances(tolerances),
        shell=shell,
    )
    after = f"churchpipe run {shlex.quote(str(case))}"
    with all_or_none([*copies.values(), *(folder / name for name in (*FINDINGS, FILE_NAME, case.name))]):
        for file, copy in copies.items():
            if not copy.exists():
                with replacing(copy) as part:
                    shutil.copyfile(file, part)
        record_findings(drawing.findings, folder, drawing.units, drawing.stones, f"{after} runs the case.")
        # Last, since a folder that has a case has been imported.
        write_case(case, text)
    fixed = int(drawing.stones.fixed.sum())
    note = f"{shell.note} {gate_words(contacts, shell)}".strip()
    count = drawing.stones.count - fixed
    volume, said = free_volume(drawing.stones), joint_words(drawing.stones, contacts)
    asked = tuple(size_questions(drawing.stones))
    misplaced = "" if missing else _misplaced(case, drawing, contacts)
    return Imported(case, count, volume, fixed, drawing.findings, tuple(missing), note, said, asked, misplaced)


def _misplaced(case: Path, drawing: Drawing, contacts: Contacts) -> str:
    """Return why loads and ties that were drawn are on no wall, so that no run would begin, "" where they are."""
    try:
        check_carried(read_case(case), drawing.stones, contacts)
    except InputError as error:
        return str(error)
    return ""


def free_volume(stones: Assemblage) -> float:
    """Return the volume, m3, of the stones that are not fixed, to be compared with what was drawn."""
    return float(stones.volume[~stones.fixed].sum())


def joint_words(stones: Assemblage, contacts: Contacts, *, typed: bool = False) -> tuple[str, ...]:
    """Return what was decided about the joints of stones, as sentences, and how far apart their faces are.

    typed: whether there is no case yet, whose keys would change it.
    """
    lines = joint_lines(*joint_account(stones, contacts), typed=typed)
    return (*lines, *histogram_lines(contacts)) if lines else ()


def gate_words(contacts: Contacts, shell: ShellTable) -> str:
    """Return whether a shell passes the match gate, as a sentence; "" where there is none. contacts: of the stones as read."""
    if shell.fitted is None:
        return ""
    stones = shell.fitted.stones
    try:
        mesh = derive_shell(shell.fitted.building(), shell.keys["element_size_mm"] / 1e3)
    except InputError as error:
        return f"No mesh can be made of them, so that a run leaves the shell out: {error} The rigid blocks stand alone."
    match = match_models(stones, contacts, mesh)
    if match.passed:
        passed = f"The gate passed: shell and stones are one building, in {len(match.figures)} figures."
        return f"{passed} {cost_words(len(mesh.triangles), int((~stones.fixed).sum()), shell)}"
    wrong = [figure for figure in match.figures if not figure.passed]
    failed = [f"{figure.name} ({figure.stones:.4g} and {figure.shell:.4g} {figure.unit})" for figure in wrong]
    return f"The gate failed, so that a run leaves the shell out: {'; '.join(failed)}. The rigid blocks stand alone."


def cost_words(elements: int, stones: int, shell: ShellTable) -> str:
    """Return how long the shell takes beside the stones, as a sentence."""
    own = SECONDS_PER_ELEMENT * elements * (1 + CURVE * ("pushover" in shell.keys["analyses"]))
    others = SECONDS_PER_STONE * stones
    words = f"Its {counted(elements, 'element takes', 'elements take')} some {max(1.0, own):.0f} s a load"
    words += f", the stones some {max(1.0, others):.0f} s"
    if stones <= MANY_STONES:
        words += f", and without dilatancy, as the case asks too, some {max(1.0, DILATANCY * others):.0f} s"
    return f"{words}; --set shell=false leaves the shell out." if own >= 10 * others else f"{words}."


def _copies(path: Path, folder: Path) -> dict[Path, Path]:
    """Return the files that a file or a folder is read from, and where each is copied to."""
    root = path if path.is_dir() else path.parent
    place = folder / path.name if path.is_dir() else folder
    return {file: place / file.relative_to(root) for file in files_of(path)}


def _directions(texts: Sequence[str]) -> list[tuple[float, float, float]]:
    directions = [parse_direction(text) for text in texts]
    names = [LoadCase(direction).name for direction in directions]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise UsageError("--load", "one direction given twice", found=", ".join(twice), expected="each load once")
    return directions


def _check_range(option: str, value: float | None, *, above_zero: bool) -> None:
    if value is not None and not ((value > 0 if above_zero else value >= 0) and value < math.inf):
        raise UsageError(option, "out of range", found=value, expected=f"a finite number {'>' if above_zero else '>='} 0")


def parse_direction(text: str) -> tuple[float, float, float]:
    """Return the direction written as "+x", "-y" or "1,1,0"."""
    word = text.strip().lower()
    axis = _AXES.get(word.lstrip("+-"))
    if axis and len(word) <= 2:
        sign = -1.0 if word.startswith("-") else 1.0
        # Adding zero takes the minus of a zero, which a case would show.
        return sign * axis[0] + 0.0, sign * axis[1] + 0.0, sign * axis[2] + 0.0
    try:
        x, y, z = (float(part) for part in word.split(","))
        if not 0 < math.hypot(x, y, z) < math.inf:
            raise ValueError
    except ValueError:
        raise UsageError(f"--load {text}", "not a direction", expected='"+x", "-y" or components such as "1,1,0"') from None
    return x, y, z


def parse_length(option: str, text: str | None) -> float | None:
    """Return a length written with its unit, such as "0.12m" or "10 mm", in m; None for none."""
    if text is None:
        return None
    word = re.fullmatch(r"\s*([0-9.]+(?:[eE][+-]?[0-9]+)?)\s*([a-z]+(?:-[a-z]+)?)\s*", text)
    try:
        value = float(word[1]) * metres(word[2]) if word else 0.0
    except ValueError:
        value = 0.0
    if not 0 < value < math.inf:
        expected = "a length with its unit, such as 0.12m or 10mm"
        raise UsageError(f"{option} {text}", "not a length", expected=expected)
    return value


def parse_tolerances(contact_gap: str | None, contact_angle: float | None, overlap: str | None) -> dict[str, float | None]:
    """Return `TOLERANCES` from the words of the command line, an angle in degrees; None for those that nobody gave."""
    if contact_angle is not None and not 0 < contact_angle < 90:
        raise UsageError(
            "--contact-angle-deg", "out of range", found=contact_angle, expected="degrees between 0 and 90, such as 5"
        )
    angle = None if contact_angle is None else math.radians(contact_angle)
    lengths = parse_length("--contact-gap", contact_gap), parse_length("--overlap", overlap)
    return dict(zip(TOLERANCES, (lengths[0], angle, lengths[1]), strict=True))


def check_findings_apart(files: Iterable[Path], folder: Path) -> None:
    """Raise UsageError where the findings in a folder would be written over one of the files that they are about.

    The drawing of findings that was laid over another one is such a file where somebody checks it in its own folder.
    """
    taken = {file.resolve() for file in files} & {(folder / name).resolve() for name in FINDINGS}
    if taken:
        remedy = "Rename the file, or choose another folder with --out."
        raise UsageError(str(min(taken)), "the findings would be written over it", remedy=remedy)


def record_findings(findings: Findings, folder: Path, units: str, stones: Assemblage | Sequence[Body], after: str) -> None:
    """Write findings.html, with a picture of the stones, and where there are findings findings.json and findings.dxf, to lay over
    the drawing.

    stones: of a file with errors the bodies that were read. after: what to type next.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if importlib.util.find_spec("jinja2"):
        from churchpipe.report.findings_page import sound_stones, write_findings_page

        drawn = stones if isinstance(stones, Assemblage) else sound_stones(stones)
        write_findings_page(folder / FINDINGS[0], findings, drawn, after)
    if not len(findings):
        return
    record = {"file": findings.file, "findings": findings.records()}
    write_text(folder / FINDINGS[1], json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    with replacing(folder / FINDINGS[2]) as part:
        write_findings(findings, part, units)
