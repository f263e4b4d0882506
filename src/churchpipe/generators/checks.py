"""Checks of parameters that the generators share."""

import math
from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, TypeVar

from churchpipe.errors import InputError
from churchpipe.model.arguments import told

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_Kind = TypeVar("_Kind", bound="DataclassInstance")

Brick = tuple[float, float, float]


def positive(where: str, value: float, *, allow_zero: bool = False) -> None:
    """Raise InputError unless the value is a finite number > 0 (or >= 0)."""
    if not (math.isfinite(value) and (value > 0 or (allow_zero and value == 0))):
        raise InputError(where, "out of range", found=value, expected=f"a finite number {'>=' if allow_zero else '>'} 0")


def whole(where: str, value: int, *, least: int) -> None:
    """Raise InputError unless the value is a whole number not below `least`."""
    if value != int(value) or value < least:
        raise InputError(where, "out of range", found=value, expected=f"a whole number >= {least}")


def one_of(where: str, value: object, *choices: str) -> None:
    """Raise InputError unless the value is one of the choices."""
    if value not in choices:
        raise InputError(where, "unknown value", found=value, expected=" or ".join(f'"{c}"' for c in choices))


def check_brick(where: str, brick: Brick) -> None:
    """Raise InputError unless a brick has three positive dimensions: length, thickness, height, m."""
    if len(brick) != 3:
        raise InputError(where, "wrong number of dimensions", found=len(brick), expected="3: length, thickness, height")
    for value in brick:
        positive(where, value)


def whole_courses(where: str, height: float, course: float) -> None:
    """Raise InputError unless a height is a whole number of courses, m."""
    count = height / course
    if abs(count - round(count)) > 1e-6:
        raise InputError(
            where,
            "not a whole number of courses",
            found=f"{height:g} m, {count:.4g} courses of {course:g} m",
            expected=f"{max(1, round(count)) * course:.6g} m",
        )


def taken(kind: type[_Kind], where: str, value: _Kind | Mapping[str, Any]) -> _Kind:
    """Return a dataclass that is given as such or as a mapping of its fields.

    Raises
    ------
    InputError: neither; a key that it does not have, or one without a default that is missing.
    """
    if isinstance(value, kind):
        return value
    if not isinstance(value, Mapping):
        raise InputError(where, "wrong kind", found=told(value), expected=f"a {kind.__name__}, or a mapping of its fields")
    known = {item.name: item for item in fields(kind)}
    for key in value:
        if key not in known:
            raise InputError(f"{where}.{key}", "unknown key", expected=", ".join(known))
    for key, item in known.items():
        if item.default is MISSING and item.default_factory is MISSING and key not in value:
            raise InputError(f"{where}.{key}", "missing")
    return kind(**value)
