"""What changes of walls would add to a load factor."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from churchpipe.model.arrays import FloatArray, NameArray, floats, store, store_arrays
from churchpipe.model.card import Shown

# What new analyses of single walls add, Pa and N.
COHESION_MORE, WEIGHT_MORE = 10e3, 10e3


@dataclass(frozen=True, slots=True, repr=False)
class Sensitivities(Shown):
    """What changes of walls would add to a load factor.

    Fields: panel (np,), the walls; cohesion (np,) 1/Pa, for each pascal of cohesion in all joints of a wall, those with its
    neighbours half; weight (np,) 1/N, for each newton more, spread over its stones by volume; joint (ni,) 1/Pa, for each pascal
    of cohesion in an interface. with_cohesion, with_weight (np,): load factors of new analyses with `COHESION_MORE` Pa or
    `WEIGHT_MORE` N more in that wall alone, NaN where none was made.
    """

    panel: NameArray
    cohesion: FloatArray
    weight: FloatArray
    joint: FloatArray
    with_cohesion: FloatArray = field(default_factory=lambda: np.empty(0))
    with_weight: FloatArray = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        count = len(self.panel)
        for key in ("with_cohesion", "with_weight"):
            value = getattr(self, key) if np.size(getattr(self, key)) else np.full(count, np.nan)
            store(self, **{key: floats(f"Sensitivities.{key}", value, (count,), finite=False)})
        store_arrays(self, panel=(count,), cohesion=(count,), weight=(count,), joint=(None,))

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        order = np.argsort(-self.cohesion)
        rows = {
            str(self.panel[i]): f"{1e4 * self.cohesion[i]:+.2e} per 10 kPa, {1e4 * self.weight[i]:+.2e} per 10 kN" for i in order
        }
        return "What would help", rows
