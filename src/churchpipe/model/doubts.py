"""Questions about values that no masonry building has, asked where somebody gives them by hand in Python.

The case file asks them as it is read (`config.plausible`). Here they are warnings, which refuse nothing and can be silenced:

    warnings.simplefilter("ignore", churchpipe.DoubtfulValue)
"""

import warnings
from collections.abc import Iterable
from inspect import currentframe
from types import FrameType
from typing import Any, cast

import numpy as np

from churchpipe.model.quantities import Unit, Usual, declared, unit_of, written

_OURS = __name__.partition(".")[0]


class DoubtfulValue(UserWarning):
    """A value that no masonry building has, such as one in another unit: the sentence says what is usual, and asks."""


def question(name: str, value: float, usual: Usual, unit: Unit, given: str = "") -> str:
    """Return what to ask about a value in a unit, "" where there is nothing to ask; given: the same as it was given."""
    # A value on the border has been converted to SI and back.
    if usual.low * (1 - 1e-9) <= value <= usual.high * (1 + 1e-9):
        return ""
    words = f" {unit.name}" if unit.name else ""
    as_given = f" ({given})" if given else ""
    return (
        f"{name} is {value:.4g}{words}{as_given}, usual are {usual.low:g} to {usual.high:g}{words}: {usual.reason}. Is it meant?"
    )


def doubt_fields(record: Any, kind: type | None = None, asked: Iterable[str] = ()) -> None:
    """Warn of the doubtful fields of a dataclass that is being made by a caller outside of this package; for `__post_init__`.

    kind: the class whose own it is, where others are made of it, which ask for themselves. asked: what there is to ask besides.
    """
    if kind is not None and record.__class__ is not kind:
        return
    depth, frame = 1, _caller(currentframe())
    # `dataclasses.replace` makes them, too.
    while frame and frame.f_back and (frame.f_locals.get("self") is record or _module(frame) == "dataclasses"):
        depth, frame = depth + 1, frame.f_back
    if _module(frame).partition(".")[0] == _OURS:
        return
    own: type = record.__class__
    for item in declared(own).values():
        value: object = getattr(record, item.name)
        if item.quantity and item.quantity.usual and value is not None:
            for one in cast("tuple[float, ...]", value if isinstance(value, tuple) else (value,)):
                _warn(f"{own.__name__}.{item.name}", float(one), item.key, item.quantity.usual, depth + 1)
    for sentence in asked:
        warnings.warn(sentence, DoubtfulValue, stacklevel=depth + 1)


def doubt_argument(name: str, values: Any, kind: type, field: str) -> None:
    """Warn of doubtful values of an argument of the public function that calls this, numbers as a field of a dataclass declares
    them; not where the function is called from inside this package."""
    caller, item = _caller(_caller(currentframe())), declared(kind)[field]
    if _module(caller).partition(".")[0] == _OURS or item.quantity is None or item.quantity.usual is None:
        return
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        # What is no number is refused by whoever called.
        return
    # What is not finite is refused, too, or says that there is no such limit.
    found = found[np.isfinite(found)]
    for one in dict.fromkeys((float(found.min()), float(found.max()))) if found.size else ():
        _warn(name, one, item.key, item.quantity.usual, 3)


def doubt(sentences: Iterable[str]) -> None:
    """Warn of what there is to ask in the public function that calls this; not where it is called from inside this package."""
    if _module(_caller(_caller(currentframe()))).partition(".")[0] != _OURS:
        for sentence in sentences:
            warnings.warn(sentence, DoubtfulValue, stacklevel=3)


def _caller(frame: FrameType | None) -> FrameType | None:
    return frame.f_back if frame else None


def _module(frame: FrameType | None) -> str:
    return str(frame.f_globals.get("__name__", "")) if frame else ""


def _warn(name: str, value: float, key: str, usual: Usual, depth: int) -> None:
    unit = unit_of(key)
    given = f"given as {value:.4g} in SI units" if unit.multiply != unit.divide else ""
    if asked := question(name, float(written(key, value)), usual, unit, given):
        warnings.warn(asked, DoubtfulValue, stacklevel=depth + 1)
