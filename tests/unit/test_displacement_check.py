"""The displacement-based check of Circolare 7/2019, C8.7.1.2.1: its formulas on curves given in closed form."""

import json
import math
import re
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.code_check import Floor, Site
from churchpipe.displacement_check import displacement_check
from churchpipe.errors import InputError
from churchpipe.halved_steps import careful_check
from churchpipe.model.arrays import FloatArray
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.checks import DisplacementCheck, SafetyCheck
from churchpipe.model.lost_seat import LostSeat
from churchpipe.model.quantities import GRAVITY, as_written
from churchpipe.oscillator import Oscillator, capacity, oscillator
from churchpipe.report.displacements import displacement_checks
from churchpipe.report.page import template
from churchpipe.run_folder import RunFolder
from churchpipe.spectrum import SiteSpectrum, Spectrum, StoreySpectrum, spectral_displacement
from records import analysis
from solids import box, on_ground

SITE = Spectrum(2.5, 0.5, soil_factor=1.2)
GIVEN = SiteSpectrum(2.5, 0.5)
SITED = Site(1.5, 1.2, spectrum=GIVEN)


def test_a_curve_that_goes_back_has_the_least_of_its_accelerations() -> None:
    # At .08 m it has .168 on the way out, .14 on the way back, and .05 + .12 / .14 (.095 - .05) = .08857 on the last branch.
    there_and_back = Oscillator(np.array([0, 0.05, 0.10, 0.04, 0.06, 0.2]), np.array([0.2, 0.18, 0.16, 0.10, 0.095, 0.05]), 0.3)
    assert there_and_back.at(0.08) == pytest.approx(0.05 + 0.12 / 0.14 * 0.045)
    assert there_and_back.at(0.02) == pytest.approx(0.192)
    assert there_and_back.at(0.10) == pytest.approx(0.05 + 0.10 / 0.14 * 0.045)
    # A drop at one displacement counts as what it ends at, and beyond its ends the curve stays as it is there.
    drop = Oscillator(np.array([0, 0.1, 0.1, 0.2]), np.array([0.2, 0.15, 0.06, 0.01]), 0.2)
    assert [drop.at(place) for place in (-0.1, 0.1, 0.3)] == pytest.approx([0.2, 0.06, 0.01])


def rocking(breadth: float, height: float) -> tuple[FloatArray, FloatArray]:
    displacement = np.linspace(0, breadth / 2, 2001)
    lever = breadth / 2 - displacement
    return displacement, lever / np.sqrt((breadth**2 + height**2) / 4 - lever**2)


def block(breadth: float, height: float) -> Oscillator:
    displacement, load_factor = rocking(breadth, height)
    return oscillator(displacement, load_factor, breadth / 2, np.array([1.0]), np.array([1.0]))


def test_limit_states_by_hand() -> None:
    found = capacity(block(0.5, 4), SITE)
    assert found.displacement == pytest.approx(0.4 * 0.25)
    level = 0.15 / math.sqrt(0.25**2 + 4 - 0.15**2) * GRAVITY / 1.35
    assert found.acceleration == pytest.approx(level, rel=1e-5)
    assert found.period == pytest.approx(1.68 * math.pi * math.sqrt(0.1 / level), rel=1e-5)
    assert found.governed == "displacement"
    assert spectral_displacement(SITE, found.period, found.ground, 8.0) == pytest.approx(found.displacement, rel=1e-9)
    collapse = capacity(block(0.5, 4), SITE, "SLC")
    assert collapse.displacement == pytest.approx(0.6 * 0.25)
    assert collapse.ground > found.ground


def test_one_body_as_many_stones() -> None:
    # Twenty courses: e* = 3 n^2/(4 n^2 - 1); the spectral displacement is that at three quarters of the height's mean.
    courses = np.arange(20) + 0.5
    displacement, load_factor = rocking(0.5, 4)
    many = oscillator(displacement, load_factor, 0.25, np.ones(20), courses)
    fraction = 3 * 400 / (4 * 400 - 1)
    assert many.ultimate == pytest.approx(0.25 / fraction)
    assert many.acceleration[0] == pytest.approx(0.125 * GRAVITY / (fraction * 1.35))


