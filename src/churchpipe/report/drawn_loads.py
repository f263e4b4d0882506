"""What a building carries, and its ties, on drawings and in the viewer: arrows, dots, lines, and the sentences of their key."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.loading.ties import anchors_of
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.placed_loads import Applied, PlacedLoads
from churchpipe.report import colours

# A load has an arrow for each cube of this share of the building's size in which it acts. Length of the longest arrow and of the
# shortest one, as a share of that size and of the longest.
_CELL, _LONGEST, _SHORTEST = 0.05, 0.09, 0.4
# Radius of a tie in the viewer as a share of that size.
_THICKNESS = 0.003
# A force with less than this share of it across the line of sight is a dot.
_SEEN_ON_END = 0.2


@dataclass(frozen=True, slots=True)
class DrawnLoads:
    """Loads and ties as they are drawn.

    names: of the loads (m). number (n,): which of them an arrow belongs to. at (n, 3) m: its tip. arrow (n, 3) m: from its tail
    to its tip; zero where a mass is only pushed. ties (k, 2, 3) m: from end to end. added (k,): whether the building as it is
    lacks the tie.
    """

    names: tuple[str, ...]
    number: IntArray
    at: FloatArray
    arrow: FloatArray
    ties: FloatArray
    added: tuple[bool, ...]


def drawn_loads(stones: Assemblage, applied: Iterable[Applied]) -> DrawnLoads:
    """Return all loads and ties of the analyses, by name; the first of them is that of the building as it is."""
    loads: dict[str, tuple[FloatArray, FloatArray]] = {}
    ties: dict[str, tuple[FloatArray, bool]] = {}
    for place, one in enumerate(applied):
        for name in dict.fromkeys(one.loads.load.tolist()):
            if name not in loads:
                loads[name] = _in_cells(one.loads, name, _CELL * stones.size)
        for number, tie in enumerate((*one.ties, *one.candidates)):
            ends = np.array([anchor.share @ anchor.point for anchor in anchors_of(stones, tie)])
            ties.setdefault(tie.name, (ends, place > 0 or number >= len(one.ties)))
    at = np.concatenate([place for place, _ in loads.values()] or [np.zeros((0, 3))])
    force = np.concatenate([force for _, force in loads.values()] or [np.zeros((0, 3))])
    size = np.linalg.norm(force, axis=1)
    share = np.where(size > 0, np.maximum(size / size.max(initial=1e-300), _SHORTEST), 0.0)
    arrow = force * (_LONGEST * stones.size * share / np.where(size > 0, size, 1.0))[:, None]
    return DrawnLoads(
        tuple(loads),
        np.repeat(np.arange(len(loads)), [len(place) for place, _ in loads.values()]),
        at,
        arrow,
        np.array([ends for ends, _ in ties.values()]).reshape(-1, 2, 3),
        tuple(added for _, added in ties.values()),
    )


def viewer_loads(drawn: DrawnLoads, origin: FloatArray, size: float) -> dict[str, Any]:
    """Return loads and ties for the viewer, m from `origin`: arrows, places without one, ties, and how thick they are.

    size: of the building, m.
    """
    length = np.linalg.norm(drawn.arrow, axis=1)
    tails = drawn.at - drawn.arrow - origin
    return {
        "arrows": [
            {"start": tails[i].tolist(), "direction": (drawn.arrow[i] / length[i]).tolist(), "length": float(length[i])}
            for i in np.flatnonzero(length > 0)
        ],
        "dots": (drawn.at - origin)[length == 0].tolist(),
        "ties": [{"ends": ends, "added": added} for ends, added in zip((drawn.ties - origin).tolist(), drawn.added, strict=True)],
        "thickness": _THICKNESS * size,
        "colours": {"load": colours.LOAD, "tie": colours.TIE},
    }


def _in_cells(loads: PlacedLoads, name: str, cell: float) -> tuple[FloatArray, FloatArray]:
    """Return the places (n, 3) m and the forces (n, 3) N of a load, summed up in cubes."""
    mine = np.flatnonzero(loads.load == name)
    point, force = loads.foot[mine], loads.dead[mine]
    _, group = np.unique(np.floor(point / cell), axis=0, return_inverse=True)
    group = group.ravel()
    # Where the forces of a cube act: their mean place, by size.
    size = np.linalg.norm(force, axis=1) + 1e-9 * (loads.mass[mine] + 1.0)
    weight, place, total = np.zeros(group.max() + 1), np.zeros((group.max() + 1, 3)), np.zeros((group.max() + 1, 3))
    np.add.at(weight, group, size)
    np.add.at(place, group, size[:, None] * point)
    np.add.at(total, group, force)
    return place / weight[:, None], total


def draw_loads(axes: Any, drawn: DrawnLoads, turned: FloatArray, cut: float | None, figures: float = 8.0) -> FloatArray:
    """Draw loads and ties, and return the points (n, 2) of the drawing that they reach.

    turned: unit vectors (3, 3) across, up and towards the eye. cut: what is nearer to the eye than this, m, is left out.
    figures: size of their numbers, points.
    """
    for ends, added in zip(drawn.ties @ turned.T, drawn.added, strict=True):
        if cut is None or ends[:, 2].min() < cut:
            line = (0, (3, 2)) if added else "-"
            axes.plot(ends[:, 0], ends[:, 1], color=colours.TIE, lw=1.1, ls=line, marker="s", ms=2.2, zorder=4)
    at, arrow = drawn.at @ turned.T, drawn.arrow @ turned.T
    shown = np.ones(len(at), dtype=bool) if cut is None else at[:, 2] < cut
    dot = shown & (np.linalg.norm(arrow[:, :2], axis=1) <= _SEEN_ON_END * np.linalg.norm(arrow, axis=1))
    flat = shown & ~dot
    axes.plot(*at[dot, :2].T, "o", color=colours.LOAD, ms=1.8, zorder=5)
    size = {"angles": "xy", "scale_units": "xy", "scale": 1, "pivot": "tip", "width": 0.005, "minlength": 0, "minshaft": 1}
    if flat.any():
        axes.quiver(*at[flat, :2].T, *arrow[flat, :2].T, color=colours.LOAD, zorder=5, **size)
    reached = np.concatenate([at[shown, :2], (at - arrow)[flat, :2]])
    for number in range(len(drawn.names)):
        mine = np.flatnonzero(shown & (drawn.number == number))
        if len(mine):
            # Loads that one sees behind one another have their figures beside each other.
            order = mine[np.argsort(at[mine, 0], kind="stable")]
            chosen = order[int((number + 0.5) / len(drawn.names) * len(order))]
            tail = at[chosen, :2] - (arrow[chosen, :2] if flat[chosen] else 0.0)
            axes.annotate(
                str(number + 1), tail, xytext=(2, 2), textcoords="offset points", fontsize=figures, color=colours.LOAD, zorder=6
            )
    return reached


def key_to_loads(drawn: DrawnLoads, *, beams: bool) -> list[str]:
    """Return the sentences that say what the arrows, dots, lines and, if there are any, the shaded ring beams are."""
    said: list[str] = []
    if drawn.names:
        named = ", ".join(f"{number} {name}" for number, name in enumerate(drawn.names, 1))
        said.append(
            f"Violet: loads, {named}. An arrow stands for what acts around its tip, and is the longer the larger that is."
        )
        said.append("A dot: a force along the line of sight, or a mass that only the earthquake pushes.")
    if len(drawn.ties):
        dashed = "; dashed: only in a variant, or one that might be added" if any(drawn.added) else ""
        said.append(f"Green: ties, and joists that hold walls together, with their anchors{dashed}.")
    if drawn.names or len(drawn.ties):
        said.append("Elevations and the plan show them through what hides them.")
    if beams:
        said.append("Blue: ring beams and slabs.")
    return said
