"""The record of an analysis, declared once: SI in the file of its stage, the units of its keys in summary.json."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_args

import numpy as np

from churchpipe.errors import InputError
from churchpipe.io.atomic import read_json, write_json
from churchpipe.io.tie_records import Gain, TieCandidate, TieForce
from churchpipe.mechanism import Part
from churchpipe.model.arguments import finite, one_of, text
from churchpipe.model.block_curve import CURVE_STATUSES
from churchpipe.model.checks import DisplacementCheck, SafetyCheck
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.names import GOOD, METHODS, MODELS, OUTER, SHELL, ContactModel, Flow, Model, Planes
from churchpipe.model.quantities import Quantity, as_read
from churchpipe.model.results import Status

# One value, or one a material where they differ.
Strength = float | dict[str, float]
Displacements = Annotated[tuple[float, ...] | None, Quantity("_m")]
Record = TypeVar("Record")
_CHOICES: dict[str, tuple[str, ...]] = {
    "model": get_args(Model),
    "flow": get_args(Flow),
    "contact_model": get_args(ContactModel),
    "method": tuple(METHODS),
    "planes": get_args(Planes),
    "status": (*get_args(Status), "left-out"),
    "ending": CURVE_STATUSES,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class HalvedSteps:
    """A capacity curve of the stones with steps half as long; difference: see `block_curve.step_difference`."""

    displacement: Displacements
    load_factors: tuple[float, ...]
    ending: str
    d0: Annotated[float, Quantity("_m")]
    difference: float
    difference_at: Annotated[float, Quantity("_m")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Analysis:
    """What an analysis was asked and how it ended; None where its kind knows no such thing, NaN where there is no such number.

    name, variant, geometry, swept: its place in the plan of the run. flow is of limit analyses of the stones, contact_model of
    these and of a curve with torsion, planes of the shell, method is "limit" or "pushover" of the shell and "curve" of the
    stones. direction: (3,) of the load, zeros of one that multiplies loads, whose names multiplies has.
    status: "left-out" where it was not made. equilibrium_residual: over the weight. gap to history: of a non-associative
    analysis, see `LimitState`; history holds its load factors. control: of a capacity curve of the shell, at the node
    control_point, which lies at control_at. ending to misfit: of a capacity curve of the stones, see `BlockCapacityCurve`;
    largest_displacement is of all stones, fallen_stones are names, and fell_at is the displacement at which each fell.
    no_equilibria: the numbers of its steps that are none, the first as drawn is 1. proved_steps: of the first ones, those proved
    one after the other. halved: the curve in steps half as long.
    element_size, elements: of its mesh.
    parts, mechanism: the macro-elements that move, and their name. check: the safety check.

    Raises
    ------
    InputError: an unknown word, a direction that is no vector, a strength, count or time below zero, a curve whose
    displacements have no load factors.
    """

    name: str
    variant: str | None
    model: Model
    flow: Flow | None = None
    method: Literal["limit", "pushover", "curve"] | None = None
    contact_model: ContactModel | None = None
    planes: Planes | None = None
    load: str
    direction: tuple[float, ...]
    multiplies: tuple[str, ...] = ()
    friction: Strength
    cohesion: Annotated[Strength, Quantity("_kPa")]
    compressive_strength: Annotated[Strength | None, Quantity("_MPa")] = None
    joints: tuple[JointGroup, ...] = ()
    load_factor: float
    lower_bound: float | None = None
    upper_bound: float | None = None
    status: Status | Literal["left-out"]
    iterations: int | None = None
    seconds: float
    solver: str | None = None
    equilibrium_residual: float
    cone_violation: float | None = None
    yield_violation: float | None = None
    message: str
    tie_candidates: tuple[TieCandidate, ...] = ()
    gains: tuple[Gain, ...] = ()
    gap: float | None = None
    interval: tuple[float, ...] | None = None
    friction_violation: float | None = None
    fixed_points: tuple[float, ...] | None = None
    history: tuple[float, ...] | None = None
    ending: str | None = None
    d0: Annotated[float | None, Quantity("_m")] = None
    displacement: Displacements = None
    load_factors: tuple[float, ...] | None = None
    largest_displacement: Annotated[float | None, Quantity("_m")] = None
    fallen_stones: tuple[str, ...] | None = None
    fell_at: Displacements = None
    misfit: float | None = None
    no_equilibria: tuple[int, ...] | None = None
    proved_steps: int | None = None
    halved: HalvedSteps | None = None
    steps: int | None = None
    control_point: int | None = None
    control_at: Annotated[tuple[float, ...] | None, Quantity("_m")] = None
    control: Annotated[tuple[float, ...] | None, Quantity("_mm")] = None
    tie_forces: tuple[TieForce, ...] = ()
    element_size: Annotated[float | None, Quantity("_mm")] = None
    elements: int | None = None
    geometry: str | None = None
    swept: dict[str, Any] = field(default_factory=dict)
    parts: tuple[Part, ...] = ()
    mechanism: str = ""
    check: SafetyCheck | DisplacementCheck | None = None

    def __post_init__(self) -> None:
        text("record: load", self.load)
        if len(self.direction) != 3:
            raise InputError("record: direction", "wrong length", found=len(self.direction), expected="3 components")
        for key, words in _CHOICES.items():
            if getattr(self, key) is not None:
                one_of(f"record: {key}", getattr(self, key), *words)
        for key in ("friction", "cohesion", "compressive_strength", "iterations", "seconds"):
            value = getattr(self, key)
            for name, number in value.items() if isinstance(value, dict) else [("", value)]:
                where = f"record: {key}" + (f" of {name}" if name else "")
                if number is not None and finite(where, number) < 0:
                    raise InputError(where, "out of range", found=number, expected=">= 0")
        for places in (self.displacement, self.control):
            if places is not None and len(places) != len(self.load_factors or ()):
                counts = f"{len(places)} and {len(self.load_factors or ())}"
                raise InputError("record", "displacements without load factors", found=counts, expected="as many of each")

    @property
    def of_shell(self) -> bool:
        """Whether it is one of the shell."""
        return self.model == SHELL

    @property
    def stands(self) -> bool:
        """Whether it has a load factor to rest on; that of a capacity curve of the stones tells how it starts."""
        return self.status in GOOD and bool(np.isfinite(self.load_factor)) and self.method != "curve"

    @property
    def crushes(self) -> bool:
        """Whether its masonry crushes: in all analyses of the stones, and in a shell with the strength of cells."""
        return (not self.of_shell or self.planes == "cell") and bool(self.compressive_strength)

    @property
    def coheres(self) -> bool:
        """Whether some of its joints have cohesion."""
        values = self.cohesion.values() if isinstance(self.cohesion, dict) else [self.cohesion]
        return any(value > 0 for value in values) or any((group.cohesion or 0) > 0 for group in self.joints)

    @property
    def kind(self) -> str:
        """Flow rule or method in words: with what its joints do besides rubbing at their corners, and with the strength of a
        shell where it is not the exact one."""
        words: list[str] = [self.flow or METHODS.get(self.method or "", "")]
        words += ["torsion"] if self.contact_model == "torsion" else []
        words += ["crushing"] if self.crushes else []
        words += ["planes of the paper (too strong)"] if self.planes in OUTER else []
        return ", ".join(words)

    @property
    def model_words(self) -> str:
        """The model as people call it."""
        return MODELS[self.model]


def common(values: Mapping[str, float]) -> Strength:
    """Return the one value of all materials, or one a material."""
    distinct = set(values.values())
    return float(distinct.pop()) if len(distinct) == 1 else dict(values)


def write_record(path: str | Path, record: Any) -> None:
    """Write the record of a stage, a dataclass, in SI; numbers that are not finite become null."""
    write_json(path, {"schema": _schema(type(record))} | asdict(record))


def read_record(path: str | Path, *kinds: type[Record]) -> Record:
    """Read a record of one of these kinds.

    Raises
    ------
    InputError: not such a file, one of another version, or values out of range.
    """
    stored: Any = read_json(path)
    schema = stored.get("schema") if isinstance(stored, dict) else None
    remedy = "Delete the file and run the case again."
    expected = " or ".join(map(_schema, kinds))
    kind = next((kind for kind in kinds if schema == _schema(kind)), None)
    if kind is None:
        raise InputError(str(path), "not the record of this stage", found=schema, expected=expected, remedy=remedy)
    try:
        return as_read(kind, stored, units=False)
    except (TypeError, AttributeError) as error:
        raise InputError(str(path), "a damaged record", found=error, expected=expected, remedy=remedy) from error


def _schema(kind: type[Any]) -> str:
    return f"churchpipe {kind.__name__.lower()} 1"
