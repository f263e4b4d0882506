"""What a field of a dataclass (SI) is in a case file: its key with the unit, its range, and what it means, declared once.

    unit_weight: Annotated[float, Quantity("_kN_m3", 0.0, above=True), "Weight of the stones."]

`declared` reads it: the tables of the case file (`config.tables`), the properties of a drawing (`dxf.properties`), the questions
about doubtful values (`config.plausible`) and the checks of the generators' parameters (`generators.fields`) are made of it.
"""

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import lru_cache
from types import NoneType, UnionType
from typing import Annotated, Any, NamedTuple, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from churchpipe.errors import InputError
from churchpipe.model.arguments import finite

_COMPARE = {">": operator.gt, ">=": operator.ge, "<": operator.lt, "<=": operator.le}
# Standard gravity, m/s2.
GRAVITY = 9.80665
MOST_COUNTED = 1_000_000


class Unit(NamedTuple):
    """A unit by its name; its value in SI is multiply / divide: dividing by 1000 rounds correctly, times 0.001 does not."""

    name: str
    multiply: float = 1.0
    divide: float = 1.0


NO_UNIT = Unit("")
# By the end of the keys that have it.
UNITS = {
    "_mm": Unit("mm", divide=1e3),
    "_mm2": Unit("mm2", divide=1e6),
    "_m": Unit("m"),
    "_deg": Unit("degrees", math.pi, 180.0),
    "_kN_m3": Unit("kN/m3", 1e3),
    "_kN": Unit("kN", 1e3),
    "_kN_m": Unit("kN/m", 1e3),
    "_kN_m2": Unit("kN/m2", 1e3),
    "_kNm": Unit("kNm", 1e3),
    "_t": Unit("t", 1e3),
    "_kPa": Unit("kPa", 1e3),
    "_MPa": Unit("MPa", 1e6),
    "_GPa": Unit("GPa", 1e9),
    "_m_s2": Unit("m/s2"),
    "_g": Unit("g", GRAVITY),
    "_s": Unit("s"),
    "_percent": Unit("%"),
    "_1_kN": Unit("1/kN", divide=1e3),
    "_1_kPa": Unit("1/kPa", divide=1e3),
    # What something becomes with so much more.
    "_10_kN": NO_UNIT,
    "_10_kPa": NO_UNIT,
}


