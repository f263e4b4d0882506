"""The command line: thin. Each command reads its arguments, calls one thing and says what came of it.

Exit codes: 0 done, 1 findings in the input (a case file or a drawing that cannot be taken), 2 usage, 3 the structure or a
solver (unstable, not converged, failed; the report is written all the same).
"""

import importlib.metadata
import os
import shlex
import signal
import sys
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console

from churchpipe.errors import InputError, UsageError
from churchpipe.options import (
    CaseFile,
    Changes,
    ContactGap,
    Folder,
    Joint,
    JointMode,
    Mortar,
    Plane,
    Repair,
    RunFolder,
    Scale,
    StonesFile,
    Support,
    Thickness,
    Units,
    UpAxis,
)
from churchpipe.resources import sample_case, sample_names

FINDINGS, USAGE, STRUCTURE, INTERRUPTED = 1, 2, 3, 130

app = typer.Typer(
    name="churchpipe",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Exit codes: 0 done, 1 findings in the input, 2 usage, 3 the structure or a solver (the report is written).",
)
# Names and paths are printed as they are: no markup and no emoji in them. Into a file or a pipe, tables keep their width.
out = Console(highlight=False, markup=False, emoji=False, width=None if sys.stdout.isatty() else 120)
err = Console(stderr=True, highlight=False, markup=False, emoji=False)


def main() -> NoReturn:
    """Run the command line and leave with its exit code."""
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        app()
    except InputError as error:
        err.print(str(error), style="red", soft_wrap=True)
        raise SystemExit(USAGE if isinstance(error, UsageError) else FINDINGS) from None
    except BrokenPipeError:
        # The reader of a pipe (head, less) has left.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(0) from None
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        problem = error.strerror or str(error)
        err.print(f"{place}{problem}. Choose another place to write to.", style="red", soft_wrap=True)
        raise SystemExit(USAGE) from None
    except MemoryError:
        err.print("Out of memory: the structure is too large for this machine.", style="red", soft_wrap=True)
        raise SystemExit(STRUCTURE) from None
    raise SystemExit(0)


def _interrupt(*_: object) -> NoReturn:
    raise KeyboardInterrupt


def _version(wanted: bool) -> None:
    if wanted:
        out.print(f"churchpipe {importlib.metadata.version('churchpipe')}")
        raise typer.Exit


@app.callback()
def churchpipe(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")] = False,
) -> None:
    """How much lateral load brings a masonry building down, from its stones.

    From a drawing: [bold]import-dxf[/], then [bold]run[/]. From a handful of dimensions: [bold]generate[/], edit, [bold]run[/].
    """


@app.command()
def run(
    case: CaseFile,
    out_dir: Annotated[
        Path | None, typer.Option("--out", "-o", help="Run folder; default runs/NAME.", show_default=False)
    ] = None,
    jobs: Annotated[int | None, typer.Option("--jobs", "-j", min=1, help="Stages at one time; default: one a core.")] = None,
    changes: Changes = None,
) -> None:
    """Run a case: stones, contacts, load factors, report. What is up to date is not done again."""
    from churchpipe import engine, stages
    from churchpipe.compare import bad_news
    from churchpipe.compilation import compiled
    from churchpipe.config import Generated, read_case
    from churchpipe.config.asrun import claim, other_case
    from churchpipe.io.tables import read_json
    from churchpipe.terminal import Display

    # A case with mistakes is refused before anything is written.
    read = read_case(case, changes or ())
    if isinstance(read.source, Generated):
        read.building()
    elif not read.source.path.resolve().is_relative_to(case.resolve().parent):
        err.print(f"The drawing lies elsewhere: {read.source.path.resolve()}", markup=False, soft_wrap=True)
    folder = out_dir or Path("runs") / read.name
    if folder.exists() and not folder.is_dir():
        raise UsageError(str(folder), "a file, where the folder of the run would be", remedy="Choose another folder with --out.")
    if other := other_case(folder, case):
        if out_dir is None:
            remedy = "Give one of them another name, or a folder of its own with --out."
            raise UsageError(str(folder), "holds the run of another case of this name", found=other, remedy=remedy)
        err.print(f"{folder} held the run of {other} until now.", soft_wrap=True)

    def prepare() -> None:
        stages.configure(case, folder, changes or ())
        claim(folder, case)

    if not compiled():
        err.print("First start: the solvers are compiled once, which takes some 10 to 20 s a model.", soft_wrap=True)
    try:
        with Display(err) as display:
            code = engine.run(folder, jobs or os.cpu_count() or 1, display.show, prepare)
    except KeyboardInterrupt:
        err.print("Stopped. What was finished stays; run it again to go on.")
        raise typer.Exit(INTERRUPTED) from None
    if display.errors:
        # The jobs of several analyses meet the same fault.
        for text in dict.fromkeys(display.errors):
            err.print(text, style="red", soft_wrap=True)
        raise typer.Exit(FINDINGS)
    if code:
        err.print(f"A stage crashed; see {folder / 'run.log'}", style="red", soft_wrap=True)
        raise typer.Exit(STRUCTURE)
    summary = read_json(folder / "summary.json")
    _print_results(summary)
    out.print(f"Report: {folder / 'report.html'}", soft_wrap=True)
    if bad_news(summary):
        raise typer.Exit(STRUCTURE)


