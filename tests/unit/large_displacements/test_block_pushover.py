"""Capacity curves: what may be asked, and what is answered when there is none."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import wall
from churchpipe.io.npz import read_npz, write_npz
from churchpipe.large_displacements import pushover
from churchpipe.large_displacements.control import control_of
from churchpipe.large_displacements.cracks import path_cracks
from models import ferris_tin_loi_wall
from solids import box, on_ground

BLOCK = on_ground(box((0, 0.5), (0, 1), (0, 2)))
PUSH = cp.LoadCase((1, 0, 0))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"step": 0.0}, "block_pushover: step: out of range"),
        ({"step": "a"}, "block_pushover: step: not a number"),
        ({"steps": 0}, "block_pushover: steps: out of range"),
        ({"halo": -1}, "block_pushover: halo: out of range"),
        ({"halved": "no"}, "block_pushover: halved: wrong kind; found 'no'; expected a bool"),
        ({"steps": 10**30}, "block_pushover: steps: out of range"),
        ({"furthest": -1.0}, "block_pushover: furthest: out of range"),
        ({"control": (0, 0)}, "block_pushover: control: wrong shape"),
        ({"control": (0, 0, 9)}, "block_pushover: control: a point outside the free stones"),
        ({"control": (0, 0, 1), "load": cp.LoadCase(live=np.eye(2, 6, k=-1))}, "control: the load has no direction"),
        ({"friction": -1.0}, "friction: out of range"),
        ({"load": 3}, "load: wrong kind"),
        ({"progress": 3}, "block_pushover: progress: not a function; found 3"),
        ({"progress": ""}, "block_pushover: progress: not a function; found ''"),
        ({"keep": []}, "block_pushover: keep: not a function; found list"),
        (
            {"step": 20},
            r"block_pushover: step: a step longer than the structure; found 20 m \(20000 mm\); expected at most 2.29 m",
        ),
        ({"friction": np.ma.masked_array([0.6], [True])}, "friction: masked entries"),
    ],
)
def test_bad_arguments(options: dict[str, Any], said: str) -> None:
    given = {"stones": BLOCK, "contacts": cp.find_contacts(BLOCK), "load": PUSH} | options
    with pytest.raises(InputError, match=said):
        cp.block_pushover(**given)


@pytest.mark.parametrize("halo", [2.0, 1e30, 10**9])
def test_a_halo_wider_than_the_structure_is_all_of_it(halo: Any) -> None:
    curve = cp.block_pushover(BLOCK, cp.find_contacts(BLOCK), PUSH, 0.6, halo=halo, steps=2)
    assert curve.initial == pytest.approx(0.25, abs=1e-6)


@pytest.mark.parametrize("friction", [0.0, 1e-300, 1e-12])
@pytest.mark.parametrize("stones", [BLOCK, on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)))])
def test_without_friction_the_curve_has_vanished_where_it_begins(stones: cp.Assemblage, friction: float) -> None:
    curve = cp.block_pushover(stones, cp.find_contacts(stones), PUSH, friction, steps=5)
    assert (curve.status, len(curve.displacement), curve.d0) == ("vanished", 1, 0.0)


def test_a_push_in_large_units_has_not_vanished() -> None:
    live = np.zeros((BLOCK.count, 6))
    live[1, 0] = 1e9
    curve = cp.block_pushover(BLOCK, cp.find_contacts(BLOCK), cp.LoadCase(live=live), 0.6, step=0.1)
    assert 0 < curve.initial < 1e-4
    assert curve.d0 == pytest.approx(0.25, abs=1e-4)


@pytest.mark.parametrize("step", [-1, 9, 1.5, "a"])
def test_a_curve_is_cut_at_a_step_that_it_has(step: Any) -> None:
    curve = cp.block_pushover(BLOCK, cp.find_contacts(BLOCK), PUSH, 0.6, steps=3)
    with pytest.raises(InputError, match=r"BlockCapacityCurve.until: step: (out of range|not a number)"):
        curve.until(step)


@pytest.mark.slow
def test_known_limit_states_are_not_made_again_and_those_of_other_stones_are(monkeypatch: pytest.MonkeyPatch) -> None:
    contacts, made = cp.find_contacts(BLOCK), list[str]()

    def analysed(*args: Any, **options: Any) -> cp.LimitState:
        state = cp.limit_analysis(*args, **options)
        made.append(state.flow)
        return state

    known = cp.limit_analysis(BLOCK, contacts, PUSH, 0.6)
    sliding = cp.limit_analysis(BLOCK, contacts, PUSH, 0.6, flow="non-associative")
    other = cp.limit_analysis(BLOCK, contacts, cp.LoadCase((0, 1, 0)), 0.6)
    monkeypatch.setattr(pushover, "limit_analysis", analysed)
    expected = cp.block_pushover(BLOCK, contacts, PUSH, 0.6, step=0.1)
    assert made == ["associative", "non-associative"]
    found = cp.block_pushover(BLOCK, contacts, PUSH, 0.6, step=0.1, state=known, sliding=sliding)
    assert len(made) == 2
    np.testing.assert_allclose(found.load_factor, expected.load_factor, rtol=1e-6)
    for wrong in (other, replace(known, load_factor=0.9 * known.load_factor), replace(known, forces=known.forces[1:])):
        cp.block_pushover(BLOCK, contacts, PUSH, 0.6, step=0.1, steps=1, state=wrong, sliding=sliding)
    assert made[2:] == ["associative"] * 3
    still = replace(sliding, velocities=np.zeros_like(sliding.velocities))
    beyond = replace(sliding, load_factor=0.9 * sliding.load_factor)
    for wrong in (known, beyond, replace(sliding, forces=sliding.forces[1:]), replace(sliding, status="not-converged"), still):
        cp.block_pushover(BLOCK, contacts, PUSH, 0.6, step=0.1, steps=1, state=known, sliding=wrong)
    assert made[5:] == ["non-associative"] * 5
    # Friction below that of the states: their forces leave their cones, and the block slides.
    curve = cp.block_pushover(BLOCK, contacts, PUSH, 0.1, step=0.1, steps=1, state=known, sliding=sliding)
    assert curve.initial == pytest.approx(0.1, abs=1e-6)


def test_unstable_stones_have_no_curve() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.6, 1.6), (0, 1), (1, 2)))
    curve = cp.block_pushover(stones, cp.find_contacts(stones), PUSH)
    assert (curve.status, len(curve.displacement)) == ("unstable", 0)
    assert "dead load" in curve.message
    assert np.isnan(curve.d0)
    assert np.isnan(curve.initial)


def test_a_wedged_block_has_no_curve() -> None:
    sides = [box((-1, 0), (0, 1), (0, 2)), box((1, 2), (0, 1), (0, 2))]
    plate = box((-5, 5), (-5, 5), (-1, 0))
    stones = cp.Assemblage.from_polyhedra([plate, *sides, box((0, 1), (0, 1), (0, 1))], 18e3, fixed=[0, 1, 2])
    curve = cp.block_pushover(stones, cp.find_contacts(stones), PUSH)
    assert curve.status == "unbounded"


def test_a_block_that_comes_up_against_another_locks() -> None:
    stop = box((1.1, 2), (0, 1), (0, 0.5))
    plate = box((-5, 5), (-5, 5), (-1, 0))
    stones = cp.Assemblage.from_polyhedra([plate, stop, box((0, 1), (0, 1), (0, 0.3))], 18e3, fixed=[0, 1])
    curve = cp.block_pushover(stones, cp.find_contacts(stones), PUSH, 0.4, step=0.03)
    assert curve.status == "unbounded"
    assert curve.displacement[-1] == pytest.approx(0.1, abs=1e-4)
    assert "locked" in curve.message


def test_control_point() -> None:
    contacts = cp.find_contacts(BLOCK)
    top = cp.block_pushover(BLOCK, contacts, PUSH, 0.7, control=(0.5, 0, 2), step=0.05)
    mean = cp.block_pushover(BLOCK, contacts, PUSH, 0.7, step=0.05)
    assert top.load_factor == pytest.approx(mean.load_factor)
    turn = top.rotation[:, 1, 1]
    # The corner over the hinge goes by h sin(angle), the centroid by h/2 sin(angle) - b/2 (1 - cos(angle)).
    assert top.displacement == pytest.approx(2 * np.sin(turn), abs=1e-8)
    assert mean.displacement == pytest.approx(np.sin(turn) + 0.25 * (1 - np.cos(turn)), abs=1e-8)
    # The pivot is the corner at (.5, 0): the corner at (.5, 2) is straight above it.
    assert mean.d0 == pytest.approx(0.25, abs=1e-6)


@pytest.mark.filterwarnings("error")
def test_a_control_point_far_beyond_everything_is_refused_without_a_warning() -> None:
    with pytest.raises(InputError, match="control: a point outside the free stones"):
        control_of(BLOCK, PUSH, (1e300, 0, 0))


def test_a_control_point_that_stands_still_is_told() -> None:
    stones = on_ground(box((0, 0.5), (0, 1), (0, 2)), box((2, 4), (0, 1), (0, 1)))
    contacts = cp.find_contacts(stones)
    still, moves = (cp.block_pushover(stones, contacts, PUSH, 0.7, control=at, step=0.05) for at in ((2, 0, 1), (0.5, 0, 2)))
    assert np.abs(still.displacement).max() < 1e-6
    assert "the control point goes" in still.message
    assert "so that the displacements of the curve say nothing of this mechanism" in still.message
    assert moves.message == ""


def test_progress_and_the_largest_displacement() -> None:
    told: list[float] = []
    curve = cp.block_pushover(
        BLOCK, cp.find_contacts(BLOCK), PUSH, 0.7, step=0.02, furthest=0.1, progress=lambda _, share: told.append(share)
    )
    assert curve.status == "unfinished"
    assert 0.1 <= curve.largest[-1] <= 0.13
    assert told == sorted(told)
    few = cp.block_pushover(BLOCK, cp.find_contacts(BLOCK), PUSH, 0.7, step=0.02, steps=3.0)  # pyright: ignore
    assert (few.status, len(few.displacement)) == ("unfinished", 3)
    assert "all steps asked for" in few.message


def test_progress_ends_at_a_whole_where_a_curve_goes_on_below_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[float] = []
    # As if each step below zero were no equilibrium, after which a structure may stand higher again.
    monkeypatch.setattr(pushover, "vanished", lambda *_: False)
    curve = cp.block_pushover(
        BLOCK, cp.find_contacts(BLOCK), PUSH, 0.7, step=0.1, steps=16, progress=lambda _, share: told.append(share)
    )
    assert min(curve.load_factor) < 0
    assert max(told) == 1.0


@pytest.mark.slow
def test_a_curve_that_was_interrupted_stays_on_its_branch(tmp_path: Path) -> None:
    # Without the forces of its last step this wall goes on along another one, 6 % of the load factor away.
    stones = ferris_tin_loi_wall(3)
    contacts, push, kept = cp.find_contacts(stones), cp.LoadCase((1, 0, 0)), list[cp.BlockCapacityCurve]()
    options: dict[str, Any] = {"step": 0.015, "steps": 7}
    whole = cp.block_pushover(stones, contacts, push, 0.65, **options, keep=kept.append)
    write_npz(tmp_path / "steps.npz", kept[3])
    again = cp.block_pushover(
        stones, contacts, push, 0.65, **options, resume=read_npz(tmp_path / "steps.npz", cp.BlockCapacityCurve)
    )
    assert len(again.load_factor) == len(whole.load_factor)
    # Its motion is kept as well, so that no step is solved again.
    assert again.load_factor == pytest.approx(whole.load_factor, rel=1e-6)
    assert again.position == pytest.approx(whole.position, abs=1e-7)
    # The work of friction hangs on how the forces are shared out, which a program knows ten times less exactly.
    assert again.dissipation == pytest.approx(whole.dissipation, rel=1e-5)
    assert len(whole.last.pair) > 0
    assert not len(whole.until(3).last.pair)


@pytest.mark.slow
def test_a_curve_goes_on_from_any_of_its_steps() -> None:
    stones = on_ground(*[box((0, 0.36), (0, 1), (i / 4, (i + 1) / 4)) for i in range(4)])
    contacts = cp.find_contacts(stones)
    tie = cp.Tie("rod", start=(0.18, 0.5, 0.9), end=(-2.0, 0.5, 0.9), stones=(4, 0), strength=200.0, ultimate=0.05)
    options: dict[str, Any] = {"ties": [tie], "step": 0.02}
    kept: list[cp.BlockCapacityCurve] = []
    whole = cp.block_pushover(stones, contacts, PUSH, 0.7, **options, keep=kept.append)
    assert [len(curve.load_factor) for curve in kept] == list(range(1, len(whole.load_factor)))
    for step in (0, 1, 5, len(kept) - 1):
        again = cp.block_pushover(stones, contacts, PUSH, 0.7, **options, resume=whole.until(step))
        assert again.status == whole.status
        assert again.load_factor[: step + 1] == pytest.approx(whole.load_factor[: step + 1], abs=1e-7)
        assert again.d0 == pytest.approx(whole.d0, rel=1e-4)
        assert again.dissipation[step] == pytest.approx(whole.dissipation[step], abs=1e-9)
        assert again.proved
        assert f"continued from step {step}" in again.message
        assert ("tie rod broke" in again.message) == ("tie rod broke" in whole.message)
    with pytest.raises(InputError, match="block_pushover: resume: steps of other stones"):
        cp.block_pushover(BLOCK, cp.find_contacts(BLOCK), PUSH, 0.7, resume=whole)
    # One friction for all joints is the same as that of each.
    each = np.full(len(contacts.blocks), 0.7)
    assert cp.block_pushover(stones, contacts, PUSH, each, **options, resume=whole.until(3)).d0 == pytest.approx(
        whole.d0, rel=1e-4
    )
    for other, named in (
        ({"friction": 0.71}, "friction"),
        ({"load": cp.LoadCase((0, 1, 0))}, "load"),
        ({"load": cp.LoadCase((1, 0, 0), profile="linear")}, "load"),
        ({"ties": ()}, "ties"),
        ({"ties": [replace(tie, strength=100.0)], "compressive_strength": 1e9}, "strength, ties"),
        # Its displacements would be added to those of the mean.
        ({"control": (0, 0, 1)}, "control"),
    ):
        with pytest.raises(InputError, match=f"block_pushover: resume: steps of another analysis; found another {named}"):
            cp.block_pushover(stones, contacts, **{"load": PUSH, "friction": 0.7, **options, **other}, resume=whole.until(3))


def test_a_friction_of_its_own_for_each_interface_goes_with_the_stones() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 0.4)), box((0.2, 0.8), (0, 1), (0.4, 0.6)))
    contacts = cp.find_contacts(stones)
    upper = (contacts.blocks != 0).all(axis=1)
    curve = cp.block_pushover(stones, contacts, PUSH, np.where(upper, 0.2, 0.5), step=0.02, furthest=0.15)
    assert curve.load_factor == pytest.approx(0.2, abs=1e-6)
    # Only the upper block moves.
    assert np.linalg.norm(curve.position[-1, 1] - curve.position[0, 1]) < 1e-6


def test_loads_travel_with_their_stones() -> None:
    # A weight P on the front edge of the top: the block rocks about its toe, (W x_w + P x_p)/(W z_w + ...) with all arms turned.
    b, h, extra = 0.5, 2.0, 4e3
    weight = BLOCK.weight[1]
    dead = np.zeros((2, 6))
    arm = np.array([-0.2, 0.0, 0.0])
    dead[1] = [0, 0, -extra, *np.cross(arm, [0, 0, -extra])]
    load = cp.LoadCase((1, 0, 0), dead=dead)
    curve = cp.block_pushover(BLOCK, cp.find_contacts(BLOCK), load, 0.9, step=0.05)
    turn = curve.rotation[:, 1, 1]

    def place(x: float, z: float) -> tuple[np.ndarray, np.ndarray]:
        return x * np.cos(turn) + z * np.sin(turn), z * np.cos(turn) - x * np.sin(turn)

    centre, height = place(-b / 2, h / 2)
    beside, _ = place(-b / 2 - 0.2, h / 2)
    assert curve.load_factor == pytest.approx(-(weight * centre + extra * beside) / (weight * height), abs=1e-6)


@pytest.mark.parametrize(("direction", "lifted"), [((0, 0, 1), True), ((0.6, 0, 0.8), False)])
def test_a_curve_ends_where_the_load_has_lifted_the_stones(direction: tuple[float, ...], lifted: bool) -> None:
    stones = on_ground(box((0, 0.5), (0, 1), (0, 1)), box((0, 0.5), (0, 1), (1, 2)))
    curve = cp.block_pushover(stones, cp.find_contacts(stones), cp.LoadCase(direction), 0.6, steps=3)
    assert curve.status == "unfinished"
    assert ("would float on" in curve.message) == lifted
    assert len(curve.displacement) == (1 if lifted else 3)
    # What balances the weight, and a lift that helps to turn the two over as one body: a (.6 h/2 + .8 b/2) = b/2.
    assert curve.load_factor[0] == pytest.approx(1.0 if lifted else 0.25 / (0.6 + 0.2), abs=1e-6)


def test_a_stone_that_loses_its_seat_falls_and_the_others_go_on() -> None:
    # A slab on a post and on the back of a block, its centroid between the two; a stop holds it as the block rocks away below it.
    post, plate, stop = box((-0.4, -0.05), (0, 1), (0, 4)), box((-9, 9), (-5, 5), (-1, 0)), box((0.2, 0.6), (0, 1), (4.2, 4.4))
    block, slab = box((0, 1), (0, 1), (0, 4)), box((-0.2, 0.2), (0, 1), (4, 4.4))
    stones = cp.Assemblage.from_polyhedra([plate, post, block, slab, stop], 18e3, fixed=[0, 1, 4])
    curve = cp.block_pushover(stones, cp.find_contacts(stones), PUSH, 0.3, step=0.02)
    (lost,) = curve.fallen
    assert lost.stones.tolist() == [3]
    # The corner of the block, where the slab rests, comes to the slab's end at .2 m: half of that at the block's centroid.
    assert 0.05 < lost.displacement < 0.15
    assert curve.displacement[lost.step] == lost.displacement
    assert (np.diff(curve.position[:, 3], axis=0)[lost.step + 1 :] == 0.0).all()
    alone = curve.displacement > lost.displacement
    assert 0 < alone.sum() < len(alone)
    centre = curve.position[alone, 2]
    assert curve.load_factor[alone] == pytest.approx((1 - centre[:, 0]) / centre[:, 2], abs=1e-5)
    assert curve.status == "vanished"


def test_a_curve_says_where_its_control_point_falls() -> None:
    post, plate, stop = box((-0.4, -0.05), (0, 1), (0, 4)), box((-9, 9), (-5, 5), (-1, 0)), box((0.2, 0.6), (0, 1), (4.2, 4.4))
    block, slab = box((0, 1), (0, 1), (0, 4)), box((-0.2, 0.2), (0, 1), (4, 4.4))
    stones = cp.Assemblage.from_polyhedra([plate, post, block, slab, stop], 18e3, fixed=[0, 1, 4])
    contacts = cp.find_contacts(stones)
    curve = cp.block_pushover(stones, contacts, PUSH, 0.3, step=0.04, steps=24, control=(-0.2, 0, 4.4))
    (lost,) = curve.fallen
    assert f"the control point falls with its stone at {1e3 * lost.displacement:.3g} mm" in curve.message
    later = curve.displacement[lost.step + 1 :]
    assert len(later) > 1
    assert (later == later[0]).all()
    # All these steps are of one displacement, and only the last step of the stone tells where it fell.
    there = [path_cracks(stones, contacts, curve, step)[0][(contacts.blocks == 3).any(axis=1)].any() for step in range(24)]
    assert there == [0 < step <= lost.step for step in range(24)]


@pytest.mark.slow
def test_a_tie_is_torn_out_where_its_stone_falls() -> None:
    post, plate, stop = box((-0.4, -0.05), (0, 1), (0, 4)), box((-9, 9), (-5, 5), (-1, 0)), box((0.2, 0.6), (0, 1), (4.2, 4.4))
    block, slab = box((0, 1), (0, 1), (0, 4)), box((-0.2, 0.2), (0, 1), (4, 4.4))
    stones = cp.Assemblage.from_polyhedra([plate, post, block, slab, stop], 18e3, fixed=[0, 1, 4])
    rod = cp.Tie("rod", start=(-2, 0.5, -0.5), end=(-0.2, 0.5, 4.2), stones=(0, 3), strength=300.0)
    curve = cp.block_pushover(stones, cp.find_contacts(stones), PUSH, 0.3, [rod], step=0.02)
    (lost,) = curve.fallen
    assert lost.stones.tolist() == [3]
    assert f"tie rod broke at a displacement of {1e3 * lost.displacement:.3g} mm" in curve.message
    assert (curve.tie_forces[curve.displacement > lost.displacement] == 0).all()


@pytest.mark.slow
def test_a_beam_that_slides_on_its_wall_has_a_curve() -> None:
    # Its first program was not solved as exactly as was asked, and there was no curve at all.
    building = replace(
        wall(
            length=2.0,
            courses=6,
            brick=(0.4, 0.3, 0.2),
            materials=(cp.Material("default", 15259.0, 0.684), cp.Material("concrete", 25e3, 0.6)),
        ),
        ring_beams=(cp.RingBeam(("wall",), 0.2, material="concrete"),),
    )
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    friction, _ = cp.joint_strength(stones, contacts, [cp.JointStrength("default", 0.684), cp.JointStrength("concrete", 0.6)])
    curve = cp.block_pushover(stones, contacts, PUSH, friction, steps=4)
    assert curve.status == "unfinished"
    assert curve.load_factor == pytest.approx([0.6] * 4, abs=1e-5)
    assert curve.proved
    # The wall alone is pushed: its base slides under the beam as well.
    pushed = cp.block_pushover(stones, contacts, cp.LoadCase((1, 0, 0), panels=("wall",)), friction, steps=4)
    own = stones.weight[stones.panel == "wall"].sum()
    assert pushed.load_factor == pytest.approx([0.684 * stones.weight.sum() / own] * 4, abs=1e-5)
