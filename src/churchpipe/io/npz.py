"""Frozen dataclasses of arrays as .npz files: no pickle, the schema inside."""

import json
import struct
import zlib
from collections.abc import Callable
from dataclasses import asdict, astuple, dataclass, fields
from pathlib import Path
from tokenize import TokenError
from typing import Any, TypeVar
from zipfile import BadZipFile

import numpy as np

from churchpipe.errors import InputError
from churchpipe.io.atomic import replacing
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.contacts import Contacts, ContactTolerances, NearMisses
from churchpipe.model.results import CapacityCurve, CapacityStep, Iteration, LimitState, ShellLimitState, StartRun
from churchpipe.model.settlement import SettlementPath
from churchpipe.model.shell import ShellModel
from churchpipe.model.shell_beams import ShellBeams
from churchpipe.model.stone_path import FallenStones, LastStep


@dataclass(frozen=True, slots=True)
class Absent:
    """Stands in the place of an artifact that cannot be made, and says why."""

    reason: str


# Raise the number when the fields of a type change: an artifact of another version is then named, not misread.
SCHEMAS: dict[type, str] = {
    Assemblage: "churchpipe assemblage 2",
    Contacts: "churchpipe contacts 2",
    LimitState: "churchpipe limit-state 2",
    ShellModel: "churchpipe shell 4",
    ShellLimitState: "churchpipe shell-limit-state 3",
    CapacityCurve: "churchpipe capacity-curve 2",
    BlockCapacityCurve: "churchpipe block-capacity-curve 5",
    SettlementPath: "churchpipe settlement-path 5",
    Absent: "churchpipe absent 1",
}


def _start_run(
    start: str, load_factor: float, converged: bool, gap: float, interval: list[float], history: list[Any]
) -> StartRun:
    low, high = interval
    return StartRun(start, load_factor, converged, gap, (low, high), tuple(Iteration(*step) for step in history))


# Tuples of small records, by the name of their field, and how each is made of what lies in the file.
_RECORDS: dict[str, Callable[..., Any]] = {
    "history": Iteration,
    "steps": CapacityStep,
    "starts": _start_run,
    "fallen": FallenStones,
}

# Fields that are dataclasses in turn; an array of theirs is stored as "field.name".
_PARTS: dict[str, type] = {"near_misses": NearMisses, "tolerances": ContactTolerances, "beams": ShellBeams, "last": LastStep}

# What zipfile, zlib, NumPy's header, JSON and our own checks raise at a damaged file.
DAMAGE = (
    *(BadZipFile, zlib.error, struct.error, EOFError, ValueError, KeyError, IndexError, TypeError, AttributeError, SyntaxError),
    *(NotImplementedError, RuntimeError, OverflowError, MemoryError, TokenError),
)

Artifact = TypeVar(
    "Artifact", Assemblage, Contacts, LimitState, ShellModel, ShellLimitState, CapacityCurve, BlockCapacityCurve, SettlementPath
)


def write_npz(
    path: str | Path,
    value: Assemblage
    | Contacts
    | LimitState
    | ShellModel
    | ShellLimitState
    | CapacityCurve
    | BlockCapacityCurve
    | SettlementPath
    | Absent,
) -> None:
    """Write an artifact: arrays as arrays, everything else as one JSON text."""
    values = {field.name: getattr(value, field.name) for field in fields(value)}
    for name in [name for name in values if name in _PARTS]:
        values |= {f"{name}.{key}": item for key, item in asdict(values.pop(name)).items()}
    arrays: dict[str, Any] = {name: item for name, item in values.items() if isinstance(item, np.ndarray)}
    rest = {name: item for name, item in values.items() if name not in arrays}
    rest |= {name: [astuple(record) for record in rest[name]] for name in _RECORDS if name in rest}
    with replacing(path) as part, part.open("wb") as file:
        np.savez_compressed(file, schema=SCHEMAS[type(value)], fields=json.dumps(rest, default=_plain), **arrays)


def _plain(value: Any) -> Any:
    """Return a number or an array of NumPy as JSON has it."""
    return value.tolist()


def read_npz(path: str | Path, kind: type[Artifact]) -> Artifact:
    """Read an artifact of the given type.

    Raises
    ------
    InputError: not such a file, one of another version, or one that could not be made.
    """
    found = read_if_made(path, kind)
    if isinstance(found, Absent):
        raise InputError(str(path), "could not be made", found=found.reason)
    return found


def read_if_made(path: str | Path, kind: type[Artifact]) -> Artifact | Absent:
    """Read an artifact of the given type, or why there is none.

    Raises
    ------
    InputError: not such a file, or one of another version.
    """
    return _read(path, {SCHEMAS[known]: known for known in (kind, Absent)})


def read_any(path: str | Path) -> Any:
    """Read an artifact of whatever type.

    Raises
    ------
    InputError: not such a file, one of another version, or one that could not be made.
    """
    found = _read(path, {schema: kind for kind, schema in SCHEMAS.items()})
    if isinstance(found, Absent):
        raise InputError(str(path), "could not be made", found=found.reason)
    return found


def _read(path: str | Path, kinds: dict[str, type]) -> Any:
    """Read an artifact of one of the types, by their schemas."""
    wanted = next(iter(kinds)) if len(kinds) <= 2 else "churchpipe ..."
    expected = f'a file "{wanted}"'
    try:
        with np.load(path, allow_pickle=False) as file:
            stored: dict[str, Any] = {name: file[name] for name in file.files}
        schema = str(stored.pop("schema", "no schema"))
        if schema in kinds:
            return _made(kinds[schema], stored)
    except OSError as error:
        raise InputError(str(path), "cannot be read", found=error.strerror or error, expected=expected) from error
    except DAMAGE as error:
        # What NumPy says of a damaged file advises to unpickle it.
        problem = "damaged, or not a file of churchpipe"
        # Whoever names a wrong file, such as a script, must not be told to delete it.
        remedy = "Name a file that churchpipe wrote; if it is one of a run, delete it and run the case again."
        raise InputError(str(path), problem, found=type(error).__name__, expected=expected, remedy=remedy) from error
    raise InputError(str(path), "another schema", found=schema, expected=wanted, remedy="Delete the file and run the case again.")


def _made(kind: type[Any], stored: dict[str, Any]) -> Any:
    rest: dict[str, Any] = {
        name: tuple(item) if isinstance(item, list) else item for name, item in json.loads(str(stored.pop("fields"))).items()
    }
    rest |= {name: tuple(record(*item) for item in rest[name]) for name, record in _RECORDS.items() if name in rest}
    values = {**stored, **rest}
    parts = {name: {key: values.pop(key) for key in list(values) if key.startswith(f"{name}.")} for name in _PARTS}
    values |= {
        name: _PARTS[name](**{key.partition(".")[2]: item for key, item in part.items()}) for name, part in parts.items() if part
    }
    return kind(**values)
