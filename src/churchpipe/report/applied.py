"""What a building carries, and its ties: tables of the report, and lines and arrows on its pictures."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from churchpipe.geometry.charts import way
from churchpipe.io.records import Analysis
from churchpipe.io.tie_records import TieForce
from churchpipe.loading.joists import AT_BEARINGS
from churchpipe.loading.ties import anchors_of
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.gains import WEIGHT_MORE
from churchpipe.model.motion import velocity_at
from churchpipe.model.placed_loads import Applied, PlacedLoads
from churchpipe.report import colours
from churchpipe.report.table import Row, amount, figure, minus, named_of
from churchpipe.stones.ring_beams import ring_beams
from churchpipe.wording import in_runs

# Length of the longest arrow over the size of the building, and most arrows drawn of a load.
_ARROW, _ARROWS = 0.08, 25
# Walls listed of an analysis.
_GAINS = 4
# A table of more rows than `_WHOLE` has so many before it, those that govern.
_WHOLE, LEADING = 12, 8
# A tie with less than this share of its strength is slack: what rounding leaves.
_SLACK = 1e-6


def load_rows(applied: Mapping[str, Applied], analyses: Iterable[Analysis] = ()) -> list[list[str]]:
    """Return a row for each load, by name: what presses, what pushes level, and the mass that the load factor multiplies, kN; one
    that is another in a variant, or with swept values, has a row for each, which says so.

    applied: of the analyses, by their names, the building as it is first.
    """
    records, found, known = {record.name: record for record in analyses}, list[list[str]](), dict[str, list[list[str]]]()
    for analysis, one in applied.items():
        loads = one.loads
        for name in dict.fromkeys(loads.load.tolist()):
            mine = loads.load == name
            level = float(np.linalg.norm(loads.dead[mine].sum(axis=0)[:2]))
            sums = (float(loads.weight[mine].sum()), level, float(loads.mass[mine].sum()))
            cells = [_bears_on(loads, mine), *(amount(value / 1e3, 1) for value in sums)]
            if cells not in (before := known.setdefault(name, [])):
                record = records.get(analysis) if before else None
                found.append([named_of(name, record.variant, record.swept) if record else name, *cells])
                before.append(cells)
    return found


def _bears_on(loads: PlacedLoads, mine: BoolArray) -> str:
    """Return the walls that bear a load; of a pressure also where their faces look."""
    walls = ", ".join(np.unique(loads.wall[mine]).tolist())
    if not str(loads.load[mine][0]).startswith("pressure "):
        return walls
    level = loads.dead[mine].sum(axis=0)[:2]
    return f"{walls}: faces that look to {minus(way(-level / np.linalg.norm(level)))}"


def beam_rows(stones: Assemblage) -> list[list[str]]:
    """Return a row for each ring beam: name, material, height m and weight kN."""
    rows: list[list[str]] = []
    for stone in np.flatnonzero(ring_beams(stones)).tolist():
        height = np.ptp(stones.points[slice(*stones.block_point_ptr[stone : stone + 2]), 2])
        name, material = str(stones.panel[stone]), str(stones.material[stone])
        rows.append([name, material, amount(float(height), 2), amount(float(stones.weight[stone]) / 1e3, 1)])
    return rows


def tie_rows(rows: Sequence[Row]) -> list[list[str]]:
    """Return a row for each tie of each analysis: tension and strength, kN, their ratio, and what governs. Joists of a floor that
    have all of it in common, as those that slide, have one row."""
    return [cells for cells, _ in _tie_rows(rows)]


def leading_ties(rows: Sequence[Row]) -> list[list[str]]:
    """Return those rows of `tie_rows` that govern where there are many, else none: ties at their strength, and those nearest to
    it."""
    ties = _tie_rows(rows)
    return _leading([cells for cells, _ in ties], [tie.share for _, tie in ties], [tie.yielded for _, tie in ties])


def _tie_rows(rows: Sequence[Row]) -> list[tuple[list[str], TieForce]]:
    """Return the cells of each row of the table of ties, and the first tie of it."""
    found: list[tuple[list[str], TieForce]] = []
    for row in rows:
        alike: dict[tuple[str, ...], list[TieForce]] = {}
        for number, tie in enumerate(row.record.tie_forces):
            floor = tie.name.rpartition(" ")[0] if tie.governs.endswith(AT_BEARINGS) else str(number)
            alike.setdefault((floor, *_tie_cells(tie)), []).append(tie)
        for (floor, *cells), ties in alike.items():
            numbers = in_runs(int(tie.name.rpartition(" ")[2]) for tie in ties) if len(ties) > 1 else ""
            name = f"{floor} {numbers}" if numbers else ties[0].name
            found.append(([row.label, name, *cells], ties[0]))
    return found


def _tie_cells(tie: TieForce) -> tuple[str, ...]:
    return (
        amount(0.0 if tie.tension <= _SLACK * tie.strength else tie.tension / 1e3, 1),
        amount(tie.strength / 1e3, 1),
        "" if math.isnan(tie.share) else f"{tie.share:.2f}",
        "yes" if tie.yielded else "no",
        tie.governs,
    )


def leading_candidates(rows: Sequence[Row]) -> list[list[str]]:
    """Return those rows of `candidate_rows` that govern where there are many, else none: ties that were analysed, and those that
    may add most."""
    ties = [tie for row in rows for tie in row.record.tie_candidates]
    # Analyses differ in their load factors: a tie adds to that of its own.
    added = [tie.rate * tie.strength for tie in ties]
    return _leading(candidate_rows(rows), added, [math.isfinite(tie.load_factor) for tie in ties])


def _leading(rows: list[list[str]], size: Sequence[float], kept: Sequence[bool]) -> list[list[str]]:
    """Return the rows to keep, and those of the largest size until they are `LEADING`, largest first; none of a short table."""
    if len(rows) <= _WHOLE:
        return []
    order = sorted(range(len(rows)), key=lambda row: (not kept[row], math.isnan(size[row]), -size[row]))
    return [rows[row] for row in order[: max(LEADING, sum(kept))]]


def candidate_rows(rows: Sequence[Row]) -> list[list[str]]:
    """Return a row for each tie that might be added, by analysis: the most that it can make of the load factor, and the load
    factor with it where that was analysed."""
    return [
        [
            row.label,
            one.name,
            amount(one.strength / 1e3, 1),
            f"{1e3 * one.rate:.2e}",
            "no bound" if math.isnan(one.most) else figure(one.most, 4),
            "not analysed" if math.isnan(one.load_factor) else figure(one.load_factor, 4),
        ]
        for row in rows
        for one in row.record.tie_candidates
    ]


def gain_table(rows: Sequence[Row], weight: float) -> tuple[list[str], list[list[str]]]:
    """Return titles, and for each analysis a row for each of the walls that more cohesion would help most, and for each that was
    analysed again: what cohesion and weight add to the load factor by the rate, and in that analysis, if there is one.

    weight: of the building, N. Of a small one a smaller weight is added than of a large one: a tangent knows no more.
    """
    out: list[list[str]] = []
    analysed = any(math.isfinite(gain.with_weight) for row in rows for gain in row.record.gains)
    step = WEIGHT_MORE if analysed else min(WEIGHT_MORE, 10.0 ** (math.floor(math.log10(weight)) - 2))
    added = f"{step / 1e3:g} kN" if step >= 1e3 else f"{step:g} N"
    titles = ("Analysis", "Wall", "10 kPa of cohesion", "analysed", f"{added} of weight", "analysed")
    for row in rows:
        gains = sorted(row.record.gains, key=lambda gain: -gain.cohesion)
        again = [math.isfinite(gain.with_cohesion) or math.isfinite(gain.with_weight) for gain in gains]
        for one in [gain for number, gain in enumerate(gains) if number < _GAINS or again[number]]:
            cells = [minus(f"{1e4 * one.cohesion:+z.4f}"), _again(row, one.with_cohesion)]
            cells += [minus(f"{step * one.weight:+z.5f}"), _again(row, one.with_weight)]
            out.append([row.label, one.panel, *cells])
    kept = [column for column, title in enumerate(titles) if title != "analysed" or any(row[column] for row in out)]
    return [titles[column] for column in kept], [[row[column] for column in kept] for row in out]


def _again(row: Row, factor: float) -> str:
    """Return how much a load factor changed in a new analysis, if there was one."""
    return "" if math.isnan(factor) else minus(f"{factor - row.record.load_factor:+z.5f}")


def add_applied(plotter: Any, stones: Assemblage, motion: FloatArray, amplitude: float, applied: Applied) -> None:
    """Add ties as lines between their anchors, displaced by the motion (nb, 6), and loads as arrows on the building."""
    import pyvista as pv

    for tie in applied.ties:
        ends: list[FloatArray] = []
        for anchor in anchors_of(stones, tie):
            moved = velocity_at(stones, motion, anchor.stone, anchor.point)
            ends.append(anchor.share @ (anchor.point + amplitude * moved))
        plotter.add_mesh(pv.Line(ends[0], ends[1]).tube(radius=0.004 * stones.size), color=colours.TIE, lighting=False)
    loads = applied.loads
    if not len(loads.load):
        return
    at = loads.foot + amplitude * velocity_at(stones, motion, loads.stone, loads.foot)
    strongest = float(np.linalg.norm(loads.dead, axis=1).max()) or 1.0
    for name in dict.fromkeys(loads.load.tolist()):
        mine = np.flatnonzero((loads.load == name) & (np.linalg.norm(loads.dead, axis=1) > 0))
        for part in mine[:: max(1, len(mine) // _ARROWS)]:
            force = loads.dead[part]
            length = _ARROW * stones.size * max(0.4, float(np.linalg.norm(force)) / strongest)
            way = force / np.linalg.norm(force)
            arrow = pv.Arrow(
                start=at[part] - length * way, direction=way, scale=length, shaft_radius=0.02, tip_radius=0.07, tip_length=0.3
            )
            plotter.add_mesh(arrow, color=colours.LOAD, lighting=False)
