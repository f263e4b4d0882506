"""Commands of runs: run, show, report."""

import os
import shlex
from collections.abc import Iterable, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from churchpipe.cli.app import FINDINGS, INTERRUPTED, STRUCTURE, app, ask, err, out
from churchpipe.cli.cases import read_sound
from churchpipe.errors import InputError, UsageError
from churchpipe.options import CaseFile, Changes, RunFolder, out_option
from churchpipe.wording import counted

if TYPE_CHECKING:
    from churchpipe.engine import Engine

# A single solve shares its work among as many threads: with far more it does not end.
_MOST_JOBS = 10_000


@app.command()
def run(
    case: CaseFile,
    out_dir: Annotated[Path | None, out_option("Run folder; default runs/NAME.")] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            "--jobs", "-j", min=1, max=_MOST_JOBS, help="How many stages may run at a time; default: one for each core."
        ),
    ] = None,
    changes: Changes = None,
    load: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Analyse this load, or this support that moves, alone. Repeatable.")
    ] = None,
    model: Annotated[
        str,
        typer.Option(
            help='Analyse one model alone: "blocks" or "shell".', show_default=False, autocompletion=lambda: ["blocks", "shell"]
        ),
    ] = "",
    only: Annotated[
        str, typer.Option(metavar="STAGE", help="Make this stage and what it needs, and no more: contacts, shell, rigid ...")
    ] = "",
    profile: Annotated[str, typer.Option(help="Where the stages run: local, slurm, or a folder with a profile.")] = "local",
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Say what would be done and why, and do nothing.")] = False,
) -> None:
    """Run a case: stones, contacts, load factors, report. Stages that are up to date are not made again."""
    from churchpipe import engine
    from churchpipe.finished import finished, run_name

    engine.profile_folder(profile)
    picked = [*(f"--load {name}" for name in load or ()), *([f"--model {model}"] if model else [])]
    asked = [*(changes or ()), *picked]
    named = out_dir or Path("runs") / run_name(case)
    if not only and case.is_file() and (good := finished(named, case, asked)) is not None:
        if dry_run:
            _print_pending([])
            return
        err.print("Nothing has changed since the last run.")
        _print_run(named, good=good)
        return
    try:
        # It loads its libraries while the case is read.
        with nullcontext() if dry_run else engine.started(profile) as ready:
            _run(case, out_dir, jobs or os.cpu_count() or 1, changes or (), tuple(load or ()), model, only, asked, ready)
    except KeyboardInterrupt:
        err.print("Stopped. What was finished stays; run it again to go on.")
        raise typer.Exit(INTERRUPTED) from None


def _run(
    case: Path,
    out_dir: Path | None,
    jobs: int,
    changes: Sequence[str],
    loads: tuple[str, ...],
    model: str,
    only: str,
    asked: Sequence[str],
    ready: "Engine | None",
) -> None:
    """Let an engine make the results of a case, and print them; where there is none, say what it would do.

    asked: what the results are to be noted under, with the case.
    """
    from churchpipe import engine
    from churchpipe.compilation import compiled
    from churchpipe.config.case import Generated
    from churchpipe.config.plan import plan
    from churchpipe.config.plausible import work_questions
    from churchpipe.config.selection import Selection, selected
    from churchpipe.configuring import configure
    from churchpipe.finished import asked as asked_for
    from churchpipe.finished import note_finished
    from churchpipe.terminal import Display

    # A case with mistakes is refused before anything is written.
    cases = read_sound(case, changes)
    selection = Selection(loads, model)
    chosen = selected(cases, selection)
    known = plan(chosen).stages
    if only and only not in known:
        raise UsageError(f"--only {only}", "no such stage in this case", expected=", ".join(known))
    until = only if only != known[-1] else ""
    ask(work_questions(chosen))
    _check_buildings(chosen)
    folder = folder_of(case, cases[0].name, out_dir)
    source = cases[0].source
    begun = asked_for(case, asked, None if isinstance(source, Generated) else source.path)

    def prepare(place: Path = folder) -> None:
        configure(case, place, changes, selection)
        _drop_damaged(place / "summary.json", folder)

    if ready is None:
        from churchpipe.pending import pending

        _print_pending(pending(folder, prepare, until))
        return
    if not compiled():
        err.print("First start: the solvers are compiled once, which takes some 10 to 20 s a model.", soft_wrap=True)
    with Display(err) as display:
        code = engine.run(ready, folder, jobs, display.show, prepare, until)
    if display.errors:
        _check_walls(chosen)
        check_nodes(folder, chosen)
        # The jobs of several analyses meet the same fault.
        for text in dict.fromkeys(display.errors):
            err.print(text, style="red", soft_wrap=True)
        raise typer.Exit(FINDINGS)
    if code:
        err.print(engine.unfinished(folder), style="red", markup=False, soft_wrap=True)
        raise typer.Exit(STRUCTURE)
    if until:
        out.print(f"Made as far as the stage {until}: {folder}", soft_wrap=True)
        return
    from churchpipe.compare import bad_news
    from churchpipe.io.summary import read_summary

    good = not bad_news(read_summary(folder / "summary.json"))
    note_finished(folder, begun, good=good)
    _print_run(folder, good=good)


def _drop_damaged(summary: Path, folder: Path) -> None:
    """Delete a summary that cannot be read, so that it is made anew from the records of the analyses. folder: of the run."""
    from churchpipe.io.summary import read_summary

    if not summary.is_file():
        return
    try:
        read_summary(summary)
    except InputError as error:
        summary.unlink()
        err.print(f"{folder / summary.name}: {error.problem}. It is made anew.", style="yellow", markup=False, soft_wrap=True)


