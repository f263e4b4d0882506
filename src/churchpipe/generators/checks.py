"""Checks of parameters that the generators share."""

from typing import Any

from churchpipe.errors import InputError
from churchpipe.model.sizes import LaidSize

Brick = tuple[LaidSize, LaidSize, LaidSize]


def check_brick(where: str, brick: Brick) -> None:
    """Raise InputError unless a brick has three dimensions: length, thickness, height, m."""
    if len(brick) != 3:
        raise InputError(where, "wrong number of dimensions", found=len(brick), expected="3: length, thickness, height")


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


def together(where: str, record: Any, *keys: str) -> None:
    """Raise InputError where some of a record's fields are given and others are None."""
    given = [key for key in keys if getattr(record, key) is not None]
    if given and len(given) < len(keys):
        missing = next(key for key in keys if key not in given)
        raise InputError(f"{where}.{missing}", "missing", found=f"{', '.join(given)} alone", expected=", ".join(keys))
