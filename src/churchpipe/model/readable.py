"""Public dataclasses as `help` shows them: plain types in their signatures, and their fields with units and meanings.

Their annotations hold what a case file says of each field, which is hundreds of characters where a reader wants one word.
"""

import inspect
from collections.abc import Callable
from functools import reduce
from types import UnionType
from typing import Any, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from churchpipe.model.quantities import UNITS, declared, unit_of

# Units of keys of a case in SI.
_OTHER = {"degrees": "rad", "t": "kg", "MPa": "Pa", "GPa": "Pa", "g": "m/s2"}
_SI = {name: name.replace("k", "").replace("mm", "m") for name in {unit.name for unit in UNITS.values()}} | _OTHER
# An annotation with more letters is none that is read.
_LONG = 60
_DONE = "__described__"


def described(kind: type) -> type:
    """Return a dataclass, with a signature and a docstring for people."""
    if _DONE in vars(kind):
        return kind
    setup: Callable[..., None] = vars(kind).get("__init__") or kind.__init__
    shown = _signature(kind, setup)
    if "__init__" in vars(kind):
        vars_of = cast("Any", setup)
        vars_of.__signature__ = shown
    own = [parameter for name, parameter in shown.parameters.items() if name != "self"]
    for name, value in (("__signature__", shown.replace(parameters=own)), ("__doc__", _doc(kind)), (_DONE, True)):
        setattr(kind, name, value)
    return kind


def _signature(kind: type, setup: Callable[..., None]) -> inspect.Signature:
    """Return the signature of `__init__` with plain types, none where it would be long."""
    of_fields, of_setup = get_type_hints(kind), get_type_hints(setup)
    found = inspect.signature(setup)
    shown: list[inspect.Parameter] = []
    for name, parameter in found.parameters.items():
        hints = (_plain(hints[name]) for hints in (of_setup, of_fields) if name in hints)
        short = next((hint for hint in hints if len(inspect.formatannotation(hint)) < _LONG), inspect.Parameter.empty)
        shown.append(parameter.replace(annotation=short))
    return found.replace(parameters=shown, return_annotation=inspect.Signature.empty)


def _plain(hint: Any) -> Any:
    """Return a type with arrays as arrays, whatever they hold."""
    if get_origin(hint) in (Union, UnionType):
        try:
            return reduce(lambda one, other: one | other, dict.fromkeys(_plain(part) for part in get_args(hint)))
        except TypeError:
            return hint
    return np.ndarray if get_origin(hint) is np.ndarray else hint


def _doc(kind: type) -> str:
    """Return the docstring with the fields that it does not describe, with their units in SI and their meanings."""
    text = inspect.cleandoc(kind.__doc__ or "")
    known = {name: item for name, item in declared(kind).items() if item.meaning}
    if not known or "\nParameters\n---" in text:
        return text
    lines = ["Fields", "------"]
    parameters = _signature(kind, kind.__init__).parameters
    for name, item in known.items():
        # Of the parameter, `name: type = default`.
        shown = str(parameters[name]).partition(":")[2].strip() if name in parameters else ""
        unit = _SI.get(unit_of(item.key).name, "") if item.quantity or unit_of(item.key).name else ""
        lines += [f"{name} : {', '.join(part for part in (shown, unit) if part)}", f"    {item.meaning}"]
    before, mark, after = text.partition("\nRaises\n------")
    return "\n".join([before.rstrip(), "", *lines]) + (f"\n{mark}{after}" if mark else "")
