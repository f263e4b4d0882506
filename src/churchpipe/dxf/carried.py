"""Ties and line loads in a drawing: inserts on their layers, a line in the block, what else is to say in its attributes.

The attributes have the keys of the case file in capitals. A place on a wall stands in an attribute, as JSON; any other place is
that of the line, which may be moved in the CAD program.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.dxf import schema
from churchpipe.errors import InputError
from churchpipe.findings import Finding, Place
from churchpipe.geometry.walls import wall_line
from churchpipe.loading.ties import place_ties
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.carried import LineLoad
from churchpipe.model.quantities import Declared, Quantity, declared, in_range, in_si, si, unit_of, written
from churchpipe.model.tie_bars import AnchorPlace, TieBar

_KINDS: Mapping[str, type[TieBar] | type[LineLoad]] = {schema.TIES: TieBar, schema.LOADS: LineLoad}
_TEXTS = ("NAME", "WALL")
# Fields that the line itself says, where no wall does.
_ENDS = ("start", "end", "between")


@dataclass(frozen=True, slots=True)
class Drawn:
    """An insert on the layer of ties or of loads: the ends (2, 3) of its line, drawing units, None without one, and its texts."""

    layer: str
    ends: FloatArray | None
    texts: Mapping[str, str]
    place: Place


def words(record: TieBar | LineLoad) -> dict[str, Any]:
    """Return a record by the keys of a case file, in their units, without what is as by default."""
    out: dict[str, Any] = {}
    for item in declared(type(record)).values():
        value = getattr(record, item.name)
        if isinstance(value, np.ndarray):
            value = tuple(value.tolist())
        if value is not None and value != item.default:
            out[item.key] = written(item.key, value, defaults=False)
    return out


def inserts_of(stones: Assemblage, ties: Sequence[TieBar], line_loads: Sequence[LineLoad]) -> list[Drawn]:
    """Return ties and line loads as they are drawn, m.

    Raises
    ------
    InputError: as `place_ties` and `wall_line`; a name that a drawing cannot hold.
    """
    out = [
        Drawn(schema.TIES, np.array([tie.start, tie.end]), _texts(bar), Place("INSERT", ""))
        for bar, tie in zip(ties, place_ties(stones, ties), strict=True)
    ]
    for load in line_loads:
        if load.wall is None:
            ends = np.array(load.between)
        else:
            wall = wall_line(stones, load.wall, load.called)
            along = (0.0 if load.begin is None else load.begin, wall.length if load.end is None else load.end)
            height = wall.top if load.height is None else load.height
            ends = np.array([np.append(wall.at(place, load.eccentricity), height) for place in along])
        out.append(Drawn(schema.LOADS, ends, _texts(load), Place("INSERT", "")))
    return out


def _texts(record: TieBar | LineLoad) -> dict[str, str]:
    table = {key: value for key, value in words(record).items() if not _is_point(value) and key != "between_m"}
    texts = {key.upper(): value if isinstance(value, str) else json.dumps(value) for key, value in table.items()}
    return {key: schema.check_text(f"{key} of {record.name}", text) for key, text in texts.items()}


def _is_point(value: Any) -> bool:
    return isinstance(value, dict) and "at_m" in value


def records_of(drawn: Sequence[Drawn], metre: float) -> tuple[tuple[TieBar, ...], tuple[LineLoad, ...], list[Finding]]:
    """Return what inserts on the layers of ties and loads say, and findings of what is wrong there; metre: of a drawing unit."""
    found: dict[str, list[Any]] = {layer: [] for layer in _KINDS}
    findings: list[Finding] = []
    for one in drawn:
        try:
            found[one.layer].append(_record(_KINDS[one.layer], one, metre))
        except (InputError, ValueError, TypeError, KeyError, RecursionError) as error:
            keys = ", ".join(item.key.upper() for item in declared(_KINDS[one.layer]).values() if item.name not in _ENDS)
            remedy = "Correct its attributes; docs/dxf.md has the layout."
            findings.append(
                one.place.finding("E07", f"on {one.layer}: {error}", expected=f"a line, and attributes {keys}", remedy=remedy)
            )
    return tuple(found[schema.TIES]), tuple(found[schema.LOADS]), findings


def _record(kind: type[TieBar] | type[LineLoad], one: Drawn, metre: float) -> TieBar | LineLoad:
    by_tag = {item.key.upper(): item for item in declared(kind).values()}
    given: dict[str, Any] = {}
    for tag, text in one.texts.items():
        item = by_tag.get(tag)
        if item is None:
            raise ValueError(f"unknown attribute {tag}")
        if text:
            value = text if tag in _TEXTS else _number(tag, text)
            given[item.name] = si(item.key, value)
            if item.quantity and item.name not in _ENDS:
                _check_range(kind, item, tag, text, value)
    ends = None if one.ends is None else [tuple((metre * end).tolist()) for end in one.ends]
    if kind is TieBar:
        for name, end in zip(("start", "end"), ends or (None, None), strict=True):
            given[name] = AnchorPlace(**in_si(given[name])) if name in given else end
    elif "wall" not in given:
        given["between"] = ends
    if any(given.get(name, 0) is None for name in _ENDS):
        raise ValueError("no line in the block")
    return kind(**given)


def _check_range(kind: type, item: Declared, tag: str, text: str, value: Any) -> None:
    """Raise an InputError that says in the unit of an attribute what it may be, since its record knows SI alone."""
    for part in () if value is None else value if isinstance(value, list) else [value]:
        try:
            in_range(kind, item.name, tag, si(item.key, part))
        except InputError as error:
            quantity = item.quantity or Quantity()
            limits = [(">" if quantity.above else ">=", quantity.low), ("<" if quantity.below else "<=", quantity.high)]
            said = " and ".join(f"{sign} {limit:g} {unit_of(item.key).name}" for sign, limit in limits if limit is not None)
            raise InputError(f"attribute {tag} = {text[:80]!r}", error.problem, expected=said.strip()) from error


def _number(tag: str, text: str) -> Any:
    try:
        value = json.loads(text)
    except ValueError as error:
        raise ValueError(f"attribute {tag} = {text[:80]!r} is no number") from error
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"attribute {tag} = {text[:80]!r} is no number")
    return value
