"""The parts of joints that crush: whose area they have, of joints that are convex and of those that are not."""

from functools import partial

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.rigid_blocks.crushing import joint_parts
from churchpipe.stones.joint_outlines import covered
from solids import box, on_ground, prism

L_SHAPE = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.3), (0.3, 0.3), (0.3, 1.0), (0.0, 1.0)]
MATERIAL = 0.51
UPRIGHT = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])


def pillar_on_a_leg() -> cp.Assemblage:
    """A pillar with an L for a base, 1 m high, and a box that lies half on one of its legs."""
    points, faces = prism([(x, -y) for x, y in L_SHAPE], 1.0)
    return on_ground((points @ UPRIGHT, faces), box((0.5, 1.5), (0.1, 0.2), (1.0, 1.5)))


def test_covered_given_no_bent_joint() -> None:
    # Convex joints have the parts that they have without `covered`, which is not asked for any.
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.2, 1.2), (0.5, 1.5), (1, 2)))
    contacts = cp.find_contacts(stones)
    plain, given = joint_parts(contacts, 8), joint_parts(contacts, 8, covered=partial(covered, stones, contacts))
    assert given.area == pytest.approx(plain.area, rel=1e-12)
    assert given.contacts.point == pytest.approx(plain.contacts.point, abs=1e-12)
    count = np.diff(given.contacts.point_ptr)
    assert np.add.reduceat(given.area, given.contacts.point_ptr[:-1]) == pytest.approx(contacts.area, rel=1e-9)
    assert sorted(contacts.area.tolist()) == pytest.approx([0.4, 1.0], rel=1e-9)
    assert (count == 64).all()


def test_parts_lie_in_the_joint_that_was_found() -> None:
    stones = pillar_on_a_leg()
    contacts = cp.find_contacts(stones)
    # The joint on the ground has the corners of its hull and the area of the L; that of the box is what lies on the leg.
    assert sorted(contacts.area.tolist()) == pytest.approx([0.05, MATERIAL], rel=1e-9)
    bent = int(contacts.area.argmax())
    parts = joint_parts(contacts, 16, covered=partial(covered, stones, contacts))
    mine = slice(*parts.contacts.point_ptr[bent : bent + 2])
    bears, place = parts.area[mine], parts.contacts.point[mine][:, :2]
    assert 0.9 * MATERIAL < bears.sum() <= MATERIAL
    assert (place[bears > 0] < 0.3 + 1e-9).any(axis=1).all()
    other = slice(*parts.contacts.point_ptr[1 - bent :][:2])
    assert parts.area[other].sum() == pytest.approx(0.05, rel=1e-9)


@pytest.mark.parametrize(("share", "status"), [(0.98, "unstable"), (1.15, "optimal")])
@pytest.mark.parametrize("plan", ["leg", "box"])
def test_a_joint_bears_its_own_area_times_the_strength(plan: str, share: float, status: str) -> None:
    # The foot of a pillar of 2 m bears 2 m of stone: an L under its own area, a box that lies on a larger one under the smaller.
    # If the hull of the L bore, it would stand at .68 of that.
    box_on_box = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.25, 0.75), (0.25, 0.75), (1, 3)))
    points, faces = prism([(x, -y) for x, y in L_SHAPE], 2.0)
    leg = on_ground((points @ UPRIGHT, faces))
    stones = leg if plan == "leg" else box_on_box
    load, strength = cp.LoadCase((1, 0, 0)), share * 2.0 * 18e3
    assert cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.7, compressive_strength=strength).status == status
