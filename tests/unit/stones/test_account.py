"""The account of joints: every face is a joint, a near miss or free, and what was decided is told."""

import numpy as np
import pytest

from churchpipe.model.contacts import Contacts
from churchpipe.stones.account import NearMissAccount, joint_account, joint_lines, surface_account, tolerances_that_join
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.histogram import angle_histogram, gap_histogram
from imprecise import corner, dome, noisy, rounded, tilted, turned_wall, voussoir_arch
from solids import box, on_ground


@pytest.mark.parametrize(
    "stones",
    [
        corner(),
        corner(head_gap=0.01),
        noisy(corner(), 1e-3, seed=7),
        tilted(turned_wall(), np.radians(0.5), seed=7),
        rounded(voussoir_arch(), 3),
        noisy(dome(), 1e-4, seed=7),
    ],
    ids=["exact", "open", "noise", "tilt", "rounded", "dome"],
)
def test_every_face_is_a_joint_a_near_miss_or_free(stones) -> None:
    account = surface_account(stones, find_contacts(stones))
    assert account.surface == pytest.approx(account.joint + account.near_miss + account.free)
    assert (account.free > -0.01 * account.surface).all()


def test_free_surface_is_that_of_the_outside() -> None:
    cubes = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)), box((0, 1), (0, 1), (2.05, 3.05)))
    account = surface_account(cubes, find_contacts(cubes))
    assert account.free[1:].tolist() == pytest.approx([4, 4, 5])
    assert account.near_miss[1:].tolist() == pytest.approx([0, 1, 1])


def test_exact_stones_have_nothing_to_tell() -> None:
    stones = corner()
    account = joint_account(stones, find_contacts(stones))
    assert account[0] == NearMissAccount(0)
    assert joint_lines(*account) == []


def test_what_was_decided_is_told() -> None:
    stones = corner(head_gap=1e-3)
    lines = joint_lines(*joint_account(stones, find_contacts(stones)))
    assert len(lines) == 1
    assert lines[0].startswith("Joints closed across a gap: 48, up to 1 mm where widest; contact gap ")
    assert lines[0].endswith("proposed from the gaps of the stones.")


def test_near_misses_are_told_with_what_would_join_them() -> None:
    stones = corner(head_gap=0.01)
    contacts = find_contacts(stones)
    record, _ = joint_account(stones, contacts)
    assert (record.count, record.joined_by) == (48, {"contact_gap_mm": 10})
    assert record.gap == pytest.approx((5e-3, 10e-3))
    (line,) = joint_lines(*joint_account(stones, contacts))
    assert line.startswith("Near misses: 48 pairs of faces face each other and are no joint, 5 to 10 mm apart")
    assert line.endswith("contact_gap_mm = 10 in [rigid] makes joints of them.")
    asked = tolerances_that_join(contacts, np.arange(48))
    assert not len(find_contacts(stones, contact_gap=asked["contact_gap_mm"] / 1e3).near_misses)


def test_leaning_near_misses_ask_for_an_angle() -> None:
    contacts = Contacts(
        *(getattr(find_contacts(corner()), name) for name in ("blocks", "frame", "area", "point", "point_ptr", "kind"))
    )
    assert not len(contacts.near_misses)
    lean = np.radians(8)
    turned = np.array([[np.cos(lean), 0, -np.sin(lean)], [0, 1, 0], [np.sin(lean), 0, np.cos(lean)]])
    points, faces = box((0, 1), (0, 1), (0, 1))
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), (points @ turned.T + [0.05, 0, 1.0], faces))
    found = find_contacts(stones)
    assert found.near_misses.angle.tolist() == pytest.approx([lean])
    assert tolerances_that_join(found, np.arange(1))["contact_angle_deg"] == pytest.approx(8.1, abs=0.11)


def test_histogram_counts_every_joint_and_every_near_miss_once() -> None:
    contacts = find_contacts(corner(head_gap=0.01))
    for found in (gap_histogram(contacts), angle_histogram(contacts)):
        assert (found.joints.sum(), found.near_misses.sum()) == (98, 48)
    gaps = gap_histogram(contacts)
    assert gaps.joints[0] == 98
    assert gaps.edges[:-1][gaps.near_misses > 0].min() == pytest.approx(0.005, rel=0.5)
