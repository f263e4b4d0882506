"""What may be asked of a path: lengths and numbers of its steps, and to go on from another one made with the same."""

from typing import Any

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import positive, whole
from churchpipe.model.arrays import BoolArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.digests import differing
from churchpipe.model.quantities import MOST_COUNTED


def check_path(where: str, stones: Assemblage, step: float | None, steps: int, furthest: float | None, halo: int) -> int:
    """Return how many contacts wide the halo is, no more than there are stones.

    where: the function that was called. The rest as in `block_pushover`.

    Raises
    ------
    InputError: values out of range, a step longer than the structure, as in other units.
    """
    whole(f"{where}: steps", steps, least=1, most=MOST_COUNTED)
    wide = whole(f"{where}: halo", halo, least=0)
    for name, value in (("step", step), ("furthest", furthest)):
        if value is not None:
            positive(f"{where}: {name}", value)
    if step is not None:
        check_step(f"{where}: step", stones, step)
    return min(wide, stones.count)


def check_step(where: str, stones: Assemblage, step: float) -> None:
    """Raise InputError for a step, m, that is longer than the structure, as one in other units is."""
    if step > stones.size:
        found, expected = f"{step:g} m ({1e3 * step:g} mm)", f"at most {stones.size:.3g} m"
        raise InputError(where, "a step longer than the structure", found=found, expected=expected)


def check_given(where: str, before: str, now: str) -> None:
    """Raise InputError where a path that is to go on was made with other values; before, now: as in `differing`."""
    if differ := differing(before, now):
        remedy = "Begin a path of its own for other values."
        raise InputError(f"{where}: resume", "steps of another analysis", found=f"another {', '.join(differ)}", remedy=remedy)


def strengths_of(friction: npt.ArrayLike, compressive_strength: npt.ArrayLike | None, joints: BoolArray | None) -> dict[str, Any]:
    """Return friction and compressive strength of all joints, or of some (ni,), as arguments of a limit analysis."""
    given = {"friction": friction, "compressive_strength": compressive_strength}
    if joints is None:
        return given
    return {name: None if each is None else np.broadcast_to(each, joints.shape)[joints] for name, each in given.items()}
