"""What the 3-D viewer of the report needs: geometry and velocities as base64 arrays, and three.js inlined.

three.js (release 170, MIT licence) lies unmodified in static/three; viewer.js is ours.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.io.records import Analysis
from churchpipe.mechanism import UNNAMED, moving_stones, reference_speed, stone_of_point, stone_speed
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import KINDS, Contacts
from churchpipe.model.results import LimitState
from churchpipe.report import colours
from churchpipe.report.motion import (
    PUSH_LENGTH,
    corner_rates,
    ground_plate,
    joint_opening,
    natural_amplitude,
    push_arrow_start,
    push_direction,
    viewpoint,
)
from churchpipe.report.packing import base64_text, packed
from churchpipe.report.surface import edges, triangles
from churchpipe.stones.ring_beams import ring_beams

SUPPORT = "support"
STATIC = Path(__file__).parent / "static"


def viewer_data(
    stones: Assemblage, results: Sequence[tuple[Analysis, LimitState, str]], contacts: Contacts | None = None
) -> dict[str, Any]:
    """Return the viewer's input as JSON-ready values; results: record of the analysis, its state, its label.

    With contacts, a stone that is clicked shows its joints: `joints`, and (ni, 4) in each analysis, see `joint_values`.

    Lengths are in m, from the centre of the structure's plan at its foot: float32 keeps micrometres however far the
    drawing's origin is. Arrays are little-endian base64: float32 (`points`, `centroid`, `velocities`, `speed`) and uint32
    (`point_ptr`, `triangles`, `edges`).
    """
    plate = ground_plate(stones)
    free = stones.points[~stones.fixed[stone_of_point(stones)]]
    low, high = free.min(axis=0), free.max(axis=0)
    origin = origin_of(stones)
    panels, panel_of = np.unique(np.where(stones.fixed, SUPPORT, stones.panel), return_inverse=True)
    plain = {SUPPORT: colours.SUPPORT} | dict.fromkeys(stones.panel[ring_beams(stones)].tolist(), colours.BEAM)
    return {
        "points": packed(stones.points - origin, "<f4"),
        "centroid": packed(stones.centroid - origin, "<f4"),
        "point_ptr": packed(stones.block_point_ptr, "<u4"),
        "triangles": packed(triangles(stones, ~plate), "<u4"),
        "edges": packed(edges(stones, ~plate), "<u4"),
        "id": stones.block_id.tolist(),
        "course": stones.course.tolist(),
        "panel_of": panel_of.tolist(),
        "panels": [
            {
                "name": str(name) or UNNAMED,
                "colour": plain.get(str(name), colours.PANELS[i % len(colours.PANELS)]),
                "drawn": bool((~plate & (panel_of == i)).any()),
            }
            for i, name in enumerate(panels)
        ],
        "free": int((~stones.fixed).sum()),
        "size": (high - low).tolist(),
        "ground": bool(plate.any()),
        "grid": _round_length(float(np.ptp(free[:, :2], axis=0).max()) / 6),
        "speed_stops": colours.SPEED_STOPS,
        "colours": {
            "edge": colours.EDGE,
            "ground": colours.GROUND,
            "push": colours.PUSH,
            "picked": colours.PICKED,
            "across": colours.ACROSS,
        },
        "analyses": [_analysis(stones, record, state, label, origin, contacts) for record, state, label in results],
        "joints": contacts
        and {
            "blocks": packed(contacts.blocks, "<u4"),
            "kinds": list(KINDS),
            "kind": [KINDS.index(kind) for kind in contacts.kind.tolist()],
        },
    }


def origin_of(stones: Assemblage) -> FloatArray:
    """Return the centre (3,) m of the structure's plan at its foot."""
    free = stones.points[~stones.fixed[stone_of_point(stones)]]
    low, high = free.min(axis=0), free.max(axis=0)
    return np.array([*(low + high)[:2] / 2, low[2]])


def joint_values(stones: Assemblage, contacts: Contacts, state: LimitState) -> FloatArray:
    """Return of each interface (ni, 4): normal force N, shear N, and the largest rates at which its corners open and slide.

    Forces are resultants, zero where the analysis has none.
    """
    velocities = np.nan_to_num(state.velocities)
    first = contacts.point_ptr[:-1]
    forces = state.forces if len(state.forces) == len(contacts.point) else np.zeros((len(contacts.point), 3))
    resultant = np.add.reduceat(forces, first, axis=0) if len(first) else np.zeros((0, 3))
    rate = corner_rates(contacts, stones, velocities)
    sliding = np.maximum.reduceat(np.linalg.norm(rate[:, 1:], axis=1), first) if len(first) else np.zeros(0)
    opening = joint_opening(contacts, stones, velocities)
    return np.column_stack([resultant[:, 0], np.linalg.norm(resultant[:, 1:], axis=1), opening, sliding])


def _analysis(
    stones: Assemblage, record: Analysis, state: LimitState, label: str, origin: FloatArray, contacts: Contacts | None
) -> dict[str, Any]:
    velocities = np.nan_to_num(state.velocities)
    speed = stone_speed(stones, velocities)
    push = push_direction(record)
    return {
        "label": label,
        "joints": contacts and packed(joint_values(stones, contacts, state), "<f4"),
        "velocities": packed(velocities, "<f4"),
        "speed": packed(speed, "<f4"),
        "reference_speed": reference_speed(speed),
        "fastest": float(speed.max(initial=0.0)),
        "amplitude": natural_amplitude(stones, speed),
        "moving": int(moving_stones(speed).sum()),
        "toward": viewpoint(stones, velocities).tolist(),
        "push": None if push is None or state.status == "unstable" else _arrow(stones, push, origin),
    }


def _arrow(stones: Assemblage, push: FloatArray, origin: FloatArray) -> dict[str, Any]:
    start = push_arrow_start(stones, push) - origin
    return {"direction": push.tolist(), "start": start.tolist(), "length": PUSH_LENGTH * stones.size}


def import_map() -> str:
    """Return the import map that gives viewer.js its modules as data: addresses, so that nothing is fetched."""
    modules = {
        "three": "three/three.module.min.js",
        "three/addons/controls/OrbitControls.js": "three/OrbitControls.js",
        "churchpipe/shell.js": "shell.js",
        "churchpipe/tools.js": "tools.js",
        "churchpipe/loads.js": "loads.js",
    }
    imports = {name: f"data:text/javascript;base64,{base64_text((STATIC / file).read_bytes())}" for name, file in modules.items()}
    return json.dumps({"imports": imports})


def static_text(name: str) -> str:
    """Return the text of a file in static/."""
    return (STATIC / name).read_text(encoding="utf-8")


def script_json(value: object) -> str:
    """Return JSON that can stand inside a script element: no "<", so no end tag and no comment."""
    return json.dumps(value, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _round_length(length: float) -> float:
    """Return 1, 2 or 5 times a power of ten, the largest not above `length`."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(max(step * power for step in (1, 2, 5) if step * power <= length * (1 + 1e-9)))
