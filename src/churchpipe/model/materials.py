"""What the stones and joints are made of."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, finite, text

# Beyond these a number is in another unit, or lost to rounding. Smallest but zero, and largest: N/m3, -, Pa; Pa, m.
_RANGES = {"unit_weight": (1e-6, 1e9), "friction": (1e-6, 1e3), "cohesion": (1e-6, 1e12)}
_MODULUS, _THICKNESS = (1e-3, 1e21), (1e-9, 1e2)


@dataclass(frozen=True, slots=True)
class Elastic:
    """Elastic constants of the running-bond cell (Malena et al. 2019, Table 1): moduli in Pa, joint thickness in m.

    Raises
    ------
    InputError
        No number, moduli outside 1e-3 Pa to 1e21 Pa, thickness outside 1e-9 m to 100 m, Poisson's ratio outside (-1, .5).
    """

    block_modulus: float
    block_poisson: float
    joint_modulus: float
    joint_poisson: float
    joint_thickness: float

    def __post_init__(self) -> None:
        for key, (low, high) in (("block_modulus", _MODULUS), ("joint_modulus", _MODULUS), ("joint_thickness", _THICKNESS)):
            _check_range(f"elastic.{key}", getattr(self, key), low, high)
        for key in ("block_poisson", "joint_poisson"):
            value = finite(f"elastic.{key}", getattr(self, key))
            if not -1 < value < 0.5:
                raise InputError(f"elastic.{key}", "out of range", found=value, expected="-1 < value < 0.5")


@dataclass(frozen=True)
class UnitWeight:
    """What stones of one material weigh, N/m3: all that the geometry of a model asks of it.

    Raises
    ------
    InputError
        No number; not zero and outside 1e-6 to 1e9 N/m3.
    """

    name: str
    unit_weight: float

    def __post_init__(self) -> None:
        text("material: name", self.name)
        _check_field(self, "unit_weight")


@dataclass(frozen=True)
class JointStrength:
    """What joints of one masonry bear, all that an analysis asks of it: friction coefficient, cohesion Pa.

    elastic: how it deforms; only needed by the shell.

    Raises
    ------
    InputError
        No number; not zero and outside 1e-6 to 1000, 1e-6 to 1e12 Pa.
    """

    name: str
    friction: float
    cohesion: float = 0.0
    elastic: Elastic | None = None

    def __post_init__(self) -> None:
        text("material: name", self.name)
        _check_field(self, "friction")
        _check_field(self, "cohesion")
        if self.elastic is not None:
            check_kind(f"material {self.name}: elastic", self.elastic, Elastic)


# Fields in the order of its bases from the last: name, unit_weight, friction, cohesion, elastic.
@dataclass(frozen=True)
class Material(JointStrength, UnitWeight):
    """One masonry: unit weight N/m3, friction coefficient, cohesion Pa; `elastic` is only needed by the shell.

    Raises
    ------
    InputError
        As `UnitWeight` and `JointStrength`.
    """

    def __post_init__(self) -> None:
        UnitWeight.__post_init__(self)
        JointStrength.__post_init__(self)


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


def _check_field(material: UnitWeight | JointStrength, key: str) -> None:
    where, value = f"material {material.name}: {key}", getattr(material, key)
    if finite(where, value) != 0:
        _check_range(where, value, *_RANGES[key], other="0, or ")


def _check_range(where: str, value: object, low: float, high: float, other: str = "") -> None:
    if not low <= finite(where, value) <= high:
        raise InputError(where, "out of range", found=value, expected=f"{other}{low:g} to {high:g}")
