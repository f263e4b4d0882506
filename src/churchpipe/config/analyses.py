"""What a case asks of the analyses: the [rigid] and [shell] tables, SI."""

import re
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from churchpipe.config.tables import listed
from churchpipe.errors import InputError
from churchpipe.model.contacts import GAP, OVERLAP
from churchpipe.model.names import CONTACT_MODEL, STRENGTH, ContactModel, Flow, Planes, Start
from churchpipe.model.quantities import Coordinate, Count, Length, Place, Quantity, Usual, Whole
from churchpipe.model.stone_path import HALO
from churchpipe.rigid_blocks.crushing import MOST_PARTS, PARTS
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP

Method = Literal["limit", "pushover"]
_Corner = tuple[Coordinate, Coordinate]
# How far a path goes: less than 1e-6 m or rad is lost to rounding, and refused in Python as well.
_FURTHEST = Quantity("_deg", 6e-5, high=180, key="furthest_deg")
_Way = Annotated[float, Quantity("_mm", 1e-3)]
_Far = Annotated[float, Quantity("_mm", 1e-3, usual=Usual(1.0, 50e3, "what can be measured to walls that have fallen"))]
_Part = Annotated[float, Quantity()]


def _one_or_more(kind: Any) -> BeforeValidator:
    """Return what makes a list of one value that is given alone; kind: of the values."""
    return BeforeValidator(listed, json_schema_input_type=list[kind] | kind)


def _known_solver(value: str) -> str:
    """Return the name of a solver of cone programs, if it is one."""
    if value not in ("auto", "interior-point", "clarabel") and not re.fullmatch(r"cvxpy(:\w+)?", value):
        raise ValueError('"auto", "interior-point", "clarabel", "cvxpy" or "cvxpy:NAME"')
    return value


def _even(value: int) -> int:
    if value % 2:
        raise ValueError("an even number")
    return value


@dataclass(frozen=True, slots=True)
class CurveSettings:
    """The capacity curve of the stones at large displacements, of each load: see `churchpipe.block_pushover`."""

    step: Annotated[
        _Way | None, "Largest displacement of a step; by default a tenth of the median thickness of the stones that move."
    ] = None
    steps: Annotated[Count, "Most steps."] = 400
    furthest: Annotated[_Far | None, "Displacement of a stone at which the curve ends."] = None
    control: Annotated[Place | None, "Point that the curve follows; by default the mean of what is pushed."] = None
    halo: Annotated[Whole, "Contacts from a moving stone to those held still; 0 holds none."] = HALO
    half_steps: Annotated[
        bool | None,
        "Whether the curve is followed again with steps half as long, of which the check takes the one that withstands less; by "
        "default where the case has the spectrum of the site.",
    ] = None


@dataclass(frozen=True, slots=True)
class RigidSettings:
    """The rigid-block analyses, and what stones may be apart and still make a joint."""

    flow: Annotated[
        tuple[Flow, ...],
        Field(min_length=1),
        _one_or_more(Flow),
        "Flow rules to analyse.",
    ] = ("associative",)
    solver: Annotated[str, AfterValidator(_known_solver), "Of the cone programs."] = "auto"
    method: Annotated[Literal["default", "paper"], "Scheme of sliding without dilatancy."] = "default"
    start: Annotated[tuple[Start, ...], Field(min_length=1), _one_or_more(Start), "Starts of its iteration."] | None = None
    contact_model: Annotated[
        tuple[ContactModel, ...],
        Field(min_length=1),
        _one_or_more(ContactModel),
        "Where friction acts in a joint: at its corners, which overrates torsion, or nearer to its middle; or both.",
    ] = (CONTACT_MODEL,)
    crushing_parts: Annotated[
        int,
        Quantity("", 2, high=MOST_PARTS),
        AfterValidator(_even),
        "Parts along each side of a joint that crushes and is no parallelogram, an even number.",
    ] = PARTS
    bipotential_gap: Annotated[float, Quantity("", 0.0, above=True, high=1, below=True), "Error at which its iteration ends."] = (
        BIPOTENTIAL_GAP
    )
    contact_gap: Annotated[
        float | None, GAP, "Largest gap between two faces of a joint; by default proposed from the stones."
    ] = None
    contact_angle: Annotated[
        float | None, Quantity("_deg", 0.0, above=True, high=90, below=True), "Largest angle between two faces of a joint."
    ] = None
    verified_gains: Annotated[
        Whole,
        "How many walls are analysed again, each alone, with 10 kPa more cohesion, and how many with 10 kN more weight, however "
        "small the building is: those that it would help most.",
    ] = 0
    overlap: Annotated[float | None, OVERLAP, "Largest depth to which two stones may overlap."] = None
    curve: Annotated[CurveSettings | None, "The capacity curve of the stones, where it is asked for."] = None


