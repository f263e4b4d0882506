"""Fields of parameter classes checked against their annotations, so that an error names the field as it was given."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from functools import lru_cache
from numbers import Real
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, describe, finite, listed, one_of, positive, whole
from churchpipe.model.arrays import store
from churchpipe.model.materials import UnitWeight
from churchpipe.model.quantities import Quantity

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_Kind = TypeVar("_Kind", bound="DataclassInstance")

# A longer length, m, must have been given in another unit.
_MOST = 1e5


def as_dataclass(kind: type[_Kind], where: str, value: _Kind | Mapping[str, Any]) -> _Kind:
    """Return a dataclass that is given as such or as a mapping of its fields.

    Raises
    ------
    InputError: neither; a key that it does not have, or one without a default that is missing.
    """
    if isinstance(value, kind):
        return value
    if not isinstance(value, Mapping):
        raise InputError(where, "wrong kind", found=describe(value), expected=f"{kind.__name__}, or a mapping of its fields")
    known = {item.name: item for item in fields(kind)}
    for key in value:
        if key not in known:
            raise InputError(f"{where}.{key}", "unknown key", expected=", ".join(known))
    for key, item in known.items():
        if item.default is MISSING and item.default_factory is MISSING and key not in value:
            raise InputError(f"{where}.{key}", "missing")
    return kind(**value)


def coerce_fields(instance: "DataclassInstance", prefix: str) -> None:
    """Check the fields of a frozen dataclass from inside its `__post_init__`: numbers become float or int, lists tuples.

    Raises
    ------
    InputError: a field that is not what its annotation says, named with the prefix before it.
    """
    hints = _hints(type(instance))
    values = {item.name: _fitted(prefix + item.name, getattr(instance, item.name), hints[item.name]) for item in fields(instance)}
    store(instance, **values)


def materials_of(where: str, value: Any) -> tuple[UnitWeight, ...]:
    """Return the materials of a building, one at least."""
    materials = tuple(listed(f"{where}.materials", value, UnitWeight))
    if not materials:
        raise InputError(f"{where}.materials", "no material", expected="at least one Material, or UnitWeight")
    return materials


@lru_cache
def _hints(kind: type[Any]) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)


def _fitted(where: str, value: Any, hint: Any, quantity: Quantity | None = None) -> Any:
    """Return a value checked against an annotation; quantity: that of its numbers."""
    origin, options = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _fitted(where, value, options[0], next((extra for extra in options[1:] if isinstance(extra, Quantity)), quantity))
    if origin in (Union, UnionType):
        return _one_of_kinds(where, value, options, quantity)
    if origin is Literal:
        one_of(where, value, *options)
        return value
    if origin is tuple or origin is Sequence:
        items = enumerate(_items(where, value))
        return tuple(_fitted(f"{where}[{number}]", item, options[0], quantity) for number, item in items)
    if quantity is not None and hint in (int, float):
        return _number(where, value, hint, quantity)
    check_kind(where, value, hint if origin is None else origin)
    return value


def _number(where: str, value: Any, kind: type, quantity: Quantity) -> float | int:
    """Return a number within the range that its quantity declares."""
    if kind is int:
        return whole(where, value, least=int(quantity.low or 0), most=None if quantity.high is None else int(quantity.high))
    if quantity.low is not None:
        positive(where, value, allow_zero=not quantity.above)
    number = finite(where, value)
    if abs(number) > _MOST:
        raise InputError(where, "out of range", found=value, expected=f"at most {_MOST:g} m")
    return number


def _one_of_kinds(where: str, value: Any, options: Sequence[Any], quantity: Quantity | None) -> Any:
    """Return a value of one of several kinds: nothing, a thing, a mapping of its fields, or a list of such."""
    if value is None and NoneType in options:
        return None
    kinds = [option for option in options if option is not NoneType]
    if len(kinds) == 1:
        return _fitted(where, value, kinds[0], quantity)
    table: Any = next((kind for kind in kinds if is_dataclass(kind)), None)
    if table is not None:
        if not isinstance(value, (table, Mapping)):
            raise InputError(where, "wrong kind", found=describe(value), expected=f"{table.__name__}, or a mapping of its fields")
        return cast("Any", value)
    several, single = sorted(kinds, key=lambda kind: get_origin(kind) is not Sequence)
    return _fitted(where, value, single if isinstance(value, str if single is str else Real) else several, quantity)


def _items(where: str, value: Any) -> list[Any]:
    error = InputError(where, "not a list", found=describe(value), expected="a list")
    if isinstance(value, str | bytes | Mapping | set | frozenset) or not isinstance(value, Iterable):
        raise error
    try:
        return list(cast("Iterable[Any]", value))
    except TypeError:
        # An array without a dimension calls itself iterable.
        raise error from None
