"""Records of analyses: what a stage hands to the comparison, JSON in SI; and the same in the words and units of summary.json."""

from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, get_args

import numpy as np

from churchpipe.errors import InputError
from churchpipe.io.atomic import write_json
from churchpipe.io.tables import read_json
from churchpipe.io.tie_records import Gain, TieCandidate, TieForce, tie_words
from churchpipe.model.arguments import finite, one_of, text
from churchpipe.model.block_curve import CURVE_STATUSES
from churchpipe.model.names import CONTACT_MODEL, RIGID_BLOCKS, SHELL, ContactModel, Planes, ShellMethod
from churchpipe.model.results import Status


@dataclass(frozen=True, slots=True)
class Question:
    """What an analysis was asked: name and direction (3,) of the load, and by material friction, cohesion (Pa), and compressive
    strength (Pa) where there is one; joints with a strength of their own, each a table of a case file.

    Raises
    ------
    InputError: no name, a direction that is no vector, strength that is no number >= 0.
    """

    load: str
    direction: tuple[float, ...]
    friction: dict[str, float]
    cohesion: dict[str, float]
    compressive_strength: dict[str, float] = field(default_factory=dict)
    joints: tuple[dict[str, Any], ...] = ()

    def __post_init__(self) -> None:
        text("record: load", self.load)
        if len(self.direction) != 3:
            raise InputError("record: direction", "wrong length", found=len(self.direction), expected="3 components")
        strength = ("friction", self.friction), ("cohesion", self.cohesion), ("compressive_strength", self.compressive_strength)
        for name, values in strength:
            for material, value in values.items():
                if finite(f"record: {name} of {material}", value) < 0:
                    raise InputError(f"record: {name} of {material}", "out of range", found=value, expected=">= 0")

    def as_words(self) -> dict[str, Any]:
        """Return the keys of summary.json; each strength: one number, or one a material where they differ."""
        cohesion = {name: value / 1e3 for name, value in self.cohesion.items()}
        crushing = {name: value / 1e6 for name, value in self.compressive_strength.items()}
        all_crush = crushing.keys() == cohesion.keys()
        return {
            "load": self.load,
            "direction": list(self.direction),
            "friction": _common(self.friction),
            "cohesion_kPa": _common(cohesion),
            **({"compressive_strength_MPa": _common(crushing) if all_crush else crushing} if crushing else {}),
            **({"joints": list(self.joints)} if self.joints else {}),
        }


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an analysis ended: NaN where there is no such number; residual over the weight, violation as of its state.

    Raises
    ------
    InputError: an unknown status, a negative count or time.
    """

    status: Status
    load_factor: float = np.nan
    lower_bound: float = np.nan
    upper_bound: float = np.nan
    equilibrium_residual: float = np.nan
    violation: float = np.nan
    iterations: int = 0
    seconds: float = 0.0
    solver: str = ""
    message: str = ""

    def __post_init__(self) -> None:
        one_of("record: status", self.status, *get_args(Status))
        for name in ("iterations", "seconds"):
            if finite(f"record: {name}", getattr(self, name)) < 0:
                raise InputError(f"record: {name}", "out of range", found=getattr(self, name), expected=">= 0")


@dataclass(frozen=True, slots=True)
class Sliding:
    """What a non-associative analysis has besides: see `LimitState`; history: its load factors."""

    gap: float
    interval: tuple[float, ...]
    friction_violation: float
    fixed_points: tuple[float, ...]
    history: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class RigidRecord:
    """A rigid-block analysis, with the ties of the structure, those that might be added, and what would help its walls."""

    question: Question
    outcome: Outcome
    flow: str
    sliding: Sliding | None = None
    contact_model: ContactModel = CONTACT_MODEL
    ties: tuple[TieForce, ...] = ()
    candidates: tuple[TieCandidate, ...] = ()
    gains: tuple[Gain, ...] = ()

    def __post_init__(self) -> None:
        one_of("record: flow", self.flow, "associative", "non-associative")
        one_of("record: contact_model", self.contact_model, *get_args(ContactModel))

    def as_words(self) -> dict[str, Any]:
        """Return the record of summary.json."""
        words = {"model": RIGID_BLOCKS, "flow": self.flow, "contact_model": self.contact_model, **self.question.as_words()}
        words |= _ending(self.outcome, "cone_violation")
        words |= {"tie_candidates": [one.as_words() for one in self.candidates]} if self.candidates else {}
        words |= {"gains": [one.as_words() for one in self.gains]} if self.gains else {}
        return words | (asdict(self.sliding) if self.sliding else {}) | tie_words(self.ties)


@dataclass(frozen=True, slots=True)
class Curve:
    """A capacity curve: the node that is followed, its displacement (ns,) m, load factors (ns,)."""

    control_point: int
    control: tuple[float, ...]
    load_factors: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.control) != len(self.load_factors):
            counts = f"{len(self.control)} and {len(self.load_factors)}"
            raise InputError("record: curve", "displacements without load factors", found=counts, expected="as many of each")


@dataclass(frozen=True, slots=True)
class ShellRecord:
    """An analysis of the shell; curve: of a pushover."""

    question: Question
    outcome: Outcome
    method: ShellMethod
    planes: Planes
    curve: Curve | None = None
    ties: tuple[TieForce, ...] = ()

    def __post_init__(self) -> None:
        one_of("record: method", self.method, *get_args(ShellMethod))
        one_of("record: planes", self.planes, *get_args(Planes))

    def as_words(self) -> dict[str, Any]:
        """Return the record of summary.json."""
        words = {"model": SHELL, "method": self.method, "planes": self.planes, **self.question.as_words()}
        words |= _ending(self.outcome, "yield_violation")
        if self.method == "pushover":
            for key in ("lower_bound", "upper_bound", "solver"):
                del words[key]
        if self.curve:
            words |= {"steps": len(self.curve.control), "control_point": self.curve.control_point}
            words |= {"control_mm": [1e3 * place for place in self.curve.control], "load_factors": list(self.curve.load_factors)}
        return words | tie_words(self.ties)


@dataclass(frozen=True, slots=True)
class BlockPath:
    """The path of a capacity curve of the stones: see `BlockCapacityCurve`.

    largest: m, of all displacements. fallen: names of the stones that fell on the way; fell_at (m) the displacement of each.
    misfit: the largest of the steps.
    """

    ending: str
    d0: float
    displacement: tuple[float, ...]
    load_factors: tuple[float, ...]
    largest: float
    fallen: tuple[str, ...]
    fell_at: tuple[float, ...]
    misfit: float

    def __post_init__(self) -> None:
        one_of("record: ending", self.ending, *CURVE_STATUSES)
        if len(self.displacement) != len(self.load_factors):
            counts = f"{len(self.displacement)} and {len(self.load_factors)}"
            raise InputError("record: path", "displacements without load factors", found=counts, expected="as many of each")


@dataclass(frozen=True, slots=True)
class BlockCurveRecord:
    """A capacity curve of the stones."""

    question: Question
    outcome: Outcome
    path: BlockPath

    def as_words(self) -> dict[str, Any]:
        """Return the record of summary.json."""
        words = {"model": RIGID_BLOCKS, "method": "curve", **self.question.as_words(), **_ending(self.outcome, "cone_violation")}
        for key in ("lower_bound", "upper_bound", "solver", "iterations"):
            del words[key]
        return words | {
            "ending": self.path.ending,
            "d0_m": self.path.d0,
            "displacement_m": list(self.path.displacement),
            "load_factors": list(self.path.load_factors),
            "largest_displacement_m": self.path.largest,
            "fallen_stones": list(self.path.fallen),
            "fell_at_m": list(self.path.fell_at),
            "misfit": self.path.misfit,
            "steps": len(self.path.displacement),
        }


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Stands for an analysis that was not made, and says why."""

    reason: str