def test_stones_that_stand_still_and_loads_on_a_part() -> None:
    # Half of the weight moves: the mean displacement of all is half that of the moving half.
    displacement, load_factor = rocking(0.5, 4)
    still = oscillator(0.5 * displacement, load_factor, 0.125, np.ones(2), np.array([1.0, 0.0]))
    assert still.ultimate == pytest.approx(0.25)
    assert still.acceleration[0] == pytest.approx(0.125 * GRAVITY / 1.35)
    # Only one of two moving halves is pushed: alpha0 counts half as much.
    part = oscillator(displacement, load_factor, 0.25, np.ones(2), np.ones(2), pushed=np.array([1.0, 0.0]))
    assert part.ultimate == pytest.approx(0.25)
    assert part.acceleration[0] == pytest.approx(0.5 * 0.125 * GRAVITY / 1.35)


def test_a_loss_of_connections_limits_the_displacement() -> None:
    displacement = np.array([0, 0.05, 0.06, 0.2, 0.3])
    curve = oscillator(displacement, np.array([0.2, 0.19, 0.08, 0.05, 0.0]), 0.3, np.ones(1), np.ones(1))
    assert curve.loss == pytest.approx(0.05)
    assert capacity(curve, SITE).displacement == pytest.approx(0.05)
    assert capacity(curve, SITE, "SLC").displacement == pytest.approx(0.18)


def test_a_loss_of_connections_counts_however_short_the_steps_are() -> None:
    displacement = np.array([0, 0.05, 0.052, 0.054, 0.057, 0.2, 0.3])
    curve = oscillator(displacement, np.array([0.2, 0.19, 0.16, 0.12, 0.08, 0.05, 0.0]), 0.3, np.ones(1), np.ones(1))
    assert curve.loss == pytest.approx(0.05)


@pytest.mark.parametrize("break_at", [0.01, 0.0347, 0.1])
def test_the_place_of_a_loss_does_not_depend_on_the_steps(break_at: float) -> None:
    # A rocking wall, alpha = .13 (1 - d/.28), and a tie that adds .2 until it breaks, its place known to .3 mm.
    for step in (0.02, 0.005, 0.001):
        displacement = np.unique([*np.arange(0, 0.28, step), break_at, break_at + 3e-4, 0.28])
        load_factor = 0.13 * (1 - displacement / 0.28) + np.where(displacement <= break_at, 0.2, 0.0)
        curve = oscillator(displacement, load_factor, 0.28, np.ones(1), np.ones(1))
        assert curve.loss == pytest.approx(break_at), step
        assert capacity(curve, SITE).displacement == pytest.approx(break_at)


def test_a_loss_of_connections_is_found_on_the_way_of_a_curve_that_goes_back() -> None:
    """Where a structure snaps back and recovers, there is less on the way than at any larger displacement."""
    displacement = np.array([0.0, 0.02, 0.04, 0.037, 0.034, 0.032, 0.036, 0.05, 0.15, 0.3])
    load_factor = np.array([0.2, 0.19, 0.18, 0.14, 0.1, 0.07, 0.14, 0.15, 0.1, 0.0])
    curve = oscillator(displacement, load_factor, 0.3, np.ones(1), np.ones(1))
    assert curve.loss == pytest.approx(0.04)
    # One that goes back as far, and keeps more than half.
    curve = oscillator(displacement, np.maximum(load_factor, 0.1), 0.3, np.ones(1), np.ones(1))
    assert curve.loss == np.inf


