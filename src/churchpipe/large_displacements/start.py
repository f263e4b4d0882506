"""What may be asked of a path: lengths and numbers of its steps."""

from churchpipe.errors import InputError
from churchpipe.model.arguments import positive, whole
from churchpipe.model.assemblage import Assemblage


def check_path(where: str, stones: Assemblage, step: float | None, steps: int, furthest: float | None, halo: int) -> int:
    """Return how many contacts wide the halo is, no more than there are stones.

    where: the function that was called. The rest as in `block_pushover`.

    Raises
    ------
    InputError: values out of range, a step longer than the structure, as in other units.
    """
    whole(f"{where}: steps", steps, least=1)
    whole(f"{where}: halo", halo, least=0)
    for name, value in (("step", step), ("furthest", furthest)):
        if value is not None:
            positive(f"{where}: {name}", value)
    if step is not None and step > stones.size:
        raise InputError(
            f"{where}: step",
            "a step longer than the structure",
            found=step,
            expected=f"at most {stones.size:.3g} m",
            remedy="Lengths are in metres (step_mm of a case in mm).",
        )
    return min(int(halo), stones.count)
