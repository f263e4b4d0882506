"""The displacement-based check of each capacity curve: its diagram, its table, and which check governs."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.io.records import Analysis
from churchpipe.model.checks import UNRELIABLE, DisplacementCheck, SpectrumParameters
from churchpipe.report import colours
from churchpipe.report.block_curves import curve_label
from churchpipe.report.plots import WIDTH, legend_below, new_plot, svg_of
from churchpipe.report.safety import verdict
from churchpipe.report.table import figure

# Headings with what they mean; those from "Demand" on stand only where the case has a spectrum.
CAPACITY = (
    ("d, mm", "displacement of the equivalent oscillator at the limit state", "displacement", 1e3, 1),
    ("a, m/s\u00b2", "its acceleration there", "acceleration", 1.0, 3),
    ("T, s", "secant period", "period", 1.0, 3),
    ("\u03be, %", "damping", "damping_percent", 1.0, 0),
    ("Demand, mm", "spectral displacement at that period for the a_g of the case", "demand", 1e3, 1),
    ("a_g withstood, m/s\u00b2", "ground acceleration that the mechanism withstands", "a_g", 1.0, 3),
)
_LIMIT_COLOURS = {"SLV": colours.PUSH, "SLC": colours.ALARM}


@dataclass(frozen=True, slots=True)
class ShownCheck:
    """A check as the report shows it: facts (words, value), rows of limit states, what is said of it, "" for nothing.

    severe: it withstands less than the check with q; steady: steps half as long change little.
    """

    label: str
    diagram: str
    facts: list[tuple[str, str]]
    rows: list[list[str]]
    governs: str
    missing: str
    unproved: str
    halved: str
    lost_seat: str
    collapse_first: str
    severe: bool
    steady: bool


def displacement_checks(analyses: Sequence[Analysis], geometry: str | None) -> dict[str, Any] | None:
    """Return the checks made of capacity curves, None where there are none: headings, checks, refused (label, message).

    analyses: the records of the summary. geometry: that of the report where there are several.
    """
    checked = [(one, one.check) for one in analyses if one.method == "curve" and one.geometry == geometry and one.check]
    if not checked:
        return None
    # One that is refused may say something of the curve besides.
    made = [(record, check) for record, check in checked if isinstance(check, DisplacementCheck) and not check.message]
    refused = [
        (_label(record), " ".join(said for said in (check.message, getattr(check, "halved", "")) if said))
        for record, check in checked
        if check.message
    ]
    return {
        "headings": [(title, meaning) for title, meaning, *_ in CAPACITY],
        "checks": [_shown(_label(record), check) for record, check in made],
        "refused": refused,
    }


def _label(record: Analysis) -> str:
    return f"load {record.load}, {curve_label(record)}"


def _shown(label: str, check: DisplacementCheck) -> ShownCheck:
    rows = [
        [name, *(figure(getattr(limit, key) * unit, digits) for _, _, key, unit, digits in CAPACITY)]
        for name, limit in check.limit_states.items()
    ]
    said = check.governs, check.missing, check.unproved, check.halved, check.lost_seat, check.collapse_first
    severe = check.force_based is not None and check.a_g_slv < check.force_based.a_g_slv
    return ShownCheck(label, adrs_svg(check), _facts(check), rows, *said, severe=severe, steady=UNRELIABLE not in check.halved)


def _facts(check: DisplacementCheck) -> list[tuple[str, str]]:
    def level(value: float) -> str:
        return f"{figure(value, 3)} m/s\u00b2"

    facts = [
        ("\u03b1\u2080", figure(check.alpha0, 4)),
        ("FC, confidence factor", figure(check.confidence_factor, 2)),
        ("a\u2080* = \u03b1\u2080 g / FC, with e* = 1", level(check.a0)),
        ("d\u2080, with e* = 1", f"{figure(1e3 * check.d0, 1)} mm"),
        ("e* of the stones", figure(check.mass_fraction, 3)),
    ]
    if check.satisfied is None or check.force_based is None:
        return facts
    force = check.force_based
    of_force = f"a_g,SLV {level(force.a_g_slv)}, \u03b6_E {figure(force.zeta_e, 2)}"
    return [
        *facts,
        *([(f"spectrum at a_g = {level(check.a_g)}", _spectrum_words(check.spectrum))] if check.spectrum else []),
        ("a_g,SLV", f"{level(check.a_g_slv)}; with e* of the stones {level(check.a_g_slv_stones)}"),
        ("a_g,SLC", f"{level(check.a_g_slc)}; with e* of the stones {level(check.a_g_slc_stones)}"),
        ("\u03b6_E = a_g,SLV / a_g", f"{figure(check.zeta_e, 2)}: {verdict(check)} for a_g = {level(check.a_g)}"),
        (f"the check with q = {force.q:g}", of_force),
        ("a_g,SLV of the idealised curve", level(check.a_g_slv_idealised)),
    ]


def _spectrum_words(made: SpectrumParameters) -> str:
    """Return the parameters of a spectrum by the letters of the code, S_S and S_T where they are known."""
    factors = ("S_S", made.stratigraphic), ("S_T", made.topographic), ("S", made.soil_factor), ("C_C", made.period_factor)
    periods = ("T_B", made.rising_end), ("T_C", made.plateau_end), ("T_D", made.velocity_end)
    return ", ".join(
        [
            *(f"{letter} {figure(value, 3)}" for letter, value in factors if value is not None),
            *(f"{letter} {figure(value, 3)} s" for letter, value in periods),
        ]
    )


def adrs_svg(check: DisplacementCheck) -> str:
    """Return an SVG of acceleration against displacement: capacity, its idealisation, limit states, demand of the case."""
    plot, (axes,) = new_plot(1, (WIDTH, 3.2))
    reach = 1e3 * np.array(check.displacement)
    axes.plot(reach, check.acceleration, "-", lw=2, color=colours.INK, label="capacity")
    end = 1e3 * check.idealised_d0
    axes.plot([0, end], [check.acceleration[0], 0], "--", lw=1, color=colours.INK, label="idealised, of the same area")
    for name, demand in check.demand.items():
        colour, limit = _LIMIT_COLOURS[name], check.limit_states[name]
        place = 1e3 * limit.displacement
        label = f"demand, {limit.damping_percent:g} %"
        axes.plot(1e3 * np.array(demand.displacement), demand.acceleration, lw=1.2, color=colour, label=label)
        # What loses its connections as it starts to move has no period.
        if limit.period > 0:
            secant = 4 * np.pi**2 * limit.displacement / limit.period**2
            axes.plot([0, place], [0, secant], ":", lw=1.2, color=colour, label=f"period of {name}")
        axes.plot([place], [limit.acceleration], "o", ms=6, color=colour, label=f"d of {name}")
    axes.set_xlabel("displacement d, mm", fontsize=8)
    axes.set_ylabel("acceleration a, m/s\u00b2", fontsize=8)
    axes.set_xlim(0, 1.05 * max(*reach, end))
    axes.set_ylim(bottom=0)
    legend_below(axes)
    return svg_of(plot)
