"""The tilting-test prototypes S22 and S5: a main wall with partitions behind it (Malena et al. 2019, section 4.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal

from churchpipe.errors import InputError
from churchpipe.generators.checks import Brick, check_brick
from churchpipe.generators.fields import as_dataclass, coerce_fields, materials_of
from churchpipe.generators.laying import Joints
from churchpipe.generators.masonry import DEFAULT_MATERIAL, Masonry, bonded_offset, straight_wall
from churchpipe.generators.openings import OpeningLike
from churchpipe.model.arguments import positive
from churchpipe.model.building import Building, UnitCell
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Coordinate, Count, Length, Ratio


@dataclass(frozen=True, slots=True)
class PrototypeParameters:
    """A main wall along x with its outer face at y = 0, and partitions along y behind it, all as thick as the brick. They are
    called main, partition-1, partition-2 and so on."""

    brick: Annotated[Brick, "Length, thickness and height of a stone."]
    partitions_x: Annotated[Sequence[Coordinate], "x of the left face of each partition."]
    partition_length: Annotated[Length, "Length of the partitions from the outer face of the main wall."]
    courses: Annotated[Count, "Number of courses."]
    main_wall_bricks: Annotated[Ratio | None, "Length of the main wall in bricks; or give its length."] = None
    main_wall_length: Annotated[Length | None, "Length of the main wall; or give it in bricks."] = None
    opening: Annotated[OpeningLike | None, "Opening in each partition, measured from y = 0."] = None
    joints: Joints = "grid"
    first_course: Annotated[Literal["main", "partitions"], "Which walls run through the junctions on course 0."] = "main"
    through_offset: Annotated[Coordinate | None, 'Place of the joints of courses that run through, with "grid".'] = None
    cut_offset: Annotated[Coordinate | None, 'Place of the joints of courses that are cut, with "grid".'] = None

    def __post_init__(self) -> None:
        coerce_fields(self, "prototype.")
        check_brick("prototype.brick", self.brick)
        length, thickness, places = self.length, self.brick[1], sorted(self.partitions_x)
        positive("prototype.main_wall_length", length)
        for left in places:
            if left < -1e-9 or left + thickness > length + 1e-9:
                raise InputError(
                    "prototype.partitions_x",
                    "a partition stands beyond the main wall",
                    found=f"{left:g} to {left + thickness:g} m",
                    expected=f"within 0 to {length:g} m",
                )
        if any(b - a < thickness - 1e-9 for a, b in pairwise(places)):
            raise InputError("prototype.partitions_x", "partitions overlap", found=places, expected=f"{thickness:g} m apart")
        if places and not self.partition_length > thickness:
            raise InputError(
                "prototype.partition_length",
                "no longer than the main wall is thick",
                found=self.partition_length,
                expected=f"> {thickness:g} m",
            )

    @property
    def length(self) -> float:
        """Length of the main wall, m."""
        if self.main_wall_length is not None and self.main_wall_bricks is None:
            return self.main_wall_length
        if self.main_wall_bricks is not None and self.main_wall_length is None:
            return self.main_wall_bricks * self.brick[0]
        raise InputError(
            "prototype",
            "the length of the main wall is given twice or not at all",
            expected='either "main_wall_bricks" or "main_wall_length"',
        )


def prototype(*, name: str = "prototype", materials: tuple[UnitWeight, ...] = (DEFAULT_MATERIAL,), **parameters: Any) -> Building:
    """Return a prototype of the tilting tests; keywords: its keys in docs/reference_case.md, without unit, SI."""
    p = as_dataclass(PrototypeParameters, "prototype", parameters)
    materials = materials_of("prototype", materials)
    masonry = Masonry(
        cell=UnitCell(a=p.brick[2], b=p.brick[0]),
        courses=p.courses,
        thickness=p.brick[1],
        material=materials[0].name,
        joints=p.joints,
        through_offset=bonded_offset(p.brick, p.brick[1]) if p.through_offset is None else p.through_offset,
        cut_offset=p.cut_offset,
    )
    main_first = p.first_course == "main"
    main = straight_wall("main", masonry, (0.0, 0.0), "x", p.length, runs_through=0 if main_first else 1)
    partitions = [
        straight_wall(
            f"partition-{number}",
            masonry,
            (left, 0.0),
            "y",
            p.partition_length,
            runs_through=1 if main_first else 0,
            openings=() if p.opening is None else (p.opening,),
            where="prototype.opening",
        )
        for number, left in enumerate(sorted(p.partitions_x), start=1)
    ]
    return Building(name, (main, *partitions), materials)
