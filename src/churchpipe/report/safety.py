"""The safety check and the macro-elements of the mechanisms, as the rows of two tables."""

import math
from collections.abc import Hashable, Sequence
from typing import Any

from churchpipe.io.records import Analysis
from churchpipe.mechanism import STILL, TAKES_PART, Part
from churchpipe.model.checks import Check, SafetyCheck
from churchpipe.model.quantities import in_unit
from churchpipe.report.table import Row, amount, figure, minus, named_of
from churchpipe.wording import counted

# Share of the mechanism's speed from which on a stone is said to move.
CUT_OFF = f"1/{1 / STILL:.0f}"

NOT_SATISFIED = "not satisfied"
# So few stones are no part of a building: what a mechanism of them says holds for them alone.
FEW_STONES = 3

# Headings with what they mean; those of SITE stand only where they are known, as where the case says what the earthquake asks.
ACTIVATION = (
    ("\u03b1\u2080", "load factor, as a multiplier of all weights that move", "alpha0", 4),
    ("Moving, kN", "weight of the stones that move", "moving_weight", 0),
    ("Stones", f"stones that move: faster than {CUT_OFF} of the mechanism", "moving_stones", 0),
    ("FC", "confidence factor", "confidence_factor", 2),
    ("a\u2080*, m/s\u00b2", "spectral acceleration that activates the mechanism, with e* = 1", "a0_lumped", 3),
    ("M*, t", "participating mass of the stones", "participating_mass", 1),
    ("e* of stones", "fraction of the moving mass that participates, each stone lumped at its centroid", "mass_fraction", 3),
    ("a\u2080* of stones, m/s\u00b2", "the same acceleration with e* of the stones", "a0", 3),
)
SITE = (
    ("Begins at, m", "height of the lowest stone that moves above the foot of the building", "begins", 2),
    ("a_g, m/s\u00b2", "ground acceleration on rock", "a_g", 3),
    ("S", "soil factor", "soil_factor", 2),
    ("q", "behaviour factor", "q", 1),
    ("a_g S / q, m/s\u00b2", "demand at the ground", "demand", 3),
    ("Z, m", "height of the mechanism above the foundation, as the case gives it", "floor_height", 2),
    ("a_Z / q, m/s\u00b2", "demand at the height of the mechanism", "floor_demand", 3),
    ("a_g,SLV, m/s\u00b2", "ground acceleration that the mechanism withstands, with e* = 1", "a_g_slv", 3),
    ("\u03b6_E", "a_g,SLV over a_g, with e* = 1", "zeta_e", 2),
    ("\u03b6_E, FC 1.35", "\u03b6_E with the confidence factor of the lowest knowledge level, e* = 1", "zeta_e_lc1", 2),
    ("\u03b6_E of stones", "the same with e* of the stones", "zeta_e_stones", 2),
)


def check_table(rows: Sequence[Row]) -> dict[str, Any] | None:
    """Return the table of safety checks, or None where no analysis has one, or all only multiply what is carried and the case
    says nothing of the site: headings, rows of cells, chips (the column of the verdicts, where there is one), sited, refused."""
    found = [
        (row, row.record.check) for row in rows if isinstance(row.record.check, SafetyCheck) and row.record.method != "curve"
    ]
    good = [(row, check) for row, check in found if not check.message]
    about = any(not row.record.multiplies or math.isfinite(check.a_g) for row, check in found)
    if not about:
        return None
    columns = [*ACTIVATION, *(column for column in SITE if any(_cell(check, *column[2:]) for _, check in good))]
    sited = any(check.satisfied is not None or math.isfinite(check.a_g) for _, check in found)
    return {
        "headings": ["Analysis", *((title, meaning) for title, meaning, _, _ in columns), *(["Verdict"] if sited else [])],
        "rows": [
            [row.label, *(_cell(check, *column[2:]) for column in columns), *([verdict(check)] if sited else [])]
            for row, check in good
        ],
        "chips": [len(columns) + 1] if sited else [],
        "kinds": ["crushing" if row.record.crushes else "" for row, _ in good],
        "sited": sited,
        "floor": any(math.isfinite(check.floor_demand) for _, check in good),
        "refused": [(row.label, check.message) for row, check in found if check.message],
    }


