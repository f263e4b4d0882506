"""What the parameters of the generators are: declared once, with unit and range, for Python (SI) and for the case file.

`fields.coerce_fields` holds parameters to it, `config.tables` the keys of a case file.
"""

from dataclasses import dataclass
from typing import Annotated

MOST_COUNTED = 1_000_000


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with a unit: `suffix` of its key in a case file. low: what it is not below, or, with `above`, is above."""

    suffix: str = ""
    low: float | None = None
    above: bool = False
    high: float | None = None


# In m; a key in _mm may be written in _m as well.
Length = Annotated[float, Quantity("_mm", 0.0, above=True)]
Distance = Annotated[float, Quantity("_mm", 0.0)]
Coordinate = Annotated[float, Quantity("_mm")]
# In rad.
Angle = Annotated[float, Quantity("_deg", 0.0, above=True)]
Ratio = Annotated[float, Quantity("", 0.0, above=True)]
Count = Annotated[int, Quantity("", 1, high=MOST_COUNTED)]
Whole = Annotated[int, Quantity("", 0)]
