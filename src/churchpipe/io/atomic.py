"""Write whole files or none; read JSON."""

import errno
import json
import math
import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from churchpipe.errors import InputError

# How temporary names begin: what a killed run left behind is known by it.
PART = ".part-"
# What is told of a path, in letters.
_LONGEST = 200


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` when the block ends well, delete it when it does not.

    The temporary name keeps the suffix, for writers that go by it. Folders are made as needed.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f"{PART}{os.getpid()}-{target.name}")
    try:
        yield part
        part.replace(target)
    except OSError as error:
        # A write that fails names no file, and one of a copy names that which is copied first.
        if error.filename is None or str(part) in (error.filename, error.filename2):
            error.filename, error.filename2 = str(target), None
        raise
    finally:
        # A file system that is read-only refuses that too, which is not what is to be told.
        with suppress(OSError):
            part.unlink(missing_ok=True)


def remove_parts(folder: Path) -> None:
    """Remove what killed processes have left in a folder under temporary names."""
    for part in [*folder.rglob(f"{PART}*")]:
        if part.is_dir():
            shutil.rmtree(part, ignore_errors=True)
        else:
            part.unlink(missing_ok=True)


@contextmanager
def all_or_none(files: Iterable[Path]) -> Iterator[None]:
    """Write several files: when the block fails, those of them that were not there before are deleted, with the folders made."""
    made = [file for file in files if not file.exists()]
    folders = {folder for file in made for folder in file.parents if not folder.exists()}
    try:
        yield
    except BaseException:
        for file in made:
            file.unlink(missing_ok=True)
        for folder in sorted(folders, key=lambda folder: len(folder.parts), reverse=True):
            # A folder in which somebody else has written since stays.
            with suppress(OSError):
                folder.rmdir()
        raise


@contextmanager
def named_by_caller(where: str, path: str | Path) -> Iterator[None]:
    """Write a file that a caller of this package named: where and the path stand in the error if the system refuses it.

    Raises
    ------
    InputError: a folder in its place, a file where one of its folders would be, a disk that is full and the like.
    """
    try:
        if Path(path).is_dir():
            raise IsADirectoryError(errno.EISDIR, "a folder of this name")
        yield
    except OSError as error:
        taken = isinstance(error, FileExistsError | NotADirectoryError)
        found = "a file where a folder would be" if taken else error.strerror or str(error)
        name = str(path) if len(str(path)) <= _LONGEST else f"{str(path)[:_LONGEST]} ..."
        problem, remedy = "the file cannot be written", "Choose another place to write to."
        raise InputError(where, problem, found=f"{found}, {name}", remedy=remedy) from error


def write_text(path: str | Path, text: str) -> None:
    """Write a text file whole."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def write_json(path: str | Path, value: Any) -> None:
    """Write JSON in the order of the keys; numbers that are not finite become null."""
    write_text(path, _json(value, sort=False))


def read_json(path: str | Path) -> Any:
    """Read a JSON artifact.

    Raises
    ------
    InputError: the file is missing or not JSON.
    """
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(path), "cannot be read", found=error.strerror or error, expected="an artifact of a run") from error
    except ValueError as error:
        raise InputError(str(path), "not JSON", found=error, remedy="Delete the file and run the case again.") from error


def write_if_changed(path: str | Path, text: str) -> None:
    """Write a text file only when its content differs, so that its date says when the content last changed."""
    target = Path(path)
    if not target.exists() or target.read_text(encoding="utf-8") != text:
        write_text(target, text)


def canonical_json(value: Any) -> str:
    """Return JSON text with sorted keys: equal content is equal text."""
    return _json(value, sort=True)


def _json(value: Any, *, sort: bool) -> str:
    return json.dumps(_finite(value), indent=1, sort_keys=sort, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
