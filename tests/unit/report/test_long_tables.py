"""Ties of a building with many of them: those that govern stand before the reader, the whole table one click away."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from churchpipe.io.tie_records import TieCandidate, TieForce
from churchpipe.report.applied import LEADING
from report_pages import Page, record_of, report, state_of, tower

STRENGTH = 4e4
# No order of strength or name: the table of an analysis keeps that of its ties.
SHARES = np.random.default_rng(1).permutation(np.linspace(0.05, 0.95, 19))


def ties(shares: np.ndarray) -> tuple[TieForce, ...]:
    return tuple(
        TieForce(f"tie {number}", share * STRENGTH, STRENGTH, share, share >= 1, "bar", 0.0)
        for number, share in enumerate(shares.tolist())
    )


def tables(folder: Path, **parts: object) -> tuple[list[list[str]], list[list[str]], str]:
    """Return the rows of ties, those before the complete table and those in it, and the page."""
    state = state_of(tower())
    page = report(folder, [(replace(record_of(state), **parts), state)])
    section = page[page.index('<section id="applied">') :]
    section = section[: section.index("</section>")]
    before, _, rest = section.partition("<details")
    shown, whole = ([row for row in Page(part).rows if row[1].startswith("tie ")] for part in (before, "<details" + rest))
    return shown, whole, page


def test_the_most_stressed_of_many_ties_stand_before_all(tmp_path: Path) -> None:
    shown, whole, page = tables(tmp_path, tie_forces=ties(SHARES))
    assert [float(row[4]) for row in shown] == [round(share, 2) for share in sorted(SHARES, reverse=True)[:LEADING]]
    assert [row[1] for row in whole] == [f"tie {number}" for number in range(19)]
    assert f"<summary>All {len(SHARES)} rows</summary>" in page
    assert f"The {LEADING} that govern: ties at their strength, and those nearest to it." in Page(page).text


def test_a_slack_tie_has_no_tension(tmp_path: Path) -> None:
    shown, whole, _ = tables(tmp_path, tie_forces=ties(np.array([1e-13, 1e-3])))
    assert [row[2] for row in shown + whole] == ["0.0", "0.04"]


def test_joists_that_carry_alike_have_one_row(tmp_path: Path) -> None:
    joists = tuple(
        TieForce(f"tie floor {number}", share * 1e3, 1e3, share, share >= 1, "friction at its bearings", 0.0)
        for number, share in enumerate([1.0, 1.0, 0.2, 1.0, 0.4], 1)
    )
    shown, whole, _ = tables(tmp_path, tie_forces=joists + ties(np.array([1.0, 1.0])))
    assert [row[1] for row in shown + whole] == ["tie floor 1, 2, 4", "tie floor 3", "tie floor 5", "tie 0", "tie 1"]
    assert [row[4] for row in shown + whole] == ["1.00", "0.20", "0.40", "1.00", "1.00"]
    slid = tuple(replace(joists[0], name=f"tie floor {number}") for number in (*range(1, 9), 11, 12, 13))
    shown, whole, _ = tables(tmp_path, tie_forces=slid + ties(np.array([1.0, 1.0])))
    assert [row[1] for row in shown + whole] == ["tie floor 1 to 8, 11 to 13", "tie 0", "tie 1"]


def test_no_tie_at_its_strength_is_hidden(tmp_path: Path) -> None:
    shares = np.where(np.arange(19) % 3 < 2, 1.0, SHARES)
    shown, whole, _ = tables(tmp_path, tie_forces=ties(shares))
    assert [row[1] for row in shown] == [f"tie {number}" for number in np.flatnonzero(shares == 1)]
    assert len(shown) > LEADING
    assert len(whole) == 19


def test_a_tie_without_strength_does_not_govern(tmp_path: Path) -> None:
    shares = np.where(np.arange(19) == 3, np.nan, SHARES)
    shown, _, _ = tables(tmp_path, tie_forces=ties(shares))
    assert len(shown) == LEADING
    assert "tie 3" not in [row[1] for row in shown]


def test_few_ties_stand_in_one_table(tmp_path: Path) -> None:
    shown, whole, page = tables(tmp_path, tie_forces=ties(SHARES[:9]))
    assert (len(shown), whole) == (9, [])
    assert '<details class="whole">' not in page


def test_candidates_that_were_analysed_or_may_add_most_stand_before_all(tmp_path: Path) -> None:
    most = 0.2 + 0.1 * SHARES
    candidates = tuple(
        TieCandidate(
            f"tie {number}",
            STRENGTH,
            float(value - 0.2) / STRENGTH,
            float(value),
            0.21 if number == int(np.argmin(most)) else np.nan,
        )
        for number, value in enumerate(most)
    )
    shown, whole, _ = tables(tmp_path, tie_candidates=candidates)
    assert len(shown) == LEADING
    assert f"tie {np.argmin(most)}" in [row[1] for row in shown]
    assert f"tie {np.argmax(most)}" in [row[1] for row in shown]
    assert len(whole) == 19


def test_candidates_have_no_bound_without_dilatancy(tmp_path: Path) -> None:
    candidates = tuple(
        TieCandidate(f"tie {number}", STRENGTH, 1e-6 * share, np.nan, np.nan) for number, share in enumerate(SHARES)
    )
    shown, whole, page = tables(tmp_path, tie_candidates=candidates)
    assert f"tie {np.argmax(SHARES)}" in [row[1] for row in shown]
    assert {row[4] for row in (*shown, *whole)} == {"no bound"}
    assert "Without dilatancy there is no such bound" in page
