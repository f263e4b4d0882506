"""Stones that float, lie twice in one place or overlap are found and named."""

import warnings

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.geometry import planar
from churchpipe.model.assemblage import Assemblage
from churchpipe.stones import soundness
from churchpipe.stones.account import joint_account, joint_lines
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.self_crossing import self_crossing_stones
from churchpipe.stones.soundness import (
    check_soundness,
    duplicate_stones,
    floating_stones,
    overlapping_stones,
    unsupported_stones,
)
from imprecise import corner
from solids import box, moved, on_ground, prism

CUBE = box((0, 1), (0, 1), (0, 1))


def test_a_sound_pile_passes() -> None:
    stones = on_ground(CUBE, box((0.2, 1.2), (0, 1), (1, 2)))
    check_soundness(stones, find_contacts(stones))


def test_floating_stones_are_named_with_their_place() -> None:
    stones = on_ground(CUBE, box((0, 1), (0, 1), (5, 6)), box((0, 1), (0, 1), (6, 7)))
    contacts = find_contacts(stones)
    assert floating_stones(stones, contacts).tolist() == [2, 3]
    with pytest.raises(InputError, match=r"B2 at \[0.5, 0.5, 5.5\] m, B3"):
        check_soundness(stones, contacts)


def test_a_stone_that_only_leans_on_its_neighbour_is_unsupported() -> None:
    # B2 hangs on the side of B1, B3 stands on B2.
    stones = on_ground(CUBE, box((1, 2), (0, 1), (0.5, 1.5)), box((1, 2), (0, 1), (1.5, 2.5)))
    contacts = find_contacts(stones)
    assert not len(floating_stones(stones, contacts))
    assert unsupported_stones(stones, contacts).tolist() == [2]


def test_duplicates_are_not_called_overlaps_too() -> None:
    stones = on_ground(CUBE, CUBE)
    assert duplicate_stones(stones).tolist() == [[1, 2]]
    with pytest.raises(InputError, match=r"1 drawn twice \(B1 and B2\)") as error:
        check_soundness(stones, find_contacts(stones))
    assert "overlap" not in str(error.value)


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_overlap_of_solids(turn: float) -> None:
    stones = on_ground(CUBE, box((0.9, 1.9), (0, 1), (0, 1)), box((1.9, 2.9), (0, 1), (0, 1)))
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    assert overlapping_stones(moved(stones, rotation, np.zeros(3))).tolist() == [[1, 2]]


def test_a_stone_in_the_notch_of_another_does_not_overlap() -> None:
    # The bounding boxes overlap and no face separates them: only the boolean tells.
    notch = prism([(0, 0), (2, 0), (2, 1), (1.5, 1), (1.5, 0.5), (0.5, 0.5), (0.5, 1), (0, 1)], 1.0)
    fitting, too_big = box((0.5, 1.5), (0, 1), (0.5, 1.5)), box((0.4, 1.6), (0, 1), (0.5, 1.5))
    assert overlapping_stones(on_ground(notch, fitting)).tolist() == []
    assert overlapping_stones(on_ground(notch, too_big)).tolist() == [[1, 2]]


@pytest.mark.parametrize(("depth", "pairs"), [(9e-7, []), (2e-6, [[1, 2]])])
def test_overlap_is_measured_by_its_depth(depth: float, pairs: list[list[int]]) -> None:
    # Flat tiles: the shared layer is 2e-5 of the volume already where coordinates of six decimals overlap by rounding alone.
    lower, upper = box((0, 1), (0, 1), (0, 0.02)), box((0, 1), (0, 1), (0.02 - depth, 0.04))
    assert overlapping_stones(on_ground(lower, upper)).tolist() == pairs
    # In a tray no plane lies between the two.
    tray = prism([(-0.5, 0), (1.5, 0), (1.5, 1), (1, 1), (1, 0.5), (0, 0.5), (0, 1), (-0.5, 1)], 1.0)
    assert overlapping_stones(on_ground(tray, box((0, 1), (0, 1), (0.5 - depth, 0.52)))).tolist() == pairs


@pytest.mark.parametrize("depth", [5e-7, 1e-3, 4e-3, 0.007, 0.042])
def test_a_brick_that_lies_in_another_has_its_joint_or_is_named_with_the_overlap_that_joins_it(depth: float) -> None:
    # Bricks 250 mm thick: 2 % of that, 5 mm, are joined without being asked for.
    bricks = [box((0, 0.5), (0, 0.25), (0, 0.25)), box((0.5, 1), (0, 0.25), (0, 0.25))]
    stones = on_ground(*bricks, box((0, 0.5), (0, 0.25), (0.25 - depth, 0.5 - depth)))
    contacts = find_contacts(stones)
    if depth > 5e-3:
        with pytest.raises(InputError, match=rf"1 pair overlaps \(B1 and B3\).* --overlap {1e3 * depth:g}mm of check and import"):
            check_soundness(stones, contacts)
        contacts = find_contacts(stones, contact_gap=2e-6, overlap=depth)
    check_soundness(stones, contacts)
    assert [1, 3] in contacts.blocks.tolist()
    assert contacts.gap.min() == pytest.approx(-depth)


