"""Ring beams on the tops of walls."""

from dataclasses import dataclass
from typing import Annotated

from churchpipe.errors import InputError
from churchpipe.model.arguments import finite, listed, positive, text, text_or_empty
from churchpipe.model.arrays import flags, store
from churchpipe.model.carried import FROM_ITS_END, Metres
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.quantities import Quantity, Usual

# How the names of beams as panels begin.
RING_BEAM = "beam "
_Size = Annotated[float, Quantity("_m", 0.0, above=True, usual=Usual(0.03, 3, "slabs and beams"))]


@dataclass(frozen=True, slots=True)
class RingBeam:
    """Rigid beams on the level tops of walls, which friction alone holds to the masonry: one on each, one along all of them, or a
    rigid floor or roof on all of them.

    Raises
    ------
    InputError
        No walls, one twice, sizes that are not above zero, ends that are not in order.
    """

    walls: Annotated[tuple[str, ...], "Names of straight walls."]
    height: Annotated[_Size, "Of the beam."]
    width: Annotated[_Size | None, "Of the beam; left out: the thickness of each wall."] = None
    begin: Annotated[Metres | None, Quantity("_m", key="from_m"), f"Along each wall, {FROM_ITS_END}; by default its end."] = None
    end: Annotated[Metres | None, Quantity("_m", key="to_m"), "Likewise its other end."] = None
    closed: Annotated[bool, "One rigid beam along all its walls, which have to meet; false: one on each wall."] = False
    slab: Annotated[bool, "One rigid plate over its walls and what lies between them: a floor or a roof."] = False
    material: Annotated[str, "A [material] of the case; left out: that of each wall."] = ""
    name: Annotated[str, "For messages, tables and pictures; by default those of its walls."] = ""

    def __post_init__(self) -> None:
        walls = tuple(text("ring beam: walls", wall) for wall in listed("ring beam: walls", self.walls, str))
        for key in ("name", "material"):
            text_or_empty(f"ring beam: {key}", getattr(self, key))
        where = f"ring beam {self.name or ' '.join(walls)}".strip()
        if not walls or len(set(walls)) < len(walls):
            raise InputError(f"{where}: walls", "not walls to lie on", found=", ".join(walls), expected="each named once")
        positive(f"{where}: height", self.height)
        if self.width is not None:
            positive(f"{where}: width", self.width)
        begin, end = (None if one is None else finite(f"{where}: ends", one) for one in (self.begin, self.end))
        if begin is not None and end is not None and not begin < end:
            raise InputError(where, "no length", found=f"from {begin:g} m to {end:g} m", expected="begin < end")
        for key in ("closed", "slab"):
            store(self, **{key: bool(flags(f"{where}: {key}", getattr(self, key), ()))})
        store(self, walls=walls, begin=begin, end=end)
        doubt_fields(self)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of its beams, as panels of the stones."""
        if self.closed or self.slab:
            return (f"{RING_BEAM}{self.name or ' '.join(self.walls)}",)
        own = f"{RING_BEAM}{self.name} on" if self.name else f"{RING_BEAM}on"
        return tuple(f"{own} {wall}" for wall in self.walls)
