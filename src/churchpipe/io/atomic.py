"""Write whole files or none; read JSON."""

import json
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from churchpipe.errors import InputError

# How temporary names begin: what a killed run left behind is known by it.
PART = ".part-"


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
        if error.filename == str(part):
            error.filename = str(target)
        raise
    finally:
        part.unlink(missing_ok=True)


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
