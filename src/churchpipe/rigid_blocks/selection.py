"""Which of several states without dilatancy is reported."""

from collections.abc import Callable, Sequence

from churchpipe.model.names import NEARLY
from churchpipe.model.results import StartRun
from churchpipe.rigid_blocks.coulomb import LEAST_FACTOR
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP, SEARCH_SPREAD

# An interval that begins below this share of the load factor begins at zero.
_ANY_LOAD = 1e-2
# A state is nearly as exact whose gap is at most so many times that of the leader, or the one wanted.
_NEARLY = 10.0


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


def nearly(runs: Sequence[StartRun], leader: StartRun) -> list[StartRun]:
    """Return the runs not certified, but nearly as exact as the leader, that are lower by more than rounding moves a search."""
    allowed = _NEARLY * max(BIPOTENTIAL_GAP, _relative_gap(leader))
    return [
        run
        for run in runs
        if not run.converged and _relative_gap(run) <= allowed and (1.0 + SEARCH_SPREAD) * run.load_factor < leader.load_factor
    ]


def _relative_gap(run: StartRun) -> float:
    """Return the gap of a run over its load factor; one of zero is measured as in `CoulombState.relative_gap`."""
    return run.gap / max(abs(run.load_factor), LEAST_FACTOR)


def nearly_words(run: StartRun) -> str:
    """Return what is said of such a run."""
    missing = _relative_gap(run)
    return (
        f"the state at {run.load_factor:.4f} from the start {run.start} {NEARLY}: its forces and its motion miss each other by"
        f" {missing:.1e} of the load factor, where {BIPOTENTIAL_GAP:.0e} is wanted, so do not count on more"
    )
