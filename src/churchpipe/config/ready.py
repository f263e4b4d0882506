"""A case beside the ready case of its generator."""

from collections.abc import Iterator
from typing import Any

# A number that differs by less from that of a ready case explains nothing.
_APART = 3.0


def farthest_number(given: Any, ready: Any) -> tuple[str, str]:
    """Return the path ".key.key" of the number that differs most, as a ratio, from the one at its place in a ready case, and how
    much it does; empty where none differs much. Both are tables of a generator's parameters, SI."""
    apart = {key: value / other for key, value, other in _pairs(given, ready, "") if value > 0 and other > 0}
    key = max(apart, key=lambda key: max(apart[key], 1 / apart[key]), default="")
    ratio = apart.get(key, 1.0)
    if max(ratio, 1 / ratio) < _APART:
        return "", ""
    return key, f"this key is {ratio:.3g} times as large as" if ratio > 1 else f"this key is {1 / ratio:.3g} times as small as"


def _pairs(given: Any, ready: Any, place: str) -> Iterator[tuple[str, float, float]]:
    if isinstance(given, dict) and isinstance(ready, dict):
        for key in given.keys() & ready.keys():
            yield from _pairs(given[key], ready[key], f"{place}.{key}")
    elif isinstance(given, list | tuple) and isinstance(ready, list | tuple):
        for number, (one, other) in enumerate(zip(given, ready, strict=False)):
            yield from _pairs(one, other, f"{place}.{number}")
    elif isinstance(given, int | float) and isinstance(ready, int | float):
        yield place, float(given), float(ready)
