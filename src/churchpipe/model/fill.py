"""Fill on the back of vaults."""

from dataclasses import dataclass
from typing import Annotated

from churchpipe.errors import InputError
from churchpipe.model.arguments import listed, text, text_or_empty
from churchpipe.model.arrays import store
from churchpipe.model.doubts import doubt_fields
from churchpipe.model.quantities import Quantity, Usual, check_ranges

_TOP = Usual(-50, 100, "vaults below the ground to those of the tallest churches")


@dataclass(frozen=True, slots=True)
class Fill:
    """Loose fill on the backs of vaults up to a level: it presses downwards on the stones below it, and its mass is pushed.

    It bears nothing: no pressure of earth holds a haunch that moves outwards.

    Raises
    ------
    InputError
        No vault, no weight, a negative one.
    """

    on: Annotated[tuple[str, ...], "Vaults, by the names of their parts, or walls that it lies on."]
    unit_weight: Annotated[
        float, Quantity("_kN_m3", 0.0, above=True, usual=Usual(1, 30, "light fill has some 5, rubble 15 to 20")), "Of the fill."
    ]
    top: Annotated[float, Quantity("_m", usual=_TOP), "z of its surface."]
    mass: Annotated[
        float | None, Quantity("_kN_m3", 0.0, key="seismic_mass_kN_m3"), "Weight that the load factor multiplies; by default all."
    ] = None
    name: Annotated[str, "For messages and tables; by default those of its vaults."] = ""

    def __post_init__(self) -> None:
        on = tuple(text("fill: on", name) for name in listed("fill: on", self.on, str))
        store(self, on=on, name=text_or_empty("fill: name", self.name))
        if not on:
            raise InputError(f"{self.called}: on", "nothing that it lies on", expected="names of vaults or walls")
        check_ranges(self, f"{self.called}: ")
        doubt_fields(self)

    @property
    def called(self) -> str:
        """What messages call it."""
        return f"fill {self.name or ' '.join(self.on)}"

    @property
    def pushed(self) -> float:
        """What the load factor multiplies, N/m3."""
        return self.unit_weight if self.mass is None else self.mass
