"""report.html: one file that opens anywhere, offline, and says what was found and how far to trust it."""

import base64
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.io.atomic import write_text
from churchpipe.io.records import Analysis
from churchpipe.io.summary import ShellSize, Size, Summary
from churchpipe.mechanism import stone_of_point
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import KINDS, Contacts
from churchpipe.model.names import GOOD
from churchpipe.model.placed_loads import Applied
from churchpipe.model.results import LimitState
from churchpipe.model.shell import ShellModel
from churchpipe.report import both, viewer
from churchpipe.report.applied import (
    beam_rows,
    candidate_rows,
    gain_table,
    leading_candidates,
    leading_ties,
    load_rows,
    tie_rows,
)
from churchpipe.report.block_curves import block_curve_plots
from churchpipe.report.contact_models import contact_model_rows
from churchpipe.report.displacements import displacement_checks
from churchpipe.report.drawings import drawings_svg
from churchpipe.report.drawn_loads import drawn_loads, key_to_loads
from churchpipe.report.figures import Job, mechanism_picture, mechanism_pictures
from churchpipe.report.motion import joint_opening, opened_joints, push_direction, viewpoint
from churchpipe.report.movements import Moved, movements_shown
from churchpipe.report.notes import convergence_note, status_note
from churchpipe.report.page import template
from churchpipe.report.paths import Followed, crack_maps, path_label, snapshots, viewer_path
from churchpipe.report.plots import convergence_svg, gaps_svg
from churchpipe.report.published import published_rows
from churchpipe.report.safety import CUT_OFF, check_table, fails, overall, part_overview, part_tables, safety_index, what_moves
from churchpipe.report.sensitivity import sensitivity_plots
from churchpipe.report.shell_picture import shell_picture
from churchpipe.report.shell_view import ShellState, joint_outlines, motion_of, shell_data
from churchpipe.report.table import (
    OF_PUSH,
    Row,
    amount,
    columns_for,
    factor_words,
    figure,
    friction_text,
    interval_text,
    rows_of,
    swept,
)
from churchpipe.report.title_block import MATERIAL_HEADINGS, material_rows, title_block
from churchpipe.report.uncertainty import uncertainty_section
from churchpipe.report.variants import link_to, variants_section
from churchpipe.report.vault_sections import vault_sections
from churchpipe.stones.account import joint_account, joint_lines
from churchpipe.stones.ring_beams import ring_beams
from churchpipe.wording import four_figures

CARDS = 8


