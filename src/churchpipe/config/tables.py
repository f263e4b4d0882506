"""Tables of the case file, made of the dataclasses (SI) where each of their keys is declared once, and read back into them."""

import inspect
import re
from collections.abc import Mapping, Sequence
from dataclasses import MISSING
from functools import lru_cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

import numpy as np
from pydantic import BeforeValidator, create_model
from pydantic import Field as Key

from churchpipe.config.section import Number, Section, Vector
from churchpipe.errors import InputError
from churchpipe.model.quantities import Declared, Quantity, declared, si, written

# In the schema of a key that a run needs and a file may leave open.
NEEDED = "x-needed"
_Record = TypeVar("_Record")
_Text = Annotated[str, Key(min_length=1, max_length=200)]


def table_of(kind: type, title: str, without: Sequence[str] = (), may_lack: Sequence[str] = (), **keys: Any) -> type[Section]:
    """Return the table whose keys are the fields of a frozen dataclass, with their units.

    Parameters
    ----------
    title: of the table in the reference. without: fields that are no keys. may_lack: fields that a file may leave open.
    keys: more of them, as `pydantic.create_model` takes them.
    """
    for item in declared(kind).values():
        if item.name in without:
            continue
        left_open, meaning = item.name in may_lack or bool(item.other), item.meaning
        if item.other:
            meaning += f" Either `{item.key}` or `{item.other}`."
        default = ... if item.default is MISSING else written(item.key, item.default)
        default = None if left_open else default
        about = Key(default, description=meaning, json_schema_extra={NEEDED: True} if left_open else None)
        annotation = _annotation(item.hint)
        takes = annotation | None if default is None else annotation
        keys |= dict.fromkeys(filter(None, (item.key, item.other)), (takes, about))
    text = inspect.cleandoc(kind.__doc__ or "").partition("\n\n")[0]
    return create_model(title, __base__=Section, __doc__=text, **keys)


def record(kind: type[_Record], table: Mapping[str, Any], place: str, **given: Any) -> _Record:
    """Return a dataclass of a checked table, in SI.

    Parameters
    ----------
    table: by the keys of the file; what it lacks has the default of its field. place: of the table, for messages.
    given: fields that are no keys.

    Raises
    ------
    InputError: values that contradict each other; both or none of two keys for one field.
    """
    known = declared(kind)
    for item in known.values():
        keys = [key for key in (item.key, item.other) if key in table]
        if item.other and len(keys) != 1:
            problem = f"two values for one {item.name.rpartition('_')[2]}" if keys else "missing key"
            raise InputError(place, problem, expected=f"either {item.other} or {item.key}")
        for key in keys:
            given[item.name] = _value(item, key, table[key], f"{place}.{key}")
    try:
        return kind(**given)
    except InputError as error:
        item = known.get(error.where.rpartition(": ")[2])
        where = f"{place}.{item.key}" if item else place
        raise InputError(
            where, error.problem, found=error.found, expected=_by_keys(error.expected, known), remedy=error.remedy
        ) from error


def _by_keys(words: str, known: Mapping[str, Declared]) -> str:
    """Return what a dataclass expects with its fields by the keys that the file has for them."""
    keys = {name: item.key for name, item in known.items() if item.key != name}
    return re.sub(rf"\b({'|'.join(keys)})\b(?!_)", lambda name: keys[name[1]], words) if keys else words


def _value(item: Declared, key: str, value: Any, place: str) -> Any:
    if item.table is None:
        return si(key, value)
    if isinstance(value, list):
        return tuple(record(item.table, part, f"{place}.{number}") for number, part in enumerate(value))
    return record(item.table, value, place)


@lru_cache
def _inner(kind: type) -> type[Section]:
    """Return the table of a dataclass inside another one, one for all places."""
    return table_of(kind, kind.__name__)


def _annotation(hint: Any, quantity: Quantity | None = None) -> Any:
    """Return what a case file takes for a field; quantity: that of its numbers."""
    origin, options = get_origin(hint), get_args(hint)
    if origin is Annotated:
        checks = [extra for extra in options[1:] if not isinstance(extra, str | Quantity)]
        inner = _annotation(options[0], next((extra for extra in options[1:] if isinstance(extra, Quantity)), quantity))
        return Annotated[inner, *checks] if checks else inner
    if origin in (Union, UnionType):
        return _either(options, quantity)
    if origin is Sequence or (origin is tuple and options[1:] == (...,)):
        return list[_annotation(options[0], quantity)]
    if origin is tuple:
        return Annotated[list[_annotation(options[0], quantity)], Key(min_length=len(options), max_length=len(options))]
    if origin is np.ndarray:
        return Vector
    if origin in (Literal, dict) or hint is bool:
        return hint
    if hint in (int, float):
        return _number(hint, quantity or Quantity())
    return _Text if hint is str else _inner(hint)


def _either(options: Sequence[Any], quantity: Quantity | None) -> Any:
    """A thing, a mapping of its fields or nothing; or one of a kind or several."""
    kinds = [option for option in options if option is not NoneType and get_origin(option) is not Mapping]
    annotation: Any = _annotation(kinds[-1], quantity)
    if len(kinds) == 2:
        either: Any = annotation | _annotation(kinds[0], quantity)
        annotation = Annotated[annotation, BeforeValidator(listed, json_schema_input_type=either)]
    return annotation | None if NoneType in options else annotation


def _number(kind: type, quantity: Quantity) -> Any:
    low, high = "gt" if quantity.above else "ge", "lt" if quantity.below else "le"
    bounds: dict[str, Any] = {key: value for key, value in ((low, quantity.low), (high, quantity.high)) if value is not None}
    return Annotated[Number if kind is float else kind, Key(**bounds)]


def listed(value: Any) -> Any:
    """Return one thing as a list of it."""
    return value if isinstance(value, list) else [value]