def test_a_face_that_begins_with_corners_on_a_line_raises_no_warning() -> None:
    outline = [(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert overlapping_stones(on_ground(prism(outline, 1.0), box((0.5, 1.5), (0, 1), (0.5, 1.5)))).tolist() == [[1, 2]]


def test_a_stone_that_floats_over_a_gap_is_named_with_the_gap_that_would_join_it() -> None:
    stones = on_ground(CUBE, box((0, 1), (0, 1), (1.05, 2.05)))
    with pytest.raises(InputError) as error:
        check_soundness(stones, find_contacts(stones))
    assert "without a path to a support (B2 at" in str(error.value)
    assert "B1 and B2, 50 mm and 0 degrees, at (0.5, 0.5, 1.025) m" in str(error.value)
    assert "contact_gap_mm = 50 in [rigid]" in str(error.value)
    check_soundness(stones, find_contacts(stones, contact_gap=0.05))


@pytest.mark.parametrize(("thickness", "joined"), [(0.021, True), (0.02, True), (0.018, False)])
def test_no_gap_is_proposed_that_does_not_join_thin_stones(thickness: float, joined: bool) -> None:
    """Tiles in mortar of 10 mm: the message told to give the gap that had been given."""
    tile = box((0, 1), (0, 1), (1.01, 1.01 + thickness))
    stones = on_ground(CUBE, tile, box((0, 1), (0, 1), (1.02 + thickness, 2)))
    contacts = find_contacts(stones, contact_gap=0.015)
    if joined:
        check_soundness(stones, contacts)
        return
    with pytest.raises(InputError, match=r"Close the gaps\. No contact gap joins .* half the thickness of the thinner stone"):
        check_soundness(stones, contacts)
    found, now = joint_account(stones, contacts)
    assert found.joined_by == {}
    assert "No contact gap joins" in " ".join(joint_lines(found, now))


def test_a_stone_that_hangs_over_a_gap_is_named() -> None:
    # B2 leans on B1 and has a gap below: friction alone would hold it.
    stones = on_ground(box((0, 1), (0, 1), (0, 2)), box((1, 2), (0, 1), (0.05, 1)))
    with pytest.raises(InputError, match=r"1 with nothing below but a gap \(B2 at .*contact_gap_mm = 50"):
        check_soundness(stones, find_contacts(stones))


def test_open_joints_that_decide_the_result_are_refused_until_somebody_decides() -> None:
    stones = corner(head_gap=0.01)
    with pytest.raises(InputError, match=r"48 pairs of faces nearly meet, 34 % of all area .* contact_gap_mm = 10 in \[rigid\]"):
        check_soundness(stones, find_contacts(stones))
    check_soundness(stones, find_contacts(stones, contact_gap=1e-3))
    check_soundness(stones, find_contacts(stones, contact_gap=0.01))


def test_overlaps_within_the_tolerance_are_joints_and_deeper_ones_are_refused() -> None:
    shallow, deep = (on_ground(CUBE, box((0, 1), (0, 1), (1 - depth, 2))) for depth in (0.004, 0.05))
    contacts = find_contacts(shallow)
    check_soundness(shallow, contacts)
    assert contacts.gap.min() == pytest.approx(-0.004)
    with pytest.raises(InputError, match="1 pair overlaps"):
        check_soundness(deep, find_contacts(deep))
    with pytest.raises(InputError, match="1 pair overlaps"):
        check_soundness(shallow, find_contacts(shallow, overlap=0.001))


@pytest.mark.parametrize("fault", ["a corner through the opposite face", "sound and not convex"])
def test_a_stone_that_crosses_itself_is_named_with_its_place(fault: str) -> None:
    outline = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
    points, faces = prism(outline, 1.0)
    if fault != "sound and not convex":
        # The notch of the L reaches through its foot.
        points[[3, 9], 2] = -0.5
    stones = Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-3, -1)), (points, faces)], 1.0, fixed=[0])
    found = self_crossing_stones(stones)
    if fault == "sound and not convex":
        assert not found
        return
    ((block, place),) = found
    assert block == 1
    assert place[2] == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(InputError, match=r"1 whose surface crosses itself \(B1 at"):
        check_soundness(stones, find_contacts(stones))


@pytest.mark.parametrize("axis", range(3))
def test_stones_in_one_line_are_compared_with_their_neighbours_alone(axis: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """In plan all stones of a pile lie on each other, which took minutes for tens of thousands."""
    compared: list[int] = []

    def overlapping(rectangles: np.ndarray) -> np.ndarray:
        pairs = planar.overlapping(rectangles)
        compared.append(len(pairs))
        return pairs

    monkeypatch.setattr(soundness, "overlapping", overlapping)
    sides = np.tile([0.0, 1.0], (300, 3, 1))
    sides[:, axis] += 0.9 * np.arange(300)[:, None]
    stones = Assemblage.from_polyhedra([box(*map(tuple, side)) for side in sides.tolist()], 1.0, fixed=[0])
    assert overlapping_stones(stones).tolist() == [[stone, stone + 1] for stone in range(299)]
    assert not len(duplicate_stones(stones))
    assert max(compared) < 600
