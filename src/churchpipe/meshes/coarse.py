"""Coordinates that a program rounded to numbers of 32 bits, or to a few digits, which stand far apart far from the origin."""

import math
from typing import Final

import numpy as np

from churchpipe.findings import Finding
from churchpipe.meshes.source import Source
from churchpipe.model.arrays import FloatArray

# Steps of the coordinates, as parts of the median stone, above which a file is doubted, and refused.
COARSE: Final = (1e-3, 1e-2)
# A text of nine digits or six decimals tells which number of 32 bits is meant, and differs from it by this part, or so much.
_NINE_DIGITS, _SIX_DECIMALS = 5e-9, 5e-7
# Nine of ten rounded numbers have all digits that they were rounded to; of round ones, such as halves and quarters, few have as
# many as the longest of them.
_LONGEST: Final = 0.5


def coarse(source: Source, size: float) -> list[Finding]:
    """Return a finding where coordinates stand far apart, as they were rounded so far from the origin; size: of a stone."""
    points = np.concatenate([body.points for body in source.bodies])
    points = points[np.isfinite(points).all(axis=1)]
    number = np.unique(np.abs(points))
    number = number[number > 0]
    if not len(number):
        return []
    # Round numbers of a small model, such as .12 and .065, look like rounded ones of a model that lies further away than it is
    # long.
    away = bool((np.abs(points).min(axis=0) > np.ptp(points, axis=0)).any())
    for step, what in (_single(number), _digits(number, COARSE[0] * size) if away else (0.0, "")):
        if step > COARSE[0] * size:
            found = f"the coordinates are numbers of {what}, which are {{}} apart so far from the origin"
            code = "E47" if step > COARSE[1] * size else "W47"
            return [Finding(code, found, f"steps below {COARSE[0]:g} of a stone", lengths=(step,))]
    return []


def _single(number: FloatArray) -> tuple[float, str]:
    """Return how far apart the numbers stand if they are of 32 bits, else 0. number (n,): above 0, rising."""
    with np.errstate(over="ignore", under="ignore"):
        single = number.astype(np.float32)
    off = np.abs(single - number)
    # Rounded numbers end in either bit; round ones, which happen to be numbers of 32 bits, in zeros. Of numbers that a text
    # gives as exactly as 32 bits do, the bits tell nothing.
    telling = (np.spacing(single) > 4.0 * _SIX_DECIMALS) | (off == 0.0).all()
    odd = bool((single[telling].view(np.uint32) & 1).any())
    rounded = odd and bool((off <= np.maximum(_NINE_DIGITS * number, _SIX_DECIMALS)).all())
    return float(np.spacing(single[-1])) if rounded else 0.0, "32 bits"


def _digits(number: FloatArray, least: float) -> tuple[float, str]:
    """Return how far apart the largest numbers stand if all have a few digits alone and smaller ones are finer, else 0.

    least: steps of no interest. Numbers with a few decimals, all in the same steps, tell nothing: they may be exact.
    """
    power = math.floor(math.log10(number[-1]))
    for digits in range(1, power + math.ceil(-math.log10(least)) + 1):
        if all(float(f"{value:.{digits}g}") == value for value in number.tolist()):
            step = 10.0 ** (power + 1 - digits)
            shorter = np.array([float(f"{value:.{max(digits - 1, 0)}g}") for value in number])
            large, longest = number >= 10.0**power, shorter != number
            finer = np.abs(number / step - np.round(number / step)) > 1e-6
            told = finer.any() and min(longest[large].mean(), longest[~large].mean()) >= _LONGEST
            return step if told else 0.0, f"{digits} digits"
    return 0.0, ""
