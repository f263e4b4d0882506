"""Buttresses and pilasters of straight walls."""

import re
from dataclasses import dataclass
from typing import Annotated, cast

from churchpipe.errors import InputError
from churchpipe.model.arguments import positive, text, text_or_empty
from churchpipe.model.arrays import flags, floats, store
from churchpipe.model.carried import FROM_ITS_END, Metres
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.load_places import TOWARD
from churchpipe.model.quantities import Quantity, Usual

_Size = Annotated[
    float, Quantity("_m", 0.0, above=True, usual=Usual(0.03, 20, "pilasters to the flying buttresses of cathedrals"))
]
_ONE_OF_THEM = re.compile(r".* buttress \d+")


def numbered(name: str, number: int) -> str:
    """Return what the stones of one of several buttresses are called, counted from 1."""
    return f"{name} buttress {number}"


def is_buttress(panel: str) -> bool:
    """Return whether stones of this name are those of a buttress, as `numbered` calls them."""
    return _ONE_OF_THEM.fullmatch(panel) is not None


@dataclass(frozen=True, slots=True)
class Buttress:
    """Buttresses alike on one side of a wall; shallow ones are pilasters.

    Raises
    ------
    InputError
        No places, sizes that are not above zero, a side that is none.
    """

    wall: Annotated[str, "The wall that they stand at."]
    along: Annotated[tuple[Metres, ...], Quantity("_m"), f"Where their middles are, along the wall {FROM_ITS_END}."]
    toward: Annotated[str, 'The side of the wall that they stand on: "+x", "-x", "+y" or "-y".']
    width: Annotated[_Size, "Along the wall."]
    depth: Annotated[_Size, "From the face of the wall."]
    height: Annotated[_Size | None, "A whole number of courses; by default that of the wall at its ends."] = None
    bonded: Annotated[bool, "Toothed into the wall; false: built against it, without mortar."] = True
    material: Annotated[str, "A [material] of the case; left out: that of the wall."] = ""
    name: Annotated[str, "Of its stones, with its number; by default that of the wall."] = ""

    def __post_init__(self) -> None:
        where = f"buttress of {text('buttress: wall', self.wall)}"
        along = tuple(floats(f"{where}: along", self.along, (None,)).tolist())
        if not along:
            raise InputError(f"{where}: along", "nowhere", found="no places", expected="one or several, m")
        if not isinstance(cast("object", self.toward), str) or self.toward not in TOWARD:
            raise InputError(f"{where}: toward", "no side", found=self.toward, expected=", ".join(TOWARD))
        for key in ("width", "depth", "height"):
            if key != "height" or self.height is not None:
                positive(f"{where}: {key}", getattr(self, key))
        for key in ("name", "material"):
            text_or_empty(f"{where}: {key}", getattr(self, key))
        store(self, along=along, bonded=bool(flags(f"{where}: bonded", self.bonded, ())))
        doubt_fields(self)
