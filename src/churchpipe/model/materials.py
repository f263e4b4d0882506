"""What the stones and joints are made of."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Annotated, TypeVar

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, finite, text
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.quantities import Quantity, Usual, declared, in_range

_MODULUS = (1e-3, 1e21)
_BLOCK = Quantity(low=0.0, above=True, usual=Usual(0.1, 200, "soft tuff to granite"), span=_MODULUS, key="block_E_GPa")
_JOINT = Quantity(
    low=0.0, above=True, usual=Usual(0.001, 100, "dry joints of models to cement mortar"), span=_MODULUS, key="joint_E_GPa"
)
_POISSON = Quantity("", -1.0, above=True, high=0.5, below=True, usual=Usual(0, 0.49, "stone and mortar have .1 to .3"))
_MORTAR = Quantity("_mm", 0.0, above=True, span=(1e-9, 1e2))
_WEIGHT = Quantity("_kN_m3", 0.0, above=True, usual=Usual(8, 35, "light tuff to basalt"), span=(1e-6, 1e9))
FRICTION = Quantity(
    low=0.0, usual=Usual(0.1, 1.5, "slopes of 6 to 56 degrees; joints of stone have 0.4 to 0.8"), span=(1e-6, 1e3)
)
COHESION = Quantity(
    "_kPa", 0.0, usual=Usual(0, 2000, "joints of lime mortar reach 200 kPa, of cement mortar 2000"), span=(1e-6, 1e12)
)
_CRUSHING = Quantity(
    "_MPa", 0.0, above=True, usual=Usual(0.3, 50, "rubble has some 1, brickwork 2 to 4, ashlar 6 and more"), span=(1e-3, 1e15)
)


@dataclass(frozen=True, slots=True)
class Elastic:
    """Elastic constants of stones and mortar (as Malena et al. 2019, Table 1): moduli in Pa, joint thickness in m.

    Raises
    ------
    InputError
        No number, moduli outside 1e-3 Pa to 1e21 Pa, thickness outside 1e-9 m to 100 m, Poisson's ratio outside (-1, .5).
    """

    block_modulus: Annotated[float, _BLOCK, "Young's modulus of the stones."]
    block_poisson: Annotated[float, replace(_POISSON, key="block_nu"), "Poisson's ratio of the stones."]
    joint_modulus: Annotated[float, _JOINT, "Young's modulus of the mortar."]
    joint_poisson: Annotated[float, replace(_POISSON, key="joint_nu"), "Poisson's ratio of the mortar."]
    joint_thickness: Annotated[float, _MORTAR, "Thickness of the joints."]

    def __post_init__(self) -> None:
        for key in ("block_modulus", "joint_modulus", "joint_thickness"):
            _check_span("elastic.", self, key)
        for key in ("block_poisson", "joint_poisson"):
            in_range(Elastic, key, f"elastic.{key}", getattr(self, key))
        doubt_fields(self)


@dataclass(frozen=True)
class UnitWeight:
    """What stones of one material weigh, N/m3: all that the geometry of a model asks of it.

    Raises
    ------
    InputError
        No number; not zero and outside 1e-6 to 1e9 N/m3.
    """

    name: str
    unit_weight: Annotated[float, _WEIGHT, "Weight of the stones with their joints."]

    def __post_init__(self) -> None:
        text("material: name", self.name)
        _check_span(f"material {self.name}: ", self, "unit_weight", or_zero=True)
        doubt_fields(self, UnitWeight)


@dataclass(frozen=True)
class JointStrength:
    """What joints of one masonry bear, all that an analysis asks of it: friction coefficient, cohesion Pa.

    elastic: how it deforms; only needed by the shell. compressive_strength: Pa, None where the masonry does not crush.

    Raises
    ------
    InputError
        No number; not zero and outside 1e-6 to 1000, 1e-6 to 1e12 Pa; a compressive strength outside 1e-3 to 1e15 Pa.
    """

    name: str
    friction: Annotated[float, FRICTION, "Coefficient of friction of the joints, the tangent of the friction angle."]
    cohesion: Annotated[float, COHESION, "Shear strength of a joint without compression."] = 0.0
    elastic: Annotated[Elastic | None, "How the masonry deforms, for the capacity curve of the shell."] = None
    compressive_strength: Annotated[float | None, _CRUSHING, "Pressure at which the masonry crushes; left out: it does not."] = (
        None
    )

    def __post_init__(self) -> None:
        text("material: name", self.name)
        where = f"material {self.name}: "
        _check_span(where, self, "friction", or_zero=True)
        _check_span(where, self, "cohesion", or_zero=True)
        if self.elastic is not None:
            check_kind(f"{where}elastic", self.elastic, Elastic)
        if self.compressive_strength is not None:
            _check_span(where, self, "compressive_strength")
        doubt_fields(self, JointStrength)


# Fields in the order of its bases from the last: name, unit_weight, friction, cohesion, elastic, compressive_strength.
@dataclass(frozen=True)
class Material(JointStrength, UnitWeight):
    """One masonry: unit weight N/m3, friction coefficient, cohesion Pa; `elastic` is only needed by the shell, the compressive
    strength Pa by stones that crush.

    Raises
    ------
    InputError
        As `UnitWeight` and `JointStrength`.
    """

    def __post_init__(self) -> None:
        UnitWeight.__post_init__(self)
        JointStrength.__post_init__(self)
        doubt_fields(self)


_Named = TypeVar("_Named", bound=UnitWeight | JointStrength)


def by_name(materials: Iterable[_Named]) -> dict[str, _Named]:
    """Return materials by their names.

    Raises
    ------
    InputError: two of one name.
    """
    known: dict[str, _Named] = {}
    for material in materials:
        if material.name in known:
            raise InputError(f"material {material.name}", "given twice", expected="each name once")
        known[material.name] = material
    return known


def _check_span(where: str, record: object, name: str, *, or_zero: bool = False) -> None:
    """Raise unless a field of a dataclass is a number within the span of its declaration, or zero where that is allowed."""
    quantity, value = declared(record.__class__)[name].quantity, finite(f"{where}{name}", getattr(record, name))
    low, high = quantity.span if quantity and quantity.span else (-math.inf, math.inf)
    if not (low <= value <= high or (or_zero and value == 0)):
        zero = "0, or " if or_zero else ""
        raise InputError(f"{where}{name}", "out of range", found=value, expected=f"{zero}{low:g} to {high:g}")
