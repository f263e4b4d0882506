"""How a drawing is read: what a person may say of it."""

from dataclasses import dataclass
from typing import Literal

from churchpipe.dxf import schema
from churchpipe.model.arguments import check_kind, one_of, positive
from churchpipe.stones.mortar import WIDEST_MEAN

ElevationPlane = Literal["xz", "xy"]
JointMode = Literal["grow", "keep"]
Mortar = Literal["counted", "ignored"]
Support = Literal["drawn", "base"]
Up = Literal["z", "y", "x", "-z", "-y", "-x"]


@dataclass(frozen=True, slots=True)
class Reading:
    """How to read a file of stones; every field has the meaning that a drawing needs most.

    units: read it in this unit ("m", "mm", "cm", "in", ...) whatever it says itself.
    repair: drop stones drawn twice and recompute attributes that cannot be understood; each repair is a warning.
    support: "base" puts a fixed support under the lowest faces when the drawing has no ground; all stones drawn stay free.
    thickness: of stones drawn as outlines, m; an outline's own DXF thickness goes before.
    plane: "xz" takes the x-y of a drawing of outlines for the elevation x-z, "xy" leaves it lying, a plan.
    joint: nominal width, m, of joints drawn open. joint_mode: "grow" lets stones meet in the middle of their joints, "keep"
    leaves them as drawn. mortar: whether its weight is "counted", as if it were stone, or "ignored".
    up: the axis of the file that points up; None for what its format says, z where it says nothing. scale: sizes in the building
    over sizes in the file, of models at scale. A DXF has neither of the two.
    """

    units: str | None = None
    repair: bool = False
    support: Support = "drawn"
    thickness: float | None = None
    plane: ElevationPlane = "xz"
    joint: float | None = None
    joint_mode: JointMode = "grow"
    mortar: Mortar = "counted"
    up: Up | None = None
    scale: float = 1.0

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
        for name in ("thickness", "joint"):
            if getattr(self, name) is not None:
                positive(name, getattr(self, name))

    @property
    def open_joint(self) -> float | None:
        """Contact gap, m, that reaches across joints that stay open, the widest of them too; None where there are none."""
        return WIDEST_MEAN * self.joint if self.joint is not None and self.joint_mode == "keep" else None


AS_DRAWN = Reading()
