"""What a path was made with, as digests that are kept with it: another load or other ties are known by them."""

from dataclasses import fields, is_dataclass
from hashlib import sha256
from typing import Any, cast

import numpy as np

from churchpipe.model.loads import LoadCase


def digests(**given: Any) -> str:
    """Return names and values that a path is made with as a text, each value as a digest: arrays, numbers, texts, dataclasses."""
    return " ".join(f"{name}:{sha256(_bytes(value)).hexdigest()[:12]}" for name, value in given.items())


def load_digest(load: LoadCase) -> str:
    """Return what `digests` makes of the load case of a path: where it pushes, and what the stones carry."""
    return digests(load=[load.direction, load.panels, load.profile, load.multiplies], carried_load=[load.dead, load.live])


def of_load(given: str, load: LoadCase, *, pushed_alike: bool = False) -> bool:
    """True where a path that was made with `given`, of `digests`, is of this load case, or not known to be of another one.

    pushed_alike: whether what the stones carry may differ.
    """
    pushes, carries = load_digest(load).split()
    return not given or ({pushes} if pushed_alike else {pushes, carries}) <= set(given.split())


def differing(before: str, now: str) -> list[str]:
    """Return what two paths were made with otherwise, by name; before, now: of `digests`, empty if unknown."""
    pairs = zip(before.split(), now.split(), strict=False)
    return [one.partition(":")[0].replace("_", " ") for one, other in pairs if one != other]


def _bytes(value: Any) -> bytes:
    if is_dataclass(value):
        return b"".join(_bytes(getattr(value, item.name)) for item in fields(value))
    if isinstance(value, list | tuple):
        return b"".join(map(_bytes, cast("list[Any] | tuple[Any, ...]", value)))
    if value is None or isinstance(value, str):
        return repr(value).encode()
    array = np.asarray(value)
    if array.dtype.kind == "U":  # the walls of an anchor
        return repr(array.tolist()).encode()
    # One number for all joints is the same as that number at each of them.
    array = array.astype(np.float64) + 0.0
    alike = array.size > 0 and bool((array == array.flat[0]).all())
    return (array.flat[0] if alike else array).tobytes()
