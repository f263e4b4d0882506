"""The plan of a run: which geometries and analyses a case file asks for, and the settings of each stage."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from churchpipe.config.case import Case, Drawing, Generated, generate
from churchpipe.config.units import in_si
from churchpipe.model.building import Building
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material

# A swept key that changes the stones; every other one touches the solves alone.
_GEOMETRIC = re.compile(r"source\.|material\..+\.unit_weight_kN_m3$")


@dataclass(frozen=True, slots=True)
class Plan:
    """What a run makes: `index` is the table of contents, the others the settings of each stage by the name of its folder.

    geometries: settings of the stones. analyses: settings of the rigid-block analyses. A name is a label, nobody parses it.
    """

    index: dict[str, Any]
    geometries: dict[str, dict[str, Any]]
    analyses: dict[str, dict[str, Any]]


def plan(cases: Sequence[Case]) -> Plan:
    """Return the plan of a case's variants. Variants that differ in friction alone share their geometry."""
    geometries: dict[str, dict[str, Any]] = {}
    analyses: dict[str, dict[str, Any]] = {}
    entries: list[dict[str, Any]] = []
    for case in cases:
        shape = {key: value for key, value in case.variant.items() if _GEOMETRIC.match(key)}
        geometry = _keep(geometries, _words(shape) or ["base"], _geometry_settings(case))
        for number, load in enumerate(case.loads):
            for flow in case.rigid.flow:
                label = _keep(
                    analyses, [load.name, flow, *_words(case.variant)], _analysis_settings(case, geometry, number, flow)
                )
                entries.append({"name": label, "geometry": geometry, "variant": case.variant})
    source = cases[0].source
    index = {
        "case": cases[0].name,
        "drawing": str(source.path.resolve()) if isinstance(source, Drawing) else None,
        "geometries": list(geometries),
        "analyses": entries,
    }
    return Plan(index, geometries, analyses)


def building_of(settings: dict[str, Any]) -> Building:
    """Return the building that settings of a geometry describe; its materials have a unit weight and no strength."""
    table = dict(settings["source"])
    materials = [Material(name, weight, 0.0) for name, weight in unit_weights(settings).items()]
    return generate(Generated(table.pop("generator"), in_si(table)), materials, settings["name"])


def unit_weights(settings: dict[str, Any]) -> dict[str, float]:
    """Return unit weights, N/m3, by material from the settings of a geometry."""
    return {name: in_si(table)["unit_weight"] for name, table in settings["material"].items()}


def load_of(settings: dict[str, Any]) -> LoadCase:
    """Return the load of an analysis from its settings."""
    return LoadCase(**settings["load"])


def materials_of(settings: dict[str, Any]) -> list[Material]:
    """Return the strength of an analysis from its settings; its materials have no unit weight, which the stones have."""
    return [Material(name, 0.0, values["friction"], values["cohesion"]) for name, values in settings["material"].items()]


def _geometry_settings(case: Case) -> dict[str, Any]:
    # Strength is left out: it enters at the solve.
    weights = {name: {"unit_weight_kN_m3": table["unit_weight_kN_m3"]} for name, table in case.table["material"].items()}
    return {"name": case.name, "source": case.table["source"], "material": weights}


def _analysis_settings(case: Case, geometry: str, number: int, flow: str) -> dict[str, Any]:
    load = case.loads[number]
    strength = {material.name: {"friction": material.friction, "cohesion": material.cohesion} for material in case.materials}
    settings: dict[str, Any] = {
        "geometry": geometry,
        "load": {
            "direction": load.direction.tolist(),
            "name": load.name,
            "panels": None if load.panels is None else list(load.panels),
            "profile": load.profile,
        },
        "material": strength,
        "flow": flow,
        "solver": case.rigid.solver,
    }
    # The associative analysis has no method and no start: changing them must not touch it.
    return settings | ({"method": case.rigid.method, "start": case.rigid.start} if flow == "non-associative" else {})


def _words(variant: dict[str, Any]) -> list[str]:
    """Return the swept values as "friction=0.5": the last part of each key, or all of it where that is not unique."""
    last = [key.rpartition(".")[2] for key in variant]
    return [
        f"{short if last.count(short) == 1 else key}={value}" for (key, value), short in zip(variant.items(), last, strict=True)
    ]


def _keep(table: dict[str, dict[str, Any]], words: Sequence[str], settings: dict[str, Any]) -> str:
    """Store settings under a name of a folder made of words; equal settings share a name, others never do."""
    label = "_".join(re.sub(r"[^\w.,=+-]+", "-", re.sub(r"[()\[\]{}'\" ]", "", word)) for word in words)
    while table.setdefault(label, settings) != settings:
        label += "~"
    return label
