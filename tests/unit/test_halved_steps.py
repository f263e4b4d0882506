"""A capacity curve with steps half as long: how far it is from that with whole ones, and which of the two is checked."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from case_texts import WALL, case_file
from churchpipe.code_check import Site
from churchpipe.config.plan import plan
from churchpipe.displacement_check import displacement_check
from churchpipe.errors import InputError
from churchpipe.halved_steps import careful_check
from churchpipe.io.recording import curve_record_of, halved_record
from churchpipe.model.block_curve import BlockCapacityCurve, step_difference
from churchpipe.report.block_curves import block_curve_plots
from churchpipe.report.displacements import displacement_checks
from churchpipe.report.page import template
from churchpipe.spectrum import SiteSpectrum
from records import analysis
from solids import box, on_ground

PUSH = cp.LoadCase((1, 0, 0))
TALL = on_ground(box((0, 0.3), (0, 1), (0, 3)))
SITED = Site(1.5, 1.2, spectrum=SiteSpectrum(2.5, 0.5))
CHECK = '[check]\nag_g = 0.15\n[check.spectrum]\nF0 = 2.5\nTC_star_s = 0.35\nsoil = "C"\n'


@pytest.fixture(scope="module")
def curve() -> BlockCapacityCurve:
    return cp.block_pushover(TALL, cp.find_contacts(TALL), PUSH, 0.6, step=0.02)


@pytest.fixture(scope="module")
def halved() -> BlockCapacityCurve:
    return cp.block_pushover(TALL, cp.find_contacts(TALL), PUSH, 0.6, step=0.02, halved=True)


def shortened(curve: BlockCapacityCurve, share: float) -> BlockCapacityCurve:
    """Return a curve whose displacements are a share of what they were."""
    start = curve.position[0]
    short = {"displacement": share * curve.displacement, "position": start + share * (curve.position - start)}
    return replace(curve, **short, d0=share * curve.d0)


def test_steps_are_half_as_long(curve: BlockCapacityCurve, halved: BlockCapacityCurve) -> None:
    way = [float(np.abs(np.diff(one.position[:, 1, 0])).max()) for one in (curve, halved)]
    assert way[1] == pytest.approx(0.5 * way[0], rel=0.05)
    assert halved.d0 == pytest.approx(curve.d0, rel=1e-3)
    # Twice as many steps are allowed.
    few = cp.block_pushover(TALL, cp.find_contacts(TALL), PUSH, 0.6, step=0.02, steps=3, halved=True)
    assert len(few.displacement) == 6


def test_the_difference_of_two_curves_by_hand(curve: BlockCapacityCurve) -> None:
    # Two straight lines down to zero, at 30 and at 20 mm: a third of the first load factor apart where the shorter one ends.
    line = replace(curve.until(1), displacement=np.array([0.0, 0.03]), load_factor=np.array([0.3, 0.0]))
    short = replace(line, displacement=np.array([0.0, 0.02]))
    assert step_difference(line, short) == pytest.approx((1 / 3, 0.02))
    assert step_difference(line, line) == (0.0, 0.0)
    # One that goes back on its way counts from where it is further than before.
    back = replace(curve.until(3), displacement=np.array([0.0, 0.01, 0.005, 0.03]), load_factor=np.array([0.3, 0.2, 0.7, 0.0]))
    assert step_difference(line, back)[0] == pytest.approx(0.0, abs=1e-12)
    leaning = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.6, 1.6), (0, 1), (1, 2)))
    nothing = cp.block_pushover(leaning, cp.find_contacts(leaning), PUSH)
    assert np.isnan(step_difference(line, nothing)[0])
    with pytest.raises(InputError, match="step_difference: halved"):
        step_difference(line, None)  # pyright: ignore[reportArgumentType]


def test_a_tie_that_tightens_or_breaks_within_a_step_sets_no_curves_apart() -> None:
    """A joist that pulls a block back gets taut within its first 2 mm, and falls off after 80 mm: the block is one mechanism, by
    plane geometry (`test_lost_seat.py`), however long the steps are."""
    post = box((-3.5, -3), (0, 1), (0, 3))
    stones = cp.Assemblage.from_polyhedra(
        [box((-9, 9), (-9, 9), (-1, 0)), post, box((0, 0.3), (0, 1), (0, 3))], 18e3, fixed=[0, 1]
    )
    strength = 0.03 * stones.weight[2]
    tie = cp.Tie("joist", (0, 0.5, 2.5), (-3, 0.5, 2.5), strength=strength, stiffness=2e6, ultimate=0.08, seated=True)
    contacts = cp.find_contacts(stones)
    whole, short = (cp.block_pushover(stones, contacts, PUSH, 0.6, [tie], step=0.03, halved=half) for half in (False, True))
    # What is left is how far the load factor falls in half a step, after the joist is taut: a twentieth of the first one.
    share, place = step_difference(whole, short)
    assert place == short.displacement[1]
    assert share == pytest.approx(0.05, abs=2e-3)
    told = careful_check(whole, short, stones, PUSH, SITED).halved
    assert "no single curve is to be relied on" not in told
    # What lies beyond the ends of the step in which the joist breaks counts.
    broke = int(np.argmax(np.diff(short.load_factor)[1:] < -0.02)) + 2
    beyond = short.load_factor.copy()
    beyond[broke] -= 0.03
    assert step_difference(whole, replace(short, load_factor=beyond))[0] > 0.2


def test_curves_that_are_apart_by_rounding_are_the_same(curve: BlockCapacityCurve) -> None:
    again = replace(curve, load_factor=curve.load_factor * (1 + 3e-9))
    told = careful_check(curve, again, TALL, PUSH, SITED).halved
    assert told.startswith(f"With steps half as long the curve is the same. It ends at {1e3 * curve.d0:.4g} mm, too. The check")
    record = replace(curve_record_of(curve, TALL, PUSH, [cp.JointStrength("default", 0.6)]), halved=halved_record(curve, again))
    (shown,) = block_curve_plots([record], None)
    assert "With steps half as long (dotted) it is the same, and ends at" in str(shown)


def test_the_check_takes_the_curve_that_withstands_less(curve: BlockCapacityCurve) -> None:
    whole = displacement_check(curve, TALL, PUSH, SITED)
    less = displacement_check(shortened(curve, 0.6), TALL, PUSH, SITED)
    assert less.a_g_slv < whole.a_g_slv
    found = careful_check(curve, shortened(curve, 0.6), TALL, PUSH, SITED)
    assert found.a_g_slv == less.a_g_slv
    assert "no single curve is to be relied on" in found.halved
    assert (
        f"ends at {600 * curve.d0:.4g} mm instead of {1e3 * curve.d0:.4g} mm. The check takes it, which withstands"
        in found.halved
    )
    found = careful_check(shortened(curve, 0.6), curve, TALL, PUSH, SITED)
    assert found.a_g_slv == less.a_g_slv
    assert "takes the curve with whole steps, which withstands no more" in found.halved
    late = np.where(np.arange(len(curve.misfit)) < len(curve.misfit) - 2, 0.0, 0.05)
    doubtful = careful_check(curve, replace(shortened(curve, 0.6), misfit=late), TALL, PUSH, SITED)
    assert doubtful.unproved.startswith("Of the curve with steps half as long: From step ")
    # Without a spectrum the shorter one is the careful one.
    assert careful_check(curve, shortened(curve, 0.6), TALL, PUSH, None).d0 == pytest.approx(0.6 * whole.d0, rel=1e-9)


def test_a_curve_that_cannot_be_checked_leaves_the_other(curve: BlockCapacityCurve) -> None:
    unfinished = replace(curve.until(3), status="unfinished")
    found = careful_check(unfinished, curve, TALL, PUSH, SITED)
    assert (found.message, found.a_g_slv) == ("", displacement_check(curve, TALL, PUSH, SITED).a_g_slv)
    assert "The check takes it; of that with whole steps there is none: " in found.halved
    found = careful_check(curve, unfinished, TALL, PUSH, SITED)
    assert "The check takes the curve with whole steps; of it there is none: " in found.halved
    neither = careful_check(unfinished, unfinished, TALL, PUSH, SITED)
    assert "does not come to its end" in neither.message
    assert "The check takes" not in neither.halved


def test_the_report_shows_both(curve: BlockCapacityCurve) -> None:
    short = shortened(curve, 0.6)
    checked = careful_check(curve, short, TALL, PUSH, SITED)
    record = replace(
        analysis(method="curve"),
        check=checked,
        displacement=tuple(curve.displacement.tolist()),
        load_factors=tuple(curve.load_factor.tolist()),
        ending=curve.status,
        d0=curve.d0,
        halved=halved_record(curve, short),
    )
    (_, svg, (sentence,)), *_ = block_curve_plots([record], None)
    assert "steps half as long" in svg
    assert "With steps half as long (dotted) it is up to" in sentence
    shown = displacement_checks([record], None)
    assert shown is not None
    assert shown["checks"][0].halved == checked.halved
    # Another curve is bad news; the same one is not.
    assert not shown["checks"][0].steady
    same = displacement_checks([replace(record, check=careful_check(curve, curve, TALL, PUSH, SITED))], None)
    assert same is not None
    (alike,) = same["checks"]
    assert alike.steady
    text = template("displacements.html").render(displacements=same)
    assert ('<p class="notice">' in text) == alike.severe == ("not safe here" in alike.governs)


@pytest.mark.parametrize(
    ("more", "again"),
    [
        ("[rigid.curve]\n", False),
        ("[rigid.curve]\n" + CHECK, True),
        ("[rigid.curve]\nhalf_steps = false\n" + CHECK, False),
        ("[rigid.curve]\nhalf_steps = true\n", True),
    ],
)
def test_a_case_that_checks_its_curve_follows_it_twice(tmp_path: Path, more: str, again: bool) -> None:
    todo = plan([cp.read_case(case_file(tmp_path, WALL + more))])
    (entry,) = [entry for entry in todo.index["analyses"] if entry["kind"] == "curve"]
    assert bool(entry.get("halved")) is again
    assert ("halved" in todo.stages) is again
    # What is asked of the second curve does not make the first one anew.
    assert "half_steps" not in todo.analyses[entry["name"]]


def test_cases_that_share_a_curve_follow_it_twice_where_one_of_them_asks(tmp_path: Path) -> None:
    cases = [cp.read_case(case_file(tmp_path, f"{WALL}[rigid.curve]\nhalf_steps = {asked}\n")) for asked in ("false", "true")]
    curves = [entry for entry in plan(cases).index["analyses"] if entry["kind"] == "curve"]
    assert [entry.get("halved") for entry in curves] == [True]
