"""Numbers as text, and words that follow them."""

from collections.abc import Iterable
from itertools import groupby


def counted(number: int, one: str, several: str = "") -> str:
    """Return a number and what it counts, with its verb where there is one.

    Parameters
    ----------
    one
        "stone moves", after 1.
    several
        "stones move", after any other number; by default `one` with an s.
    """
    return f"{number} {one if number == 1 else several or one + 's'}"


def in_runs(numbers: Iterable[int]) -> str:
    """Return whole numbers as text, three or more that follow each other by their ends: "1, 2, 4 to 13"."""
    runs = [[number for _, number in run] for _, run in groupby(enumerate(numbers), lambda one: one[1] - one[0])]
    return ", ".join(f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs)


def three_figures(value: float) -> str:
    """Return a quantity to three figures, a large one in whole numbers: how many mm a facade leans."""
    return f"{value:,.0f}" if abs(value) >= 99.95 else f"{value:.3g}"


def four_figures(value: float) -> str:
    """Return a quantity to four figures, a large one in whole numbers and never as a power of ten: the weight of a church."""
    return f"{value:,.0f}" if abs(value) >= 999.95 else f"{value:.4g}"
