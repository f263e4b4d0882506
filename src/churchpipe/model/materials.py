"""What the stones and joints are made of."""

from dataclasses import dataclass

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, finite, text


@dataclass(frozen=True, slots=True)
class Elastic:
    """Elastic constants of the running-bond cell (Malena et al. 2019, Table 1): moduli in Pa, joint thickness in m."""

    block_modulus: float
    block_poisson: float
    joint_modulus: float
    joint_poisson: float
    joint_thickness: float


@dataclass(frozen=True, slots=True)
class Material:
    """One masonry: unit weight N/m3, friction coefficient, cohesion Pa; `elastic` is only needed by the shell."""

    name: str
    unit_weight: float
    friction: float
    cohesion: float = 0.0
    elastic: Elastic | None = None

    def __post_init__(self) -> None:
        text("material: name", self.name)
        for key, value, smallest in (
            ("unit_weight", self.unit_weight, 0.0),
            ("friction", self.friction, 0.0),
            ("cohesion", self.cohesion, 0.0),
        ):
            if finite(f"material {self.name}: {key}", value) < smallest:
                raise InputError(
                    f"material {self.name}: {key}", "out of range", found=value, expected=f"a finite number >= {smallest:g}"
                )
        if self.elastic is not None:
            check_kind(f"material {self.name}: elastic", self.elastic, Elastic)