Record = RigidRecord | BlockCurveRecord | ShellRecord | LeftOut
_SCHEMAS: dict[str, type[Any]] = {
    "churchpipe rigid-record 3": RigidRecord,
    "churchpipe block-curve-record 1": BlockCurveRecord,
    "churchpipe shell-record 2": ShellRecord,
    "churchpipe left-out 1": LeftOut,
}
_LISTS = {"ties": TieForce, "candidates": TieCandidate, "gains": Gain}
_PARTS = {"question": Question, "outcome": Outcome, "sliding": Sliding, "curve": Curve, "path": BlockPath}


def write_record(path: str | Path, record: Record) -> None:
    """Write a record; numbers that are not finite become null."""
    schema = next(name for name, kind in _SCHEMAS.items() if isinstance(record, kind))
    write_json(path, {"schema": schema} | asdict(record))


def read_record(path: str | Path) -> Record:
    """Read a record.

    Raises
    ------
    InputError: not such a file, one of another version, or values out of range.
    """
    stored: Any = read_json(path)
    schema = stored.pop("schema", None) if isinstance(stored, dict) else None
    remedy = "Delete the file and run the case again."
    if schema not in _SCHEMAS:
        raise InputError(str(path), "no record of an analysis", found=schema, expected=", ".join(_SCHEMAS), remedy=remedy)
    try:
        parts = {
            key: _part(_PARTS[key], value) if key in _PARTS and value is not None else value for key, value in stored.items()
        }
        lists = {key: parts[key] or () for key in _LISTS if key in parts}
        parts |= {key: tuple(_part(_LISTS[key], one) for one in value) for key, value in lists.items()}
        return _SCHEMAS[schema](**parts)
    except (TypeError, AttributeError) as error:
        raise InputError(str(path), "a damaged record", found=error, expected=schema, remedy=remedy) from error


def _part(kind: type[Any], stored: dict[str, Any]) -> Any:
    """Return a part of a record: lists are tuples, and null stands for a number that is none."""
    numbers = {item.name for item in fields(kind) if item.type is float}
    values = {key: tuple(np.nan if x is None else x for x in v) if isinstance(v, list) else v for key, v in stored.items()}
    return kind(**{key: np.nan if value is None and key in numbers else value for key, value in values.items()})


def _ending(outcome: Outcome, violation: str) -> dict[str, Any]:
    return {
        "load_factor": outcome.load_factor,
        "lower_bound": outcome.lower_bound,
        "upper_bound": outcome.upper_bound,
        "status": outcome.status,
        "iterations": outcome.iterations,
        "seconds": round(outcome.seconds, 3),
        "solver": outcome.solver,
        "equilibrium_residual": outcome.equilibrium_residual,
        violation: outcome.violation,
        "message": outcome.message,
    }


def _common(values: dict[str, float]) -> float | dict[str, float]:
    distinct = set(values.values())
    return float(distinct.pop()) if len(distinct) == 1 else values
