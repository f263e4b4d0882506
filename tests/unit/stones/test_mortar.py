"""Stones with mortar between them grow until they meet in the middle of their joints."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely.affinity

import churchpipe
from churchpipe.dxf.jointing import jointed
from churchpipe.dxf.reading import Reading
from churchpipe.dxf.stones import Stone
from churchpipe.findings import Finding, Place
from churchpipe.model.assemblage import Assemblage
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.ground import level_supports
from churchpipe.stones.mortar import close_joints, open_joints
from churchpipe.stones.soundness import check_soundness
from dxf_models import box, prism
from imprecise import joined_pairs, shaken, two_leaves
from solids import prism as upright

JOINT = 0.010


def bricks(courses: int, length: int) -> list:
    """Running bond of bricks 250 x 120 x 65 mm with joints of 10 mm all round, half bricks at the ends of every other course."""
    solids = []
    for course in range(courses):
        z = course * 0.075
        whole = 0.26 * np.arange(length + 1)
        edges = whole if course % 2 == 0 else np.concatenate(([0.0], whole[:-1] + 0.13, whole[-1:]))
        solids += [box((start, 0, z), (stop - start - JOINT, 0.12, 0.065)) for start, stop in pairwise(edges)]
    return solids


def assembled(solids: list) -> Assemblage:
    return Assemblage.from_polyhedra(solids, 18e3, fixed=[0])


def test_every_bed_and_head_joint_of_a_wall_is_found_and_nothing_overlaps() -> None:
    solids = bricks(4, 5)
    closed = close_joints(solids, JOINT)
    contacts = find_contacts(assembled(closed.solids))
    # Heads: 4 in courses of five bricks, 5 in those of six; beds: 10 between two courses.
    assert len(contacts.blocks) == 2 * 4 + 2 * 5 + 3 * 10
    assert len(closed.joints.width) == 2 * 4 + 2 * 5 + 3 * 10
    np.testing.assert_allclose(closed.joints.width, JOINT, rtol=1e-9)
    # The wall is a box without holes: 4 courses and the three joints between them.
    assert closed.volume.sum() == pytest.approx((5 * 0.26 - JOINT) * 0.12 * (4 * 0.075 - JOINT), rel=1e-9)
    assert closed.stuck == []


def test_wedge_joints_of_an_arch_close_on_their_bisectors() -> None:
    # Nine voussoirs over half a circle, joints 6 mm at the intrados and 14 mm at the extrados.
    inner, outer, wide, wider, count = 1.0, 1.3, 0.006, 0.014, 9
    solids = []
    for k in range(count):
        a, b = np.pi * k / count, np.pi * (k + 1) / count
        ring = [
            (radius * np.cos(angle + sign * 0.5 * gap / radius), radius * np.sin(angle + sign * 0.5 * gap / radius))
            for radius, gap, angle, sign in (
                (inner, wide, a, 1),
                (outer, wider, a, 1),
                (outer, wider, b, -1),
                (inner, wide, b, -1),
            )
        ]
        solids.append(prism(np.array(ring), 0.4))
    closed = close_joints(solids, JOINT)
    assert len(closed.joints.width) == count - 1
    contacts = find_contacts(assembled(closed.solids))
    assert len(contacts.blocks) == count - 1
    middle = contacts.point.reshape(count - 1, 4, 3).mean(axis=1)
    np.testing.assert_allclose(np.sort(np.arctan2(middle[:, 1], middle[:, 0])), np.pi * np.arange(1, count) / count, atol=1e-9)


def test_bricks_laid_at_a_slant_do_not_grow_into_the_ground() -> None:
    """Bricks at 30 degrees, cut at z = 0, the smallest scraps left out: a corner 1 mm above it would grow 7 mm below it."""
    wall, solids = shapely.box(0, 0, 1.6, 1.6), []
    for course in range(-30, 30):
        for number in range(-10, 10):
            x, z = (number + course % 2 / 2) * 0.26, course * 0.075
            brick = shapely.affinity.rotate(shapely.box(x, z, x + 0.25, z + 0.065), 30, origin=(0, 0)) & wall
            if brick.area > 0.1 * 0.25 * 0.065:
                corners = shapely.get_coordinates(shapely.orient_polygons(brick.simplify(1e-9)))[:-1]
                solids.append(upright(corners.tolist(), 0.12))
    closed = close_joints(solids, JOINT)
    assert min(points[:, 2].min() for points, _ in closed.solids) == pytest.approx(0.0, abs=1e-9)
    plates, standing = level_supports(closed.solids)
    assert set(standing) >= {k for k, (points, _) in enumerate(solids) if (np.abs(points[:, 2]) < 1e-9).sum() == 4}
    stones = Assemblage.from_polyhedra([*closed.solids, *plates], 18e3, fixed=[len(solids)])
    check_soundness(stones, find_contacts(stones))


def test_stones_of_different_size_and_noise_still_meet_in_one_bed() -> None:
    rng = np.random.default_rng(3)
    solids = [(points + rng.uniform(-3e-4, 3e-4, points.shape), faces) for points, faces in bricks(4, 5)]
    closed = close_joints(solids, JOINT)
    assert len(closed.joints.width) == 48
    assert closed.volume.sum() == pytest.approx((5 * 0.26 - JOINT) * 0.12 * (4 * 0.075 - JOINT), rel=5e-3)


@pytest.mark.parametrize(
    "noise",
    [1e-3, *(pytest.param(noise, marks=pytest.mark.slow("docs/contacts.md: four stones that meet")) for noise in (1e-6, 1e-4))],
)
def test_stones_across_from_each_other_do_not_touch_where_four_meet(noise: float) -> None:
    # Two leaves, each brick behind one of the other leaf: such strips bore beds, and the load factor across rose by a half.
    tolerances = Reading(joint=JOINT).tolerances({})
    assert tolerances == {"least_width": pytest.approx(0.002)}
    leaves = two_leaves(JOINT, courses=4, length=4)
    pairs = joined_pairs(find_contacts(assembled(close_joints(leaves, JOINT).solids)).blocks.tolist())
    # Of each leaf 3 heads a course and 7 beds between two; 16 bricks stand back to back.
    assert len(pairs) == 2 * (4 * 3 + 3 * 7) + 16
    for seed in range(3000, 3004):
        grown = assembled(close_joints(shaken(leaves, noise, seed), JOINT).solids)
        assert joined_pairs(find_contacts(grown, **tolerances).blocks.tolist()) == pairs


def test_open_joints_are_measured_where_nobody_named_them() -> None:
    found = open_joints(bricks(3, 4))
    assert len(found.width) == 3 + 4 + 3 + 2 * 8
    np.testing.assert_allclose(found.width, JOINT, rtol=1e-9)
    touching = [box((x, 0, z), (1, 1, 1)) for x in (0, 1) for z in (0, 1)]
    assert len(open_joints(touching).width) == 0


@pytest.mark.parametrize("count", [16, 24, 60])
def test_wedges_that_meet_in_one_point_have_no_gap_across_each_other(count: int) -> None:
    """From 16 on, every second one faces the other at less than 12 degrees, with a wedge between them."""
    rim = [(np.cos(angle), np.sin(angle)) for angle in np.linspace(0.0, np.pi, count + 1)]
    wedges = [prism(np.array([(0.0, 0.0), *pair]), 0.5) for pair in pairwise(rim)]
    assert len(open_joints(wedges).width) == 0


@pytest.mark.parametrize(("bed", "tile"), [(0.0, 0.010), (0.004, 0.003)])
def test_stones_do_not_grow_through_a_thin_one_between_them(bed: float, tile: float) -> None:
    """A tile between bricks, in touch with them or in thin mortar; 10 mm of mortar above."""
    heights, solids, low = (0.065, tile, 0.065, 0.065), [], 0.0
    for height, mortar in zip(heights, (bed, bed, JOINT, 0.0), strict=True):
        solids.append(box((0, 0, low), (0.25, 0.12, height)))
        low += height + mortar
    closed = close_joints(solids, JOINT)
    levels = [(points[:, 2].min(), points[:, 2].max()) for points, _ in closed.solids]
    ends = np.cumsum([0.0, 0.065 + bed / 2, tile + bed, 0.065 + bed / 2 + JOINT / 2, 0.065 + JOINT / 2])
    np.testing.assert_allclose(levels, [*pairwise(ends)], atol=1e-9)
    assert closed.wide == []


def test_a_flat_stone_among_others_has_no_mortar() -> None:
    place = Place("solid", "", "")
    solids = [*bricks(2, 2), box((0, 0, 0.15), (0.25, 0.12, 0.0))]
    stones = [Stone(points, faces, False, place, "", "default") for points, faces in solids]
    _, share = jointed(stones, JOINT, "keep", "counted", 1.0, [])
    assert share[-1] == 1.0
    assert (share[:-1] > 1.0).all()


def test_meshes_with_joints_between_them_grow_too(tmp_path: Path) -> None:
    lines: list[str] = []
    count = 0
    for number, (points, faces) in enumerate(bricks(2, 2)):
        lines.append(f"o brick-{number}")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
        lines += ["f " + " ".join(str(node + 1 + count) for node in face) for face in faces]
        count += len(points)
    path = tmp_path / "wall.obj"
    path.write_text("\n".join(lines) + "\n")
    stones, findings = churchpipe.read_stones(path, units="m", joint=JOINT, support="base", unit_weight=18e3)
    assert "W26" in findings.codes
    # One head joint below, two above, four beds, two feet.
    assert len(find_contacts(stones).blocks) == 1 + 2 + 4 + 2


def test_a_joint_between_sides_in_triangles_is_one_joint() -> None:
    drawn = [*bricks(2, 2), box((-0.26, 0, 0), (0.25, 0.12, 0.065)), box((-0.26, 0, 0.075), (0.25, 0.12, 0.055))]
    split = [(points, [three for a, b, c, d in faces for three in ((a, b, c), (a, c, d))]) for points, faces in drawn]
    findings: list[Finding] = []
    for solids in (drawn, split):
        stones = [
            Stone(points, tuple(map(tuple, faces)), False, Place("solid", "", ""), "", "default") for points, faces in solids
        ]
        jointed(stones, JOINT, "grow", "counted", 1.0, findings)
    # Heads: one below, two above; beds: four; at the end two heads and a bed.
    assert [finding.found.split(" of ")[0] for finding in findings] == 2 * ["10 joints"]
