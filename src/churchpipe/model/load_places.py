"""Names, places and directions of loads, checked as they are given."""

from typing import Any

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import finite, text, text_or_empty
from churchpipe.model.arrays import FloatArray, floats, store

TOWARD = {"+x": (1.0, 0.0, 0.0), "-x": (-1.0, 0.0, 0.0), "+y": (0.0, 1.0, 0.0), "-y": (0.0, -1.0, 0.0)}
Toward = str | npt.ArrayLike


def named(load: object, kind: str, name: str, wall: str | None) -> str:
    """Store the name of a load and return how messages call it."""
    if wall is not None:
        text(f"{kind}: wall", wall)
    store(load, name=text_or_empty(f"{kind}: name", name))
    return called(kind, name, wall)


def called(kind: str, name: str, wall: str | None) -> str:
    """Return how messages call a load."""
    return f"{kind} {name or wall or ''}".strip()


def points(array: FloatArray) -> Any:
    """Return two points (2, 3) as tuples."""
    first, second = array.tolist()
    return tuple(first), tuple(second)


def on_wall_or_at(where: str, key: str, wall: str | None, place: object, **on_wall: float | None) -> None:
    """Raise unless a load has a wall or a place of its own, and not both."""
    if (wall is None) == (place is None):
        found = "neither" if wall is None else "both"
        raise InputError(where, "no place" if wall is None else "two places", found=found, expected=f"a wall, or {key}")
    extra = [name for name, value in on_wall.items() if value is not None]
    if wall is None and extra:
        raise InputError(where, "a place on a wall, without a wall", expected=f"{key} alone, or a wall beside {', '.join(extra)}")


def store_numbers(load: object, where: str, **values: float | None) -> None:
    """Store numbers that may be left out, checked to be finite."""
    store(load, **{key: None if value is None else finite(f"{where}: {key}", value) for key, value in values.items()})


def level(where: str, toward: Toward) -> FloatArray:
    """Return a level direction (3,), of length one."""
    if isinstance(toward, str):
        if toward not in TOWARD:
            raise InputError(f"{where}: toward", "unknown direction", found=toward, expected=", ".join(TOWARD))
        return floats(f"{where}: toward", TOWARD[toward], (3,))
    vector = floats(f"{where}: toward", toward, (3,))
    # Any length will do, also one whose square is no number.
    largest = float(np.abs(vector).max())
    if not largest > 0 or abs(vector[2]) > 1e-9 * largest:
        raise InputError(f"{where}: toward", "not level", found=vector.tolist(), expected="a vector with z = 0")
    return floats(f"{where}: toward", vector / largest / np.linalg.norm(vector / largest), (3,))
