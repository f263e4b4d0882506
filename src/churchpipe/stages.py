"""The stages of a run: one plain function each, paths in, paths out. They know no engine.

A stage whose result is bad news (unstable, not converged) ends well, with the status in its JSON; only input that cannot be
taken raises.
"""

import importlib.metadata
import platform
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from churchpipe import compare as results
from churchpipe.config.case import read_variants
from churchpipe.config.plan import building_of, load_of, materials_of, plan, unit_weights
from churchpipe.errors import InputError
from churchpipe.io.atomic import canonical_json, write_if_changed, write_json
from churchpipe.io.building_json import read_building, write_building
from churchpipe.io.npz import read_npz, write_npz
from churchpipe.io.records import record_of
from churchpipe.io.tables import read_json, write_table
from churchpipe.io.vtu import write_vtu
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.results import LimitState

Progress = Callable[[str, float], None]


def configure(case: str | Path, out: str | Path, overrides: Sequence[str] = ()) -> Path:
    """Write the plan of a run and the settings of each stage into `out`; a file whose content is unchanged is not touched.

    Files: plan.json, as-run.toml (the case, and what --set changed), geometry/NAME/settings.json, rigid/NAME/settings.json.
    Returns the plan's path.
    """
    out = Path(out)
    todo = plan(read_variants(case, overrides))
    drawing = todo.index["drawing"]
    if drawing and not Path(drawing).is_file():
        raise InputError(f"{case}: source.dxf", "no such drawing", found=drawing, remedy="Paths are relative to the case file.")
    for kind, settings in (("geometry", todo.geometries), ("rigid", todo.analyses)):
        for name, table in settings.items():
            write_if_changed(out / kind / name / "settings.json", canonical_json(table))
    changes = "".join(f"# --set {change}\n" for change in overrides)
    write_if_changed(out / "as-run.toml", changes + Path(case).read_text(encoding="utf-8"))
    write_if_changed(out / "plan.json", canonical_json(todo.index))
    return out / "plan.json"


def source(settings: Path, building: Path) -> None:
    """Settings of a geometry -> building.json."""
    write_building(building, building_of(read_json(settings)))


def blocks(building: Path, assemblage: Path, dxf: Path, vtu: Path) -> None:
    """Building -> its stones, for the next stages, for CAD and for ParaView."""
    from churchpipe.derive.blocks import derive_blocks
    from churchpipe.dxf.writer import write_dxf

    stones = derive_blocks(read_building(building))
    write_dxf(stones, dxf)
    write_vtu(vtu, stones)
    write_npz(assemblage, stones)


def drawing(settings: Path, dxf: Path, assemblage: Path, vtu: Path) -> None:
    """Drawing -> its stones, exactly as drawn."""
    from churchpipe.dxf.reader import read_drawing

    table = read_json(settings)
    options = {key: value for key, value in table["source"].items() if key in ("units", "support", "repair")}
    weights = unit_weights(table)
    drawn = read_drawing(dxf, **options, unit_weight=weights)
    missing = [name for name in drawn.unweighted if name not in weights]
    if missing:
        raise InputError(
            dxf.name,
            "stones of materials that the case does not know",
            found=", ".join(missing),
            expected=", ".join(weights),
            remedy=f"Add [material.{missing[0]}] with unit_weight_kN_m3 and friction to the case.",
        )
    write_vtu(vtu, drawn.stones)
    write_npz(assemblage, drawn.stones)


def contacts(assemblage: Path, contacts: Path, progress: Progress | None = None) -> None:
    """Stones -> their interfaces; stones that float, lie twice in one place or overlap are named before any solve."""
    from churchpipe.derive.contacts import find_contacts
    from churchpipe.derive.soundness import check_soundness

    stones = read_npz(assemblage, Assemblage)
    found = find_contacts(stones)
    check_soundness(stones, found, progress)
    write_npz(contacts, found)


def rigid(settings: Path, assemblage: Path, contacts: Path, state: Path, record: Path, progress: Progress | None = None) -> None:
    """One rigid-block analysis -> its state and its record for the summary."""
    from churchpipe.derive.joints import joint_strength
    from churchpipe.rigid_blocks.limit import limit_analysis

    table = read_json(settings)
    stones, joints = read_npz(assemblage, Assemblage), read_npz(contacts, Contacts)
    load, materials = load_of(table), materials_of(table)
    friction, cohesion = joint_strength(stones, joints, materials)
    options = {key: table[key] for key in ("flow", "solver", "method", "start") if key in table}
    used = set(stones.material[~stones.fixed].tolist())
    found = limit_analysis(stones, joints, load, friction, cohesion, **options, progress=progress)
    write_npz(state, found)
    write_json(record, record_of(found, load, [material for material in materials if material.name in used]))


def compare(plan: Path, summary: Path, table: Path) -> None:
    """All analyses of a plan -> summary.json and table.csv."""
    run, index = plan.parent, read_json(plan)
    sizes = {
        name: results.figures(
            read_npz(run / "geometry" / name / "assemblage.npz", Assemblage),
            read_npz(run / "geometry" / name / "contacts.npz", Contacts),
        )
        for name in index["geometries"]
    }
    analyses = [_analysis(run, entry, len(sizes) > 1) for entry in index["analyses"]]
    write_table(table, analyses)
    write_json(summary, results.summary(index["case"], sizes, analyses))


def report(plan: Path, summary: Path, assemblage: Path, contacts: Path, html: Path) -> None:
    """Summary and states of one geometry -> report.html, its pictures, and the mechanisms for ParaView."""
    from churchpipe.report.html import write_report

    run = plan.parent
    stones = read_npz(assemblage, Assemblage)
    records = {record["name"]: record for record in read_json(summary)["analyses"]}
    mine = [entry["name"] for entry in read_json(plan)["analyses"] if entry["geometry"] == assemblage.parent.name]
    states = {name: read_npz(run / "rigid" / name / "rigid.npz", LimitState) for name in mine}
    for name, state in states.items():
        write_vtu(run / "rigid" / name / "mechanism.vtu", stones, state.velocities)
    write_report(
        html,
        summary=read_json(summary),
        stones=stones,
        contacts=read_npz(contacts, Contacts),
        results=[(records[name], state) for name, state in states.items()],
        case_text=(run / "as-run.toml").read_text(encoding="utf-8"),
        versions=versions(),
        figures_dir=html.parent / "figures",
    )


def versions() -> dict[str, str]:
    """Return the versions that a result depends on."""
    packages = ("churchpipe", "numpy", "scipy", "shapely", "clarabel", "ezdxf", "manifold3d")
    return {"python": platform.python_version()} | {name: importlib.metadata.version(name) for name in packages}


def _analysis(run: Path, entry: dict[str, Any], several: bool) -> dict[str, Any]:
    """Return the record of an analysis, with its name, what was swept, and its geometry where there are several."""
    place = {"geometry": entry["geometry"]} if several else {}
    variant = {"variant": entry["variant"]} if entry["variant"] else {}
    return {"name": entry["name"], **read_json(run / "rigid" / entry["name"] / "rigid.json"), **place, **variant}


# All arguments are paths; those in `LONG` take `progress` besides.
STAGES: dict[str, Callable[..., None]] = {
    "source": source,
    "blocks": blocks,
    "drawing": drawing,
    "contacts": contacts,
    "rigid": rigid,
    "compare": compare,
    "report": report,
}
LONG = frozenset({"contacts", "rigid"})