def test_connections_that_are_lost_at_once_leave_the_onset() -> None:
    # Nothing is left to go: a period of zero has no displacement, which any earthquake meets.
    curve = oscillator(np.array([0, 0.002, 0.1, 0.3]), np.array([0.7, 0.2, 0.1, 0.0]), 0.3, np.ones(1), np.ones(1))
    assert curve.loss == 0.0
    found = capacity(curve, SITE)
    assert (found.displacement, found.period, found.governed) == (0.0, 0.0, "onset")
    assert found.ground == pytest.approx(0.7 * GRAVITY / (1.35 * 1.2), rel=1e-9)


@pytest.mark.parametrize("d0", [0.55, 0.73])
@pytest.mark.parametrize("limit", ["SLV", "SLC"])
def test_no_smaller_earthquake_asks_for_more(d0: float, limit: Literal["SLV", "SLC"]) -> None:
    # a_g S of soil D falls by 6 % between a_g = .8 g/F0 and 1.07 g/F0, from .96 g/F0, as S = 2.4 - 1.5 F0 a_g/g falls to .9.
    spectrum = Spectrum(2.5, 0.35, soil="D")
    onset, damping = 0.5, {"SLV": 8.0, "SLC": 10.0}[limit]
    curve = oscillator(np.array([0, d0]), np.array([onset, 0.0]), d0, np.ones(1), np.ones(1))
    curve = replace(curve, loss=math.inf)
    found = capacity(curve, spectrum, limit)
    level = onset * GRAVITY / 1.35

    def withstood(ground: float) -> bool:
        moved = spectral_displacement(spectrum, found.period, ground, damping) <= found.displacement * (1 + 1e-9)
        return moved or spectrum.acceleration(0.0, ground, 5.0) <= level * (1 + 1e-9)

    assert all(withstood(ground) for ground in np.linspace(0.01, found.ground, 2000))
    assert not withstood(found.ground * 1.001)


def test_what_does_not_even_start_to_move() -> None:
    # A small model has little displacement: the onset governs.
    found = capacity(block(0.03, 0.3), SITE)
    assert found.governed == "onset"
    assert found.ground == pytest.approx(0.1 * GRAVITY / (1.35 * 1.2), rel=1e-6)


def test_collapse_that_comes_before_life_safety_is_said(curve: BlockCapacityCurve) -> None:
    # A tie that adds .06 until it breaks at half of d0: by hand a falls from .06 + .6 alpha0 to .4 alpha0.
    assert displacement_check(curve, LEANING, PUSH, SITED).collapse_first == ""
    tied = curve.load_factor + np.where(curve.displacement < 0.5 * curve.displacement[-1], 0.06, 0.0)
    check = displacement_check(replace(curve, load_factor=tied), LEANING, PUSH, SITED)
    safety, collapse = check.limit_states["SLV"], check.limit_states["SLC"]
    assert collapse.acceleration < 0.5 * safety.acceleration
    assert check.a_g_slc < check.a_g_slv
    assert f"a_g,SLC is {check.a_g_slc:.3f} m/s2 and a_g,SLV {check.a_g_slv:.3f} m/s2" in check.collapse_first
    assert f"from {safety.period:.2f} to {collapse.period:.2f} s" in check.collapse_first
    shown = displacement_checks([replace(analysis(method="curve"), check=check)], None)
    assert check.collapse_first in template("displacements.html").render(displacements=shown).replace("\n", " ")


def test_a_check_without_q_promises_no_reserve() -> None:
    small = on_ground(box((0, 0.03), (0, 0.1), (0, 0.3)))
    curve = cp.block_pushover(small, cp.find_contacts(small), PUSH, 0.7, step=0.003)
    both = {q: displacement_check(curve, small, PUSH, replace(SITED, behaviour_factor=q)) for q in (1.0, 2.0)}
    for q, check in both.items():
        assert check.limit_states["SLV"].governed == "onset"
        assert check.force_based is not None
        assert check.force_based.a_g_slv == pytest.approx(q * check.a_g_slv, rel=1e-6)
    assert "and q promises a reserve that it has not" in both[2.0].governs
    # With q = 1 both are the acceleration that starts the motion.
    assert both[1.0].governs.endswith("so little that it falls as soon as it starts.")


