"""The plan of a run: which geometries and analyses a case file asks for, and the settings of each stage."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import product
from typing import Any

from churchpipe.config.carries import LOADS, TIES, plain
from churchpipe.config.case import Case, Drawing
from churchpipe.config.laid_sizes import laying_questions
from churchpipe.config.plausible import questions
from churchpipe.model import swept
from churchpipe.model.loads import LoadCase, load_table
from churchpipe.model.names import CONTACT_MODEL

# What acts in every analysis; candidates for ties are ranked by the rigid blocks alone.
_BORNE = tuple(dict.fromkeys((*LOADS, *TIES)))


@dataclass(frozen=True, slots=True)
class Plan:
    """What a run makes: `index` is the table of contents, the others the settings of each stage by the name of its folder.

    geometries: settings of the stones. contacts: the tolerances of their joints that the case gives, by the same names.
    shells: of the meshes. carried: what the building carries in each case of a mesh, by their names, for their gate. analyses: of
    both models; `kinds` has the kind of each: "rigid", "curve", "limit" or "pushover". movements: of the supports
    that move.
    A name is a label, nobody parses it.
    """

    index: dict[str, Any]
    geometries: dict[str, dict[str, Any]]
    contacts: dict[str, dict[str, Any]]
    shells: dict[str, dict[str, Any]]
    analyses: dict[str, dict[str, Any]]
    movements: dict[str, dict[str, Any]]
    carried: dict[str, list[dict[str, Any]]]

    @property
    def files(self) -> dict[str, Any]:
        """The settings of all stages, by their files' paths in the folder of the run, without ".json"."""
        tables = {f"geometry/{name}/settings": table for name, table in self.geometries.items()}
        tables |= {f"geometry/{name}/tolerances": table for name, table in self.contacts.items()}
        tables |= {f"shell/{name}/settings": table for name, table in self.shells.items()}
        tables |= {f"shell/{name}/carried": table for name, table in self.carried.items()}
        tables |= {f"{self.kinds[name]}/{name}/settings": table for name, table in self.analyses.items()}
        return tables | {f"movement/{name}/settings": table for name, table in self.movements.items()}

    @property
    def kinds(self) -> dict[str, str]:
        """Kind of each analysis, by its name."""
        return {entry["name"]: entry["kind"] for entry in self.index["analyses"]}

    @property
    def stages(self) -> tuple[str, ...]:
        """Names of the stages that make it, in the order of the work."""
        shells, kinds = bool(self.shells), set(self.kinds.values())
        drawn = self.index["drawing"] is not None
        first = ("drawing", "contacts", *(["panels"] if shells else [])) if drawn else ("source", "blocks", "contacts")
        solved = [kind for kind in ("rigid", "curve", "limit", "pushover") if kind in kinds]
        solved += ["halved"] if any(entry.get("halved") for entry in self.index["analyses"]) else []
        moved = ["movement"] if self.movements else []
        sampled = ["sample"] if self.index["sample"] else []
        return (*first, *(["shell", "match"] if shells else []), *solved, *moved, *sampled, "compare", "report")