def _cell(check: SafetyCheck, name: str, digits: int) -> str:
    value, _ = in_unit(check, name)
    return "" if value is None or math.isnan(value) else amount(value, digits)


def verdict(check: Check | None) -> str:
    """Return whether a safety check is satisfied, in words; "" where there is none or the case says nothing of the site."""
    if check is None or check.satisfied is None:
        return ""
    if check.satisfied:
        return "satisfied"
    return "only with e* of stones" if check.satisfied_stones else NOT_SATISFIED


def safety_index(row: Row) -> str:
    """Return zeta_E of a row's check with its verdict, with e* = 1 first; "" where the case says nothing of the site."""
    check = row.record.check
    if check is None or check.satisfied is None:
        return ""
    of_stones = figure(check.zeta_e_stones, 2)
    return f"\u03b6_E = {figure(check.zeta_e, 2)}, {verdict(check)}; with e* of the stones {of_stones}"


def fails(row: Row) -> bool:
    """Return whether a row's check was made and is not satisfied."""
    return row.record.check is not None and row.record.check.satisfied is False


def overall(rows: Sequence[Row], questions: Sequence[Hashable]) -> dict[str, Any] | None:
    """Return the verdict on all loads of the building as it is, None where the case says nothing of the site: satisfied (None
    where no load has a check), words.

    questions: what each row asks. Where one has a capacity curve the check by displacements governs, as the rule of the circular;
    else the lowest zeta_E does. What has no check is named: a verdict on some loads is none on the others.
    """
    asked: dict[Hashable, list[Row]] = {}
    unmade: dict[Hashable, Row] = {}
    for row, question in zip(rows, questions, strict=True):
        if row.record.check is not None and row.record.check.satisfied is not None:
            asked.setdefault(question, []).append(row)
        elif not row.of_shell and row.record.status != "unbounded":
            unmade.setdefault(question, row)
    # What only grows is not asked of an earthquake.
    without = [row.label for question, row in unmade.items() if question not in asked and not (asked and row.record.multiplies)]
    if not asked:
        sited = any(row.record.check is not None and math.isfinite(row.record.check.a_g) for row in rows)
        words = f"No load of the case has a check: {'; '.join(without)}. The table of the safety check says why."
        return {"satisfied": None, "words": words} if sited else None
    found = [(_lowest([row for row in of_one if row.record.method == "curve"] or of_one), of_one) for of_one in asked.values()]
    (lead, alike), failed = min(found, key=lambda one: _zeta(one[0])), [row for row, _ in found if fails(row)]
    of_site = figure(lead.record.check.a_g if lead.record.check else None, 3)
    words = (
        f"the lowest safety index \u03b6_E is {figure(_zeta(lead), 2)} ({lead.label}): the ground acceleration that the building "
        f"withstands, over the a_g = {of_site} m/s\u00b2 that is asked for."
    )
    loads = ", ".join(dict.fromkeys(row.load for row in failed))
    told = f"Under {loads} the building does not bear what the earthquake asks;" if failed else "Of the loads of the case"
    if fallen := list(dict.fromkeys(row.load for row in failed if row.record.status == "unstable")):
        told += f" under {', '.join(fallen)} it does not stand even under its own weight;"
    words = f"{told} {words}"
    if lead.record.flow == "associative" and lead.record.status != "unstable":
        words += " It is made of an associative load factor, an upper estimate where joints slide."
    words += _decided(found)
    words += _moving(lead, alike)
    if any(row.of_shell for row in rows):
        words += " The check is of the stones; the shell has none."
    if without:
        words += f" There is no check of: {'; '.join(without)}."
    return {"satisfied": not failed, "words": words}


