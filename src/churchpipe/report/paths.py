"""The real path of the stones in the report: frames for the viewer, snapshots, and crack maps."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.io.records import Analysis
from churchpipe.large_displacements.cracks import path_cracks
from churchpipe.mechanism import moving_stones, reference_speed, stone_speed
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.contacts import Contacts
from churchpipe.report.block_curves import curve_label
from churchpipe.report.cracks import counted_on, crack_map_svg
from churchpipe.report.figures import Job, mechanism_picture
from churchpipe.report.frames import frames, placed
from churchpipe.report.motion import push_direction, viewpoint
from churchpipe.report.packing import packed
from churchpipe.report.table import minus
from churchpipe.wording import three_figures

Followed = tuple[Analysis, BlockCapacityCurve]
# Crack maps show the joints at this share of d0, the life safety limit state, and so many walls at the most, those with cracks of
# this share of the widest.
_LIMIT, _WALLS, _SHOWN = 0.4, 8, 0.05


def path_label(record: Analysis) -> str:
    """Return the name of a path for a chooser."""
    return f"real path, load {record.load}, {curve_label(record)}"


def viewer_path(stones: Assemblage, record: Analysis, curve: BlockCapacityCurve, origin: FloatArray) -> dict[str, Any]:
    """Return a path as an analysis of the viewer: `path` holds its frames, position (nf, nb, 3) m, rotation (nf, nb, 3) rad and
    the words of each; stones are coloured by how far they go in the end."""
    kept = frames(len(curve.displacement))
    gone = _gone(curve, len(curve.displacement) - 1)
    speed = stone_speed(stones, gone)
    return {
        "label": path_label(record),
        "joints": None,
        "velocities": packed(gone, "<f4"),
        "speed": packed(speed, "<f4"),
        "reference_speed": reference_speed(speed),
        "amplitude": 0.0,
        "moving": int(moving_stones(speed).sum()),
        "toward": viewpoint(stones, gone).tolist(),
        "push": None,
        "path": {
            "position": packed(curve.position[kept] - origin, "<f4"),
            "rotation": packed(curve.rotation[kept], "<f4"),
            "words": [_words(curve, step) for step in kept],
        },
    }


def snapshots(stones: Assemblage, followed: Sequence[Followed], folder: Path) -> list[tuple[str, Path, Job]]:
    """Return (label, file, job) of pictures of each path half-way and at its end, the stones where they are, not exaggerated."""
    out: list[tuple[str, Path, Job]] = []
    for record, curve in followed:
        last = len(curve.displacement) - 1
        # Both from one side, that from which the end is seen best: or one could not compare them.
        toward = viewpoint(stones, _gone(curve, last))
        for step in dict.fromkeys((_part_way(curve.displacement, 0.5), last)):
            file = folder / f"{record.name or 'curve'}_{step:03d}.png"
            label = f"{path_label(record)}: {_words(curve, step)}"
            job = (
                _snapshot,
                (stones, curve.position[step], curve.rotation[step], _gone(curve, step), file, push_direction(record), toward),
            )
            out.append((label, file, job))
    return out


def crack_maps(stones: Assemblage, contacts: Contacts, followed: Sequence[Followed]) -> list[tuple[str, str]]:
    """Return (words, SVG) of the elevation of each wall that cracks, at two fifths of the way to the end of each curve."""
    bears = ~stones.fixed[contacts.blocks].all(axis=1)
    out: list[tuple[str, str]] = []
    for record, curve in followed:
        step = _part_way(curve.displacement, _LIMIT)
        opening, _ = path_cracks(stones, contacts, curve, step)
        opening = np.where(bears, opening, 0.0)
        names = np.unique(stones.panel[~stones.fixed]).tolist()
        widest = {str(name): _widest(stones, contacts, opening, name) for name in names}
        chosen = sorted((name for name in widest if widest[name] > _SHOWN * max(widest.values())), key=lambda name: -widest[name])
        for name in chosen[:_WALLS]:
            drawn = crack_map_svg(stones, contacts, opening, name)
            if drawn:
                words = f"{path_label(record)}, {name or 'stones of no wall'}, {_words(curve, step)}"
                out.append((f"{words}; lengths {counted_on(stones, name)}", drawn))
    return out


def _part_way(displacement: FloatArray, share: float) -> int:
    """Return the first step that is this share of the way to the last one: a control point may go to and fro, or backwards."""
    end = float(displacement[-1])
    return int(np.argmax(np.sign(end) * displacement >= share * abs(end)))


def _widest(stones: Assemblage, contacts: Contacts, opening: FloatArray, wall: str) -> float:
    """Return the widest opening, m, of the joints of a wall, those with its neighbours and with the ground among them."""
    own = ((stones.panel == wall) & ~stones.fixed)[contacts.blocks].any(axis=1)
    return float(opening[own].max(initial=0.0))


def _gone(curve: BlockCapacityCurve, step: int) -> FloatArray:
    """Return how far the stones have gone and turned by a step (nb, 6), m and rad."""
    return np.concatenate([curve.position[step] - curve.position[0], curve.rotation[step] - curve.rotation[0]], axis=1)


def _words(curve: BlockCapacityCurve, step: int) -> str:
    """Return where a step is, and whether it is an equilibrium: a picture of one that is none must not look like another."""
    proof = ""
    if step >= curve.proved_steps:
        proof = ", no equilibrium" if curve.jumps[step] else ", not proved"
    gone, factor = (minus(text) for text in (three_figures(1e3 * curve.displacement[step]), f"{curve.load_factor[step]:z.4f}"))
    return f"{gone} mm, load factor {factor}{proof}"


def _snapshot(
    stones: Assemblage,
    position: FloatArray,
    rotation: FloatArray,
    gone: FloatArray,
    file: Path,
    push: FloatArray | None,
    toward: FloatArray,
) -> None:
    mechanism_picture(placed(stones, position, rotation), gone, file, push, amplitude=0.0, toward=toward)
