"""Joints with a strength of their own: a repointed wall, a base on a damp course, a vault that only lies on its walls."""

from dataclasses import dataclass
from typing import Annotated

from churchpipe.errors import InputError
from churchpipe.model.arguments import finite, listed, one_of, text
from churchpipe.model.arrays import store
from churchpipe.model.carried import Metres
from churchpipe.model.contacts import KINDS, ContactKind
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.materials import COHESION, FRICTION
from churchpipe.model.quantities import Quantity, check_ranges


@dataclass(frozen=True, slots=True)
class JointGroup:
    """Joints with a strength of their own, in place of that of their materials. What is given picks them, all of it together.

    Raises
    ------
    InputError
        Nothing that picks joints, no strength, one below zero, heights that are not in order.
    """

    name: Annotated[str, "For messages."]
    kind: Annotated[
        ContactKind | None,
        "What they are: level, upright and sloping (bed, head, radial; the crown of an arch of an even number of voussoirs is "
        "upright), those of two walls with or without mortar (junction, butt), those on the ground (base).",
    ] = None
    walls: Annotated[tuple[str, ...], "Walls that they lie in."] = ()
    between: Annotated[tuple[str, str] | None, "Two walls, or parts of vaults, that meet in them."] = None
    above: Annotated[Metres | None, Quantity("_m"), "Height that their middles are above."] = None
    below: Annotated[Metres | None, Quantity("_m"), "Height that their middles are below."] = None
    friction: Annotated[float | None, FRICTION, "Coefficient of friction; left out: that of the materials."] = None
    cohesion: Annotated[float | None, COHESION, "Shear strength without compression; left out: that of the materials."] = None

    def __post_init__(self) -> None:
        where = f"joints {text('joints: name', self.name)}"
        walls = tuple(listed(f"{where}: walls", self.walls, str))
        pair = None if self.between is None else tuple(listed(f"{where}: between", self.between, str))
        if self.kind is not None:
            one_of(f"{where}: kind", self.kind, *KINDS)
        if pair is not None and (len(pair) != 2 or pair[0] == pair[1]):
            raise InputError(f"{where}: between", "not two walls", found=", ".join(pair), expected="the names of two walls")
        if self.friction is None and self.cohesion is None:
            raise InputError(where, "no strength", expected="friction, cohesion or both")
        check_ranges(self, f"{where}: ", "friction", "cohesion")
        heights = [None if value is None else finite(f"{where}: height", value) for value in (self.above, self.below)]
        if self.kind is None and not walls and pair is None and heights == [None, None]:
            raise InputError(where, "all joints", expected="kind, walls, between, above or below", remedy="Change the materials.")
        if heights[0] is not None and heights[1] is not None and not heights[0] < heights[1]:
            raise InputError(where, "no height", found=f"{heights[0]:g} to {heights[1]:g} m", expected="above < below")
        store(self, walls=walls, between=pair, above=heights[0], below=heights[1])
        doubt_fields(self)

    @property
    def named(self) -> tuple[str, ...]:
        """The walls that it names."""
        return (*self.walls, *(self.between or ()))
