"""Powers of ten at logarithmic axes, as plain text: to typeset one as a formula takes matplotlib some ten milliseconds."""

import math
from typing import Any

from matplotlib.ticker import LogFormatter

_RAISED = str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")


class Powers(LogFormatter):
    """Labels 10\u207b\u00b3, and 2\u00d710\u207b\u00b3 where matplotlib labels more than decades."""

    def __call__(self, x: float, pos: Any = None) -> str:
        return power(x) if super().__call__(x, pos) else ""


def power(value: float) -> str:
    """Return a number as a multiple of a power of ten."""
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)) + 1e-9)
    share = value / 10.0**exponent
    factor = "" if math.isclose(share, 1) else "\u2212" if math.isclose(share, -1) else f"{share:.4g}\u00d7"
    return f"{factor}10{str(exponent).translate(_RAISED)}"


def label_powers(axis: Any) -> None:
    """Label a logarithmic axis of a plot so."""
    axis.set_major_formatter(Powers())
    axis.set_minor_formatter(Powers())