def write_report(
    path: str | Path,
    *,
    summary: Summary,
    stones: Assemblage,
    contacts: Contacts,
    results: Sequence[tuple[Analysis, LimitState]],
    case_text: str,
    versions: Mapping[str, str],
    figures_dir: Path | None = None,
    shells: Mapping[str, ShellModel] | None = None,
    shell_results: Sequence[tuple[Analysis, str, ShellState]] = (),
    published: Sequence[Mapping[str, Any]] = (),
    project: Mapping[str, str] | None = None,
    materials: Sequence[Mapping[str, Any]] = (),
    moved: Sequence[Moved] = (),
    followed: Sequence[Followed] = (),
    applied: Mapping[str, Applied] | None = None,
) -> None:
    """Write a self-contained report.

    Parameters
    ----------
    summary: what the run found. results: each rigid-block analysis that is drawn, and its state.
    figures_dir: where the pictures of the mechanisms are kept as PNG too (None: nowhere).
    shells: the meshes of the shell, by name. shell_results: for each analysis of the shell its record, its mesh, its state.
    published: load factors of others, see `published_rows`. project: the title block. materials: of the case, in SI.
    moved: supports that move, see `movements_shown`. followed: capacity curves, with their records.
    applied: loads and ties of the rigid-block analyses, by their names.

    A picture that cannot be drawn (no graphics library) is replaced by a sentence; the report is written all the same.
    """
    meshes, analyses = shells or {}, summary.analyses
    followed = [(record, curve) for record, curve in followed if len(curve.displacement)]
    rows = rows_of(analyses, results, shell_results)
    of_blocks = [row for row in rows if row.state is not None]
    of_shell = [row for row in rows if row.shell is not None]
    columns = columns_for(rows)
    asis = [row for row in rows if not row.variant]
    geometry = next((row.record.geometry for row in (*of_blocks, *of_shell, *rows)), None)
    loads = drawn_loads(stones, (applied or {}).values())
    with _pictures(stones, contacts, meshes, of_blocks, of_shell, figures_dir, applied or {}, followed) as pictures:
        domain, domain_words = both.domain_plot(meshes, rows)
        text = template("report.html").render(
            name=(project or {}).get("title") or summary.case,
            title_block=title_block(project or {}, case_text, versions),
            drawings=drawings_svg(stones, loads),
            key_to_loads=key_to_loads(loads, beams=bool(ring_beams(stones).any())),
            material_headings=MATERIAL_HEADINGS,
            materials=material_rows(stones, materials, [row.record.swept for row in rows]),
            facts=_facts(summary.geometries.get(geometry or "", summary), _mesh_size(summary, list(meshes)), stones),
            kinds=_interface_kinds(contacts),
            joints=joint_lines(*joint_account(stones, contacts)),
            gaps=gaps_svg(contacts),
            cards=_cards(asis, bool(of_shell)) if len(asis) <= CARDS else [],
            uncertainty=uncertainty_section(summary.uncertainty, rows),
            variants=variants_section(summary.variants, analyses, geometry or ""),
            elsewhere=_elsewhere(summary, geometry or ""),
            columns=[(column.title, column.meaning) for column in columns],
            rows=[[column.text(row) for column in columns] for row in rows],
            words=[place for place, column in enumerate(columns) if not column.numeric],
            factors=[place for place, column in enumerate(columns) if column.title == "Load factor"],
            factor_words=factor_words([row.record for row in rows], OF_PUSH),
            pushes=any(any(row.record.direction) for row in rows),
            chips=[place for place, column in enumerate(columns) if column.title == "Status"],
            parts=part_tables(rows),
            part_overview=part_overview(rows),
            check=check_table(rows),
            verdict=overall(asis, [both.question(row) for row in asis]),
            cut_off=CUT_OFF,
            match=both.gate(summary, list(meshes)),
            compared=both.compared(summary.comparison, rows),
            contact_models=contact_model_rows(summary.contact_models),
            capacity=both.capacity_plots(rows),
            movements=movements_shown(moved),
            vault_sections=vault_sections(stones, contacts, of_blocks),
            block_curves=block_curve_plots(analyses, geometry),
            crack_maps=crack_maps(stones, contacts, followed),
            displacements=displacement_checks(analyses, geometry),
            mesh_plot=both.mesh_plot(rows),
            domain=domain,
            domain_words=domain_words,
            guidance=summary.guidance,
            questions=summary.questions,
            load_rows=load_rows(applied or {}, analyses),
            beam_rows=beam_rows(stones),
            tie_rows=tie_rows(rows),
            leading_ties=leading_ties(rows),
            candidate_rows=candidate_rows(rows),
            leading_candidates=leading_candidates(rows),
            gains=gain_table([row for row in rows if not row.variant], float(stones.weight[~stones.fixed].sum())),
            notes=[(row.label, note) for row in rows if (note := status_note(stones, row))],
            published=published_rows(published, asis),
            sensitivity=sensitivity_plots(rows),
            convergence=_convergence(rows),
            non_associative=any(row.record.flow == "non-associative" for row in rows),
            choices=[
                *(f"{row.label}: {figure(row.value('load_factor'), 4)}" for row in of_blocks),
                *(path_label(record) for record, _ in followed),
            ],
            shell_choices=[f"{row.label}: {figure(row.value('load_factor'), 4)}" for row in of_shell] if of_blocks else [],
            viewer_data=viewer.script_json(_viewer_data(stones, contacts, meshes, of_blocks, of_shell, followed)),
            import_map=viewer.import_map(),
            viewer_script=viewer.static_text("viewer.js"),
            tables_script=viewer.static_text("tables.js"),
            three_licence=viewer.static_text("three/LICENSE"),
            style=viewer.static_text("report.css"),
            case_text=case_text,
            versions=versions,
            # Last, since they are drawn while all that stands before is made.
            **pictures(),
        )
    write_text(path, text)


