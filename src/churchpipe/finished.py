"""Whether a run folder still holds all that a case asks for. If so, its results are told without starting the engine.

The engine would find the same out, in some seconds. This looks at dates and sizes only: whatever differs, even a date, is left
to the engine, which compares contents.
"""

import hashlib
import json
import os
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from churchpipe.engine import UNFINISHED
from churchpipe.io.atomic import write_text
from churchpipe.resources import pipeline_folder

# Lies in a run folder: the question that its results answer, and all its files as they were when it had ended.
RECORD = Path(".snakemake", "finished.json")
# Date and size of a file, by its path: of one in the folder, from there, so that a copy of the folder tells of its own files.
_Stamps = dict[str, list[int]]


def run_name(case: Path) -> str:
    """Return the name of the run of a case file, "" where the text does not tell it."""
    try:
        # A pipe is not waited for.
        name = tomllib.loads(case.read_text(encoding="utf-8-sig") if case.is_file() else "").get("name", case.stem)
    except (OSError, ValueError):
        return ""
    return name if isinstance(name, str) else ""


@dataclass(frozen=True, slots=True)
class Asked:
    """What a run is asked for as it begins: the question, and the files of the drawing as they were, if there is one."""

    question: str
    drawing: _Stamps


def asked(case: Path, changes: Sequence[str], drawing: Path | None) -> Asked:
    """Return what a case with these changes asks for, before any stage reads it: it may be edited while the run is at work."""
    return Asked(_question(case, changes), _stamps(case.parent, _drawn(drawing.resolve()) if drawing else []))


def note_finished(folder: Path, begun: Asked, *, good: bool) -> None:
    """Note that a folder holds the results of what was asked for, are they good or not."""
    engine = folder.resolve() / RECORD.parent
    # A link to nowhere, as editors leave one while a file is open, is no result.
    files = [path for path in _files(folder) if engine not in path.parents and path.exists()]
    stamps = _stamps(folder, [path.relative_to(folder.resolve()) for path in files]) | begun.drawing
    write_text(folder / RECORD, json.dumps({"question": begun.question, "good": good, "files": stamps}))


def finished(folder: Path, case: Path, changes: Sequence[str]) -> bool | None:
    """Return whether the results that lie in a folder are good; None where they may not answer this case with these changes."""
    record = folder / RECORD
    if not record.is_file() or (folder / UNFINISHED).exists():
        return None
    try:
        noted = json.loads(record.read_text(encoding="utf-8"))
        same = noted["question"] == _question(case, changes) and noted["files"] == _stamps(folder, map(Path, noted["files"]))
        return noted["good"] if same else None
    except (OSError, ValueError, KeyError, TypeError):
        # A file is gone, or the record is damaged, as where the power failed.
        return None


def _question(case: Path, changes: Sequence[str]) -> str:
    """Return what decides the results besides the drawing: the case, what was changed in it, and the program."""
    own, pipeline = Path(__file__).parent, pipeline_folder()
    program = [path for path in _files(own) if "__pycache__" not in path.parts]
    program += [pipeline / "Snakefile", *_files(pipeline / "rules"), *_files(pipeline / "profiles")]
    asked = [str(case.resolve()), hashlib.sha256(case.read_bytes()).hexdigest(), list(changes), _stamps(own, program)]
    return hashlib.sha256(json.dumps(asked, sort_keys=True).encode()).hexdigest()


def _drawn(drawing: Path) -> list[Path]:
    """Return the files that a drawing is read from and, where there may be several, their folders, which others may join."""
    from churchpipe.meshes.reader import BODIES, files_of

    files = files_of(drawing)
    several = [drawing] if drawing.is_dir() else [drawing.parent] if drawing.name == BODIES else []
    folders = {*several, *(file.parent for file in files if several)}
    return [*files, *sorted(folders)]


def _files(folder: Path) -> Iterator[Path]:
    for where, _, names in os.walk(folder.resolve()):
        yield from (Path(where, name) for name in names)


def _stamps(folder: Path, files: Iterable[Path]) -> _Stamps:
    found = {str(path): (folder / path).stat() for path in files}
    return {name: [stat.st_mtime_ns, stat.st_size] for name, stat in found.items()}
