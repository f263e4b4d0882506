"""The real path in the report: frames of the viewer, snapshots, crack maps."""

import base64
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.model.arrays import FloatArray
from churchpipe.report.cracks import crack_map_svg
from churchpipe.report.paths import crack_maps, path_label, snapshots, viewer_path
from churchpipe.report.viewer import origin_of
from records import analysis
from solids import box, moved, on_ground

STONES = replace(
    on_ground(*[box((0, 0.4), (0, 1), (i / 2, (i + 1) / 2)) for i in range(4)]), panel=np.array(["ground", *["pier"] * 4])
)
CONTACTS = cp.find_contacts(STONES)
RECORD = analysis(name="curve", friction=0.6)


@pytest.fixture(scope="module")
def curve() -> cp.BlockCapacityCurve:
    return cp.block_pushover(STONES, CONTACTS, cp.LoadCase((1, 0, 0)), 0.6, step=0.02)


def numbers(text: str) -> FloatArray:
    return np.frombuffer(base64.b64decode(text), dtype="<f4").reshape(-1, STONES.count, 3)


def test_the_viewer_has_the_poses_of_the_path(curve: cp.BlockCapacityCurve) -> None:
    found = viewer_path(STONES, RECORD, curve, origin_of(STONES))
    path = found["path"]
    assert path_label(RECORD) == found["label"] == "real path, load +x, friction 0.6"
    assert path["words"][0] == "0 mm, load factor 0.2000"
    assert numbers(path["position"])[-1] + origin_of(STONES) == pytest.approx(curve.position[-1], abs=1e-6)
    assert numbers(path["rotation"])[-1] == pytest.approx(curve.rotation[-1], abs=1e-6)
    assert len(path["words"]) == len(numbers(path["position"])) <= 16
    assert found["moving"] == 4


def test_pictures_stand_half_way_and_at_the_end(curve: cp.BlockCapacityCurve, tmp_path: Path) -> None:
    last = len(curve.load_factor) - 1
    # Many short steps lie where something happens: half of the steps is not half of the way.
    curve = replace(curve, displacement=curve.displacement[-1] * np.linspace(0.0, 1.0, last + 1) ** 2)
    half = int(np.ceil(last * np.sqrt(0.5)))
    made = snapshots(STONES, [(RECORD, curve)], tmp_path)
    assert [file.name for _, file, _ in made] == [f"curve_{half:03d}.png", f"curve_{last:03d}.png"]
    assert f": {1e3 * curve.displacement[half]:.3g} mm," in made[0][0]
    assert made[-1][0].startswith("real path, load +x, friction 0.6: ")
    # The stones are drawn where they are at the step, and both times from the same side.
    assert np.array_equal(made[-1][2][1][1], curve.position[-1])
    assert np.array_equal(made[0][2][1][-1], made[1][2][1][-1])


def test_figures_below_zero_have_the_minus_sign_of_the_report(curve: cp.BlockCapacityCurve) -> None:
    back = replace(curve, displacement=-curve.displacement, load_factor=curve.load_factor - 0.21)
    words = viewer_path(STONES, RECORD, back, origin_of(STONES))["path"]["words"]
    assert words[-1].startswith(f"\u2212{1e3 * curve.displacement[-1]:.3g} mm, load factor \u2212")
    assert not any("-" in each for each in words)


def test_crack_maps_show_the_joint_that_opens(curve: cp.BlockCapacityCurve) -> None:
    ((words, drawing),) = crack_maps(STONES, CONTACTS, [(RECORD, curve)])
    assert "pier" in words
    assert drawing.startswith("<svg")


def test_pictures_of_steps_that_are_not_proved_say_so(curve: cp.BlockCapacityCurve, tmp_path: Path) -> None:
    last = len(curve.misfit) - 1
    misfit = np.zeros(last + 1)
    misfit[1], misfit[last] = 0.05, 0.5
    jumps = replace(curve, misfit=misfit)
    half_way, end = (label for label, _, _ in snapshots(STONES, [(RECORD, jumps)], tmp_path))
    assert half_way.endswith(", not proved")
    assert end.endswith(", no equilibrium")
    ((words, _),) = crack_maps(STONES, CONTACTS, [(RECORD, jumps)])
    assert ", not proved; lengths counted from" in words
    assert viewer_path(STONES, RECORD, jumps, origin_of(STONES))["path"]["words"][0] == "0 mm, load factor 0.2000"
    assert not any("proved" in label for label, _, _ in snapshots(STONES, [(RECORD, curve)], tmp_path))