def plan(cases: Sequence[Case]) -> Plan:
    """Return the plan of a case's variants and of the combinations of its swept values.

    Those that differ in friction alone share stones and mesh, those that differ in the element size alone share the stones and
    the rigid-block analyses. What a variant leaves as it is is not made again.
    """
    geometries: dict[str, dict[str, Any]] = {}
    contacts: dict[str, dict[str, Any]] = {}
    shells: dict[str, dict[str, Any]] = {}
    analyses: dict[str, dict[str, Any]] = {}
    entries: dict[str, dict[str, Any]] = {}
    movements: dict[str, dict[str, Any]] = {}
    moved: dict[str, dict[str, Any]] = {}
    places: dict[str, str] = {}
    variants: dict[str | None, dict[str, Any]] = {}
    carried: dict[str, list[dict[str, Any]]] = {}

    def add(kind: str, words: list[str], case: Case, swept: dict[str, Any], settings: dict[str, Any], **place: Any) -> str:
        check = place.get("check")
        name = _same(case, {key: (table, entries[key].get("check")) for key, table in analyses.items()}, (settings, check))
        name = name or _keep(analyses, [*words, *_words(swept, case)], settings)
        entry = entries.setdefault(name, {"name": name, "kind": kind, **place, "variant": _name(case), "swept": swept})
        if place.get("halved"):
            # It is enough that one of the cases that share a curve asks for it.
            entry["halved"] = True
        variants[_name(case)]["analyses"].append(name)
        return name

    for case in cases:
        shape = {key: value for key, value in case.swept.items() if swept.changes_stones(key)}
        settings, tolerances = _geometry_settings(case), case.tolerances
        geometry = _same(case, {key: (table, contacts[key]) for key, table in geometries.items()}, (settings, tolerances))
        geometry = geometry or _keep(geometries, _words(shape, case) or ["base"], settings)
        contacts[geometry] = tolerances
        cost = case.variant.cost if case.variant else {}
        variants.setdefault(_name(case), {"name": _name(case), "geometry": geometry, "cost": cost, "analyses": []})
        of_stones = {key: value for key, value in case.swept.items() if not swept.of_shell(key)}
        of_shell = {key: value for key, value in case.swept.items() if not swept.of_rigid_blocks(key)}
        check = {"check": asdict(case.check)} if case.check else {}
        for load in case.loads:
            made: dict[tuple[str, str], str] = {}
            for flow, contact_model in product(case.rigid.flow, case.rigid.contact_model):
                settings = _rigid_settings(case, geometry, load, flow, contact_model)
                words = [load.name, flow, *([contact_model] if "contact_model" in settings else [])]
                made[flow, contact_model] = add("rigid", words, case, of_stones, settings, geometry=geometry, **check)
            if case.rigid.curve:
                settings = _curve_settings(case, geometry, load)
                # A curve begins with the analyses of both flow rules, and need not make them again.
                known = [name for (_, model), name in made.items() if model == case.rigid.contact_model[0]]
                begins = [name for name in known if "crushing_parts" not in analyses[name]]
                add(
                    "curve",
                    [load.name, "curve"],
                    case,
                    of_stones,
                    settings,
                    geometry=geometry,
                    begins_from=begins,
                    **check,
                    **_halved(case),
                )
        for movement in case.movements:
            settings = {"geometry": geometry, **_strengths(case), "solver": case.rigid.solver, **asdict(movement)}
            settings |= case.carries.settings(*LOADS)
            settings |= _contact_model_of_paths(case)
            settings["without_ties"] = bool(case.carries.settings(*TIES))
            name = _same(case, movements, settings) or _keep(movements, [movement.name, *_words(of_stones, case)], settings)
            moved.setdefault(name, {"name": name, "geometry": geometry, "variant": _name(case), "swept": of_stones})
        if case.shell is None:
            continue
        meshed = {key: value for key, value in case.swept.items() if swept.changes_mesh(key)}
        settings = {"geometry": geometry, "element_size": case.shell.element_size}
        loads = case.carries.settings(*LOADS)
        mesh = _same(case, shells, settings) or _keep(shells, _words(meshed, case) or ["base"], settings)
        places[mesh] = geometry
        if loads not in carried.setdefault(mesh, []):
            carried[mesh].append(loads)
        for load in case.loads:
            for method in case.shell.analyses:
                settings = _shell_settings(case, mesh, load, method)
                add(method, [load.name, method], case, of_shell, settings, geometry=geometry, shell=mesh)
    source = cases[0].source
    index = {
        "case": cases[0].name,
        "drawing": str(source.path.resolve()) if isinstance(source, Drawing) else None,
        "geometries": list(geometries),
        "shells": [{"name": mesh, "geometry": place} for mesh, place in places.items()],
        "analyses": list(entries.values()),
        "variants": list(variants.values()),
        "movements": list(moved.values()),
        "published": [asdict(value) for value in cases[0].published],
        "project": asdict(cases[0].project),
        "materials": [asdict(material) for material in cases[0].materials],
        "questions": [*laying_questions(cases), *questions(cases)],
        "sample": asdict(cases[0].sample) if cases[0].sample else None,
    }
    return Plan(index, geometries, contacts, shells, analyses, movements, carried)


def _name(case: Case) -> str | None:
    return case.variant.name if case.variant else None


def _same(case: Case, known: Mapping[str, Any], value: Any) -> str | None:
    """Return what a variant leaves as it is, by the name that it has already; None for the building as it is."""
    return next((name for name, table in known.items() if table == value), None) if case.variant else None


def _geometry_settings(case: Case) -> dict[str, Any]:
    # Strength is left out: it enters at the solve.
    source = asdict(case.source)
    # The drawing's path is in the index: a folder that is moved changes no stone.
    source.pop("path", None)
    return {
        "name": case.name,
        "source": source,
        "unit_weight": {material.name: material.unit_weight for material in case.materials},
        # Walls are of the first one unless they say otherwise, and JSON sorts the keys of a table.
        "materials": [material.name for material in case.materials],
        **({"buttresses": [plain(buttress) for buttress in case.buttresses]} if case.buttresses else {}),
        **({"ring_beams": [plain(beam) for beam in case.ring_beams]} if case.ring_beams else {}),
        "most_stones": case.most_stones,
        **({"panels": _named_panels(case)} if isinstance(case.source, Drawing) else {}),
    }


