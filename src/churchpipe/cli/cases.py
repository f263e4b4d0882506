"""Commands of case files: generate, schema."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from churchpipe.cli.app import app, err, out
from churchpipe.errors import InputError, UsageError
from churchpipe.resources import sample_case, sample_names


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


def check_case(path: Path) -> None:
    from churchpipe.config import Generated, read_variants
    from churchpipe.config.plan import plan

    variants = read_variants(path)
    for case in variants:
        if isinstance(case.source, Generated):
            case.building()
        elif not case.source.path.exists():
            raise InputError(f"{path}: source", "no such file of stones", found=case.source.path)
    todo = plan(variants)
    counts = (
        (todo.geometries, "structure", "structures"),
        (todo.shells, "mesh", "meshes"),
        (todo.analyses, "analysis", "analyses"),
    )
    words = [f"{len(made)} {one if len(made) == 1 else several}" for made, one, several in counts if made]
    out.print(f"{path}: {', '.join(words)}.", markup=False, soft_wrap=True)
    for question in todo.index["questions"]:
        err.print(question, markup=False, soft_wrap=True)
