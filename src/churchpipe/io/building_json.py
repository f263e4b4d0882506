"""A `Building` as JSON that a person can read."""

import json
from dataclasses import MISSING, Field, fields, is_dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np

from churchpipe.errors import InputError
from churchpipe.io.atomic import write_json
from churchpipe.model.arguments import check_kind
from churchpipe.model.building import BondRegion, Building, Chart, Junction, Opening, Panel, Part, Support, UnitCell
from churchpipe.model.materials import Elastic, Material, UnitWeight
from churchpipe.model.ring_beam import RingBeam
from churchpipe.model.vault import Run, Section, Side, Vault

SCHEMA = "churchpipe building 1"

_TYPES = {
    kind.__name__: kind
    for kind in (
        *(Building, RingBeam, Panel, Junction, Part, BondRegion, UnitCell, Opening, *get_args(Chart), Support),
        *(Vault, Run, Section, Side, UnitWeight, Material, Elastic),
    )
}


def write_building(path: str | Path, building: Building) -> None:
    """Write a building; each object names its type, arrays are lists, lengths are metres."""
    write_json(path, {"schema": SCHEMA, "building": _encode(building)})


def read_building(path: str | Path) -> Building:
    """Read a building.

    Raises
    ------
    InputError: not such a file, or one of another version.
    """
    try:
        stored = json.loads(Path(path).read_text(encoding="utf-8"))
        schema = stored.get("schema", "no schema") if isinstance(stored, dict) else "no schema"
        if schema == SCHEMA:
            building = _decode(stored["building"])
            check_kind("building", building, Building)
            return building
    except OSError as error:
        raise InputError(str(path), "cannot be read", found=error.strerror or error, expected=f'a file "{SCHEMA}"') from error
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(
            str(path), "damaged", found=error, expected=f'a file "{SCHEMA}"', remedy="Delete it and run the case again."
        ) from error
    raise InputError(str(path), "another schema", found=schema, expected=SCHEMA, remedy="Delete it and run the case again.")


def _encode(value: Any) -> Any:
    if is_dataclass(value):
        kept = {field.name: getattr(value, field.name) for field in fields(value) if not _empty_by_default(value, field)}
        return {"type": type(value).__name__} | {name: _encode(own) for name, own in kept.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [_encode(item) for item in value]
    return value


def _empty_by_default(owner: Any, field: Field[Any]) -> bool:
    """Return whether a field is an array without rows, as it is by default: a list of nothing would not tell its width."""
    value = getattr(owner, field.name)
    return field.default_factory is not MISSING and isinstance(value, np.ndarray) and not value.size


def _decode(value: Any) -> Any:
    if isinstance(value, dict):
        return _TYPES[value["type"]](**{key: _decode(item) for key, item in value.items() if key != "type"})
    if isinstance(value, list):
        return tuple(_decode(item) for item in value)
    return value