def _named_panels(case: Case) -> list[str]:
    """Return the panels that the loads of a case name: those of a drawing are known when it is read."""
    return sorted({panel for load in case.loads for panel in load.panels or ()})


def _rigid_settings(case: Case, geometry: str, load: LoadCase, flow: str, contact_model: str) -> dict[str, Any]:
    settings: dict[str, Any] = {
        "geometry": geometry,
        "load": load_table(load),
        **_strengths(case),
        "flow": flow,
        "solver": case.rigid.solver,
        **case.carries.settings(),
    }
    if contact_model != CONTACT_MODEL:
        settings["contact_model"] = contact_model
    if any("compressive_strength" in values for values in settings["material"].values()):
        settings["crushing_parts"] = case.rigid.crushing_parts
    if flow == "associative":
        # It has no method and no start: changing them must not touch it.
        return settings | ({"verified_gains": case.rigid.verified_gains} if case.rigid.verified_gains else {})
    start = {"start": list(case.rigid.start)} if case.rigid.start else {}
    return settings | start | {"method": case.rigid.method, "bipotential_gap": case.rigid.bipotential_gap}


def _curve_settings(case: Case, geometry: str, load: LoadCase) -> dict[str, Any]:
    assert case.rigid.curve is not None
    settings = {"geometry": geometry, "load": load_table(load), **_strengths(case), "solver": case.rigid.solver}
    settings |= case.carries.settings(*_BORNE) | _contact_model_of_paths(case)
    given = asdict(case.rigid.curve).items()
    return settings | {key: value for key, value in given if value is not None and key != "half_steps"}


def _halved(case: Case) -> dict[str, bool]:
    """Say whether a curve is followed again with half the step: by default where it is checked against an earthquake."""
    asked = case.rigid.curve.half_steps if case.rigid.curve else None
    checked = case.check is not None and case.check.spectrum is not None
    return {"halved": True} if asked or (asked is None and checked) else {}


def _contact_model_of_paths(case: Case) -> dict[str, str]:
    """Return the contact model in which stones are followed as they move: the first of the case."""
    first = case.rigid.contact_model[0]
    return {} if first == CONTACT_MODEL else {"contact_model": first}


def _shell_settings(case: Case, mesh: str, load: LoadCase, method: str) -> dict[str, Any]:
    shell = case.shell
    assert shell is not None
    strengths = _strengths(case)
    material = strengths["material"]
    settings = {"shell": mesh, "load": load_table(load), "planes": shell.planes, "membrane": shell.membrane}
    settings |= case.carries.settings(*_BORNE)
    if method == "limit":
        return settings | strengths | {"solver": shell.solver}
    for known in case.materials:
        if known.elastic:
            material[known.name]["elastic"] = asdict(known.elastic)
    given = {"control_point": shell.control, "steps": shell.steps}
    return settings | strengths | {key: value for key, value in given.items() if value is not None}


def _strengths(case: Case) -> dict[str, Any]:
    """Return the settings of the materials, and of the joints with a strength of their own, where there are any."""
    out: dict[str, dict[str, Any]] = {}
    for material in case.materials:
        out[material.name] = {"friction": material.friction, "cohesion": material.cohesion}
        if material.compressive_strength is not None:
            out[material.name]["compressive_strength"] = material.compressive_strength
    groups = {"joints": [plain(group) for group in case.joints]} if case.joints else {}
    return {"material": out, **groups}


def _words(values: dict[str, Any], case: Case) -> list[str]:
    """Return swept values as "friction=0.5", by the last part of each key, or all of it where that is not unique; then the
    variant."""
    last = [key.rpartition(".")[2] for key in values]
    words = [
        f"{short if last.count(short) == 1 else key}={value}" for (key, value), short in zip(values.items(), last, strict=True)
    ]
    return [*words, case.variant.name] if case.variant else words


def _keep(table: dict[str, dict[str, Any]], words: Sequence[str], settings: dict[str, Any]) -> str:
    """Store settings under a name of a folder made of words; equal settings share a name, others never do."""
    label = "_".join(re.sub(r"[^\w.,=+-]+", "-", re.sub(r"[()\[\]{}'\" ]", "", word)) for word in words)
    # File systems take 255 bytes.
    label = label.encode()[:200].decode(errors="ignore")
    while table.setdefault(label, settings) != settings:
        label += "~"
    return label