class Usual(NamedTuple):
    """A range that a quantity has in practice, in the unit of its key, and what the range rests on."""

    low: float
    high: float
    reason: str


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number of a case file; its values are in the unit of its key.

    suffix: of the key, the unit. low: what it is not below, or, with `above`, is above; high, below: likewise.
    usual: outside of it a value is questioned. span: in SI, beyond it a number is in another unit or lost to rounding. key: the
    whole key, where it is not the field's name with the suffix. other: a key with another unit that may be given instead.
    """

    suffix: str = ""
    low: float | None = None
    above: bool = False
    high: float | None = None
    below: bool = False
    usual: Usual | None = None
    span: tuple[float, float] | None = None
    key: str = ""
    other: str = ""


# In m; a key of [source] in _mm may be written in _m as well.
Length = Annotated[float, Quantity("_mm", 0.0, above=True)]
Distance = Annotated[float, Quantity("_mm", 0.0)]
Coordinate = Annotated[float, Quantity("_mm")]
Place = tuple[Coordinate, Coordinate, Coordinate]
# In rad.
Angle = Annotated[float, Quantity("_deg", 0.0, above=True)]
Ratio = Annotated[float, Quantity("", 0.0, above=True)]
Count = Annotated[int, Quantity("", 1, high=MOST_COUNTED)]
Whole = Annotated[int, Quantity("", 0)]


class Declared(NamedTuple):
    """A field as a case file has it.

    key: its key; other: another one for it, or "". default: MISSING where there is none. tables: the dataclasses of which it
    holds one or several. meaning: in a sentence, or "". hint: its annotation.
    """

    name: str
    key: str
    other: str
    default: Any
    quantity: Quantity | None
    tables: tuple[type, ...]
    meaning: str
    hint: Any

    @property
    def table(self) -> type | None:
        """The one dataclass that it holds, or the first of several; None."""
        return self.tables[0] if self.tables else None


@lru_cache
def declared(kind: type) -> dict[str, Declared]:
    """Return the fields of a dataclass by their names, as they are declared."""
    hints = get_type_hints(kind, include_extras=True)
    out: dict[str, Declared] = {}
    for item in fields(kind):
        hint, quantity = hints[item.name], _found(hints[item.name], Quantity)
        key = (quantity.key or item.name + quantity.suffix) if quantity else item.name
        other = quantity.other if quantity else ""
        default = item.default if item.default_factory is MISSING else item.default_factory()
        out[item.name] = Declared(item.name, key, other, default, quantity, _tables(hint), _found(hint, str) or "", hint)
    return out


def unit_of(key: str) -> Unit:
    """Return the unit that a key ends with."""
    return UNITS.get(_suffix(key), NO_UNIT)


def bare(key: str) -> str:
    """Return a key without its unit."""
    return key.removesuffix(_suffix(key))


def si(key: str, value: Any) -> Any:
    """Return the value of a key in SI; lists become tuples, and what is no number stays."""
    if isinstance(value, list | tuple):
        return tuple(si(key, item) for item in cast("Sequence[Any]", value))
    unit = unit_of(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or unit.multiply == unit.divide:
        return value
    return value * unit.multiply / unit.divide


def written(key: str, value: Any, *, defaults: bool = True) -> Any:
    """Return a value (SI) in the unit of its key; tuples become lists, dataclasses tables: `as_written`."""
    if isinstance(value, list | tuple):
        return [written(key, item, defaults=defaults) for item in cast("Sequence[Any]", value)]
    if isinstance(value, dict):
        return {name: written(key, item, defaults=defaults) for name, item in cast("dict[str, Any]", value).items()}
    if is_dataclass(value):
        return as_written(value, defaults=defaults)
    unit = unit_of(key)
    return value * unit.divide / unit.multiply if isinstance(value, float) and unit.multiply != unit.divide else value


def in_si(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with units taken out of its keys and values in SI; nested tables too."""
    return {bare(key): _nested(key, value) for key, value in table.items()}


def as_written(record: Any, *, defaults: bool = True) -> dict[str, Any]:
    """Return the fields of a dataclass by their keys, in their units; dataclasses in it are tables.

    None is left out of fields that have a default. defaults: whether values that are the default of their field are there; a NaN
    that is the default is one of them.
    """
    out: dict[str, Any] = {}
    for item in declared(record.__class__).values():
        value = getattr(record, item.name)
        known = value is not None and (defaults or (value is not item.default and value != item.default))
        if item.default is MISSING or known:
            out[item.key] = written(item.key, value, defaults=defaults)
    return out


Kind = TypeVar("Kind")


def as_read(kind: type[Kind], table: Mapping[str, Any], *, units: bool = True) -> Kind:
    """Return the dataclass that a table was made of: by `as_written`, or, units False, by `dataclasses.asdict`.

    None is NaN where a number must stand, as JSON has it; keys of no field are left out, and fields that a dataclass sets itself.
    """
    own = {item.name for item in fields(cast("Any", kind)) if item.init}
    keys = {(item.key if units else name): item for name, item in declared(kind).items() if name in own}
    return kind(**{item.name: _read(item, table[key], units) for key, item in keys.items() if key in table})


def required(kind: type) -> list[str]:
    """Return the keys of the fields that have no default."""
    return [item.key for item in declared(kind).values() if item.default is MISSING]


# No force or stress in a building is so large, N or Pa; the squares of what is larger are no numbers.
_MOST = 1e30


def in_range(kind: type, name: str, where: str, value: object) -> float:
    """Return a number (SI), if it is one that a field of a dataclass may have.

    where: the field, for messages.

    Raises
    ------
    InputError: no finite number, or one out of the range that the field declares.
    """
    item, number = declared(kind)[name], finite(where, value)
    quantity = item.quantity or Quantity()
    bounds = [(">" if quantity.above else ">=", quantity.low), ("<" if quantity.below else "<=", quantity.high)]
    limits = [(sign, si(item.key, limit)) for sign, limit in bounds if limit is not None]
    if abs(number) > _MOST and any(part in unit_of(item.key).name for part in ("N", "Pa")):
        limits.append(("<=", _MOST))
    if not all(_COMPARE[sign](number, limit) for sign, limit in limits):
        expected = " and ".join(f"{sign} {limit:.6g}" for sign, limit in limits)
        raise InputError(where, "out of range", found=value, expected=expected)
    return number


