"""What the building of a case carries, and the ties in it: as the file says it, and as the settings of a stage."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, TypeVar

import numpy as np

from churchpipe.errors import InputError
from churchpipe.loading.placing import place_loads
from churchpipe.loading.ties import place_ties
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.carried import AreaLoad, LineLoad, PointLoad, Pressure
from churchpipe.model.diaphragm import Diaphragm
from churchpipe.model.fill import Fill
from churchpipe.model.placed_loads import Applied, joined_loads
from churchpipe.model.tie_bars import AnchorPlace, TieBar
from churchpipe.model.ties import Tie

_Placed = TypeVar("_Placed")
# The tables of a case, by their keys.
KINDS: Mapping[str, type[Any]] = {
    "line_loads": LineLoad,
    "point_loads": PointLoad,
    "area_loads": AreaLoad,
    "diaphragms": Diaphragm,
    "pressures": Pressure,
    "fills": Fill,
    "ties": TieBar,
    "tie_candidates": TieBar,
}
# What presses and is pushed, and what holds together.
LOADS = ("line_loads", "point_loads", "area_loads", "diaphragms", "pressures", "fills")
TIES = ("ties", "diaphragms")
MEANINGS = {
    "line_loads": "Roofs, floors and thrusts along walls.",
    "point_loads": "Loads at points of walls.",
    "area_loads": "Floors and roofs that span between walls.",
    "diaphragms": "Flexible floors and roofs, whose joists also hold two walls together.",
    "pressures": "Soil or water against walls.",
    "fills": "Fill on the backs of vaults.",
    "ties": "Steel bars between walls.",
    "tie_candidates": "Bars that might be added: ranked by what each of them would add to the load factor.",
}


@dataclass(frozen=True, slots=True)
class Carries:
    """The tables of a case by their keys, each a tuple of records; SI."""

    line_loads: tuple[LineLoad, ...] = ()
    point_loads: tuple[PointLoad, ...] = ()
    area_loads: tuple[AreaLoad, ...] = ()
    diaphragms: tuple[Diaphragm, ...] = ()
    pressures: tuple[Pressure, ...] = ()
    fills: tuple[Fill, ...] = ()
    ties: tuple[TieBar, ...] = ()
    tie_candidates: tuple[TieBar, ...] = ()

    def __bool__(self) -> bool:
        """Whether there is anything."""
        return any(getattr(self, key) for key in KINDS)

    def settings(self, *keys: str) -> dict[str, Any]:
        """Return these tables as JSON has them, without the empty ones."""
        return {key: [plain(item) for item in getattr(self, key)] for key in keys or KINDS if getattr(self, key)}


def carries_of(settings: Mapping[str, Any]) -> Carries:
    """Return what the settings of a stage say, the inverse of `Carries.settings`."""
    return Carries(**{key: tuple(_made(kind, table) for table in settings.get(key, ())) for key, kind in KINDS.items()})


def placed(carries: Carries, stones: Assemblage) -> Applied:
    """Return loads and ties at the stones that bear them.

    Raises
    ------
    InputError: as `place_loads` and `place_ties`; it begins with the table at fault, such as "line_loads.0".
    """
    loads = [part for key in LOADS for part in _each(carries, key)]
    on_stones = joined_loads([tried(key, lambda load=load: place_loads(stones, [load])) for key, load in loads])
    table_of: dict[str, str] = {}

    def bars(*keys: str) -> tuple[Tie, ...]:
        found: list[Tie] = []
        for key, bar in (part for table in keys for part in _each(carries, table)):
            for tie in tried(key, lambda bar=bar: place_ties(stones, [bar])):
                if tie.name in table_of:
                    # Floors without a name are called after their walls, and so are their joists.
                    remedy = 'Give each floor a name of its own, such as name = "upper floor".'
                    if not all(table.startswith("diaphragms.") for table in (key, table_of[tie.name])):
                        remedy = f"It is that of {table_of[tie.name]} too: the joists of a floor have its name and a number. "
                        remedy += "Give the tie another name, or the floor."
                    raise InputError(key, "two ties of one name", found=tie.name, expected="a name each", remedy=remedy)
                table_of[tie.name] = key
                found.append(tie)
        return tuple(found)

    return Applied(on_stones, bars(*TIES), bars("tie_candidates"))


def _each(carries: Carries, key: str) -> Iterator[tuple[str, Any]]:
    yield from ((f"{key}.{number}", item) for number, item in enumerate(getattr(carries, key)))


def tried(key: str, place: Callable[[], _Placed]) -> _Placed:
    """Return what is placed; an error names the table at fault, such as "ties.0"."""
    try:
        return place()
    except InputError as error:
        raise InputError(
            key, f"{error.where}: {error.problem}", found=error.found, expected=error.expected, remedy=error.remedy
        ) from error


def plain(value: Any) -> Any:
    """Return a record or a value as JSON has it; fields that have their default are left out."""
    if is_dataclass(value) and not isinstance(value, type):
        items = ((field, getattr(value, field.name)) for field in fields(value))
        return {field.name: plain(item) for field, item in items if item is not None and item is not field.default}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [plain(item) for item in value] if isinstance(value, tuple) else value


def _made(kind: type[Any], table: Mapping[str, Any]) -> Any:
    places = {key: AnchorPlace(**value) for key, value in table.items() if key in ("start", "end") and isinstance(value, dict)}
    return kind(**{**table, **places})