def test_bad_input() -> None:
    displacement, load_factor = rocking(0.5, 4)
    one = np.ones(1)
    with pytest.raises(InputError, match="d0: the curve does not come to its end"):
        oscillator(displacement, load_factor, math.nan, one, one)
    with pytest.raises(InputError, match="does not go along its load"):
        oscillator(displacement, load_factor, 0.25, one, -one)
    with pytest.raises(InputError, match="load_factor: wrong shape"):
        oscillator(displacement, load_factor[:-1], 0.25, one, one)
    with pytest.raises(InputError, match="limit: unknown limit state"):
        capacity(block(0.5, 4), SITE, "SLD")


def test_the_idealised_curve_of_a_rocking_body_is_its_own() -> None:
    curve = block(0.5, 10.0)
    assert curve.idealised.ultimate == pytest.approx(curve.ultimate, rel=2e-3)
    assert np.trapezoid(curve.idealised.acceleration, curve.idealised.displacement) == pytest.approx(
        np.trapezoid(curve.acceleration, curve.displacement)
    )


def test_with_one_body_displacement_and_acceleration_are_less() -> None:
    displacement, load_factor = rocking(0.5, 4)
    many = oscillator(displacement, load_factor, 0.25, np.ones(20), np.arange(20) + 0.5)
    assert many.lumped.ultimate == pytest.approx(0.25)
    assert many.lumped.acceleration[0] == pytest.approx(0.125 * GRAVITY / 1.35)
    assert capacity(many.lumped, SITE).ground < capacity(many, SITE).ground


def test_at_a_height_the_storey_asks_for_more() -> None:
    storey = StoreySpectrum(SITE, first_period=0.4, peak=3.0)
    curve = block(0.5, 4)
    ground, high = capacity(curve, SITE), capacity(curve, storey)
    assert high.ground < ground.ground
    assert spectral_displacement(storey, high.period, high.ground, 8.0) == pytest.approx(high.displacement, rel=1e-6)
    # What hardly moves must not even start to: the acceleration of the storey.
    small = capacity(block(0.01, 0.1), storey)
    assert small.governed == "onset"
    assert storey.acceleration(0.0, small.ground, 5.0) == pytest.approx(0.1 * GRAVITY / 1.35, rel=1e-6)


LEANING = on_ground(box((0, 0.5), (0, 1), (0, 2)))
PUSH = cp.LoadCase((1, 0, 0))


@pytest.fixture(scope="module")
def curve() -> BlockCapacityCurve:
    return cp.block_pushover(LEANING, cp.find_contacts(LEANING), PUSH, 0.7, step=0.025)


def test_the_record_of_a_curve(curve: BlockCapacityCurve) -> None:
    record = displacement_check(curve, LEANING, PUSH, SITED)
    assert record.force_based is not None
    found = capacity(block(0.5, 2), SITE)
    assert record.a_g_slv == pytest.approx(found.ground, rel=1e-4)
    assert record.zeta_e == pytest.approx(found.ground / 1.5, rel=1e-4)
    assert record.satisfied == (found.ground >= 1.5)
    assert record.limit_states["SLV"].period == pytest.approx(found.period, rel=1e-4)
    assert record.force_based.a_g_slv == pytest.approx(2 * 0.25 * GRAVITY / (1.35 * 1.2), rel=1e-6)
    assert "less than q takes for granted" in record.governs
    assert record.demand["SLV"].displacement[-1] >= found.displacement
    json.dumps(as_written(record))


def test_the_control_point_of_a_curve_changes_nothing(curve: BlockCapacityCurve) -> None:
    top = cp.block_pushover(LEANING, cp.find_contacts(LEANING), PUSH, 0.7, step=0.025, control=(0.5, 0, 2))
    assert top.d0 > 1.5 * curve.d0
    # Dataclasses with a NaN that is in both are not equal from Python 3.13 on; dictionaries are.
    found, expected = (asdict(displacement_check(one, LEANING, PUSH, SITED)) for one in (top, curve))
    assert found == expected


