"""Checks of parameters that the generators share."""

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, TypeVar

from churchpipe.errors import InputError
from churchpipe.model.arguments import positive, told

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_Kind = TypeVar("_Kind", bound="DataclassInstance")

Brick = tuple[float, float, float]


def check_brick(where: str, brick: Brick) -> None:
    """Raise InputError unless a brick has three positive dimensions: length, thickness, height, m."""
    if not isinstance(brick, Sequence) or len(brick) != 3:
        found = len(brick) if isinstance(brick, Sequence) else told(brick)
        raise InputError(where, "wrong number of dimensions", found=found, expected="3: length, thickness, height")
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