def _decided(found: Sequence[tuple[Row, Sequence[Row]]]) -> str:
    """Return what to say where a check by displacements decides that is satisfied while one by accelerations is not, else "";
    found: the row that decides, and all that ask the same."""
    passed = [rows for decides, rows in found if decides.record.method == "curve" and not fails(decides)]
    failed = [row for rows in passed for row in rows if row.record.method != "curve" and fails(row)]
    if not failed:
        return ""
    least = _lowest(failed)
    return (
        " Where a load has a check by displacements, that one decides. By accelerations alone, which say when stones begin to "
        f"move, the lowest ζ_E is {figure(_zeta(least), 2)} ({least.label})."
    )


def _moving(lead: Row, alike: Sequence[Row]) -> str:
    """Return the sentence on what moves in an analysis, "" where none tells; of a capacity curve, whose record does not, what
    starts to move in the first that does of those that ask the same."""
    teller = next((row for row in (lead, *alike) if what_moves(row.record)), None)
    if teller is None:
        return ""
    start = "What moves" if teller is lead else f"What starts to move ({teller.label})"
    return f" {start}, by its share of the motion: {what_moves(teller.record)}."


def _lowest(rows: Sequence[Row]) -> Row:
    return min(rows, key=_zeta)


def _zeta(row: Row) -> float:
    return row.record.check.zeta_e if row.record.check else math.inf


def part_overview(rows: Sequence[Row]) -> dict[str, Any] | None:
    """Return the share of the motion of each macro-element under each load, or None where there is one analysis to tell of.

    headings (load, model and kind, variant and what is swept); rows of cells of all that move under some load, "" where at rest;
    still: the others.
    """
    shown = _first_of_each(rows)
    if len(shown) < 2:
        return None
    motion = [{part.name: part.motion for part in row.record.parts if part.moving > 0} for row in shown]
    largest = {name: max(shares.get(name, 0.0) for shares in motion) for shares in motion for name in shares}
    names = dict.fromkeys(part.name for row in shown for part in row.record.parts)
    return {
        "headings": ["Share of the motion", *map(_named, shown)],
        "rows": [
            [name, *("" if name not in shares else _percent(shares[name]) for shares in motion)]
            for name in sorted(largest, key=lambda name: -largest[name])
        ],
        "still": [name for name in names if name not in largest],
    }


def _named(row: Row) -> str:
    """Return the load, the model and the kind of an analysis, and the variant and swept settings that it is of."""
    return named_of(f"{row.load}, {'shell, ' if row.of_shell else ''}{row.kind}", row.record.variant, row.record.swept)


def what_moves(record: Analysis) -> str:
    """Return the macro-elements that take part in the motion, with the most first; "" where none is known.

    Where no more than a few stones of them move, it says so: the share is that of the motion, not of the macro-element.
    """
    parts = [part for part in record.parts if part.motion >= TAKES_PART]
    words = ", ".join(f"{part.name} {_percent(part.motion)}" for part in parts)
    check = record.check
    if not parts or not isinstance(check, SafetyCheck) or not 0 < (check.moving_stones or 0) <= FEW_STONES:
        return words
    return f"{words}; no more than {counted(check.moving_stones or 0, 'stone')} of {figure(check.moving_weight / 1e3, 2)} kN"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 5e-3 else "< 1 %"


def _first_of_each(rows: Sequence[Row]) -> list[Row]:
    """Return the first analysis of each load, model and kind whose macro-elements are known."""
    first: dict[tuple[str, bool, str], Row] = {}
    for row in rows:
        if row.record.parts:
            first.setdefault((row.load, row.of_shell, row.kind), row)
    return list(first.values())


def part_tables(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return for the first analysis of each load and kind: label, cells of the macro-elements that move, and those at rest."""
    return [
        {
            "label": row.label,
            "rows": [_part(part) for part in row.record.parts if part.moving > 0],
            "still": [part.name for part in row.record.parts if not part.moving > 0],
        }
        for row in _first_of_each(rows)
    ]


def _part(part: Part) -> list[str]:
    shares = f"{100 * part.moving:.0f} %", minus(f"{part.displacement:z.2f}"), f"{100 * part.motion:.1f} %"
    return [part.name, amount(part.weight / 1e3, 1), *shares]