MASSES = pytest.mark.slow("docs/displacement_check.md: masses on a block")


@MASSES
@pytest.mark.parametrize("mass", [0.0, 10e3, 40e3])
@pytest.mark.parametrize("profile", ["uniform", "linear"])
def test_masses_are_bodies_of_their_own(mass: float, profile: Literal["uniform", "linear"]) -> None:
    # A block of W that turns about an edge, b wide and h high, with P and the mass Q in the middle of its top. With the angle t,
    # the load factor vanishes at tan t0 = b/2 (W + P) / (W h/2 + P h).
    b, h, pressing, stone = 0.5, 2.0, 15e3, float(LEANING.weight.sum())
    load = cp.LoadCase((1, 0, 0), profile=profile)
    placed = cp.place_loads(LEANING, [cp.PointLoad(at=(0.25, 0.5, h), dead=pressing, mass=mass)])
    curve = cp.block_pushover(LEANING, cp.find_contacts(LEANING), cp.loaded(load, LEANING, placed), 0.7, step=5e-3)
    assert curve.status == "vanished"
    record = displacement_check(curve, LEANING, load, SITED, placed)
    weight, height = np.array([stone, mass]), np.array([h / 2, h])
    pushed = weight * (height * weight.sum() / (weight @ height) if profile == "linear" else 1.0)
    end = math.atan(b / 2 * (stone + pressing) / (stone * h / 2 + pressing * h))
    travelled = b / 2 * (1 - math.cos(end)) + height * math.sin(end)
    onset = b / 2 * (stone + pressing) / (pushed @ height)
    assert curve.initial == pytest.approx(onset, rel=1e-6)
    assert record.moving_weight == pytest.approx(weight.sum(), rel=1e-9)
    assert record.alpha0 == pytest.approx(onset * (pushed @ height) / (weight @ height), rel=1e-3)
    assert record.mass_fraction == pytest.approx((weight @ height) ** 2 / (weight.sum() * (weight @ height**2)), rel=1e-3)
    # With e* = 1 the oscillator goes as far as the mean of all that moves.
    assert record.d0 == pytest.approx(weight @ travelled / weight.sum(), rel=5e-3)


