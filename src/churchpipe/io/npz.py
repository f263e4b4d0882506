"""Frozen dataclasses of arrays as .npz files: no pickle, the schema inside."""

import json
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar
from zipfile import BadZipFile

import numpy as np

from churchpipe.errors import InputError
from churchpipe.io.atomic import replacing
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.results import Iteration, LimitState

# Raise the number when the fields of a type change: an artifact of another version is then named, not misread.
SCHEMAS: dict[type, str] = {
    Assemblage: "churchpipe assemblage 1",
    Contacts: "churchpipe contacts 1",
    LimitState: "churchpipe limit-state 1",
}

Artifact = TypeVar("Artifact", Assemblage, Contacts, LimitState)


def write_npz(path: str | Path, value: Assemblage | Contacts | LimitState) -> None:
    """Write an artifact: arrays as arrays, everything else as one JSON text."""
    values = {field.name: getattr(value, field.name) for field in fields(value)}
    arrays: dict[str, Any] = {name: item for name, item in values.items() if isinstance(item, np.ndarray)}
    rest = {name: item for name, item in values.items() if name not in arrays}
    if "history" in rest:
        rest["history"] = [(step.load_factor, step.violation, step.gap) for step in rest["history"]]
    with replacing(path) as part, part.open("wb") as file:
        np.savez_compressed(file, schema=SCHEMAS[type(value)], fields=json.dumps(rest), **arrays)


def read_npz(path: str | Path, kind: type[Artifact]) -> Artifact:
    """Read an artifact of the given type.

    Raises
    ------
    InputError: not such a file, or one of another version.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            stored: dict[str, Any] = {name: file[name] for name in file.files}
    except (BadZipFile, ValueError, EOFError, OSError) as error:
        raise InputError(str(path), "cannot be read", found=error, expected=f'a file "{SCHEMAS[kind]}"') from error
    schema = str(stored.pop("schema", "no schema"))
    if schema != SCHEMAS[kind]:
        raise InputError(
            str(path), "another schema", found=schema, expected=SCHEMAS[kind], remedy="Delete the file and run the case again."
        )
    rest: dict[str, Any] = {
        name: tuple(item) if isinstance(item, list) else item for name, item in json.loads(str(stored.pop("fields"))).items()
    }
    if "history" in rest:
        rest["history"] = tuple(Iteration(*step) for step in rest["history"])
    return kind(**stored, **rest)
