"""How a drawing is read: what a person may say of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from churchpipe.dxf import schema
from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, one_of, positive
from churchpipe.model.quantities import Length, Ratio
from churchpipe.model.sizes import LaidSize
from churchpipe.recognition.laying import LaidBond, LaidPattern
from churchpipe.stones.mortar import STRIP, WIDEST_MEAN

ElevationPlane = Literal["xz", "xy"]
JointMode = Literal["grow", "keep"]
Mortar = Literal["counted", "ignored"]
Support = Literal["drawn", "base"]
Up = Literal["z", "y", "x", "-z", "-y", "-x"]


@dataclass(frozen=True, slots=True)
class Reading:
    """How to read a file of stones; every key has the default that a drawing needs most. A DXF has no `up` and no `scale`."""

    units: Annotated[str | None, 'Read the file in this unit ("m", "mm", "in" ...), whatever it says itself.'] = None
    repair: Annotated[bool, "Drop stones drawn twice and recompute wrong attributes; each repair is listed."] = False
    support: Annotated[Support, '"base": a support under the lowest faces of a file that has none.'] = "drawn"
    thickness: Annotated[Length | None, "Of stones drawn as outlines; an outline's own DXF thickness goes before."] = None
    plane: Annotated[ElevationPlane, "What x-y of a drawing of outlines is: the elevation, or a plan."] = "xz"
    joint: Annotated[Length | None, "Nominal width of joints drawn open."] = None
    joint_mode: Annotated[JointMode, '"grow": stones meet in the middle of their joints; "keep": they stay as drawn.'] = "grow"
    mortar: Annotated[Mortar, 'Weight of the mortar: "counted" as if it were stone, or "ignored".'] = "counted"
    up: Annotated[Up | None, "Axis of the file that points up; by default what its format says, else z."] = None
    scale: Annotated[Ratio, "Sizes in the building over sizes in the file, of models at scale."] = 1.0
    bond: Annotated[LaidPattern | None, "Bodies and outlines are whole walls and rings, and stones are laid in them."] = None
    course: Annotated[LaidSize | None, "Height of the courses of `bond`; width of the voussoirs of a ring."] = None
    stone: Annotated[LaidSize | None, "About the length of the stones of `bond`; each clear bay is divided evenly."] = None
    lintel_bearing: Annotated[Length | None, "Bearing, on either side, of lintels that `bond` lays over flat heads."] = None

    def __post_init__(self) -> None:
        if self.units is not None:
            schema.metres(self.units)
        check_kind("repair", self.repair, bool)
        one_of("support", self.support, "drawn", "base")
        one_of("plane", self.plane, "xz", "xy")
        one_of("joint_mode", self.joint_mode, "grow", "keep")
        one_of("mortar", self.mortar, "counted", "ignored")
        if self.up is not None:
            one_of("up", self.up, "z", "y", "x", "-z", "-y", "-x")
        positive("scale", self.scale)
        for name in ("thickness", "joint", "course", "stone", "lintel_bearing"):
            if getattr(self, name) is not None:
                positive(name, getattr(self, name))
        for name, usual in (("joint_mode", "grow"), ("mortar", "counted")):
            if self.joint is None and getattr(self, name) != usual:
                expected = "joint, the width of the joints, beside it"
                raise InputError(name, "no joint to close", found=getattr(self, name), expected=expected)
        if self.bond is None:
            for name in ("course", "stone", "lintel_bearing"):
                if getattr(self, name) is not None:
                    raise InputError(name, "no bond to lay", expected="a bond, such as running, and whole walls in the file")
        elif self.joint is not None:
            raise InputError("joint", "stones laid in a wall meet", expected="a joint or a bond, not both")
        elif self.laid is None:
            raise InputError("course", "missing", expected="the height of a course")

    @property
    def drawn(self) -> Literal["stone", "wall"]:
        """What the bodies of the file are."""
        return "wall" if self.bond else "stone"

    @property
    def laid(self) -> LaidBond | None:
        """The bond to lay in whole walls; None where the file has stones."""
        return LaidBond(self.bond, self.course, self.stone, self.lintel_bearing) if self.bond and self.course else None

    @property
    def kept_joint(self) -> float | None:
        """Nominal width, m, of joints that stay open; None where there are none."""
        return self.joint if self.joint_mode == "keep" else None

    def tolerances(self, given: Mapping[str, float | None]) -> dict[str, float]:
        """Return the tolerances of joints, m and rad, that somebody gave. Joints that are kept open give a contact gap, which
        reaches across the widest of them too; those that are closed give a least width of contacts."""
        own: dict[str, float] = {}
        if self.joint is not None:
            own = {"contact_gap": WIDEST_MEAN * self.joint} if self.joint_mode == "keep" else {"least_width": STRIP * self.joint}
        return own | {key: value for key, value in given.items() if value is not None}


AS_DRAWN = Reading()
