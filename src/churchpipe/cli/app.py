"""The application of the command line, and where it prints."""

import importlib.metadata
import os
import sys
from collections.abc import Iterable
from typing import Annotated, NoReturn

import typer
from rich.console import Console

FINDINGS, USAGE, STRUCTURE, INTERRUPTED = 1, 2, 3, 130

app = typer.Typer(
    name="churchpipe",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Exit codes: 0 done; 1 errors in the input; 2 a command that cannot be read; 3 the structure does not stand, "
    "an analysis did not converge, the match gate failed (all three with a report), or the run crashed.",
)


def leave_pipe(code: int = 0) -> NoReturn:
    """End well where the reader of a pipe (head, less) has left: it has read what it wanted."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    raise SystemExit(code)


def _open_streams() -> None:
    """Let streams lead nowhere that were closed as the program began: a file opened later would take their place."""
    # In the order of their numbers, of which the system gives the lowest that is free.
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8"))


class _Results(Console):
    def on_broken_pipe(self) -> None:
        """Leave, which by default is an error."""
        leave_pipe()


_open_streams()
# Names and paths are printed as they are: no markup and no emoji in them. Into a file or a pipe, tables keep their width.
out = _Results(highlight=False, markup=False, emoji=False, width=None if sys.stdout.isatty() else 120)
err = Console(stderr=True, highlight=False, markup=False, emoji=False)


def ask(questions: Iterable[str]) -> None:
    """Print what is to be asked about the input, beside what was asked for."""
    for question in questions:
        err.print(question, soft_wrap=True)


def _version(wanted: bool) -> None:
    if wanted:
        out.print(f"churchpipe {importlib.metadata.version('churchpipe')}")
        raise typer.Exit


@app.callback()
def churchpipe(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")] = False,
) -> None:
    """How much lateral load brings a masonry building down, from its stones.

    From a drawing or a mesh: [bold]import[/], then [bold]run[/]. From a handful of dimensions: [bold]generate[/], edit,
    [bold]run[/].
    """
