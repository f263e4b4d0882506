"""The stages of a run: one plain function each, paths in, paths out. They know no engine.

A stage whose result is bad news (unstable, not converged, no shell to be had of these stones) ends well, with the status in its
JSON; only input that cannot be taken raises. What the shell refuses stops the shell alone: the rigid blocks go on.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.config.carries import carries_of, placed
from churchpipe.config.settings import beams_of, buttresses_of, joints_of, load_of, strengths_of, used_by, weights_of
from churchpipe.dxf.reading import Reading
from churchpipe.errors import Extra, InputError
from churchpipe.io.atomic import read_json, write_json
from churchpipe.io.building_json import read_building, write_building
from churchpipe.io.npz import Absent, read_if_made, read_npz, write_npz
from churchpipe.io.recording import record_of, shell_record_of
from churchpipe.io.records import Analysis, read_record, write_record
from churchpipe.io.sample_study import Sample, sample_study, sampled_records
from churchpipe.io.shell_vtu import write_shell_mechanism, write_shell_msh, write_shell_vtu
from churchpipe.io.summary import VariantResult, read_summary, write_summary
from churchpipe.io.tables import write_table
from churchpipe.io.vtu import write_vtu
from churchpipe.loading.wrenches import loaded, shell_loaded
from churchpipe.match import Match
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import CONTACT_MODEL
from churchpipe.model.progress import Progress
from churchpipe.model.results import CapacityCurve, CapacityStep, ShellLimitState
from churchpipe.model.shell import ShellModel
from churchpipe.model.ties import Tie


def source(settings: Path, building: Path) -> None:
    """Settings of a geometry -> building.json."""
    from churchpipe.generators import generate

    table = read_json(settings)
    added = {"ring_beams": beams_of(table), "buttresses": buttresses_of(table), "most_stones": table["most_stones"]}
    write_building(building, generate(**table["source"], materials=weights_of(table), name=table["name"], **added))


def blocks(building: Path, assemblage: Path, dxf: Path | None = None, vtu: Path | None = None) -> None:
    """Building -> its stones, for the next stages, for CAD and for ParaView."""
    from churchpipe.dxf.writer import write_dxf
    from churchpipe.stones.blocks import derive_blocks

    stones = derive_blocks(read_building(building))
    if dxf:
        write_dxf(stones, dxf)
    if vtu:
        write_vtu(vtu, stones)
    write_npz(assemblage, stones)


def drawing(settings: Path, file: Path, assemblage: Path, vtu: Path) -> None:
    """Drawing, or another file of stones -> its stones, exactly as drawn; those of no wall get the names of walls fitted."""
    from churchpipe.meshes.reader import read_file
    from churchpipe.recognition.panels import wall_names
    from churchpipe.stones.ring_beams import add_beams

    table = read_json(settings)
    weights: dict[str, float] = table["unit_weight"]
    drawn = read_file(file, **table["source"]["reading"], unit_weight=weights)
    missing = [name for name in drawn.unweighted if name not in weights]
    if missing:
        raise InputError(
            file.name,
            "stones of materials that the case does not know",
            found=", ".join(missing),
            expected=", ".join(weights),
            remedy=f"Add [material.{missing[0]}] with unit_weight_kN_m3 and friction to the case.",
        )
    named = replace(drawn.stones, panel=wall_names(drawn.stones, Reading(**table["source"]["reading"]).kept_joint))
    stones = add_beams(named, beams_of(table), weights)
    known = sorted(set(stones.panel[~stones.fixed].tolist()) - {""})
    unknown = [name for name in table["panels"] if name not in known]
    if unknown:
        raise InputError("load: panels", "no such panel", found=", ".join(unknown), expected=", ".join(known) or "no panels")
    write_vtu(vtu, stones)
    write_npz(assemblage, stones)


def contacts(tolerances: Path, assemblage: Path, contacts: Path, progress: Progress | None = None) -> None:
    """Stones -> their interfaces; stones that float, lie twice in one place or overlap are named before any solve."""
    from churchpipe.stones.contacts import find_contacts
    from churchpipe.stones.soundness import check_soundness

    stones = read_npz(assemblage, Assemblage)
    found = find_contacts(stones, **read_json(tolerances))
    check_soundness(stones, found, progress)
    write_npz(contacts, found)


def panels(settings: Path, assemblage: Path, building: Path, fitted: Path, fit: Path) -> None:
    """Stones of a drawing -> the panels fitted to them, and the stones, with their mortar, by these panels' names.

    fit.json: the stones that fit none, how far stones were moved ("moved"), and why there are no panels at all ("message").
    """
    from churchpipe.recognition.panels import fit_panels

    table, stones = read_json(settings), read_npz(assemblage, Assemblage)
    try:
        found = fit_panels(stones, joint=Reading(**table["source"]["reading"]).kept_joint)
        made = found.building(name=table["name"])
    except InputError as error:
        write_building(building, Building(table["name"], (), tuple(weights_of(table))))
        write_npz(fitted, stones)
        write_json(fit, {"unfit": stones.block_id[~stones.fixed].tolist(), "message": str(error), "moved": ""})
        return
    write_building(building, made)
    write_npz(fitted, found.stones)
    write_json(fit, {"unfit": found.unfit.tolist(), "message": "", "moved": found.moved_words})


def shell(settings: Path, building: Path, shell: Path) -> None:
    """Building -> its mid-surfaces as a mesh, for the next stages; beside it shell.msh for Gmsh and shell.vtu for ParaView."""
    from churchpipe.shell_mesh.shell import derive_shell

    exports = shell.with_suffix(".msh"), shell.with_suffix(".vtu")
    try:
        mesh = derive_shell(read_building(building), read_json(settings)["element_size"])
    except InputError as error:
        for export in exports:
            export.unlink(missing_ok=True)
        write_npz(shell, Absent(str(error)))
        return
    write_shell_msh(exports[0], mesh)
    write_shell_vtu(exports[1], mesh)
    write_npz(shell, mesh)


def match(shell: Path, carried: Path, assemblage: Path, contacts: Path, record: Path) -> None:
    """Both models and what they carry -> whether they are one building, and all figures of it."""
    from churchpipe.match import match_models

    if isinstance(mesh := read_if_made(shell, ShellModel), Absent):
        write_record(record, Match(message=mesh.reason))
        return
    stones = read_npz(assemblage, Assemblage)
    loads = [placed(carries_of(table), stones).loads for table in read_json(carried) if table]
    write_record(record, match_models(stones, read_npz(contacts, Contacts), mesh, loads))


def limit(
    settings: Path, shell: Path, match: Path, assemblage: Path, state: Path, record: Path, progress: Progress | None = None
) -> None:
    """One limit analysis of the shell -> its state and its record; none where the gate failed."""
    from churchpipe.homogenised_shell.limit import shell_limit_analysis

    table = read_json(settings)
    options = {key: table[key] for key in ("planes", "membrane", "solver")}

    def work(mesh: ShellModel, load: LoadCase, materials: list[JointStrength], ties: Sequence[Tie]) -> ShellLimitState:
        return shell_limit_analysis(mesh, load, materials, ties=ties, **options, progress=progress)

    _analyse_shell("limit", table, shell, match, assemblage, state, record, work, progress)


def pushover(
    settings: Path, shell: Path, match: Path, assemblage: Path, state: Path, record: Path, progress: Progress | None = None
) -> None:
    """One capacity curve of the shell -> the curve with the last step's state, and its record; none where the gate failed."""
    from churchpipe.homogenised_shell.pushover import pushover

    table = read_json(settings)
    options = {key: table[key] for key in ("planes", "membrane", "control_point", "steps") if key in table}

    def report(step: CapacityStep) -> None:
        if progress:
            progress(f"load factor {step.load_factor:.4f}, {step.displacement * 1e3:.3g} mm", 0.0)

    def work(mesh: ShellModel, load: LoadCase, materials: list[JointStrength], ties: Sequence[Tie]) -> CapacityCurve:
        return pushover(mesh, load, materials, **options, ties=ties, progress=report)

    _analyse_shell("pushover", table, shell, match, assemblage, state, record, work, progress)


