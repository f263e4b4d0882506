"""The part of the report that sets the two models side by side: what the template shows of the shell."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from churchpipe.io.summary import Pair, Summary
from churchpipe.match import Figure
from churchpipe.model.results import CapacityCurve
from churchpipe.model.shell import ShellModel
from churchpipe.model.swept import MESH_SIZE, of_both, setting
from churchpipe.report.block_curves import control_words
from churchpipe.report.shell_plots import capacity_svg, domain_svg, mesh_svg
from churchpipe.report.table import Row, change, figure, friction_text, minus, swept


def question(row: Row) -> tuple[str, ...]:
    """Return what an analysis asks, by either model: stones, load, strength."""
    others = {key: value for key, value in swept(row).items() if of_both(key)}
    strength = friction_text(row), str(row.record.cohesion)
    return row.record.geometry or "", row.load, *strength, str(others), row.variant


def partner(row: Row, rows: Sequence[Row]) -> int:
    """Return which of the rigid-block rows asks the same as a row of the shell; -1: none."""
    return next((number for number, other in enumerate(rows) if question(other) == question(row)), -1)


def compared(pairs: Sequence[Pair], rows: Sequence[Row]) -> list[list[str]]:
    """Return the table of pairs: load and variant, analysis and load factor of either model, their ratio, overlap."""
    by_name = {row.record.name: row for row in rows}
    out: list[list[str]] = []
    for pair in pairs:
        blocks, shell = by_name.get(pair.blocks), by_name.get(pair.shell)
        if blocks and shell:
            cells = [text for row in (blocks, shell) for text in (_words(row), figure(row.value("load_factor"), 4))]
            ends = [
                "" if pair.ratio is None else change(pair.ratio - 1),
                "" if pair.overlap is None else minus(f"{pair.overlap:.2f}"),
            ]
            out.append([", ".join(filter(None, (blocks.load, blocks.variant))), *cells, *ends])
    return out


def _words(row: Row) -> str:
    more = [setting(key, value) for key, value in swept(row).items() if key != MESH_SIZE]
    return ", ".join([row.kind, *([row.mesh_size] if row.mesh_size else []), f"friction {friction_text(row)}", *more])


def gate(summary: Summary, meshes: Sequence[str]) -> dict[str, Any] | None:
    """Return the gate of the first of a report's meshes as text, or None: passed, message, stones unfit and moved, rows."""
    match = next((summary.shells[name].match for name in meshes if name in summary.shells), summary.match)
    if match is None:
        return None
    rows = [
        [
            *(item.name, *(_quantity(value, item.unit) for value in (item.stones, item.shell)), *_apart(item)),
            "agrees" if item.passed else "differs",
        ]
        for item in match.figures
    ]
    overlap = match.junction_overlap
    words = {key: getattr(match, key) for key in ("passed", "message", "unfit", "moved")}
    return words | {"rows": rows, "junction_overlap": "" if overlap is None else f"{100 * overlap:.1f} %"}


def _quantity(value: float, unit: str) -> str:
    return minus(f"{value:.6g}") + (f" {unit}" if unit else "")


def _apart(item: Figure) -> tuple[str, str]:
    if item.unit == "degrees":
        return f"{item.difference:.2f}\u00b0", f"{item.tolerance:g}\u00b0"
    return _percent(100 * item.difference), f"{100 * item.tolerance:g} %"


def _percent(value: float) -> str:
    """Return per cent as text that can be compared with what is allowed; what rounding leaves is not counted out."""
    if 0 < value < 1e-3:
        return "< 0.001 %"
    return f"{value:.2f} %" if value >= 1 else f"{value:.3g} %"