def test_a_curve_whose_last_steps_are_not_proved_is_checked_as_far_as_they_are(curve: BlockCapacityCurve) -> None:
    whole, count = displacement_check(curve, LEANING, PUSH, SITED), len(curve.misfit)
    assert whole.unproved == ""
    for first in (count - 2, count // 2):
        doubtful = replace(curve, misfit=np.where(np.arange(count) < first, 0.0, 0.05))
        assert doubtful.proved_steps == first
        found = displacement_check(doubtful, LEANING, PUSH, SITED)
        assert f"From step {first + 1} of {count} on" in found.unproved
        # Ended at its last proved step, or as it was found: whichever withstands less.
        ended = replace(curve.until(first - 1), status="collapsed", d0=float(curve.displacement[first - 1]))
        short = displacement_check(ended, LEANING, PUSH, SITED)
        assert found.a_g_slv == pytest.approx(min(short.a_g_slv, whole.a_g_slv))
        # Nothing is asked of it: it ends where the proved steps do.
        assert displacement_check(doubtful, LEANING, PUSH, None).d0 == pytest.approx(short.d0)
        shown = displacement_checks([replace(analysis(method="curve"), check=found)], None)
        assert shown is not None
        assert shown["checks"][0].unproved == found.unproved
    jumping = replace(curve, misfit=np.where(np.arange(count) < count // 2, 0.0, 3.0))
    told = displacement_check(jumping, LEANING, PUSH, SITED).unproved
    assert "is proved: the structure jumps on the way, or stones of it hang, and these load factors are no equilibria" in told
    nothing = replace(curve, misfit=np.full(count, 0.05))
    assert "no proved step" in displacement_check(nothing, LEANING, PUSH, SITED).message


def test_a_curve_that_stops_where_no_motion_fits_is_checked_as_ended_there(curve: BlockCapacityCurve) -> None:
    last = len(curve.misfit) // 2
    stopped = replace(curve.until(last), status="not-converged")
    end = float(curve.displacement[last])
    short = displacement_check(replace(stopped, status="collapsed", d0=end), LEANING, PUSH, SITED)
    found = displacement_check(stopped, LEANING, PUSH, SITED)
    assert (found.message, found.a_g_slv, found.d0) == ("", short.a_g_slv, short.d0)
    told = f"The curve stops at {1e3 * end:.3g} mm, where no motion was found that fits its forces. "
    assert found.unproved == f"{told}The check takes it as ended there."
    # Its last steps need not be proved either.
    doubtful = replace(stopped, misfit=np.where(np.arange(last + 1) < last - 1, 0.0, 0.05))
    assert displacement_check(doubtful, LEANING, PUSH, SITED).unproved.startswith(f"{told}From step {last} of {last + 1} on")
    # Where it ends before it is said to go little, this is no property of the mechanism.
    early = displacement_check(replace(curve.until(1), status="not-converged"), LEANING, PUSH, SITED)
    assert early.force_based is not None
    assert early.a_g_slv < early.force_based.a_g_slv
    assert "as far as the curve is proved, and how much further it goes is not known" in early.governs
    assert "as soon as it starts" not in early.governs
    # One whose steps were used up may be followed further.
    assert "Follow the curve further" in displacement_check(replace(stopped, status="unfinished"), LEANING, PUSH, SITED).message


@pytest.mark.parametrize("status", ["converged", "not-converged", "failed"])
def test_a_run_checks_a_curve_that_is_not_proved_to_its_end(
    curve: BlockCapacityCurve, status: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(RunFolder, "block_curve", lambda *_: curve)
    monkeypatch.setattr(RunFolder, "stones", lambda *_: (LEANING, None))
    monkeypatch.setattr("churchpipe.run_folder.read_json", lambda _: {"material": {"default": {}}})
    monkeypatch.setattr("churchpipe.run_folder.load_of", lambda _: PUSH)
    entry = {"kind": "curve", "name": "+x_curve", "geometry": "base"}
    found = RunFolder(tmp_path, {})._mechanism(entry, status)
    assert ("check" in found) == (status != "failed")


def test_a_run_cuts_its_check_where_a_joist_loses_its_seat(
    curve: BlockCapacityCurve, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lost = LostSeat("floor 2", 2.5)
    monkeypatch.setattr(RunFolder, "block_curve", lambda *_: curve)
    monkeypatch.setattr(RunFolder, "stones", lambda *_: (LEANING, None))
    monkeypatch.setattr("churchpipe.run_folder.read_json", lambda _: {"material": {"default": {}}})
    monkeypatch.setattr("churchpipe.run_folder.load_of", lambda _: PUSH)
    monkeypatch.setattr("churchpipe.run_folder.site_of", lambda _: SITED)
    monkeypatch.setattr("churchpipe.halved_steps.lost_seat", lambda *_: lost)
    entry = {"kind": "curve", "name": "+x_curve", "geometry": "base", "check": {}}
    found = RunFolder(tmp_path, {})._mechanism(entry, "converged")["check"]
    assert found.lost_seat.startswith("Joist floor 2 loses its seat at ")
    assert (
        found.limit_states["SLC"].displacement < displacement_check(curve, LEANING, PUSH, SITED).limit_states["SLC"].displacement
    )
    shown = displacement_checks([replace(analysis(method="curve"), check=found)], None)
    assert shown is not None
    assert shown["checks"][0].lost_seat == found.lost_seat


def test_a_mechanism_at_the_foot_of_the_building_has_a_floor_like_the_ground(curve: BlockCapacityCurve) -> None:
    floor = Floor(0.0, 12.0, 2, 3.0, first_period=0.3)
    found = displacement_check(curve, LEANING, PUSH, Site(1.5, 1.2, floor=floor, spectrum=GIVEN))
    assert found.a_g_slv == displacement_check(curve, LEANING, PUSH, SITED).a_g_slv
    # Without damping a part in tune with the building would be shaken without end.
    with pytest.raises(InputError, match="damping_percent: out of range; found 0"):
        Floor(6.0, 12.0, 2, 3.0, 0.0)


@pytest.mark.parametrize("direction", [(-1, 0, 0), (0, 1, 0)])
def test_a_curve_that_does_not_go_along_its_load_has_no_check(curve: BlockCapacityCurve, direction: tuple[float, ...]) -> None:
    found = displacement_check(replace(curve, given=""), LEANING, cp.LoadCase(direction), SITED)
    assert "the mechanism does not go along its load" in found.message


@pytest.mark.parametrize("other", [{"direction": (1, 0.2, 0)}, {"direction": (-1, 0, 0)}, {"profile": "linear"}])
def test_the_curve_of_another_load_is_refused(curve: BlockCapacityCurve, other: dict[str, Any]) -> None:
    load = cp.LoadCase(**{"direction": (1, 0, 0), **other})
    with pytest.raises(InputError, match=rf"load: the curve is of another load; found {re.escape(load.name)}"):
        displacement_check(curve, LEANING, load, SITED)


@pytest.mark.parametrize(
    ("other", "found"),
    [
        ([box((0, 0.5), (0, 1), (0, 2)), box((2, 3), (0, 1), (0, 2))], "2 stones; expected 3 stones"),
        ([box((0, 0.5), (0, 1), (0, 4))], "1e\\+03 mm from where stone B1 is; expected a curve of these stones"),
    ],
)
def test_the_curve_of_other_stones_is_refused(curve: BlockCapacityCurve, other: list[Any], found: str) -> None:
    with pytest.raises(InputError, match=rf"displacement_check: curve: a curve of other stones; found {found}"):
        displacement_check(curve, on_ground(*other), PUSH, SITED)
    with pytest.raises(InputError, match="a curve of other stones"):
        careful_check(curve, curve, on_ground(*other), PUSH, SITED)


@pytest.mark.slow
def test_what_moves_later_does_not_make_the_oscillator_go_further() -> None:
    # A lintel slides on two columns, friction .15; from where its end has come to the edge of a column on, that leans after it.
    columns = [box((0, 0.5), (0, 1), (0, 2.4)), box((2.6, 3.2), (0, 1), (0, 2.4))]
    stones = on_ground(*columns, box((0, 3.2), (0, 1), (2.4, 2.9)))
    contacts = cp.find_contacts(stones)
    friction = np.where((contacts.blocks == 3).any(axis=1), 0.15, 0.9)
    curve = cp.block_pushover(stones, contacts, PUSH, friction, step=0.03)
    gone = curve.position[-1, :, 0] - curve.position[0, :, 0]
    assert curve.load_factor[0] == pytest.approx(0.15, abs=1e-6)
    assert gone[1] > 0.1
    found = displacement_check(curve, stones, PUSH, SITED)
    assert found.moving_weight == pytest.approx(stones.weight[3])
    assert found.mass_fraction == pytest.approx(1.0)
    # It is the lintel that starts to move, and its displacement counts.
    assert found.d0 == pytest.approx(gone[3], rel=1e-6)


def test_a_check_says_what_makes_its_spectrum(curve: BlockCapacityCurve) -> None:
    # NTC 2018, tables 3.2.IV and 3.2.V, soil C and topography T2, a_g 1.5 m/s2.
    site = Site(1.5, spectrum=SiteSpectrum(2.45, 0.32, "C", "T2"))
    found = displacement_check(curve, LEANING, PUSH, site)
    share = 1.5 / GRAVITY
    soil, longer = 1.7 - 0.6 * 2.45 * share, 1.05 * 0.32**-0.33
    asked = {"F0": 2.45, "TC_star_s": 0.32, "S_S": soil, "S_T": 1.2, "S": 1.2 * soil, "C_C": longer}
    asked |= {"T_B_s": longer * 0.32 / 3, "T_C_s": longer * 0.32, "T_D_s": 1.6 + 4 * share}
    assert as_written(found, defaults=False)["spectrum"] == pytest.approx(asked)
    shown = displacement_checks([replace(analysis(method="curve"), check=found)], None)
    assert shown is not None
    facts = dict(shown["checks"][0].facts)
    words = "S_S 1.475, S_T 1.200, S 1.770, C_C 1.529, T_B 0.163 s, T_C 0.489 s, T_D 2.212 s"
    assert facts["spectrum at a_g = 1.500 m/s\u00b2"] == words
    # Of S alone nobody knows what it is made of, and a table has no such parameters.
    alone = displacement_check(curve, LEANING, PUSH, SITED)
    assert "S_S" not in as_written(alone, defaults=False)["spectrum"]
    table = Site(1.5, 1.2, spectrum=SiteSpectrum(period=(0.0, 0.2, 0.5, 2.0), level=(1.8, 4.5, 4.5, 1.1)))
    assert displacement_check(curve, LEANING, PUSH, table).spectrum is None


def test_what_is_missing_is_named(curve: BlockCapacityCurve) -> None:
    assert "[check]" in displacement_check(curve, LEANING, PUSH, None).missing
    assert "[check.spectrum]" in displacement_check(curve, LEANING, PUSH, Site(1.5, 1.2)).missing
    floor = Floor(6.0, 12.0, 2, 3.0)
    record = displacement_check(curve, LEANING, PUSH, Site(1.5, 1.2, floor=floor, spectrum=GIVEN))
    assert "first_period_s" in record.missing
    assert record.force_based is not None
    assert record.force_based.floor_demand == pytest.approx(floor.acceleration / 2)
    short = cp.block_pushover(LEANING, cp.find_contacts(LEANING), PUSH, 0.7, step=0.025, steps=3)
    said = displacement_check(short, LEANING, PUSH, None).message
    assert "does not come to its end; found a load factor of 0." in said
    assert "more steps, or a larger furthest_mm, in [rigid.curve]" in said
    one = cp.block_pushover(LEANING, cp.find_contacts(LEANING), PUSH, 0.7, step=0.025, steps=1)
    assert "no mechanism" in displacement_check(one, LEANING, PUSH, None).message


def test_the_report_shows_the_check(curve: BlockCapacityCurve) -> None:
    record = analysis(method="curve")
    check = displacement_check(curve, LEANING, PUSH, SITED)
    # A curve that has no end, followed with steps half as long: it has a message and says how far apart both are.
    apart = replace(record, check=DisplacementCheck(message="no end", halved="Steps half as long are 18 % away."))
    ended = displacement_checks([apart], None)
    assert ended is not None
    assert not ended["checks"]
    assert [text for _, text in ended["refused"]] == ["no end Steps half as long are 18 % away."]
    shown = displacement_checks([replace(record, check=check), replace(record, check=SafetyCheck(message="why")), record], None)
    assert shown is not None
    (one,) = shown["checks"]
    assert one.diagram.startswith("<svg")
    assert [row[0] for row in one.rows] == ["SLV", "SLC"]
    assert one.governs == check.governs
    assert shown["refused"] == [("load +x, friction 0.7", "why")]
    # Connections that are lost at once leave no displacement and no period.
    at_once = {"SLV": replace(check.limit_states["SLV"], displacement=0.0, period=0.0), "SLC": check.limit_states["SLC"]}
    assert displacement_checks([replace(record, check=replace(check, limit_states=at_once))], None) is not None
    unsited = displacement_checks([replace(record, check=displacement_check(curve, LEANING, PUSH, None))], None)
    assert unsited is not None
    assert (unsited["checks"][0].rows, unsited["checks"][0].governs) == ([], "")
    assert " with e* = 1.<" in template("displacements.html").render(displacements=unsited)
    assert displacement_checks([record], None) is None
