"""The [[published]] tables of a case: load factors to set ours beside."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from churchpipe.config.section import nearest
from churchpipe.errors import InputError
from churchpipe.model.names import Flow
from churchpipe.model.quantities import Quantity, Usual

_FACTOR = Quantity("", 0.0, above=True, usual=Usual(1e-3, 10.0, "walls that hardly stand to arches in many times their weight"))


@dataclass(frozen=True, slots=True)
class Published:
    """A load factor that somebody published: the report sets ours beside it.

    Raises
    ------
    InputError: a flow rule of a model that has none, rigid blocks without one.
    """

    load: Annotated[str, "Name of the load that it is for."]
    model: Annotated[Literal["rigid", "shell", "experiment"], "What gave it."]
    load_factor: Annotated[float, _FACTOR, "The published value."]
    source: Annotated[str, "Where it stands."]
    flow: Annotated[Flow | None, "Flow rule, of rigid blocks."] = None
    friction: Annotated[float | None, Quantity(low=0.0), "Coefficient that it holds for; by default that of the case."] = None

    def __post_init__(self) -> None:
        if self.model == "rigid" and self.flow is None:
            raise InputError("published: flow", "missing key", expected='"associative" or "non-associative", for rigid blocks')
        if self.model != "rigid" and self.flow is not None:
            raise InputError("published: flow", "only rigid blocks have a flow rule", found=self.flow, expected="no flow")


def check_published(file: str, published: Sequence[Published], loads: Sequence[str]) -> None:
    """Raise InputError where a published value is for none of the loads of these names."""
    for number, value in enumerate(published):
        if value.load not in loads:
            raise InputError(
                f"{file}: published.{number}.load",
                "no such load in this case",
                found=value.load,
                expected=f"one of {', '.join(loads)}",
                remedy=nearest(value.load, loads),
            )
