"""Questions about values that no masonry building has. They refuse nothing: a slip of a unit is found, a study goes on."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from churchpipe.model.assemblage import Assemblage
from churchpipe.spectrum import GRAVITY

if TYPE_CHECKING:
    from churchpipe.config.case import Case


@dataclass(frozen=True, slots=True)
class Usual:
    """A range that a quantity has in practice: its key for a person, least and most in SI, its unit, and what the range rests on.

    scale: of the unit, in SI.
    """

    key: str
    low: float
    high: float
    reason: str
    unit: str = ""
    scale: float = 1.0

    def question(self, value: float, place: str = "") -> str:
        """Return what to ask about a value (SI), "" where there is nothing to ask."""
        if self.low <= value <= self.high:
            return ""
        low, high, found = (f"{number / self.scale:.4g}" for number in (self.low, self.high, value))
        unit = f" {self.unit}" if self.unit else ""
        return f"{place}{self.key} is {found}{unit}, usual are {low} to {high}{unit}: {self.reason}. Is it meant?"


# By the names of the fields of Material, Elastic, Site and Floor.
MATERIAL = {
    "unit_weight": Usual("unit_weight_kN_m3", 8e3, 35e3, "light tuff to basalt", "kN/m3", 1e3),
    "friction": Usual("friction", 0.1, 1.5, "slopes of 6 to 56 degrees; joints of stone have 0.4 to 0.8"),
    "cohesion": Usual("cohesion_kPa", 0.0, 2e6, "joints of lime mortar reach 200 kPa, of cement mortar 2000", "kPa", 1e3),
}
ELASTIC = {
    "block_modulus": Usual("elastic.block_E_GPa", 1e8, 2e11, "soft tuff to granite", "GPa", 1e9),
    "joint_modulus": Usual("elastic.joint_E_GPa", 1e6, 1e11, "dry joints of models to cement mortar", "GPa", 1e9),
}
SITE = {
    "ground_acceleration": Usual(
        "a_g", 1e-3 * GRAVITY, 1.5 * GRAVITY, "design values on rock are mostly below 0.6 g", "g", GRAVITY
    ),
    "soil_factor": Usual("soil_factor", 0.8, 3.0, "S_S up to 1.8 times S_T up to 1.4"),
    "behaviour_factor": Usual("q", 1.0, 4.0, "2 for local mechanisms, at most 3 to 4 for whole buildings of masonry"),
    "confidence_factor": Usual("confidence_factor", 1.0, 1.35, "the code has 1, 1.2 and 1.35"),
}
SPECTRAL = Usual("spectral_acceleration", 1e-3 * GRAVITY, 5 * GRAVITY, "some three times the ground acceleration", "g", GRAVITY)
HEIGHT = Usual("the height of the structure", 0.05, 200.0, "models of tilting tests to the tallest spires", "m")
LENGTH = Usual("the length of the structure", 0.05, 500.0, "models of tilting tests to the longest churches", "m")
STONE = Usual("the longest side of a stone", 0.005, 25.0, "bricks of models to the largest cut stones", "m")


def questions(cases: Sequence["Case"]) -> list[str]:
    """Return what to ask about materials and site of a case's variants, each once."""
    return list(dict.fromkeys(text for case in cases for text in _of_case(case) if text))


def size_questions(stones: Assemblage) -> list[str]:
    """Return what to ask about the extents of a structure and of its stones, supports left out."""
    first = stones.block_point_ptr[:-1]
    low, high = (reduce.reduceat(stones.points, first)[~stones.fixed] for reduce in (np.minimum, np.maximum))
    side, whole = (high - low).max(axis=1), high.max(axis=0) - low.min(axis=0)
    asked = [HEIGHT.question(float(whole[2])), LENGTH.question(float(whole[:2].max()))]
    asked += [STONE.question(float(side.max())), STONE.question(float(side.min()))]
    return list(dict.fromkeys(text for text in asked if text))


def _of_case(case: "Case") -> Iterator[str]:
    for material in case.materials:
        place = f"material.{material.name}."
        yield from (usual.question(getattr(material, name), place) for name, usual in MATERIAL.items())
        if elastic := material.elastic:
            yield from (usual.question(getattr(elastic, name), place) for name, usual in ELASTIC.items())
    if site := case.check:
        yield from (usual.question(getattr(site, name), "check.") for name, usual in SITE.items())
        if site.floor:
            yield SPECTRAL.question(site.floor.spectral_acceleration, "check.floor.")
