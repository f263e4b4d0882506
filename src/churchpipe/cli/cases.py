"""Commands of case files: generate, schema."""

import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from churchpipe.cli.app import app, ask, err, out
from churchpipe.errors import InputError, UsageError
from churchpipe.options import out_option
from churchpipe.resources import sample_case, sample_names
from churchpipe.wording import counted


def _samples(begun: str) -> list[str]:
    """Return the ready cases that a shell may complete a word to."""
    return [name for name in sample_names() if name.startswith(begun)]


@app.command()
def generate(
    name: Annotated[
        str, typer.Argument(help=f"One of {', '.join(sample_names())}.", show_default=False, autocompletion=_samples)
    ],
    case: Annotated[Path | None, out_option("The case file to write; default: the terminal.")] = None,
) -> None:
    """Write a commented case file to edit: dimensions, materials, loads."""
    text = sample_case(name)
    if case is None:
        out.print(text, end="", soft_wrap=True)
        return
    if case.exists():
        raise UsageError(str(case), "exists already", remedy="Choose another name, or delete it first.")
    # By this suffix check and view tell a case from a drawing, and editors find its schema.
    if case.suffix.lower() != ".toml":
        raise UsageError(f"--out {case}", "not the name of a case", expected="a name that ends in .toml")
    from churchpipe.config.json_schema import write_case
    from churchpipe.config.schema import NAME_PATTERN

    # A run has the name of its case: two cases of one sample are run in two folders.
    if re.match(NAME_PATTERN, case.stem):
        text = re.sub(r'^name = "[^"]*"', f'name = "{case.stem}"', text, count=1, flags=re.MULTILINE)
    write_case(case, text)
    out.print(f"{case}: edit it, then churchpipe run {shlex.quote(str(case))}", soft_wrap=True)


@app.command()
def schema(
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the keys as a page to read instead (docs/reference_case.md).")
    ] = False,
) -> None:
    """Print the JSON schema of the case file, by which editors complete and check it."""
    from churchpipe.config.json_schema import schema_text
    from churchpipe.config.reference import reference_page

    out.print(reference_page() if markdown else schema_text(), markup=False, end="", soft_wrap=True)


def read_sound(path: Path, changes: Sequence[str]) -> Any:
    """Return the cases of a file, after its first building was made, and the walls of those of its variants: mistakes are found
    before anything is written."""
    from churchpipe.config.case import Generated, read_variants

    cases = read_variants(path, changes)
    source = cases[0].source
    if isinstance(source, Generated):
        cases[0].building()
        for case in {case.variant.name: case for case in reversed(cases) if case.variant}.values():
            if (case.source, case.buttresses) != (source, cases[0].buttresses):
                case.laid()
        return cases
    if not source.path.resolve().is_relative_to(path.resolve().parent):
        err.print(f"The drawing lies elsewhere: {source.path.resolve()}", soft_wrap=True)
    _check_there(path, cases[0])
    return cases


def check_case(path: Path, changes: Sequence[str]) -> None:
    """Lay the stones of all buildings of a case, or read its drawing, and say what a run would make."""
    from churchpipe.config.case import Generated, read_variants
    from churchpipe.config.laid_sizes import laying_questions
    from churchpipe.config.plan import plan
    from churchpipe.config.plausible import work_questions

    cases = read_variants(path, changes)
    first = laying_questions(cases)
    ask(first)
    seen: list[Any] = []
    for case in cases:
        made = case.building() if isinstance(case.source, Generated) else None
        if (known := (case.source, case.buttresses, case.ring_beams)) in seen:
            continue
        seen.append(known)
        if made:
            _check_laid(path, case, made)
        else:
            _check_drawn(path, case)
    todo = plan(cases)
    sampled = todo.index["sample"]
    counts = (
        (todo.geometries, "structure", ""),
        (todo.shells, "mesh", "meshes"),
        (todo.analyses, "analysis", "analyses"),
        (todo.movements, "support that moves", "supports that move"),
        (range(sampled["number"]) if sampled else (), "sample of uncertain values", "samples of uncertain values"),
    )
    words = [counted(len(made), one, several) for made, one, several in counts if made]
    out.print(f"{path}: {', '.join(words)}.", soft_wrap=True)
    ask(text for text in (*todo.index["questions"], *work_questions(cases)) if text not in first)


def _check_there(path: Path, case: Any) -> None:
    """Raise InputError, with its line, where the drawing or the mesh of a case is not there."""
    if not case.source.path.exists():
        key = "dxf" if "dxf" in case.table["source"] else "file"
        remedy = "Paths are relative to the case file."
        error = InputError(f"{path}: source.{key}", "no such file", found=case.source.path, remedy=remedy)
        raise case.located(error)


def _check_laid(path: Path, case: Any, building: Any) -> None:
    from churchpipe.config.picked import check_picked, ground_questions
    from churchpipe.config.soil_questions import end_questions
    from churchpipe.model.sizes import size_questions
    from churchpipe.stones.blocks import derive_blocks
    from churchpipe.stones.contacts import find_contacts
    from churchpipe.stones.soundness import check_soundness

    try:
        stones = derive_blocks(building)
        contacts = find_contacts(stones, **case.tolerances)
        check_soundness(stones, contacts)
    except InputError as error:
        raise case.located(error) from error
    check_picked(case, stones, contacts)
    name = f"{path}, {case.variant.name}" if case.variant else str(path)
    free = counted(int((~stones.fixed).sum()), "stone")
    out.print(f"{name}: {free}, {counted(len(contacts.area), 'joint')}.", markup=False, soft_wrap=True)
    ask([*size_questions(stones), *ground_questions(case, stones, contacts), *end_questions(case.carries, stones)])


def _check_drawn(path: Path, case: Any) -> None:
    from churchpipe.importing import check_carried, check_drawing, joint_words
    from churchpipe.model.sizes import size_questions

    _check_there(path, case)
    weights = {material.name: material.unit_weight for material in case.materials}
    read, contacts = check_drawing(case.source.path, case.source.reading, weights, case.tolerances)
    if len(read.findings):
        err.print(str(read.findings), soft_wrap=True)
    asked = check_carried(case, read.stones, contacts)
    free = int((~read.stones.fixed).sum())
    out.print(f"{case.source.path}: {counted(free, 'stone')}.", soft_wrap=True)
    for line in joint_words(read.stones, contacts):
        out.print(line, soft_wrap=True)
    ask([*size_questions(read.stones), *asked])
