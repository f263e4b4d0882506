"""The [source] tables of what is laid around arched openings: church, chapel, tower, apse, arch on piers."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from churchpipe.config.section import Count, NotNegative, Number, Positive, Section

Joints = Literal["grid", "bay"]
Across = Literal["x", "y"]
Pattern = Literal["running", "stack", "header-stretcher"]
Headers = Literal["english", "flemish", "none"]


def _listed(value: Any) -> Any:
    return value if isinstance(value, list) else [value]


class ArchedOpeningTable(Section):
    """A door or window under voussoirs, or a round one, in one or several walls and places."""

    name: Annotated[str, Field(min_length=1)]
    wall: Annotated[list[str], BeforeValidator(_listed)]
    centre_mm: Annotated[list[Number], BeforeValidator(_listed)]
    width_mm: Positive
    springing_mm: Positive
    voussoirs: Count
    depth_mm: Positive
    sill_mm: NotNegative = 0.0
    shape: Literal["round", "segmental", "pointed", "circle"] = "round"
    rise_mm: Positive | None = None


class WallBondTable(Section):
    """The bond of one or several walls that are not laid in running bond."""

    wall: Annotated[list[str], BeforeValidator(_listed)]
    pattern: Pattern
    headers: Headers | None = None
    stone_length_mm: Positive | None = None


class NaveTable(Section):
    """The side walls of a nave; width between centrelines."""

    width_mm: Positive
    length_mm: Positive
    height_mm: Positive
    thickness_mm: Positive


class CrossWallTable(Section):
    """A wall across the nave, with a gable up to its ridge."""

    thickness_mm: Positive
    ridge_mm: Positive | None = None


class TranseptTable(Section):
    """The arms of a church; width over all, depth between centrelines."""

    width_mm: Positive
    depth_mm: Positive
    thickness_mm: Positive
    height_mm: Positive | None = None


class ChoirTable(Section):
    """What lies behind a transept."""

    length_mm: Positive


class ChurchTowerTable(Section):
    """A bell tower on an arm of the transept."""

    height_mm: Positive
    side: Literal["left", "right"] = "left"
    width_mm: Positive | None = None


class ChurchChapelTable(Section):
    """An arm of the transept with a height of its own."""

    height_mm: Positive
    side: Literal["left", "right"] = "right"


class ChurchApseTable(Section):
    """A half round behind the end wall."""

    inner_radius_mm: Positive
    thickness_mm: Positive
    height_mm: Positive
    centre_mm: Number = 0.0


class ChurchSource(Section):
    """A church from its parts."""

    generator: Literal["church"]
    course_mm: Positive
    stone_length_mm: Positive
    nave: NaveTable
    facade: CrossWallTable | None = None
    triumphal_arch: CrossWallTable | None = None
    transept: TranseptTable | None = None
    choir_arch: CrossWallTable | None = None
    choir: ChoirTable | None = None
    east: CrossWallTable | None = None
    tower: ChurchTowerTable | None = None
    chapel: ChurchChapelTable | None = None
    apses: list[ChurchApseTable] = Field(default_factory=list)
    openings: list[ArchedOpeningTable] = Field(default_factory=list)
    bonds: list[WallBondTable] = Field(default_factory=list)
    joints: Joints = "bay"
    first_course: Across = "x"


class ChapelSource(Section):
    """A small church of one room; width and length over all."""

    generator: Literal["chapel"]
    course_mm: Positive
    stone_length_mm: Positive
    width_mm: Positive
    length_mm: Positive
    height_mm: Positive
    thickness_mm: Positive
    ridge_mm: Positive | None = None
    apse: ChurchApseTable | None = None
    openings: list[ArchedOpeningTable] = Field(default_factory=list)
    bonds: list[WallBondTable] = Field(default_factory=list)
    joints: Joints = "bay"
    first_course: Across = "x"


class TowerSource(Section):
    """A free-standing tower; width and depth over all."""

    generator: Literal["tower"]
    course_mm: Positive
    stone_length_mm: Positive
    width_mm: Positive
    height_mm: Positive
    thickness_mm: Positive
    depth_mm: Positive | None = None
    plan: Literal["rectangular", "round"] = "rectangular"
    openings: list[ArchedOpeningTable] = Field(default_factory=list)
    bonds: list[WallBondTable] = Field(default_factory=list)
    joints: Joints = "bay"
    first_course: Across = "x"


class ApseSource(Section):
    """An apse behind a wall."""

    generator: Literal["apse"]
    course_mm: Positive
    stone_length_mm: Positive
    inner_radius_mm: Positive
    thickness_mm: Positive
    height_mm: Positive
    wall_length_mm: Positive
    wall_thickness_mm: Positive
    wall_height_mm: Positive
    openings: list[ArchedOpeningTable] = Field(default_factory=list)
    bonds: list[WallBondTable] = Field(default_factory=list)
    joints: Joints = "bay"
    first_course: Across = "x"


class ArchPiersSource(Section):
    """An arch on two piers; `backfill` names the material of what lies on it."""

    generator: Literal["arch_piers"]
    course_mm: Positive
    stone_length_mm: Positive
    span_mm: Positive
    springing_mm: Positive
    pier_width_mm: Positive
    thickness_mm: Positive
    height_mm: Positive
    voussoirs: Count
    depth_mm: Positive
    shape: Literal["round", "segmental", "pointed"] = "round"
    rise_mm: Positive | None = None
    backfill: str | None = None