@dataclass(frozen=True, slots=True)
class MovementSettings:
    """A support that moves: its foot in the ground, which way, and how far. See `churchpipe.settlement_path`."""

    support: Annotated[str | None, "Wall whose foot moves, or a fixed stone by its name."] = None
    within: Annotated[tuple[_Corner, _Corner] | None, "Instead: opposite corners of a rectangle of the ground, in plan."] = None
    name: Annotated[str, "Of the movement, for tables and pictures; by default that of the support."] = ""
    direction: Annotated[tuple[_Part, _Part, _Part], "Of the movement, or of its axis, right-handed."] = (0.0, 0.0, -1.0)
    about: Annotated[Place | None, "A point of the axis about which the support turns; left out: it moves along."] = None
    furthest: Annotated[_Far | None, "Movement at which to stop; left out: at collapse."] = None
    furthest_angle: Annotated[float | None, _FURTHEST, "Where it turns, likewise."] = None
    step: Annotated[_Way | None, "Largest displacement of a step; by default a tenth of the median thickness of the stones."] = (
        None
    )
    steps: Annotated[Count, "Most steps."] = 200
    halo: Annotated[Whole, "Contacts from a moving stone to those held still; 0 holds none."] = HALO

    def __post_init__(self) -> None:
        if (self.support is None) == (self.within is None):
            raise InputError("movement", "one support is needed", expected="either support (a name) or within_mm (a rectangle)")
        if not any(self.direction):
            raise InputError("movement: direction", "no direction", found=list(self.direction), expected="a vector of length > 0")
        if self.about is None and self.furthest_angle is not None:
            raise InputError("movement", "an angle of a support that moves along", expected="furthest_mm, or a point about_mm")
        if self.about is not None and self.furthest is not None:
            raise InputError("movement", "a length of a support that turns", expected="furthest_deg")
        object.__setattr__(self, "name", self.name or self.support or "rectangle")


@dataclass(frozen=True, slots=True)
class ShellSettings:
    """The homogenised shell: its mesh, its strength, its analyses."""

    element_size: Annotated[Length, "Sides of the elements."]
    planes: Annotated[Planes, "Strength of the masonry: exact of the cell, or the planes of the paper."] = STRENGTH
    membrane: Annotated[Literal["LST", "CST"], "Membrane of the elements: linear or constant strain."] = "LST"
    analyses: Annotated[
        tuple[Method, ...],
        Field(min_length=1),
        _one_or_more(Method),
        "The limit load, the capacity curve, or both.",
    ] = ("limit",)
    solver: Annotated[Literal["auto", "interior-point", "clarabel"], "Of the cone programs."] = "auto"
    control_point: Annotated[Whole | None, "Node that the capacity curve follows; by default what moves most."] = None
    control_place: Annotated[
        Place | None, Quantity("_mm", key="control_point_mm"), "Place whose nearest node the capacity curve follows."
    ] = None
    steps: Annotated[Count | None, "Most steps of the capacity curve."] = None

    def __post_init__(self) -> None:
        if self.control_point is not None and self.control_place is not None:
            raise InputError("shell", "two control points", expected="control_point (a node) or control_point_mm (a place)")

    @property
    def control(self) -> int | tuple[float, ...] | None:
        """Node or place, m, that a capacity curve follows; None: what moves most."""
        return self.control_place if self.control_point is None else self.control_point