@app.command()
def show(folder: RunFolder) -> None:
    """Show the results of a run as a table."""
    from churchpipe.io.tables import read_summary

    _print_results(read_summary(_result_of(folder, "summary.json")))


@app.command()
def report(
    folder: RunFolder,
    pdf: Annotated[bool, typer.Option("--pdf", help="Print it to report.pdf, pages of A4.")] = False,
) -> None:
    """Say where the report of a run is, or print it to a PDF."""
    page = _result_of(folder, "report.html")
    if not pdf:
        out.print(str(page), soft_wrap=True)
        return
    from churchpipe.report.pdf import write_pdf

    paper = page.with_suffix(".pdf")
    out.print(f"{write_pdf(page, paper)} pages: {paper}", soft_wrap=True)


@app.command("import-dxf", help="Make a case of a drawing: the same as import.")
@app.command("import")
def import_file(
    file: StonesFile,
    folder: Folder = None,
    units: Units = None,
    unit_weight: Annotated[float | None, typer.Option("--unit-weight-kN-m3", help="Of all stones.")] = None,
    friction: Annotated[float | None, typer.Option(help="Friction coefficient of all joints.")] = None,
    load: Annotated[
        list[str] | None, typer.Option(metavar="DIRECTION", help='Direction of a load: "+x", "-y" or "1,1,0". Repeatable.')
    ] = None,
    support: Support = "drawn",
    repair: Repair = False,
    thickness: Thickness = None,
    plane: Plane = "xz",
    joint: Joint = None,
    joint_mode: JointMode = "grow",
    mortar: Mortar = "counted",
    contact_gap: ContactGap = None,
    up: UpAxis = None,
    scale: Scale = 1.0,
) -> None:
    """Make a case of a file of stones: FOLDER/case.toml and a copy of the file. All findings are listed.

    DXF, OBJ, STL, PLY, GLB, 3MF, Rhino 3DM, COMPAS JSON, LMGC90 (BODIES.DAT), 3DEC, or a folder: docs/formats.md.
    """
    from churchpipe.importing import import_drawing, parse_length

    folder = folder or Path(file.stem)
    done = import_drawing(
        file,
        folder,
        _reading(units, support, repair, thickness, plane, joint, joint_mode, mortar, up, scale),
        unit_weight=None if unit_weight is None else unit_weight * 1e3,
        friction=friction,
        loads=load or (),
        contact_gap=parse_length("--contact-gap", contact_gap),
    )
    _list(done.findings)
    out.print(f"{done.stones} stones on {done.fixed} fixed ones: {done.case}", markup=False, soft_wrap=True)
    if len(done.findings):
        out.print(
            f"Findings: {folder / 'findings.json'} and findings.dxf, circles to lay over the drawing.",
            markup=False,
            soft_wrap=True,
        )
    for line in (*done.joints, done.shell):
        out.print(line, markup=False, soft_wrap=True)
    for key in done.missing:
        out.print(f"Still to be filled in: {key}", markup=False, soft_wrap=True)


@app.command()
def check(
    file: StonesFile,
    units: Units = None,
    support: Support = "drawn",
    repair: Repair = False,
    thickness: Thickness = None,
    plane: Plane = "xz",
    joint: Joint = None,
    joint_mode: JointMode = "grow",
    mortar: Mortar = "counted",
    contact_gap: ContactGap = None,
    up: UpAxis = None,
    scale: Scale = 1.0,
    folder: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder for findings.json and findings.dxf.", show_default=False)
    ] = None,
) -> None:
    """List all findings in a file of stones, and stones that float or overlap; or what is wrong with a case.

    Exit code 1 for errors.
    """
    if file.suffix.lower() == ".toml":
        _check_case(file)
        return
    from churchpipe.findings import FindingsError
    from churchpipe.importing import check_drawing, parse_length, record_findings

    reading = _reading(units, support, repair, thickness, plane, joint, joint_mode, mortar, up, scale)
    try:
        read, joints = check_drawing(file, reading, contact_gap=parse_length("--contact-gap", contact_gap))
    except FindingsError as error:
        if folder:
            record_findings(error.findings, folder, units or "m")
        raise
    _list(read.findings)
    for line in joints:
        out.print(line, markup=False, soft_wrap=True)
    if folder:
        record_findings(read.findings, folder, read.units)
    warnings = f"{len(read.findings)} warnings" if len(read.findings) else "nothing to report"
    out.print(f"{file}: {int((~read.stones.fixed).sum())} stones, {warnings}.", markup=False, soft_wrap=True)


