"""Commands of files of stones: import, check, export-dxf, export-obj."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from churchpipe.cli.app import app, ask, err, out
from churchpipe.cli.cases import check_case
from churchpipe.cli.reading import refuse_misplaced, with_reading
from churchpipe.errors import UsageError
from churchpipe.options import CaseFile, Changes, ContactAngle, ContactGap, Folder, ModelFile, Overlap, StonesFile, out_option
from churchpipe.wording import counted, four_figures


@app.command("import-dxf", help="Make a case of a drawing: the same as import.")
@app.command("import")
@with_reading
def import_file(
    file: StonesFile,
    reading: Any,
    folder: Folder = None,
    unit_weight: Annotated[float | None, typer.Option("--unit-weight-kN-m3", help="Unit weight of all stones, kN/m3.")] = None,
    friction: Annotated[float | None, typer.Option(help="Friction coefficient of all joints.")] = None,
    load: Annotated[
        list[str] | None, typer.Option(metavar="DIRECTION", help='Direction of a load: "+x", "-y" or "1,1,0". Repeatable.')
    ] = None,
    contact_gap: ContactGap = None,
    contact_angle: ContactAngle = None,
    overlap: Overlap = None,
) -> None:
    """Make a case of a file of stones: FOLDER/case.toml and a copy of the file. All findings are listed.

    DXF, OBJ, STL, PLY, GLB, 3MF, Rhino 3DM, COMPAS JSON, LMGC90 (BODIES.DAT), 3DEC, or a folder: docs/formats.md.
    """
    from churchpipe.config.case import read_variants
    from churchpipe.config.plausible import questions
    from churchpipe.importing import import_drawing, parse_tolerances

    if file.suffix.lower() == ".toml":
        command = f"churchpipe run {shlex.quote(str(file))}"
        raise UsageError(str(file), "a case, which is not imported", expected="a drawing or a mesh", remedy=f"{command} runs it.")
    folder = folder or Path(file.stem)
    done = import_drawing(
        file,
        folder,
        reading,
        unit_weight=None if unit_weight is None else unit_weight * 1e3,
        friction=friction,
        loads=load or (),
        tolerances=parse_tolerances(contact_gap, contact_angle, overlap),
    )
    _list(done.findings)
    held = f"{counted(done.stones, 'stone')}, {four_figures(done.volume)} m3, on {counted(done.fixed, 'fixed one')}"
    out.print(f"{held}: {done.case}", markup=False, soft_wrap=True)
    more = ", findings.json, and findings.dxf with circles to lay over the drawing" if len(done.findings) else ""
    out.print(f"Look at it: {folder / 'findings.html'}{more}", markup=False, soft_wrap=True)
    for line in (*done.joints, done.shell):
        out.print(line, markup=False, soft_wrap=True)
    ask(done.asked)
    for key in done.missing:
        out.print(f"Still to be filled in: {key}", markup=False, soft_wrap=True)
    ask(() if done.missing else questions(read_variants(done.case)))
    if done.misplaced:
        err.print(f"To be corrected first: {done.misplaced}", markup=False, soft_wrap=True)
    out.print(f"Next: churchpipe run {shlex.quote(str(done.case))}", markup=False, soft_wrap=True)


@app.command()
@with_reading
def check(
    context: typer.Context,
    file: ModelFile,
    reading: Any,
    contact_gap: ContactGap = None,
    contact_angle: ContactAngle = None,
    overlap: Overlap = None,
    changes: Changes = None,
    folder: Annotated[Path | None, out_option("Folder for findings.json and findings.dxf.")] = None,
) -> None:
    """List what is wrong with a file of stones, also stones that float or overlap, or with a case.

    The exit code is 1 where there are errors.
    """
    refuse_misplaced(context, file, "contact_gap", "contact_angle", "overlap", "folder")
    if file.suffix.lower() == ".toml":
        check_case(file, changes or ())
        return
    from churchpipe.findings import FindingsError
    from churchpipe.importing import (
        UnsoundError,
        check_drawing,
        check_findings_apart,
        free_volume,
        joint_words,
        parse_tolerances,
        record_findings,
    )
    from churchpipe.meshes.reader import files_of
    from churchpipe.model.sizes import size_questions

    if folder:
        check_findings_apart(files_of(file), folder)
    try:
        read, contacts = check_drawing(file, reading, tolerances=parse_tolerances(contact_gap, contact_angle, overlap))
    except FindingsError as error:
        if folder:
            again = "Mend what the errors say, then check it again."
            record_findings(error.findings, folder, reading.units or "m", error.bodies, again)
            err.print(f"Look at it: {folder / 'findings.html'}", markup=False, soft_wrap=True)
        raise
    except UnsoundError as error:
        if folder:
            record_findings(error.drawing.findings, folder, error.drawing.units, error.drawing.stones, error.fault)
            err.print(f"Look at it: {folder / 'findings.html'}", markup=False, soft_wrap=True)
        raise
    _list(read.findings)
    for line in joint_words(read.stones, contacts, typed=True):
        out.print(line, markup=False, soft_wrap=True)
    ask(size_questions(read.stones))
    after = f"churchpipe import {shlex.quote(str(file))}"
    if folder:
        record_findings(read.findings, folder, read.units, read.stones, f"{after}, with the same options, makes a case of it.")
        out.print(f"Look at it: {folder / 'findings.html'}", markup=False, soft_wrap=True)
    warnings = counted(len(read.findings), "warning") if len(read.findings) else "nothing to report"
    held = f"{counted(int((~read.stones.fixed).sum()), 'stone')}, {four_figures(free_volume(read.stones))} m3"
    out.print(f"{file}: {held}, {warnings}.", markup=False, soft_wrap=True)
    out.print(f"Next: {after}, with the same options", markup=False, soft_wrap=True)


@app.command()
@with_reading
def view(
    context: typer.Context,
    file: ModelFile,
    reading: Any,
    page: Annotated[Path | None, out_option("Page to write; default: NAME.view.html here.")] = None,
    opens: Annotated[bool, typer.Option("--open/--no-open", help="Open it in the browser, or only say where it is.")] = True,
    changes: Changes = None,
) -> None:
    """Look at a model before any analysis: stones and their names, walls, openings, findings. A case, a drawing or a mesh."""
    import webbrowser

    from churchpipe.viewing import write_view

    refuse_misplaced(context, file)
    page = page or Path(f"{file.stem}.view.html")
    if page.is_dir():
        raise UsageError(f"--out {page}", "a folder", expected="the name of the page to write")
    # Anything else may be the file that is looked at, or another one that somebody wrote.
    if page.suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"--out {page}", "not the name of a page", expected="a name that ends in .html")
    write_view(file, page, reading, changes or ())
    out.print(str(page), soft_wrap=True)
    if opens:
        webbrowser.open(page.resolve().as_uri())


# Tables of a case that a drawing has no place for.
_UNDRAWN = (
    *("project", "rigid", "shell", "check", "published", "sample"),
    *("point_loads", "area_loads", "diaphragms", "pressures", "fills", "tie_candidates", "joints", "movements", "variants"),
)


@app.command("export-dxf")
def export_dxf(
    case: CaseFile,
    drawing: Annotated[Path, out_option("The drawing to write.")],
    changes: Changes = None,
) -> None:
    """Write the stones of a case as a DXF drawing, its materials and loads inside."""
    from churchpipe.config.case import Generated
    from churchpipe.dxf.writer import write_dxf

    if drawing.suffix.lower() != ".dxf":
        raise UsageError(f"--out {drawing}", "not the name of a drawing", expected="a name that ends in .dxf")
    read, stones = _stones_of(case, changes or (), drawing)
    carried = read.carries
    write_dxf(stones, drawing, materials=read.materials, loads=read.loads, ties=carried.ties, line_loads=carried.line_loads)
    out.print(f"{counted(int((~stones.fixed).sum()), 'stone')}: {drawing}", soft_wrap=True)
    beams = () if isinstance(read.source, Generated) else ("ring_beams",)
    left = [key for key in (*_UNDRAWN, *beams) if read.table.get(key)] + (["sweep"] if read.swept else [])
    if left:
        err.print(f"Not in the drawing, and the case's alone: {', '.join(left)}.", soft_wrap=True)


@app.command("export-obj")
def export_obj(
    case: CaseFile,
    mesh: Annotated[Path, out_option("The mesh to write.")],
    changes: Changes = None,
) -> None:
    """Write the stones of a case as a mesh (Wavefront OBJ) for other programs: an object for each stone, in metres."""
    from churchpipe.io.obj import write_obj

    if mesh.suffix.lower() != ".obj":
        raise UsageError(f"--out {mesh}", "not the name of a mesh", expected="a name that ends in .obj")
    _, stones = _stones_of(case, changes or (), mesh)
    write_obj(stones, mesh)
    out.print(f"{counted(int((~stones.fixed).sum()), 'stone')}: {mesh}", soft_wrap=True)
    told = "In the mesh are the stones, with the names of their walls and materials; all else is the case's alone."
    err.print(told, soft_wrap=True)


def _stones_of(path: Path, changes: Sequence[str], file: Path) -> tuple[Any, Any]:
    """Return a case, and its stones with their ground, to be written to another file than they are from."""
    from dataclasses import asdict

    from churchpipe.config.case import Generated, read_case
    from churchpipe.config.laid_stones import laid_stones
    from churchpipe.meshes.reader import files_of, read_file

    case = read_case(path, changes)
    if isinstance(case.source, Generated):
        return case, laid_stones(case, case.building())
    source = case.source.path
    if file.exists() and any(map(file.samefile, files_of(source))):
        raise UsageError(f"--out {file}", "the file that the case is made of", expected="another name")
    if source.is_dir() and file.parent.exists() and file.parent.samefile(source):
        raise UsageError(f"--out {file}", "in the folder that the case is made of", expected="another folder")
    weights = {material.name: material.unit_weight for material in case.materials}
    return case, read_file(source, unit_weight=weights, **asdict(case.source.reading)).stones


def _list(findings: Any) -> None:
    if len(findings):
        err.print(str(findings), soft_wrap=True)
