"""A case file as the table that stands in it."""

import re
import tomllib
from pathlib import Path
from typing import Any

from churchpipe.config.overrides import DEEPEST, depth
from churchpipe.errors import InputError


def read_table(path: Path) -> dict[str, Any]:
    """Return a case file's table as it is written.

    Raises
    ------
    InputError: not a text file, not TOML.
    """
    try:
        if path.exists() and not path.is_file():
            # A pipe can be read once only.
            raise InputError(str(path), "not a file", found="a folder, a pipe or a device", expected="a case file")
        table = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(str(path), "cannot be read", found=error.strerror or error, expected="a case file") from error
    except UnicodeDecodeError as error:
        raise InputError(
            str(path),
            "not a text in UTF-8",
            found=f"{error.reason}, byte {error.start + 1}",
            expected="a case file in TOML",
            remedy="A text in another encoding (UTF-16, Latin-1) is to be saved as UTF-8.",
        ) from error
    except RecursionError as error:
        raise _too_deep(path) from error
    except InputError:
        raise
    except ValueError as error:
        # TOMLDecodeError is one; a number of thousands of digits is refused by Python itself.
        remedy = "Text needs quotes, a number digits on both sides of its point (0.5, not .5 or 0,5); a table has [brackets], "
        remedy += "each of several of one name [[two]]."
        if path.suffix.lower() != ".toml":
            remedy = "Of a drawing or a mesh, churchpipe import makes a case."
        found = str(error).replace("Cannot overwrite a value", "a key given twice")
        found = re.sub(r"Cannot declare \((.*?),?\) twice", r"a table given twice, \1", found)
        raise InputError(str(path), "not TOML", found=found, remedy=remedy) from error
    if depth(table) > DEEPEST:
        raise _too_deep(path)
    return table


def _too_deep(path: Path) -> InputError:
    expected = f"a case file, at most {DEEPEST} levels"
    return InputError(str(path), "not a case file", found="lists or tables too deep", expected=expected)
