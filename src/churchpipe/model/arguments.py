"""Arguments of the wrong kind: named at the door, not met in the depths."""

import math
import numbers
import os
from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, cast

from churchpipe.errors import InputError, check_whole

_LEAST = 1e-6


def check_kind(where: str, value: object, *kinds: type, remedy: str = "") -> None:
    """Raise InputError unless a value is of a type of ours, or of one of several."""
    if not isinstance(value, kinds):
        expected = " or ".join(f"{'an' if kind.__name__[0] in 'AEIOU' else 'a'} {kind.__name__}" for kind in kinds)
        raise InputError(where, "wrong kind", found=describe(value), expected=expected, remedy=remedy)


def check_call(where: str, value: object, *, needed: bool = False) -> None:
    """Raise InputError unless a value is a function or, where it is not needed, None."""
    if not callable(value) and (needed or value is not None):
        expected = "a function" if needed else "a function, or None"
        raise InputError(where, "not a function", found=describe(value), expected=expected)


def listed(where: str, value: Any, *kinds: type) -> list[Any]:
    """Return a sequence of values of one type, or of several, as a list.

    Raises
    ------
    InputError: no sequence, or one of other things.
    """
    if isinstance(value, (*kinds, str, bytes)) or not isinstance(value, Iterable):
        raise _no_list(where, cast("object", value), *kinds)
    try:
        items = list(cast("Iterable[Any]", value))
    except TypeError:
        # An array without a dimension calls itself iterable.
        raise _no_list(where, cast("object", value), *kinds) from None
    for number, item in enumerate(items):
        check_kind(f"{where}[{number}]", item, *kinds)
        if isinstance(item, str):
            check_whole(f"{where}[{number}]", item)
    return items


def _no_list(where: str, value: object, *kinds: type) -> InputError:
    expected = f"a list of {' or '.join(kind.__name__ for kind in kinds)}"
    return InputError(where, "wrong kind", found=describe(value), expected=expected)


def finite(where: str, value: object, expected: str = "a finite number") -> float:
    """Return a value that is one finite number; expected: what else it is to be, for messages.

    Raises
    ------
    InputError: none, such as a text, a list or NaN.
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise InputError(where, "not a number", found=describe(value), expected="a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(where, "out of range", found=describe(value), expected=expected)
    return number


def check_order(where: str, begin: float | None, end: float | None) -> None:
    """Raise InputError for two places, m, that are not in order; None: one that is not given."""
    if begin is not None and end is not None and not finite(f"{where}: begin", begin) < finite(f"{where}: end", end):
        raise InputError(where, "no length", found=f"from {begin:g} m to {end:g} m", expected="begin < end")


def path_of(where: str, value: object) -> Path:
    """Return a path.

    Raises
    ------
    InputError: not the name of a file.
    """
    if not isinstance(value, str | os.PathLike):
        raise InputError(where, "not a path", found=describe(value), expected="the path of a file")
    name = os.fsdecode(cast("str | os.PathLike[str]", value))
    try:
        known = os.fsencode(name)
    except UnicodeEncodeError:
        # Half of a character beyond the first 65536, as a text cut in two leaves it.
        known = b""
    if not known or b"\0" in known:
        raise InputError(where, "not a path", found=repr(name)[:60], expected="the path of a file")
    return Path(name)


def text(where: str, value: object) -> str:
    """Return a value that is a text with something in it.

    Raises
    ------
    InputError: anything else.
    """
    if not isinstance(value, str) or not value:
        raise InputError(where, "no name", found=describe(value), expected="a text")
    check_whole(where, value)
    return value


def text_or_empty(where: str, value: object) -> str:
    """Return a value that is a text, which may be empty.

    Raises
    ------
    InputError: anything else.
    """
    if not isinstance(value, str):
        raise InputError(where, "not a text", found=describe(value), expected="a text")
    check_whole(where, value)
    return value


def one_of(where: str, value: object, *choices: str) -> None:
    """Raise InputError unless the value is one of the choices."""
    if not isinstance(value, str) or value not in choices:
        found = value if isinstance(value, str) else describe(value)
        raise InputError(where, "unknown value", found=found, expected=" or ".join(f'"{c}"' for c in choices))


def positive(where: str, value: object, *, allow_zero: bool = False) -> None:
    """Raise InputError unless the value is a finite number > 0 (or >= 0), and not so small that rounding loses it."""
    expected = f"a finite number {'>=' if allow_zero else '>'} 0"
    number = finite(where, value, expected)
    if number < 0 or (number == 0 and not allow_zero):
        raise InputError(where, "out of range", found=value, expected=expected)
    if 0 < number < _LEAST:
        raise InputError(where, "lost to rounding", found=value, expected=f">= {_LEAST:g}")


def check_constants(
    settings: Any, *, may_be_zero: Sequence[str] = (), below_one: Sequence[str] = (), above_one: Sequence[str] = ()
) -> None:
    """Raise InputError unless the numbers of a dataclass, single or in tuples, are > 0, or as is said of the fields named."""
    for item in fields(settings):
        name, value = item.name, getattr(settings, item.name)
        zero, single = name in may_be_zero, cast("tuple[float, ...]", value if isinstance(value, tuple) else (value,))
        for one in single:
            for good, expected in (
                (isinstance(one, bool) or one > 0 or (zero and one == 0), ">= 0" if zero else "> 0"),
                (name not in below_one or one < 1, "< 1"),
                (name not in above_one or one > 1, "> 1"),
            ):
                if not good:
                    raise InputError(
                        f"{type(settings).__name__}.{name}", "out of range", found=cast("object", value), expected=expected
                    )


def whole(where: str, value: object, *, least: int, most: int | None = None) -> int:
    """Return a whole number that is not below `least`, nor above `most`.

    Raises
    ------
    InputError: no such number.
    """
    number = finite(where, value)
    if number != int(number) or number < least or (most is not None and number > most):
        limit = f">= {least}" if most is None else f"from {least} to {most}"
        raise InputError(where, "out of range", found=value, expected=f"a whole number {limit}")
    return int(cast("Any", value))


def describe(value: object) -> str:
    """Return a value as a message shows it: short, with its type where that is the point."""
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        return repr(value)[:60]
    return f"{type(value).__name__}"
