"""Flexible floors and roofs: joists that hold two walls together by what holds their ends."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

from churchpipe.errors import InputError
from churchpipe.model.arguments import positive
from churchpipe.model.arrays import floats, store
from churchpipe.model.carried import AreaLoad
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.quantities import Quantity, Usual, in_range

TIMBER_MODULUS = 10e9
_FRICTION = Usual(0, 1.5, "wood or steel on masonry has 0.3 to 0.7")
_FIXING = Usual(0, 500, "an anchor in masonry holds some 5 to 50")
_Side = Annotated[float, Quantity("_mm", 0.0, above=True, usual=Usual(20, 1500, "laths to main beams"))]
_SEAT = Usual(20, 1000, "joists lie some 80 to 250 on a wall")
_MODULUS = Usual(0.5, 250, "timber to steel")


@dataclass(frozen=True, slots=True, kw_only=True)
class Diaphragm(AreaLoad):
    """A floor or roof of joists that span between two parallel walls.

    Its weight lies on both of them, as that of any `AreaLoad`. Besides, each joist pulls them together with what holds its ends:
    friction times the dead load that it bears there, and a fixing. A joist never pushes walls apart, and no force goes across
    the joists: in its plane the floor bends without resistance.

    Parameters
    ----------
    walls, dead, begin, end, height, bearing, mass, name
        As of an `AreaLoad` between two walls.
    spacing
        m from joist to joist. The length of the floor is divided evenly, into strips about so wide.
    friction
        Of a joist on its bearings.
    fixing
        What an anchor at each end of a joist holds beside friction, N.
    joist
        Width and height of a joist, m; capacity curves take its stiffness from them.
    modulus
        Of the joists, Pa.
    bearing_length
        m; a joist pulled so far falls off its bearing. None: never.

    Raises
    ------
    InputError
        As `AreaLoad`; not two walls, nothing that holds the joists, sizes that are not above zero.
    """

    spacing: Annotated[
        float,
        Quantity("_m", 0.0, above=True, usual=Usual(0.1, 6, "joists to main beams")),
        "From joist to joist; the floor is divided evenly, about so.",
    ]
    friction: Annotated[float, Quantity("", 0.0, usual=_FRICTION), "Of a joist on its bearings."] = 0.0
    fixing: Annotated[
        float, Quantity("_kN", 0.0, usual=_FIXING), "What an anchor at each end of a joist holds beside friction."
    ] = 0.0
    joist: Annotated[tuple[_Side, _Side], "Width and height of a joist: its stiffness, for capacity curves."] = (0.1, 0.2)
    modulus: Annotated[float, Quantity("_GPa", 0.0, above=True, usual=_MODULUS), "Of the joists."] = TIMBER_MODULUS
    bearing_length: Annotated[
        float | None, Quantity("_mm", 0.0, above=True, usual=_SEAT), "A joist pulled so far falls off; left out: never."
    ] = None
    kind: ClassVar[str] = "diaphragm"

    def __init__(
        self,
        walls: Sequence[str],
        *,
        spacing: float,
        dead: float = 0.0,
        friction: float = 0.0,
        fixing: float = 0.0,
        begin: float | None = None,
        end: float | None = None,
        height: float | None = None,
        bearing: float = 0.0,
        mass: float | None = None,
        joist: tuple[float, float] = (0.1, 0.2),
        modulus: float = TIMBER_MODULUS,
        bearing_length: float | None = None,
        name: str = "",
    ) -> None:
        extent = {"begin": begin, "end": end, "height": height, "mass": mass}
        AreaLoad.__init__(self, walls, dead=dead, bearing=bearing, name=name, **extent)
        where = self.called
        if len(self.walls) != 2:
            raise InputError(f"{where}: walls", "not two walls", found=", ".join(self.walls), expected="two parallel ones")
        for key, value in (("spacing", spacing), ("dead", dead)):
            positive(f"{where}: {key}", value)
        for key, value in (("modulus", modulus), ("friction", friction), ("fixing", fixing)):
            in_range(Diaphragm, key, f"{where}: {key}", value)
        if not friction and not fixing:
            remedy = "Without either it is an area load."
            raise InputError(where, "nothing holds its joists", expected="friction or a fixing", remedy=remedy)
        width, depth = floats(f"{where}: joist", joist, (2,)).tolist()
        for side in (width, depth):
            in_range(Diaphragm, "joist", f"{where}: joist", side)
        if bearing_length is not None:
            in_range(Diaphragm, "bearing_length", f"{where}: bearing_length", bearing_length)
        store(self, spacing=float(spacing), friction=float(friction), fixing=float(fixing), joist=(width, depth))
        store(self, modulus=float(modulus), bearing_length=bearing_length)
        doubt_fields(self)
