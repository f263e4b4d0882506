"""The displacement-based check of each capacity curve: its diagram, its table, and which check governs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.io.records import Analysis
from churchpipe.report import colours
from churchpipe.report.block_curves import curve_label
from churchpipe.report.plots import legend_beside, new_plot, svg_of
from churchpipe.report.table import figure

# Headings with what they mean; those from "Demand" on stand only where the case has a spectrum.
CAPACITY = (
    ("d, mm", "displacement of the equivalent oscillator at the limit state", "displacement_m", 1e3, 1),
    ("a, m/s\u00b2", "its acceleration there", "acceleration_m_s2", 1.0, 3),
    ("T, s", "secant period", "period_s", 1.0, 3),
    ("\u03be, %", "damping", "damping_percent", 1.0, 0),
    ("Demand, mm", "spectral displacement at that period for the a_g of the case", "demand_m", 1e3, 1),
    ("a_g, m/s\u00b2", "ground acceleration that the mechanism withstands", "a_g_m_s2", 1.0, 3),
)
_LIMIT_COLOURS = {"SLV": colours.PUSH, "SLC": colours.ALARM}


@dataclass(frozen=True, slots=True)
class DisplacementCheck:
    """A check as the report shows it: facts (words, value), rows of limit states, both closing sentences, "" where none."""

    label: str
    diagram: str
    facts: list[tuple[str, str]]
    rows: list[list[str]]
    governs: str
    missing: str


def displacement_checks(analyses: Sequence[Analysis], geometry: str | None) -> dict[str, Any] | None:
    """Return the checks made of capacity curves, None where there are none: headings, checks, refused (label, message).

    analyses: the records of the summary. geometry: that of the report where there are several.
    """
    mine = [record for record in analyses if record.method == "curve" and record.geometry == geometry]
    checked = [(record, record.check) for record in mine if record.check]
    if not checked:
        return None
    good = [(record, check) for record, check in checked if "message" not in check]
    return {
        "headings": [(title, meaning) for title, meaning, *_ in CAPACITY],
        "checks": [_check(_label(record), check) for record, check in good],
        "refused": [(_label(record), check["message"]) for record, check in checked if "message" in check],
    }


def _label(record: Analysis) -> str:
    return f"load {record.load}, {curve_label(record)}"


def _check(label: str, check: Mapping[str, Any]) -> DisplacementCheck:
    rows = [
        [name, *(figure(limit[key] * unit, digits) for _, _, key, unit, digits in CAPACITY)]
        for name, limit in check.get("limit_states", {}).items()
    ]
    return DisplacementCheck(label, adrs_svg(check), _facts(check), rows, check.get("governs", ""), check.get("missing", ""))


def _facts(check: Mapping[str, Any]) -> list[tuple[str, str]]:
    def level(key: str) -> str:
        return f"{figure(check[key], 3)} m/s\u00b2"

    facts = [
        ("\u03b1\u2080", figure(check["alpha0"], 4)),
        ("FC, confidence factor", figure(check["confidence_factor"], 2)),
        ("a\u2080* = \u03b1\u2080 g / FC, with e* = 1", level("a0_m_s2")),
        ("d\u2080, with e* = 1", f"{figure(1e3 * check['d0_m'], 1)} mm"),
        ("e* of the stones", figure(check["mass_fraction"], 3)),
    ]
    if "zeta_e" not in check:
        return facts
    verdict, force = "satisfied" if check["satisfied"] else "not satisfied", check["force_based"]
    of_force = f"a_g,SLV {figure(force['a_g_slv_m_s2'], 3)} m/s\u00b2, \u03b6_E {figure(force['zeta_e'], 2)}"
    return [
        *facts,
        ("a_g,SLV", f"{level('a_g_slv_m_s2')}; with e* of the stones {level('a_g_slv_stones_m_s2')}"),
        ("a_g,SLC", f"{level('a_g_slc_m_s2')}; with e* of the stones {level('a_g_slc_stones_m_s2')}"),
        ("\u03b6_E = a_g,SLV / a_g", f"{figure(check['zeta_e'], 2)}: {verdict} for a_g = {level('a_g_m_s2')}"),
        (f"the check with q = {force['q']:g}", of_force),
        ("a_g,SLV of the idealised curve", level("a_g_slv_idealised_m_s2")),
    ]


def adrs_svg(check: Mapping[str, Any]) -> str:
    """Return an SVG of acceleration against displacement: capacity, its idealisation, limit states, demand of the case."""
    plot, (axes,) = new_plot(1, (7.2, 3.6))
    capacity = [1e3 * np.array(check["displacement_m"]), np.array(check["acceleration_m_s2"])]
    axes.plot(*capacity, "-", lw=2, color=colours.INK, label="capacity")
    ideal = [0, 1e3 * check["idealised_d0_m"]], [check["acceleration_m_s2"][0], 0]
    axes.plot(*ideal, "--", lw=1, color=colours.INK, label="idealised, of the same area")
    for name, demand in check.get("demand", {}).items():
        colour, limit = _LIMIT_COLOURS[name], check["limit_states"][name]
        place, level = 1e3 * limit["displacement_m"], limit["acceleration_m_s2"]
        label = f"demand, {limit['damping_percent']:g} %"
        axes.plot(1e3 * np.array(demand["displacement_m"]), demand["acceleration_m_s2"], lw=1.2, color=colour, label=label)
        secant = 4 * np.pi**2 * limit["displacement_m"] / limit["period_s"] ** 2
        axes.plot([0, place], [0, secant], ":", lw=1.2, color=colour, label=f"period of {name}")
        axes.plot([place], [level], "o", ms=6, color=colour, label=f"d of {name}")
    axes.set_xlabel("displacement d, mm", fontsize=8)
    axes.set_ylabel("acceleration a, m/s\u00b2", fontsize=8)
    axes.set_xlim(0, 1.05 * max(*capacity[0], ideal[0][1]))
    axes.set_ylim(bottom=0)
    legend_beside(axes)
    return svg_of(plot)