def _analyse_shell(
    method: str,
    table: dict[str, Any],
    shell: Path,
    match: Path,
    assemblage: Path,
    state: Path,
    record: Path,
    work: Callable[..., ShellLimitState | CapacityCurve],
    progress: Progress | None,
) -> None:
    from churchpipe.homogenised_shell.joint_groups import shell_joint_groups

    load, materials, stones = load_of(table), strengths_of(table), read_npz(assemblage, Assemblage)
    words: dict[str, Any] = {"method": method, "planes": table["planes"], "joints": joints_of(table)}
    # Those of the stones, beams among them: both models answer one question.
    used = used_by(stones, materials)
    if not read_record(match, Match).passed:
        reason = "the two models do not match"
        write_npz(state, Absent(reason))
        write_record(record, shell_record_of(reason, load, used, **words, status="left-out"))
        return
    mesh = read_npz(shell, ShellModel)
    if progress:
        progress(f"{len(mesh.triangles)} elements", 0.0)
    applied = placed(carries_of(table), stones)
    try:
        mesh, materials = shell_joint_groups(mesh, materials, words["joints"])
        found = work(mesh, shell_loaded(load, mesh, stones, applied.loads), materials, applied.ties)
    except InputError as error:
        if error.where == "control_point":
            # Of all that is given, the mesh alone tells whether it has such a node.
            raise error.at("shell.control_point") from error
        write_npz(state, Absent(str(error)))
        write_record(record, shell_record_of(str(error), load, used, **words))
        return
    write_npz(state, found)
    write_record(record, shell_record_of(found, load, used, ties=applied.ties, mesh=mesh, **words))