def check_ranges(record: Any, where: str, *names: str) -> None:
    """Raise an InputError, as `in_range` does, unless fields of a dataclass are numbers, or tuples of numbers, in range.

    None and tuples are for fields that are declared so. where: what stands before the name of the field in messages. names: of
    the fields; by default all with a quantity.
    """
    kind = record.__class__
    for name in names or [name for name, item in declared(kind).items() if item.quantity]:
        value, allowed = getattr(record, name), _kinds(declared(kind)[name].hint)
        parts: Sequence[object] = (value,)
        if isinstance(value, tuple) and tuple in allowed:
            parts = cast("tuple[object, ...]", value)
        for part in parts if value is not None or NoneType not in allowed else ():
            in_range(kind, name, f"{where}{name}", part)


def in_unit(record: Any, name: str) -> tuple[Any, str]:
    """Return the value of a field in the unit of its key, and the name of that unit."""
    key = declared(record.__class__)[name].key
    return written(key, getattr(record, name)), unit_of(key).name


def _read(item: Declared, value: Any, units: bool) -> object:
    if item.tables:
        if isinstance(value, list):
            return tuple(_one_of(item.tables, one, units) for one in cast("list[Any]", value))
        if isinstance(value, dict) and _of_names(item.hint):
            return {name: _one_of(item.tables, one, units) for name, one in cast("dict[str, Any]", value).items()}
        return None if value is None else _one_of(item.tables, cast("dict[str, Any]", value), units)
    key = item.key if units else ""
    if isinstance(value, dict):
        none = math.nan if get_args(item.hint)[1:] == (float,) else None
        values = {name: si(key, part) for name, part in cast("dict[str, Any]", value).items()}
        return {name: none if part is None else part for name, part in values.items()}
    value = si(key, value)
    if isinstance(value, tuple):
        return tuple(math.nan if part is None else part for part in cast("tuple[Any, ...]", value))
    number = (get_args(item.hint)[0] if get_origin(item.hint) is Annotated else item.hint) is float
    return math.nan if value is None and number else cast("object", value)


def _one_of(kinds: Sequence[type[Any]], table: Mapping[str, Any], units: bool) -> object:
    """Return the first of several dataclasses that has all keys of a table, or else the first."""
    keys = [{item.key if units else name for name, item in declared(kind).items()} for kind in kinds]
    fitting = (kind for kind, known in zip(kinds, keys, strict=True) if known >= table.keys())
    return as_read(next(fitting, kinds[0]), table, units=units)


def _of_names(hint: Any) -> bool:
    """Whether a field holds its dataclasses by name."""
    return get_origin(hint) is dict or (get_origin(hint) is Annotated and _of_names(get_args(hint)[0]))


def _suffix(key: str) -> str:
    return max((suffix for suffix in UNITS if key.endswith(suffix)), key=len, default="")


def _nested(key: str, value: Any) -> Any:
    if isinstance(value, dict):
        return in_si(cast("dict[str, Any]", value))
    if isinstance(value, list):
        return tuple(_nested(key, item) for item in cast("list[Any]", value))
    return si(key, value)


def _found(hint: Any, kind: type) -> Any:
    """Return the first thing of a kind that an annotation, or one inside it, carries; None."""
    extras = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
    own = next((extra for extra in extras if isinstance(extra, kind)), None)
    if own is not None or get_origin(hint) is None:
        return own
    inner = get_args(hint)[:1] if extras else get_args(hint)
    return next((found for part in inner if (found := _found(part, kind)) is not None), None)


def _kinds(hint: Any) -> set[Any]:
    """Return what a field may be: the types of its annotation, that of tuples bare."""
    if get_origin(hint) is Annotated:
        return _kinds(get_args(hint)[0])
    if get_origin(hint) in (Union, UnionType):
        return {kind for part in get_args(hint) for kind in _kinds(part)}
    return {get_origin(hint) or hint}


def _tables(hint: Any) -> tuple[type, ...]:
    """Return the dataclasses of which a field holds one or several."""
    if isinstance(hint, type) and is_dataclass(hint):
        return (hint,)
    return tuple(found for part in get_args(hint) for found in _tables(part))
