"""Commands of runs: run, show, report."""

import os
from pathlib import Path
from typing import Annotated, Any

import typer

from churchpipe.cli.app import FINDINGS, INTERRUPTED, STRUCTURE, app, err, out
from churchpipe.errors import InputError, UsageError
from churchpipe.options import CaseFile, Changes, RunFolder


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
    from churchpipe import engine
    from churchpipe.finished import finished, note_finished, run_name
    from churchpipe.io.tables import read_json

    named = out_dir or Path("runs") / run_name(case)
    if case.is_file() and (good := finished(named, case, changes or ())) is not None:
        err.print("Nothing has changed since the last run.")
        _tell(named, good=good)
        return
    from churchpipe import stages
    from churchpipe.compare import bad_news
    from churchpipe.compilation import compiled
    from churchpipe.config import Generated, read_case
    from churchpipe.config.asrun import claim, other_case
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
    good = not bad_news(read_json(folder / "summary.json"))
    drawing = None if isinstance(read.source, Generated) else read.source.path
    note_finished(folder, case, changes or (), drawing, good=good)
    _tell(folder, good=good)


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


def _result_of(folder: Path, name: str) -> Path:
    """Return a file that a run has left, if the run ended well."""
    from churchpipe.engine import unfinished

    if why := unfinished(folder):
        raise InputError(str(folder), "the last run did not end well", found=why, remedy="Mend what it says and run it again.")
    if not (folder / name).is_file():
        raise InputError(str(folder), "no results", expected=name, remedy="churchpipe run CASE.toml makes it.")
    return folder / name


def _tell(folder: Path, *, good: bool) -> None:
    """Print the results of a run that has ended; leave with the code for bad news, if they are."""
    from churchpipe.io.tables import read_json

    _print_results(read_json(folder / "summary.json"))
    out.print(f"Report: {folder / 'report.html'}", soft_wrap=True)
    if not good:
        raise typer.Exit(STRUCTURE)


def _print_results(summary: dict[str, Any]) -> None:
    from churchpipe.terminal import remarks, results_table

    out.print(results_table(summary))
    for line in remarks(summary):
        out.print(line, soft_wrap=True)
