"""What a case file may say. Keys, types and ranges; units are in the key names."""

import re
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from churchpipe.config.section import Count, NotNegative, Positive, Section, Table, Vector, gathered, validated
from churchpipe.config.sources import check_source
from churchpipe.errors import InputError
from churchpipe.model.names import STRENGTH, Planes

Flow = Literal["associative", "non-associative"]
Method = Literal["limit", "pushover"]
Start = Literal["dead-load", "uniform", "associative"]


def _listed(value: Any) -> Any:
    """Return one text as a list of it."""
    return [value] if isinstance(value, str) else value


def _known_solver(value: str) -> str:
    """Return the name of a solver of cone programs, if it is one."""
    if value not in ("auto", "interior-point", "clarabel") and not re.fullmatch(r"cvxpy(:\w+)?", value):
        raise ValueError('"auto", "interior-point", "clarabel", "cvxpy" or "cvxpy:NAME"')
    return value


Poisson = Annotated[float, Field(ge=0, lt=0.5)]


class ElasticTable(Section):
    """Elastic constants, which the rigid blocks do not need."""

    block_E_GPa: Positive
    block_nu: Poisson
    joint_E_GPa: Positive
    joint_nu: Poisson
    joint_thickness_mm: Positive


class MaterialTable(Section):
    """One masonry. Unit weight and friction have no default: a case that leaves them out does not run."""

    unit_weight_kN_m3: Positive | None = None
    friction: NotNegative | None = None
    cohesion_kPa: NotNegative = 0.0
    elastic: ElasticTable | None = None


class LoadTable(Section):
    """A lateral load."""

    direction: Vector
    name: Annotated[str, Field(max_length=100)] = ""
    panels: list[str] | None = None
    profile: Literal["uniform", "linear"] = "uniform"


class CurveTable(Section):
    """The capacity curve of the stones at large displacements, of each load."""

    step_mm: Positive | None = None
    steps: Count = 400
    furthest_mm: Positive | None = None
    control_mm: Vector | None = None


class RigidTable(Section):
    """The rigid-block analyses, and what stones may be apart and still make a joint."""

    flow: list[Flow] = Field(default_factory=lambda: ["associative"], min_length=1)
    solver: Annotated[str, AfterValidator(_known_solver)] = "auto"
    method: Literal["default", "paper"] = "default"
    start: (
        Annotated[list[Start], Field(min_length=1), BeforeValidator(_listed, json_schema_input_type=list[Start] | Start)] | None
    ) = None
    bipotential_gap: Annotated[float, Field(gt=0, lt=1)] = 1e-5
    contact_gap_mm: Positive | None = None
    contact_angle_deg: Annotated[float, Field(gt=0, lt=90)] | None = None
    overlap_mm: Positive | None = None
    curve: CurveTable | None = None


class ShellTable(Section):
    """The homogenised shell: its mesh, its strength, its analyses."""

    element_size_mm: Positive
    planes: Planes = STRENGTH
    membrane: Literal["LST", "CST"] = "LST"
    analyses: list[Method] = Field(default_factory=lambda: ["limit"], min_length=1)
    solver: Literal["auto", "interior-point", "clarabel"] = "auto"
    control_point: Annotated[int, Field(ge=0)] | None = None
    control_point_mm: Vector | None = None
    steps: Count | None = None


class FloorTable(Section):
    """A mechanism that begins above the ground: Z and H, storeys, and S_e(T1), in m/s2 or in g."""

    height_m: NotNegative
    building_height_m: Positive
    storeys: Count
    spectral_acceleration_m_s2: Positive | None = None
    spectral_acceleration_g: Positive | None = None
    damping_percent: NotNegative = 5.0


class CheckTable(Section):
    """The safety check of the Italian code: a_g, in m/s2 or in g, and the soil factor S have no default."""

    a_g_m_s2: Positive | None = None
    ag_g: Positive | None = None
    soil_factor: Positive
    q: Annotated[float, Field(ge=1, allow_inf_nan=False)] = 2.0
    confidence_factor: Annotated[float, Field(ge=1, allow_inf_nan=False)] = 1.35
    floor: FloorTable | None = None


class PublishedTable(Section):
    """A load factor that somebody published: the report sets ours beside it."""

    load: Annotated[str, Field(min_length=1)]
    model: Literal["rigid", "shell", "experiment"]
    load_factor: Positive
    source: Annotated[str, Field(min_length=1)]
    flow: Flow | None = None
    friction: NotNegative | None = None


class CaseTable(Section):
    """The whole file, one variant of it; [source] is checked apart, by its generator."""

    name: Annotated[str, Field(pattern=r"^\w[\w .+-]*$", max_length=100)]
    source: dict[str, Any]
    material: dict[str, MaterialTable] = Field(default_factory=dict)
    load: list[LoadTable] = Field(default_factory=list)
    rigid: RigidTable = RigidTable()
    shell: ShellTable | None = None
    check: CheckTable | None = None
    published: list[PublishedTable] = Field(default_factory=list)


def check(table: Table, file: str) -> tuple[CaseTable, Section]:
    """Return a case's table and its source, checked.

    Raises
    ------
    InputError: everything that is wrong, each with its key; an unknown key with the nearest known one.
    """
    problems: list[InputError] = []
    case = validated(CaseTable, table, "", file, problems)
    source = check_source(table["source"], file, problems) if isinstance(table.get("source"), dict) else None
    if problems or case is None or source is None:
        raise gathered(file, problems)
    return case, source
