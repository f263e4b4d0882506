"""The [[published]] tables of a case: load factors to set ours beside."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from churchpipe.config.schema import Flow, PublishedTable
from churchpipe.config.section import nearest
from churchpipe.errors import InputError


@dataclass(frozen=True, slots=True)
class Published:
    """A published load factor: for which load and model, and where it stands.

    flow: of the rigid blocks, else None. friction: the coefficient it holds for, None for whatever the case has.
    """

    load: str
    model: Literal["rigid", "shell", "experiment"]
    flow: Flow | None
    load_factor: float
    source: str
    friction: float | None = None


def read_published(file: str, sections: Sequence[PublishedTable], loads: Sequence[str]) -> tuple[Published, ...]:
    """Return the [[published]] tables of a case, whose loads have these names.

    Raises
    ------
    InputError: a load that the case does not have, a flow rule of a model that has none, rigid blocks without one.
    """
    return tuple(_published(f"{file}: published.{number}", section, loads) for number, section in enumerate(sections))


def _published(place: str, section: PublishedTable, loads: Sequence[str]) -> Published:
    if section.load not in loads:
        raise InputError(
            f"{place}.load",
            "no such load in this case",
            found=section.load,
            expected=f"one of {', '.join(loads)}",
            remedy=nearest(section.load, loads),
        )
    if section.model == "rigid" and section.flow is None:
        raise InputError(f"{place}.flow", "missing key", expected='"associative" or "non-associative", for rigid blocks')
    if section.model != "rigid" and section.flow is not None:
        raise InputError(f"{place}.flow", "only rigid blocks have a flow rule", found=section.flow, expected="no flow")
    return Published(section.load, section.model, section.flow, section.load_factor, section.source, section.friction)