def _elsewhere(summary: Summary, here: str) -> list[tuple[str, str]]:
    """Return name and address of the reports of the other geometries of a run: of a sweep, or of variants, by their names."""
    names = list(summary.geometries)
    called = {variant.geometry: variant.name for variant in reversed(summary.variants) if variant.name}
    return [(called.get(name, name), link_to(here, name, names[0])) for name in names if name != here]


def _mesh_size(summary: Summary, meshes: Sequence[str]) -> ShellSize | None:
    """Return the size of the first of a report's meshes; those of other geometries have others."""
    return next((summary.shells[name] for name in meshes if name in summary.shells), None if summary.shells else summary.shell)


def _facts(found: Size, shell: ShellSize | None, stones: Assemblage) -> list[tuple[str, str]]:
    free = stones.points[~stones.fixed[stone_of_point(stones)]]
    size = " \u00d7 ".join(amount(float(length), 2) for length in np.ptp(free, axis=0))
    counts = {"stones": found.blocks, "interfaces": found.interfaces, "contact points": found.contact_points}
    counts |= {"shell elements": shell.elements, "shell nodes": shell.nodes} if shell else {}
    facts = [(title, f"{count:,}") for title, count in counts.items()]
    of_stones = [("weight", f"{four_figures(found.weight / 1e3)} kN")]
    of_stones.append(("size along x \u00d7 y \u00d7 z", f"{size} m"))
    return facts[:3] + of_stones + facts[3:]


def _interface_kinds(contacts: Contacts) -> str:
    counts = [(int((contacts.kind == kind).sum()), kind) for kind in KINDS]
    return ", ".join(f"{count:,} {kind}" for count, kind in counts if count)


def _cards(rows: Sequence[Row], both_models: bool) -> list[dict[str, str]]:
    """Return a card for each analysis; of several that answer one question the first, the careful one, says so."""
    # Capacity curves of the stones answer another question, and have a check of their own.
    asked = [(*both.question(row), str(row.record.method == "curve")) for row in rows]
    leads = [asked.count(one) > 1 and one not in asked[:place] for place, one in enumerate(asked)]
    words = [_use(row, lead) for row, lead in zip(rows, leads, strict=True)]
    return [_card(row, both_models) | {"use": use} for row, use in zip(rows, words, strict=True)]


def _use(row: Row, leads: bool) -> str:
    """Return what a card says of the use of its load factor; leads: the careful one of several."""
    if row.record.load_factor < 0:
        return "below zero: stones fall under the dead load alone"
    return "the careful value: use it" if leads and row.status in GOOD else ""


def _card(row: Row, both_models: bool) -> dict[str, str]:
    model = "rigid blocks, " if both_models and not row.of_shell else ""
    return {
        "label": model + row.label,
        "value": figure(row.value("load_factor"), 4),
        "interval": interval_text(row.record),
        "status": row.status,
        "moves": what_moves(row.record),
        "safety": safety_index(row),
        "verdict": "unsafe" if fails(row) else "",
    }


def _convergence(rows: Sequence[Row]) -> list[tuple[str, str, str]]:
    """Return label, plot and facts of each non-associative iteration."""
    associative = {_loading(row): row.state.load_factor for row in rows if row.state and row.state.flow == "associative"}
    return [
        (row.label, convergence_svg(row.state, associative.get(_loading(row))), convergence_note(row))
        for row in rows
        if row.state and row.state.history
    ]


