"""The one exception that users meet: what is wrong, where, and how to mend it."""

import os
import re
from pathlib import Path
from typing import Any

# Halves of a character beyond the first 65536, as a text cut in two leaves them: no file can hold them.
_HALVES = re.compile("[\\ud800-\\udfff]")
# What would steer a terminal, turn the direction of what follows, or cannot be written to it.
_STEERING = re.compile("[\\x00-\\x08\\x0b-\\x1f\\x7f-\\x9f\\u202a-\\u202e\\u2066-\\u2069\\ud800-\\udfff]")
INSTALL = "pip install 'churchpipe[all]' installs all that churchpipe can use."


def steers(text: str) -> bool:
    """Return whether a text has characters that would steer a terminal, or turn the direction of what follows."""
    return bool(_STEERING.search(text))


def halved(text: str) -> bool:
    """Return whether a text has half of a character."""
    return bool(_HALVES.search(text))


def check_whole(where: str, text: str) -> None:
    """Raise InputError for a text that no file can hold, since it has half of a character."""
    if halved(text):
        raise InputError(
            where,
            "half of a character, which no file can hold",
            found=repr(text)[:60],
            expected="whole characters",
            remedy="A text that was cut, or read as UTF-16, leaves such halves: give the whole name.",
        )


class InputError(ValueError):
    """Input that churchpipe cannot take.

    Parameters
    ----------
    where
        The file, key, stone or argument at fault.
    problem
        What is wrong there.
    found, expected
        The value met and the value wanted (left out of the message when empty).
    remedy
        What the user can do about it.
    """

    def __init__(self, where: str, problem: str, *, found: object = "", expected: str = "", remedy: str = "") -> None:
        self.where, self.problem, self.found, self.expected, self.remedy = where, problem, found, expected, remedy
        parts = [f"{where}: {problem}"]
        if not isinstance(found, str) or found:
            parts.append(f"found {found}")
        if expected:
            parts.append(f"expected {expected}")
        message = "; ".join(parts)
        # What several errors say together may end with the question of the last one.
        message += "" if message.endswith((".", "?")) else "."
        shown = f"{message} {remedy}".strip()
        super().__init__(_STEERING.sub(lambda found: found[0].encode("unicode_escape").decode(), shown))

    def __reduce__(self) -> tuple[Any, ...]:
        """Let the error come whole from another process, whatever was found."""
        kept = isinstance(self.found, str | int | float | tuple | None)
        return _again, (self.__class__, self.args), {**self.__dict__, "found": self.found if kept else str(self.found)}

    def at(self, where: str) -> "InputError":
        """Return the same error of another place."""
        return InputError(where, self.problem, found=self.found, expected=self.expected, remedy=self.remedy)

    def within(self, folder: Path) -> "InputError":
        """Return the same error, with the whole path of a file in that folder which it names from there."""
        path = os.path.join(folder, self.where)
        # One that could not be written is not there.
        named = os.path.isfile(path) or ("/" in self.where and os.path.isdir(os.path.dirname(path)))
        return self.at(path) if named else self


def _again(kind: type[InputError], arguments: tuple[Any, ...]) -> InputError:
    error = kind.__new__(kind)
    error.args = arguments
    return error


class Extra:
    """Around an import of what only `churchpipe[all]` installs: says so where it is missing.

    Parameters
    ----------
    purpose: what needs it.

    Raises
    ------
    InputError: a package is not installed.
    """

    def __init__(self, purpose: str) -> None:
        self._purpose = purpose

    def __enter__(self) -> None: ...

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, ModuleNotFoundError):
            raise InputError(
                self._purpose, "a package is not installed", found=error.name or str(error), remedy=INSTALL
            ) from error


class UsageError(InputError):
    """An argument of the command line that cannot be taken: the input itself was not looked at."""