def test_crack_maps_of_a_control_point_that_goes_backwards_or_to_and_fro(curve: cp.BlockCapacityCurve) -> None:
    ((_, expected),) = crack_maps(STONES, CONTACTS, [(RECORD, curve)])
    ((words, drawing),) = crack_maps(STONES, CONTACTS, [(RECORD, replace(curve, displacement=-curve.displacement))])
    assert ", \u2212" in words
    assert drawing == expected
    swaying = 1e-9 * (-1.0) ** np.arange(len(curve.displacement))
    for sign in (1.0, -1.0):
        assert len(crack_maps(STONES, CONTACTS, [(RECORD, replace(curve, displacement=sign * swaying))])) <= 1


def test_joints_that_open_by_rounding_alone_have_no_map(curve: cp.BlockCapacityCurve) -> None:
    lifted = curve.position[:1] + 1e-9 * np.arange(STONES.count)[None, :, None]
    shut = replace(curve, position=np.repeat(lifted, len(curve.position), axis=0), rotation=np.zeros_like(curve.rotation))
    assert not crack_maps(STONES, CONTACTS, [(RECORD, shut)])


def test_crack_maps_show_walls_that_open_at_their_ground_alone() -> None:
    # A post of one stone turns over beside a pier that stands: all that opens is the joint below it.
    post = box((3, 3.3), (0, 1), (0, 2))
    pier = [box((0, 0.4), (0, 1), (i / 2, (i + 1) / 2)) for i in range(4)]
    stones = replace(on_ground(post, *pier), panel=np.array(["ground", "post", *["pier"] * 4]))
    contacts = cp.find_contacts(stones)
    curve = cp.block_pushover(stones, contacts, cp.LoadCase((1, 0, 0)), 0.6, step=0.02)
    assert curve.initial == pytest.approx(0.15, rel=1e-6)
    ((words, _),) = crack_maps(stones, contacts, [(RECORD, curve)])
    assert "post" in words
    assert words.endswith("lengths counted from x = 3.15, y = 0 m towards +y")


def test_crack_maps_begin_at_the_end_of_their_wall() -> None:
    # Wherever the wall stands and however it is turned, what is "along the wall" is counted from its left end.
    opening = np.where(CONTACTS.kind == "bed", 2e-3, 0.0)
    turn = np.radians(37)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    drawn: list[list[str]] = []
    for angle, shift in ((np.eye(3), [0, 0, 0]), (np.eye(3), [310, -720, 0]), (rotation, [310, -720, 0])):
        stones = replace(moved(STONES, angle, np.array(shift, dtype=float)), panel=STONES.panel)
        texts = re.findall(r"<text[^>]*>([^<]*)</text>", crack_map_svg(stones, cp.find_contacts(stones), opening, "pier"))
        drawn.append(texts)
        assert "m along the wall" in texts
        assert "0.0" in texts
    assert drawn[0] == drawn[1]
    assert set(drawn[0]) == set(drawn[2])


def test_figures_of_a_crack_map_do_not_cover_each_other() -> None:
    # Two cracks 1 m apart in a wall of 12 m have one figure, two 5 m apart have theirs: one piece of text more.
    row = on_ground(*(box((i, i + 1), (0, 0.5), (0, 1)) for i in range(12)))
    stones = replace(row, panel=np.array(["ground", *["row"] * 12]))
    contacts = cp.find_contacts(stones)
    place = np.array([contacts.point[first:last, 0].mean() for first, last in pairwise(contacts.point_ptr)]).round(9)
    near, far = (
        crack_map_svg(stones, contacts, np.where((contacts.kind == "head") & np.isin(place, at), 7e-3, 0.0), "row").count(
            'id="text_'
        )
        for at in ((1.0, 2.0), (1.0, 6.0))
    )
    assert far == near + 1


def test_a_joint_seen_from_the_front_is_no_crack_across_a_stone() -> None:
    # Two leaves of a wall part; seen from the side of one, the joint between them is as long and as high as the stone.
    leaves = on_ground(box((0, 2), (0, 0.3), (0, 1)), box((0, 2), (0.3, 0.6), (0, 1)))
    stones = replace(leaves, panel=np.array(["ground", "outer", "inner"]))
    contacts = cp.find_contacts(stones)
    assert len(contacts.blocks) == 3
    between = ~stones.fixed[contacts.blocks].any(axis=1)
    for opening, turns in ((between, 4), (~between, 1)):
        drawn = crack_map_svg(stones, contacts, 2e-3 * opening, "outer")
        (path,) = re.findall(r'id="LineCollection_1">\s*<path d="([^"]*)"', drawn)
        corners = np.array(re.findall(r"[ML] (\S+) (\S+)", path), dtype=float)
        assert len(corners) == turns + 1
        # Along its edges alone, which are upright or level.
        assert np.abs(np.diff(corners, axis=0)).min(axis=1).max() < 1e-6
