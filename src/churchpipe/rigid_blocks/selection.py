"""Which of several states without dilatancy is reported."""

from collections.abc import Callable, Sequence

from churchpipe.model.results import StartRun
from churchpipe.rigid_blocks.settings import SEARCH_SPREAD

# An interval that begins below this share of the load factor begins at zero.
_ANY_LOAD = 1e-2


def led_by(
    runs: Sequence[StartRun], interval_of: Callable[[int], tuple[float, float]]
) -> tuple[int, dict[int, tuple[float, float]]]:
    """Return which of several settled runs is reported, and the intervals looked at for that, by their numbers.

    A few stones that only friction holds between others may be squeezed out under any load factor from zero on, with the
    self-stress for it. Such a state says nothing of the lateral load: the next one leads, if there is one without zero in its
    interval.
    """
    left, intervals = list(range(len(runs))), dict[int, tuple[float, float]]()
    while left:
        first = left[leading([runs[number] for number in left])]
        intervals[first] = interval_of(first)
        if not fits_any_load(runs[first], intervals[first]):
            return first, intervals
        left.remove(first)
    return leading(runs), intervals


def fits_any_load(run: StartRun, interval: tuple[float, float]) -> bool:
    """Say whether the interval of a run begins at zero."""
    return interval[0] <= _ANY_LOAD * run.load_factor


def leading(runs: Sequence[StartRun]) -> int:
    """Return which of several settled runs leads: the lowest, or the run from the centre where it is as low.

    As low: but for the share that rounding alone moves the end of a search. The run from the centre does not depend on rounding,
    so that a model has one load factor whatever its order of stones and the machine.
    """
    lowest = min(range(len(runs)), key=lambda k: runs[k].load_factor)
    allowed = (1.0 + SEARCH_SPREAD) * runs[lowest].load_factor
    return next((k for k, run in enumerate(runs) if run.start == "centre" and run.load_factor <= allowed), lowest)
