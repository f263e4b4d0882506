"""Tables of the case file made of the generators' parameter classes, where each parameter is declared once."""

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from functools import lru_cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from pydantic import BeforeValidator, Field, create_model

from churchpipe.config.section import Number, Section
from churchpipe.config.units import UNITS
from churchpipe.generators.quantities import Quantity

_Text = Annotated[str, Field(min_length=1)]


@lru_cache
def table_of(kind: type, generator: str = "") -> type[Section]:
    """Return the table whose keys are the fields of a frozen dataclass, with their units; of a generator, with its name."""
    hints = get_type_hints(kind, include_extras=True)
    keys: dict[str, Any] = {"generator": (Literal[generator], ...)} if generator else {}
    for item in fields(kind):
        annotation, suffix = _written(hints[item.name])
        default = ... if item.default is MISSING else item.default
        if isinstance(default, float):
            multiply, divide = UNITS.get(suffix, (1.0, 1.0))
            default = default * divide / multiply
        keys[item.name + suffix] = (annotation, list(default) if isinstance(default, tuple) else default)
    return create_model(kind.__name__, __base__=Section, __doc__=kind.__doc__, **keys)


def _written(hint: Any) -> tuple[Any, str]:
    """Return what a case file takes for a field, and the unit that its key ends with."""
    origin, options = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _number(options[0], options[1]), options[1].suffix
    if origin in (Union, UnionType):
        return _either(options)
    if origin is tuple:
        annotation, suffix = _written(options[0])
        return Annotated[list[annotation], Field(min_length=len(options), max_length=len(options))], suffix
    if origin is Sequence:
        annotation, suffix = _written(options[0])
        return list[annotation], suffix
    if origin is Literal:
        return hint, ""
    return (_Text if hint is str else table_of(hint)), ""


def _either(options: Sequence[Any]) -> tuple[Any, str]:
    """A thing, a mapping of its fields or nothing; or one of a kind or several."""
    kinds = [option for option in options if option is not NoneType and get_origin(option) is not Mapping]
    annotation, suffix = _written(kinds[-1])
    if len(kinds) == 2:
        either: Any = annotation | _written(kinds[0])[0]
        annotation = Annotated[annotation, BeforeValidator(_listed, json_schema_input_type=either)]
    optional: Any = annotation
    return (optional | None if NoneType in options else annotation), suffix


def _number(kind: type, quantity: Quantity) -> Any:
    low = {"gt": quantity.low} if quantity.above else {"ge": quantity.low}
    bounds: dict[str, Any] = {key: value for key, value in (low | {"le": quantity.high}).items() if value is not None}
    return Annotated[Number if kind is float else kind, Field(**bounds)]


def _listed(value: Any) -> Any:
    return value if isinstance(value, list) else [value]
