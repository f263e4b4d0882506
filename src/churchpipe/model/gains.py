"""What changes of walls would add to a load factor."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray, NameArray, floats, names, store
from churchpipe.model.card import card


@dataclass(frozen=True, slots=True)
class Sensitivities:
    """What changes of walls would add to a load factor.

    Fields: panel (np,), the walls; cohesion (np,) 1/Pa, for each pascal of cohesion in all joints of a wall, those with its
    neighbours half; weight (np,) 1/N, for each newton more, spread over its stones by volume; joint (ni,) 1/Pa, for each pascal
    of cohesion in an interface.
    """

    panel: NameArray
    cohesion: FloatArray
    weight: FloatArray
    joint: FloatArray

    def __post_init__(self) -> None:
        count = len(self.panel)
        store(
            self,
            panel=names("Sensitivities.panel", self.panel, (count,)),
            cohesion=floats("Sensitivities.cohesion", self.cohesion, (count,)),
            weight=floats("Sensitivities.weight", self.weight, (count,)),
            joint=floats("Sensitivities.joint", self.joint, (None,)),
        )

    def _repr_html_(self) -> str:
        order = np.argsort(-self.cohesion)
        rows = {
            str(self.panel[i]): f"{1e4 * self.cohesion[i]:+.2e} per 10 kPa, {1e4 * self.weight[i]:+.2e} per 10 kN" for i in order
        }
        return card("What would help", rows)