def rigid(settings: Path, assemblage: Path, contacts: Path, state: Path, record: Path, progress: Progress | None = None) -> None:
    """One rigid-block analysis -> its state and its record for the summary."""
    from churchpipe.rigid_blocks.limit import limit_analysis
    from churchpipe.rigid_blocks.ranking import rank_ties
    from churchpipe.rigid_blocks.sensitivity import sensitivities, verify_gains
    from churchpipe.stones.joints import crushing_strength, joint_strength

    table = read_json(settings)
    stones, joints = read_npz(assemblage, Assemblage), read_npz(contacts, Contacts)
    load, materials = load_of(table), strengths_of(table)
    applied = placed(carries_of(table), stones)
    pushed = loaded(load, stones, applied.loads)
    friction, cohesion = joint_strength(stones, joints, materials, joints_of(table))
    keys = ("flow", "solver", "method", "start", "bipotential_gap", "contact_model", "crushing_parts")
    options = {key: table[key] for key in keys if key in table}
    options |= {"ties": applied.ties, "compressive_strength": crushing_strength(stones, joints, materials)}
    found = limit_analysis(stones, joints, pushed, friction, cohesion, **options, progress=progress)
    ended, weighed = np.isfinite(found.load_factor), applied.candidates
    ranked = rank_ties(found, weighed, stones, joints, pushed, friction, cohesion, **options) if weighed and ended else ()
    known = found.flow == "associative" and ended and found.velocities.any()
    model = table.get("contact_model", CONTACT_MODEL)
    rates = sensitivities(found, stones, joints, pushed, contact_model=model) if known else None
    if rates and (best := table.get("verified_gains", 0)):
        rates = verify_gains(rates, stones, joints, pushed, friction, cohesion, best=best, **options)
    write_npz(state, found)
    used = used_by(stones, materials)
    write_record(record, record_of(found, load, used, model, applied.ties, ranked, rates, joints_of(table)))


def curve(
    settings: Path, assemblage: Path, contacts: Path, state: Path, record: Path, *first: Path, progress: Progress | None = None
) -> None:
    """A curve of the stones, from their first analyses if made -> curve and record; a killed run goes on from its steps."""
    from churchpipe.path_run import follow_curve

    follow_curve("curve", (settings, assemblage, contacts), state, record, first, progress)


def halved(settings: Path, assemblage: Path, contacts: Path, state: Path, *first: Path, progress: Progress | None = None) -> None:
    """The settings of a curve -> that curve with steps half as long."""
    from churchpipe.path_run import follow_curve

    follow_curve("halved", (settings, assemblage, contacts), state, None, first, progress)


def movement(
    settings: Path, tolerances: Path, assemblage: Path, contacts: Path, *made: Path, progress: Progress | None = None
) -> None:
    """A support that moves -> stones, their ground cut, joints, path and record; an interrupted run goes on from its steps."""
    from churchpipe.path_run import follow_movement

    follow_movement((settings, tolerances, assemblage, contacts), made, progress)


def sample(settings: Path, file: Path, record: Path, *shared: Path) -> None:
    """One sample, with the drawing and what it shares with the building as it is -> its records, or why it cannot be built."""
    from churchpipe.sample_run import run_sample

    stages = (source, blocks, drawing, contacts, panels, shell, match, rigid, curve, halved, limit, pushover)
    try:
        found = run_sample(read_json(settings), file, shared, {stage.__name__: stage for stage in stages}, record.parent)
        write_record(record, Sample(tuple(found)))
    except InputError as error:
        write_record(record, Sample((), str(error)))