def _loading(row: Row) -> tuple[str, ...]:
    return row.variant, row.load, friction_text(row), str(swept(row)), str(row.record.contact_model)


def _viewer_data(
    stones: Assemblage,
    contacts: Contacts,
    meshes: Mapping[str, ShellModel],
    of_blocks: Sequence[Row],
    of_shell: Sequence[Row],
    followed: Sequence[Followed],
) -> dict[str, Any]:
    data = viewer.viewer_data(stones, [(row.record, row.state, row.label) for row in of_blocks if row.state], contacts)
    data["analyses"] += [viewer_path(stones, record, curve, viewer.origin_of(stones)) for record, curve in followed]
    if not of_shell or not of_blocks:
        return data
    found = [(row.label, *row.shell, both.partner(row, of_blocks)) for row in of_shell if row.shell]
    velocities = [np.nan_to_num(row.state.velocities) for row in of_blocks if row.state]
    return data | {"shell": shell_data(meshes, found, stones, contacts, velocities, viewer.origin_of(stones))}


@contextmanager
def _pictures(
    stones: Assemblage,
    contacts: Contacts,
    meshes: Mapping[str, ShellModel],
    rows: Sequence[Row],
    of_shell: Sequence[Row],
    keep: Path | None,
    applied: Mapping[str, Applied],
    followed: Sequence[Followed],
) -> Iterator[Callable[[], dict[str, Any]]]:
    """Draw the first analysis of each variant, load and kind; yield what waits for the pictures: label and PNG as base64 of
    each, and why there is none, if so."""
    first: dict[tuple[str, str, str], Row] = {}
    for row in (*rows, *of_shell):
        first.setdefault((row.variant, row.load, row.kind), row)
    with tempfile.TemporaryDirectory() as scratch:
        folder = keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        drawn: list[tuple[str, Path]] = []
        jobs: list[Job] = []
        for number, row in enumerate(first.values(), 1):
            # Names of analyses of a run are those of its folders; any others may be no names of files.
            file = folder / f"{row.record.name or number if keep else number}.png"
            drawn.append((row.label, file))
            if row.state:
                push = None if row.status == "unstable" else push_direction(row.record)
                carried = applied.get(row.record.name)
                jobs.append((mechanism_picture, (stones, np.nan_to_num(row.state.velocities), file, push, carried)))
            elif row.shell:
                place = both.partner(row, rows)
                # The side is chosen by what moves in the stones, in another analysis where none asks the same.
                seen, beside = (rows[max(place, 0)].state if rows else None), (rows[place].state if place >= 0 else None)
                moved = np.nan_to_num(seen.velocities) if seen else np.zeros((stones.count, 6))
                mesh, state = meshes[row.shell[0]], row.shell[1]
                scene = (mesh, motion_of(state), np.nan_to_num(state.plastic))
                toward = viewpoint(stones, moved)
                jobs.append((shell_picture, (*scene, file, toward)))
                if beside and row.record.method == "limit":
                    overlay = file.with_stem(f"{file.stem}_overlay")
                    joints = joint_outlines(contacts, np.flatnonzero(opened_joints(joint_opening(contacts, stones, moved))))
                    drawn.append((f"{row.label}: plastic strain, and the joints of the stones that open", overlay))
                    jobs.append((shell_picture, (*scene, overlay, toward, joints)))
        for label, file, job in snapshots(stones, followed, folder):
            drawn.append((label, file))
            jobs.append(job)
        with mechanism_pictures(jobs) as wait:

            def made() -> dict[str, Any]:
                problem = wait()
                found = [(label, base64.b64encode(file.read_bytes()).decode("ascii")) for label, file in drawn if file.exists()]
                return {"pictures": found, "picture_problem": problem}

            yield made