@app.command("export-dxf")
def export_dxf(
    case: CaseFile,
    drawing: Annotated[Path, typer.Option("--out", "-o", help="The drawing to write.", show_default=False)],
    changes: Changes = None,
) -> None:
    """Write the stones of a case as a DXF drawing, its materials and loads inside."""
    from churchpipe.config import read_case
    from churchpipe.dxf.writer import write_dxf
    from churchpipe.stones.blocks import derive_blocks

    if drawing.suffix.lower() != ".dxf":
        raise UsageError(f"--out {drawing}", "not the name of a drawing", expected="a name that ends in .dxf")
    read = read_case(case, changes or ())
    stones = derive_blocks(read.building())
    write_dxf(stones, drawing, materials=read.materials, loads=read.loads)
    out.print(f"{int((~stones.fixed).sum())} stones: {drawing}", soft_wrap=True)


@app.command()
def generate(
    name: Annotated[str, typer.Argument(help=f"One of {', '.join(sample_names())}.", show_default=False)],
    case: Annotated[Path | None, typer.Option("--out", "-o", help="The case file to write; default: the terminal.")] = None,
) -> None:
    """Write a commented case file to edit: dimensions, materials, loads."""
    text = sample_case(name)
    if case is None:
        out.print(text, end="", soft_wrap=True)
        return
    if case.exists():
        raise UsageError(str(case), "exists already", remedy="Choose another name, or delete it first.")
    from churchpipe.config.json_schema import write_case

    write_case(case, text)
    out.print(f"{case}: edit it, then churchpipe run {shlex.quote(str(case))}", soft_wrap=True)


@app.command()
def schema(
    markdown: Annotated[bool, typer.Option("--markdown", help="The same as a page to read (docs/reference_case.md).")] = False,
) -> None:
    """Print the JSON schema of the case file, by which editors complete and check it."""
    from churchpipe.config.json_schema import schema_text
    from churchpipe.config.reference import reference_page

    out.print(reference_page() if markdown else schema_text(), markup=False, end="", soft_wrap=True)


@app.command()
def doctor() -> None:
    """Check what is native or heavy, draw one picture, and print the line that installs what is missing."""
    from churchpipe.doctor import examine
    from churchpipe.terminal import findings_table

    findings = examine()
    out.print(findings_table(findings))
    for remedy in dict.fromkeys(finding.remedy for finding in findings if finding.remedy):
        out.print(remedy, soft_wrap=True)
    if not all(finding.passed for finding in findings):
        raise typer.Exit(FINDINGS)


@app.command(hidden=True)
def stage(name: str, label: str, paths: list[Path]) -> None:
    """Run one stage: what the rules of the pipeline call."""
    from churchpipe import stages
    from churchpipe.terminal import Reporter

    takes_progress = name in stages.LONG
    code = Reporter(name, label, sys.stderr).run(stages.STAGES[name], *paths, takes_progress=takes_progress)
    raise typer.Exit(code)


def _result_of(folder: Path, name: str) -> Path:
    """Return a file that a run has left, if the run ended well."""
    from churchpipe.engine import unfinished

    if why := unfinished(folder):
        raise InputError(str(folder), "the last run did not end well", found=why, remedy="Mend what it says and run it again.")
    if not (folder / name).is_file():
        raise InputError(str(folder), "no results", expected=name, remedy="churchpipe run CASE.toml makes it.")
    return folder / name


def _check_case(path: Path) -> None:
    from churchpipe.config import Generated, read_variants
    from churchpipe.config.plan import plan

    variants = read_variants(path)
    for case in variants:
        if isinstance(case.source, Generated):
            case.building()
        elif not case.source.path.exists():
            raise InputError(f"{path}: source", "no such file of stones", found=case.source.path)
    todo = plan(variants)
    counts = ((todo.geometries, "structures"), (todo.shells, "meshes"), (todo.analyses, "analyses"))
    out.print(f"{path}: {', '.join(f'{len(made)} {name}' for made, name in counts if made)}.", markup=False, soft_wrap=True)
    for question in todo.index["questions"]:
        err.print(question, markup=False, soft_wrap=True)


def _print_results(summary: dict[str, Any]) -> None:
    from churchpipe.terminal import remarks, results_table

    out.print(results_table(summary))
    for line in remarks(summary):
        out.print(line, soft_wrap=True)


def _reading(
    units: str | None,
    support: str,
    repair: bool,
    thickness: str | None,
    plane: str,
    joint: str | None,
    joint_mode: str,
    mortar: str,
    up: str | None,
    scale: float,
) -> Any:
    """Return how a drawing is read from the options of the command line."""
    from churchpipe.dxf.reading import Reading
    from churchpipe.importing import parse_length

    lengths = {"thickness": parse_length("--thickness", thickness), "joint": parse_length("--joint", joint)}
    words: dict[str, Any] = {"support": support, "plane": plane, "joint_mode": joint_mode, "mortar": mortar}
    words |= {"up": up, "scale": scale}
    try:
        return Reading(units=units, repair=repair, **lengths, **words)
    except InputError as error:
        option = "--" + error.where.replace("_", "-")
        raise UsageError(option, error.problem, found=error.found, expected=error.expected) from None


def _list(findings: Any) -> None:
    if len(findings):
        err.print(str(findings), soft_wrap=True)
