"""What may be asked of a path: lengths and numbers of its steps, and to go on from another one made with the same."""

from dataclasses import fields, is_dataclass
from hashlib import sha256
from typing import Any

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import positive, whole
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.quantities import MOST_COUNTED


def check_path(where: str, stones: Assemblage, step: float | None, steps: int, furthest: float | None, halo: int) -> int:
    """Return how many contacts wide the halo is, no more than there are stones.

    where: the function that was called. The rest as in `block_pushover`.

    Raises
    ------
    InputError: values out of range, a step longer than the structure, as in other units.
    """
    whole(f"{where}: steps", steps, least=1, most=MOST_COUNTED)
    whole(f"{where}: halo", halo, least=0)
    for name, value in (("step", step), ("furthest", furthest)):
        if value is not None:
            positive(f"{where}: {name}", value)
    if step is not None:
        check_step(f"{where}: step", stones, step)
    return min(int(halo), stones.count)


def check_step(where: str, stones: Assemblage, step: float) -> None:
    """Raise InputError for a step, m, that is longer than the structure, as one in other units is."""
    if step > stones.size:
        found, expected = f"{step:g} m ({1e3 * step:g} mm)", f"at most {stones.size:.3g} m"
        raise InputError(where, "a step longer than the structure", found=found, expected=expected)


def digests(**given: Any) -> str:
    """Return names and values that a path is made with as a text, each value as a digest: arrays, numbers, texts, dataclasses."""
    return " ".join(f"{name}:{sha256(_bytes(value)).hexdigest()[:12]}" for name, value in given.items())


def load_digest(load: LoadCase) -> str:
    """Return what `digests` makes of the load case of a path: where it pushes, and what the stones carry."""
    return digests(load=[load.direction, load.panels, load.profile], carried_load=[load.dead, load.live])


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


def check_given(where: str, before: str, now: str) -> None:
    """Raise InputError where a path that is to go on was made with other values; before, now: as in `differing`."""
    if differ := differing(before, now):
        remedy = "Begin a path of its own for other values."
        raise InputError(f"{where}: resume", "steps of another analysis", found=f"another {', '.join(differ)}", remedy=remedy)


def _bytes(value: Any) -> bytes:
    if is_dataclass(value):
        return b"".join(_bytes(getattr(value, item.name)) for item in fields(value))
    if isinstance(value, list | tuple):
        return b"".join(map(_bytes, value))
    if value is None or isinstance(value, str):
        return repr(value).encode()
    array = np.asarray(value)
    if array.dtype.kind == "U":  # the walls of an anchor
        return repr(array.tolist()).encode()
    # One number for all joints is the same as that number at each of them.
    array = array.astype(np.float64) + 0.0
    alike = array.size > 0 and bool((array == array.flat[0]).all())
    return (array.flat[0] if alike else array).tobytes()