def capacity_plots(rows: Sequence[Row]) -> list[tuple[str, str]]:
    """Return heading and plot of the capacity curves of each question, the load factors of the other analyses as lines."""
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        if row.shell and isinstance(row.shell[1], CapacityCurve) and len(row.shell[1].control) > 1:
            groups.setdefault(question(row), []).append(row)
    plots: list[tuple[str, str]] = []
    for asked, members in groups.items():
        curves = [
            (_words(row), 1e3 * row.shell[1].control, row.shell[1].load_factor)
            for row in members
            if row.shell and isinstance(row.shell[1], CapacityCurve)
        ]
        meshes = {row.shell[0] for row in members if row.shell}
        others = [r for r in rows if question(r) == asked and r not in members and (not r.shell or r.shell[0] in meshes)]
        lines = [
            (_line(row), value) for row in others if (value := row.value("load_factor")) is not None and math.isfinite(value)
        ]
        followed = " and ".join(dict.fromkeys(control_words(row.record) for row in members if row.record.control_at))
        heading = _question_words(members[0]) + (f", displacement of {followed}" if followed else "")
        plots.append((heading, capacity_svg(curves, lines)))
    return plots


def _line(row: Row) -> str:
    return "shell, limit analysis" if row.of_shell else f"rigid blocks, {row.kind}"


def mesh_plot(rows: Sequence[Row]) -> str:
    """Return load factor against element size when some analysis of the shell was made on several meshes; else ""."""
    series: dict[tuple[str, ...], list[tuple[float, float]]] = {}
    words: dict[tuple[str, ...], str] = {}
    for row in rows:
        factor, size = row.value("load_factor"), row.record.element_size
        if row.of_shell and size and factor is not None and math.isfinite(factor):
            series.setdefault((*question(row), row.kind), []).append((1e3 * size, factor))
            words.setdefault(question(row), _question_words(row))
    drawn = {key: points for key, points in series.items() if len({size for size, _ in points}) > 1}
    if not drawn:
        return ""
    several = len({key[:-1] for key in drawn}) > 1
    labels = {key: f"shell, {key[-1]}" + (f", {words[key[:-1]]}" if several else "") for key in drawn}
    asked = {key[:-1] for key in drawn}
    lines = [
        (_line(row), value)
        for row in rows
        if not row.of_shell
        and question(row) in asked
        and (value := row.value("load_factor")) is not None
        and math.isfinite(value)
    ]
    return mesh_svg([(labels[key], *np.array(points).T) for key, points in drawn.items()], [] if several else lines)


def _question_words(row: Row) -> str:
    """Return what tells a `question` from others: its variant, if it is of one, load, friction and what else is swept."""
    more = [setting(key, value) for key, value in swept(row).items() if of_both(key)]
    return ", ".join([*([row.variant] if row.variant else []), f"load {row.load}", f"friction {friction_text(row)}", *more])


def domain_plot(meshes: Mapping[str, ShellModel], rows: Sequence[Row]) -> tuple[str, str]:
    """Return sections of the strength of the most common unit cell of the shell, and what they are drawn for."""
    shell = next(iter(meshes.values()), None)
    frictions = next((row.record.friction for row in rows if row.of_shell), None)
    if shell is None or frictions is None or not shell.yields.any():
        return "", ""
    bonds, rank = np.unique(shell.bonds, return_inverse=True)
    materials, made_of = np.unique(shell.material, return_inverse=True)
    sizes = shell.unit_cells[shell.cell], shell.thickness, rank.ravel()[shell.cell], made_of.ravel()
    known, kind = np.unique(np.column_stack(sizes)[shell.yields], axis=0, return_inverse=True)
    a, b, h, *numbers = known[np.argmax(np.bincount(kind.ravel(), shell.area[shell.yields]))].tolist()
    bond, material = (str(names[int(number)]) for names, number in zip((bonds, materials), numbers, strict=True))
    friction = frictions.get(material) if isinstance(frictions, dict) else frictions
    if not friction:
        return "", ""
    sizes_mm = f"course height {1e3 * a:g} mm, stone length {1e3 * b:.4g} mm, thickness {1e3 * h:g} mm"
    words = f"{bond} bond, {sizes_mm}, friction {friction:g}"
    return domain_svg(a, b, h, friction, bond), words
