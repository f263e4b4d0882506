"""Materials and loads as custom properties of the document, in the words of the case file."""

import json
import math
from collections.abc import Sequence
from typing import Any, Final

from churchpipe.dxf.schema import LOAD_PROPERTY, MATERIAL_PROPERTY, check_text
from churchpipe.errors import InputError
from churchpipe.findings import Finding
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material

# Key of the case file -> field and SI factor.
MATERIAL_KEYS: Final = {
    "unit_weight_kN_m3": ("unit_weight", 1e3),
    "friction": ("friction", 1.0),
    "cohesion_kPa": ("cohesion", 1e3),
}
ELASTIC_KEYS: Final = {
    "block_E_GPa": ("block_modulus", 1e9),
    "block_nu": ("block_poisson", 1.0),
    "joint_E_GPa": ("joint_modulus", 1e9),
    "joint_nu": ("joint_poisson", 1.0),
    "joint_thickness_mm": ("joint_thickness", 1e-3),
}
LOAD_KEYS: Final = ("direction", "panels", "profile")
# A DXF string holds 2049 bytes.
LONGEST_PROPERTY: Final = 2000

Property = tuple[str, str]


def encode_materials(materials: Sequence[Material]) -> list[Property]:
    """Return one property a material: `CP_MATERIAL_<name>` and its constants as JSON."""
    return [_encode(MATERIAL_PROPERTY, material.name, _material_table(material)) for material in materials]


def encode_loads(loads: Sequence[LoadCase]) -> list[Property]:
    """Return one property a load; extra wrenches belong to stones, not to a document: an `InputError`."""
    out: list[Property] = []
    for load in loads:
        if load.dead is not None or load.live is not None:
            raise InputError(f"load {load.name}", "a drawing cannot hold extra wrenches", expected="dead and live = None")
        table: dict[str, Any] = {"direction": load.direction.tolist(), "profile": load.profile}
        if load.panels is not None:
            table["panels"] = list(load.panels)
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
                materials.append(_material(tag.removeprefix(MATERIAL_PROPERTY), json.loads(text)))
            elif tag.startswith(LOAD_PROPERTY):
                loads.append(_load(tag.removeprefix(LOAD_PROPERTY), json.loads(text)))
        except (ValueError, TypeError, AttributeError, RecursionError) as error:
            keys = LOAD_KEYS if tag.startswith(LOAD_PROPERTY) else (*MATERIAL_KEYS, "elastic")
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


def _material_table(material: Material) -> dict[str, Any]:
    table: dict[str, Any] = {key: getattr(material, field) / factor for key, (field, factor) in MATERIAL_KEYS.items()}
    if material.elastic is not None:
        table["elastic"] = {key: getattr(material.elastic, field) / factor for key, (field, factor) in ELASTIC_KEYS.items()}
    return table


def _material(name: str, table: dict[str, Any]) -> Material:
    _check_keys(table, {*MATERIAL_KEYS, "elastic"}, {"unit_weight_kN_m3", "friction"})
    values = {
        MATERIAL_KEYS[key][0]: _number(key, value) * MATERIAL_KEYS[key][1] for key, value in table.items() if key != "elastic"
    }
    elastic = None
    if table.get("elastic") is not None:
        _check_keys(table["elastic"], set(ELASTIC_KEYS), set(ELASTIC_KEYS))
        elastic = Elastic(
            **{ELASTIC_KEYS[key][0]: _number(key, value) * ELASTIC_KEYS[key][1] for key, value in table["elastic"].items()}
        )
    return Material(name, **values, elastic=elastic)


def _load(name: str, table: dict[str, Any]) -> LoadCase:
    _check_keys(table, set(LOAD_KEYS), {"direction"})
    panels = table.get("panels")
    if panels is not None and not (isinstance(panels, list) and all(isinstance(p, str) for p in panels)):
        raise ValueError("panels is not a list of names")
    return LoadCase(table["direction"], name=name, panels=panels, profile=table.get("profile", "uniform"))


def _check_keys(table: dict[str, Any], allowed: set[str], required: set[str]) -> None:
    unknown, missing = sorted(table.keys() - allowed), sorted(required - table.keys())
    if unknown or missing:
        raise ValueError("; ".join([f"unknown key {k}" for k in unknown] + [f"{k} is missing" for k in missing]))


def _number(key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{key} is not a number")
    return float(value)
