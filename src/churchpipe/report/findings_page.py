"""findings.html: the stones of a file in three dimensions before any solve, what was found in it, and where."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.dxf.elevation import stood_up
from churchpipe.errors import InputError
from churchpipe.findings import CODES, Body, Finding, Findings
from churchpipe.io.atomic import write_text
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.model.placed_loads import Applied
from churchpipe.report import viewer
from churchpipe.report.applied import beam_rows, load_rows
from churchpipe.report.drawings import drawings_svg
from churchpipe.report.drawn_loads import DrawnLoads, drawn_loads, key_to_loads, viewer_loads
from churchpipe.report.motion import viewpoint
from churchpipe.report.packing import packed
from churchpipe.report.page import template
from churchpipe.report.table import amount
from churchpipe.report.walls import opening_outlines, wall_rows

# Radius of a mark as a part of the size of the structure; the most places that are marked and listed of one kind.
MARK, MOST = 0.02, 200
COLOURS = {"error": "#c0261c", "warning": "#d98a00"}


def write_findings_page(
    path: Path,
    findings: Findings,
    stones: Assemblage | None,
    after: str,
    building: Building | None = None,
    questions: Sequence[str] = (),
    applied: Sequence[Applied] = (),
) -> None:
    """Write findings.html.

    stones: as read, None when nothing can be drawn. after: what to type next. building: its walls are listed, and their openings
    drawn. questions: about doubtful values. applied: loads and ties of the building as it is, then of variants.
    """
    loads = drawn_loads(stones, applied) if stones else None
    beams = beam_rows(stones) if stones else []
    strengths = {tie.name: tie.strength for one in applied for tie in (*one.ties, *one.candidates)}
    text = template("findings.html").render(
        file=findings.file,
        kinds=[_kind(kind) for kind in findings.kinds],
        errors=len(findings.errors),
        warnings=len(findings.warnings),
        free=int((~stones.fixed).sum()) if stones else 0,
        volume=float(stones.volume[~stones.fixed].sum()) if stones else 0.0,
        after=after,
        most=MOST,
        walls=wall_rows(building) if building else [],
        questions=questions,
        drawings=drawings_svg(stones, loads) if stones and loads and (applied or beams) else [],
        key_to_loads=key_to_loads(loads, beams=bool(beams)) if loads else [],
        pushes=True,
        load_rows=load_rows({str(number): one for number, one in enumerate(applied)}),
        beam_rows=beams,
        tie_rows=[[name, amount(strength / 1e3, 1)] for name, strength in strengths.items()],
        drawn=stones is not None,
        viewer_data=viewer.script_json(_drawn(stones, findings, building, loads)) if stones and loads else "",
        import_map=viewer.import_map(),
        viewer_script=viewer.static_text("viewer.js"),
        tables_script=viewer.static_text("tables.js"),
        three_licence=viewer.static_text("three/LICENSE"),
        style=viewer.static_text("report.css"),
    )
    write_text(path, text)


def sound_stones(bodies: Sequence[Body]) -> Assemblage | None:
    """Return those bodies of a file with errors that are sound solids, None without any."""
    sound: list[Body] = []
    for body in bodies:
        try:
            Assemblage.from_polyhedra([(body.points, body.faces)], 1.0)
        except InputError:
            continue
        sound.append(body)
    if all(body.fixed for body in sound):
        return None
    fixed = [number for number, body in enumerate(sound) if body.fixed]
    names = [f"{number}: {body.name}" for number, body in enumerate(sound, 1)]
    return Assemblage.from_polyhedra([(body.points, body.faces) for body in sound], 1.0, fixed=fixed, block_id=names)


def _kind(kind: tuple[Finding, ...]) -> dict[str, Any]:
    first = kind[0]
    return {
        "code": first.code,
        "severity": first.severity,
        "subject": CODES[first.code],
        "count": len(kind),
        "expected": first.expected,
        "remedy": first.remedy,
        "places": [(finding.place, finding.what) for finding in kind[:MOST]],
    }


def _drawn(stones: Assemblage, findings: Findings, building: Building | None, loads: DrawnLoads) -> dict[str, Any]:
    """Return the input of the viewer: stones that stand still, the edges of openings, loads, ties, and a mark at each place, the
    errors above the warnings."""
    still: FloatArray = np.zeros((stones.count, 6))
    origin, radius = viewer.origin_of(stones), MARK * stones.size
    # What is drawn last lies above.
    placed = [finding for kind in findings.kinds[::-1] for finding in kind[:MOST] if finding.position is not None]
    places = np.array([finding.position for finding in placed], dtype=np.float64).reshape(-1, 3)
    places = stood_up(places) if findings.stood_up else places
    return viewer.viewer_data(stones, []) | {
        "analyses": [
            {
                "label": "",
                "joints": None,
                "velocities": packed(still, "<f4"),
                "speed": packed(still[:, 0], "<f4"),
                "reference_speed": 0.0,
                "amplitude": 0.0,
                "moving": 0,
                "toward": viewpoint(stones, still).tolist(),
                "push": None,
            }
        ],
        "loads": viewer_loads(loads, origin, stones.size),
        "outlines": opening_outlines(building, origin) if building else [],
        "marks": [
            {
                "place": (place - origin).tolist(),
                "radius": radius,
                "colour": COLOURS[finding.severity],
                "label": f"{finding.code}: {finding.what}",
            }
            for finding, place in zip(placed, places, strict=True)
        ],
    }