def compare(plan: Path, summary: Path, table: Path, samples: Path | None = None) -> None:
    """All analyses of a plan -> summary.json and table.csv; those of all samples -> samples.csv."""
    from churchpipe import compare as results
    from churchpipe.code_check import floor_questions, low_floor_questions
    from churchpipe.config.plausible import unanswered
    from churchpipe.model.sizes import size_questions
    from churchpipe.run_folder import read_run

    run = read_run(plan)
    sizes, meshes = {name: results.size(*run.stones(name)) for name in run.index["geometries"]}, run.meshes()
    found = [record for entry in run.index["analyses"] if (record := run.record(entry, meshes)).status != "left-out"]
    analyses = results.careful_first(found)
    compared = [replace(pair, overlap=run.overlap(pair.blocks, pair.shell)) for pair in results.pairs(found)]
    write_table(table, analyses)
    sizes_asked = (text for name in run.index["geometries"] for text in size_questions(run.stones(name)[0]))
    begun = floor_questions((record.load, record.check) for record in analyses if record.variant is None)
    begun += low_floor_questions((record.load, record.check) for record in analyses)
    of_stones = [*sizes_asked, *run.ground_questions(), *run.end_questions()]
    asked = list(dict.fromkeys([*unanswered(run.index["questions"]), *of_stones, *begun]))
    study = None
    if samples:
        study = sample_study(run.index["sample"], run.samples(), analyses)
        write_table(samples, sampled_records(run.index["sample"], run.samples()))
    variants = [VariantResult(**variant) for variant in run.index["variants"]]
    words = results.summary(run.index["case"], sizes, meshes, analyses, compared, asked, variants, run.movements(), study)
    write_summary(summary, words)


def report(plan: Path, summary: Path, assemblage: Path, contacts: Path, html: Path) -> None:
    """Summary and states of one geometry -> report.html, its pictures, and mechanisms and joints for ParaView."""
    with Extra("the report"):
        from churchpipe.report.frames import write_path
        from churchpipe.report.html import write_report
        from churchpipe.report.joints_vtu import write_joints

    from churchpipe.run_folder import read_run, versions

    run, geometry, words = read_run(plan), assemblage.parent.name, read_summary(summary)
    stones, joints = read_npz(assemblage, Assemblage), read_npz(contacts, Contacts)
    records = {record.name: record for record in words.analyses}
    mine = [entry for entry in run.index["analyses"] if entry["geometry"] == geometry]
    states = {entry["name"]: run.block_state(entry) for entry in mine if entry["kind"] == "rigid"}
    for name, state in states.items():
        write_vtu(run.path / "rigid" / name / "mechanism.vtu", stones, state.velocities)
        write_joints(run.path / "rigid" / name / "joints.vtu", stones, joints, state)
    curves = {entry["name"]: (entry, run.block_curve(entry)) for entry in mine if entry["kind"] == "curve"}
    for entry, path in curves.values():
        write_path(run.folder(entry) / "path.pvd", stones, path)
    moved = [(record, *run.moved(record.name)) for record in run.movements(geometry)]
    for record, own, _, way in moved:
        write_path(run.path / "movement" / record.name / "path.pvd", own, way)
    made = {mesh["name"]: run.shell(mesh["name"]) for mesh in run.index["shells"] if mesh["geometry"] == geometry}
    meshes = {name: mesh for name, mesh in made.items() if isinstance(mesh, ShellModel)}
    found: list[tuple[Analysis, str, ShellLimitState | CapacityCurve]] = []
    for entry in (entry for entry in mine if "shell" in entry):
        mechanism, state = run.folder(entry) / "mechanism.vtu", run.shell_state(entry)
        if isinstance(state, Absent):
            mechanism.unlink(missing_ok=True)
        else:
            write_shell_mechanism(mechanism, meshes[entry["shell"]], state)
            found.append((records[entry["name"]], entry["shell"], state))
    write_report(
        html,
        summary=words,
        stones=stones,
        contacts=joints,
        results=[(records[name], state) for name, state in states.items()],
        shells=meshes,
        shell_results=found,
        published=run.index["published"],
        project=run.index["project"],
        materials=run.index["materials"],
        moved=moved,
        followed=[(records[name], path) for name, (_, path) in curves.items()],
        applied={entry["name"]: run.applied(entry, stones) for entry in mine if entry["kind"] in ("rigid", "curve")},
        case_text=(run.path / "as-run.toml").read_text(encoding="utf-8"),
        versions=versions(),
        figures_dir=html.parent / "figures",
    )


# All arguments are paths; those in `LONG` take `progress` besides.
_ALL = (
    source,
    blocks,
    drawing,
    contacts,
    panels,
    shell,
    match,
    rigid,
    curve,
    halved,
    movement,
    sample,
    limit,
    pushover,
    compare,
    report,
)
STAGES: dict[str, Callable[..., None]] = {stage.__name__: stage for stage in _ALL}
LONG = frozenset({"contacts", "rigid", "curve", "halved", "movement", "limit", "pushover"})
