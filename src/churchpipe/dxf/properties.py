"""Materials and loads as custom properties of the document, in the words of the case file."""

import json
import math
from collections.abc import Sequence
from dataclasses import MISSING
from typing import Any, Final, TypeVar

from churchpipe.dxf.schema import LOAD_PROPERTY, MATERIAL_PROPERTY, check_text
from churchpipe.errors import InputError
from churchpipe.findings import Finding
from churchpipe.model.loads import LoadCase, load_table
from churchpipe.model.materials import Material
from churchpipe.model.quantities import Declared, as_written, declared, si

# A DXF string holds 2049 bytes.
LONGEST_PROPERTY: Final = 2000

Property = tuple[str, str]
_Kind = TypeVar("_Kind")


def encode_materials(materials: Sequence[Material]) -> list[Property]:
    """Return one property a material: `CP_MATERIAL_<name>` and its constants as JSON."""
    tables = ((material.name, as_written(material)) for material in materials)
    return [_encode(MATERIAL_PROPERTY, name, {key: table[key] for key in table if key != "name"}) for name, table in tables]


def encode_loads(loads: Sequence[LoadCase]) -> list[Property]:
    """Return one property a load; extra wrenches belong to stones, not to a document: an `InputError`."""
    out: list[Property] = []
    for load in loads:
        if load.dead is not None or load.live is not None:
            raise InputError(f"load {load.name}", "a drawing cannot hold extra wrenches", expected="dead and live = None")
        table = {key: value for key, value in load_table(load).items() if key != "name"}
        out.append(_encode(LOAD_PROPERTY, load.name, table))
    return out


def decode_properties(properties: Sequence[Property]) -> tuple[tuple[Material, ...], tuple[LoadCase, ...], list[Finding]]:
    """Return the materials and loads stored in a document, and a finding for each that cannot be understood."""
    materials: list[Material] = []
    loads: list[LoadCase] = []
    findings: list[Finding] = []
    for tag, text in properties:
        try:
            if tag.startswith(MATERIAL_PROPERTY):
                materials.append(_record(Material, json.loads(text), name=tag.removeprefix(MATERIAL_PROPERTY)))
            elif tag.startswith(LOAD_PROPERTY):
                loads.append(_load(tag.removeprefix(LOAD_PROPERTY), json.loads(text)))
        except (ValueError, TypeError, AttributeError, RecursionError) as error:
            kind = LoadCase if tag.startswith(LOAD_PROPERTY) else Material
            keys = _keys(kind, "name")
            findings.append(
                Finding(
                    "E16",
                    f"document property {tag} = {text[:80]!r} ({error})",
                    expected=f"JSON with the keys {', '.join(keys)}",
                    remedy="Correct or delete it among the drawing's custom properties (DWGPROPS).",
                )
            )
    for kind, names in (("material", [m.name for m in materials]), ("load", [c.name for c in loads])):
        findings += [Finding("E16", f"{kind} {n!r} is stored twice") for n in dict.fromkeys(names) if names.count(n) > 1]
    return tuple(materials), tuple(loads), findings


def _encode(prefix: str, name: str, table: dict[str, Any]) -> Property:
    tag = check_text(f"{prefix}{name}", prefix + name)
    text = json.dumps(table, separators=(", ", ": "), allow_nan=False)
    if len(text) > LONGEST_PROPERTY:
        raise InputError(tag, "too long for a document property", found=len(text), expected=f"{LONGEST_PROPERTY} characters")
    return tag, text


def _keys(kind: type, *without: str) -> dict[str, Declared]:
    return {item.key: item for item in declared(kind).values() if item.meaning and item.name not in without}


def _record(kind: type[_Kind], table: dict[str, Any], **given: Any) -> _Kind:
    """Return a dataclass of numbers, and of dataclasses of numbers, from the keys of a case file."""
    known = _keys(kind, *given)
    _check_keys(table, set(known), {key for key, item in known.items() if item.default is MISSING})
    for key, value in table.items():
        inner = known[key].table
        if inner is None:
            given[known[key].name] = si(key, _number(key, value))
        elif value is not None:
            given[known[key].name] = _record(inner, value)
    return kind(**given)


def _load(name: str, table: dict[str, Any]) -> LoadCase:
    _check_keys(table, set(_keys(LoadCase, "name")), set() if "multiplies" in table else {"direction"})
    names = {key: table.get(key) for key in ("panels", "multiplies")}
    for key, value in names.items():
        if value is not None and not (isinstance(value, list) and all(isinstance(one, str) for one in value)):
            raise ValueError(f"{key} is not a list of names")
    return LoadCase(table.get("direction"), name=name, profile=table.get("profile", "uniform"), **names)


def _check_keys(table: dict[str, Any], allowed: set[str], required: set[str]) -> None:
    unknown, missing = sorted(table.keys() - allowed), sorted(required - table.keys())
    if unknown or missing:
        raise ValueError("; ".join([f"unknown key {k}" for k in unknown] + [f"{k} is missing" for k in missing]))


def _number(key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{key} is not a number")
    return float(value)