def _check_buildings(cases: Iterable[Any]) -> None:
    """Make all generated buildings of a run of several, and look at what they bear.

    The stages would do it one after the other, and a fault in the last one end the run after hours, without a report.
    """
    from churchpipe.config.carries import plain
    from churchpipe.config.case import Generated

    different: list[tuple[Any, Any]] = []
    for case in cases:
        # As lists, since arrays are not equal as a whole.
        known = plain((case.source, case.buttresses, case.ring_beams, case.joints, case.carries))
        if isinstance(case.source, Generated) and all(known != other for other, _ in different):
            different.append((known, case))
    for _, case in different if len(different) > 1 else ():
        case.building()


def _check_walls(cases: Iterable[Any]) -> None:
    """Look again for what a stage missed in the walls of a building or a drawing: it knows no line of the case."""
    from dataclasses import asdict

    from churchpipe.config.case import Drawing
    from churchpipe.config.laid_stones import laid_stones
    from churchpipe.config.picked import check_picked, picks
    from churchpipe.importing import check_carried
    from churchpipe.meshes.reader import read_file
    from churchpipe.stones.contacts import find_contacts

    for case in cases:
        if isinstance(case.source, Drawing):
            weights = {material.name: material.unit_weight for material in case.materials}
            stones = read_file(case.source.path, unit_weight=weights, **asdict(case.source.reading)).stones
            check_carried(case, stones, find_contacts(stones, **case.tolerances) if picks(case) else None)
            continue
        stones = laid_stones(case, case.building())
        if picks(case):
            check_picked(case, stones, find_contacts(stones, **case.tolerances))


def check_nodes(folder: Path, cases: Iterable[Any]) -> None:
    """Look in the meshes of a run for the node that a capacity curve follows: the stage that missed it knows no line."""
    from churchpipe.io.npz import Absent
    from churchpipe.run_folder import read_run

    run = read_run(folder / "plan.json")
    meshes = [run.shell(entry["name"]) for entry in run.index["shells"] if run.has_shell(entry["name"])]
    counts = [len(mesh.points) for mesh in meshes if not isinstance(mesh, Absent)]
    for case in cases:
        node = case.shell.control_point if case.shell else None
        if node is not None and counts and node >= min(counts):
            where, expected = f"{case.path}: shell.control_point", f"0 to {min(counts) - 1}"
            remedy = "The nodes are numbered by the mesh: control_point_mm gives a place, whose nearest node is followed."
            raise case.located(InputError(where, "no such node", found=node, expected=expected, remedy=remedy))


def folder_of(case: Path, name: str, out_dir: Path | None) -> Path:
    """Return the folder of the run of a case, if it is free for it. name: of the case."""
    from churchpipe.config.asrun import ORIGIN, other_case

    folder = out_dir or Path("runs") / name
    if folder.exists() and not folder.is_dir():
        raise UsageError(str(folder), "a file, where the folder of the run would be", remedy="Choose another folder with --out.")
    theirs = [file.name for file in folder.iterdir() if not file.name.startswith(".")] if folder.is_dir() else []
    if theirs and not {ORIGIN, "plan.json"} & {*theirs}:
        own = folder / "run"
        one = case.name if case.name in theirs else min(theirs)
        err.print(
            f"The folder {folder} holds other files, such as {one}. Those of the run, report.html, code, geometry, log and so "
            f"on, are written among them: --out {shlex.quote(str(own))} keeps them apart.",
            markup=False,
            soft_wrap=True,
        )
    if other := other_case(folder, case):
        if out_dir is None:
            remedy = "Give one of them another name, or a folder of its own with --out."
            raise UsageError(str(folder), "holds the run of another case of this name", found=other, remedy=remedy)
        err.print(f"{folder} held the run of {other} until now.", soft_wrap=True)
    return folder


def _print_pending(jobs: Any) -> None:
    for job in jobs:
        out.print(f"{job.stage:<9} {job.name:<44} {job.why}", soft_wrap=True)
    count = f"{counted(len(jobs), 'stage')} would be run." if jobs else "Everything is up to date."
    out.print(count)


@app.command()
def show(folder: RunFolder) -> None:
    """Show the results of a run: load factors, what moves, the safety check. Of a folder of runs: which runs lie in it."""
    from churchpipe.terminal import runs_table

    if runs := runs_table(folder):
        out.print(runs)
        return
    _print_results(_result_of(folder, "summary.json"))


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


def _result_of(folder: Path, name: str) -> Path:
    """Return a file that a run has left, if the run ended well."""
    from churchpipe.engine import unfinished

    if why := unfinished(folder):
        raise InputError(
            str(folder), "the last run did not go to its end", found=why, remedy="Run it again, with what it says mended."
        )
    if not (folder / name).is_file():
        raise InputError(str(folder), "no results", expected=name, remedy="churchpipe run CASE.toml makes it.")
    return folder / name


def _print_run(folder: Path, *, good: bool) -> None:
    """Print the results of a run that has ended; leave with the code for bad news, if they are."""
    _print_results(folder / "summary.json")
    out.print(f"Report: {folder / 'report.html'}", soft_wrap=True)
    if not good:
        raise typer.Exit(STRUCTURE)


def _print_results(path: Path) -> None:
    from churchpipe.io.summary import read_summary
    from churchpipe.terminal import mechanism_table, remarks, results_table, sizes_words

    summary = read_summary(path)
    # A case may move supports alone.
    tables = (results_table(summary), mechanism_table(summary)) if summary.analyses else ()
    if not tables:
        out.print(sizes_words(summary), style="bold", markup=False, soft_wrap=True)
    for table in filter(None, tables):
        out.print(table)
        out.print()
    for line in remarks(summary):
        out.print(line, soft_wrap=True)
