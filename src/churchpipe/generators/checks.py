"""Checks of parameters that the generators share."""

import math

from churchpipe.errors import InputError

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
