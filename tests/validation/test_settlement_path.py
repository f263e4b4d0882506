"""Supports that move on: a spreading arch against a linkage of three hinges, a wall whose corner sinks against its energy.

Arch: semicircle of mean radius 1, thickness .2, 40 voussoirs, its right springing pushed out. Two parts turn about the intrados
of a haunch each and meet at the extrados of the crown; the thrust is minus the derivative of their potential energy. Linkage and
energy are computed here, apart from the program. A published test of a spreading arch with a springing that moves at 45 degrees
(Zampieri, Simoncello, Pellegrino, Frattura ed Integrita Strutturale 43, 2018) was looked for: its numbers were not to be had.
"""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.generators import arch, wall
from churchpipe.large_displacements.cracks import joint_cracks
from churchpipe.model.arrays import FloatArray
from churchpipe.stones.footing import footing
from solids import box, on_ground

VOUSSOIRS, DEPTH = 40, 0.2


@pytest.fixture(scope="module")
def spreading() -> tuple[cp.Assemblage, cp.SettlementPath]:
    stones = cp.derive_blocks(arch(mean_radius=1.0, thickness=DEPTH, width=1.0, voussoirs=VOUSSOIRS))
    right = int(np.argmax(np.where(stones.fixed, stones.centroid[:, 0], -np.inf)))
    return stones, cp.settlement_path(stones, cp.find_contacts(stones), [right], (1, 0, 0), friction=0.75, step=0.01)


def corner(joint: int, side: float) -> FloatArray:
    angle = np.pi * joint / VOUSSOIRS
    return (1 + side * DEPTH / 2) * np.array([-np.cos(angle), np.sin(angle)])


def linkage(stones: cp.Assemblage, haunch: int, movement: FloatArray) -> FloatArray:
    """Thrust over the weight (n,) of three hinges: intrados `haunch` joints from either end, extrados of the crown."""
    left, right, crown = corner(haunch, -1), corner(VOUSSOIRS - haunch, -1), corner(VOUSSOIRS // 2, 1)
    free = np.flatnonzero(~stones.fixed)
    order = free[np.argsort(stones.centroid[free, 0])]
    centre, weight = stones.centroid[order][:, [0, 2]], stones.weight[order] / stones.weight.sum()
    parts = (slice(haunch, VOUSSOIRS // 2), left), (slice(VOUSSOIRS // 2, VOUSSOIRS - haunch), right)

    def energy(spread: float) -> float:
        out = 0.0
        end = right + np.array([spread, 0.0])
        lengths = [float(np.linalg.norm(crown - foot)) for foot in (left, right)]
        span = end[0] - left[0]
        x = (span**2 + lengths[0] ** 2 - lengths[1] ** 2) / (2 * span)
        top = left + np.array([x, np.sqrt(lengths[0] ** 2 - x**2)])
        for (which, foot), now in zip(parts, (left, end), strict=True):
            (u0, v0), (u1, v1) = crown - foot, top - now
            turn = np.arctan2(v1, u1) - np.arctan2(v0, u0)
            arm = centre[which] - foot
            out += float(weight[which] @ (now[1] + np.sin(turn) * arm[:, 0] + np.cos(turn) * arm[:, 1]))
        return out

    small = 1e-5
    return np.array([(energy(s - small) - energy(s + small)) / (2 * small) for s in movement])


def test_spreading_arch_as_a_linkage_of_three_hinges(spreading: tuple[cp.Assemblage, cp.SettlementPath]) -> None:
    stones, path = spreading
    thrust = path.reaction / stones.weight.sum()
    assert path.least / stones.weight.sum() == pytest.approx(0.15399, abs=1e-5)
    assert thrust == pytest.approx(linkage(stones, 7, path.movement), abs=1e-4)
    # Other linkages are far off, and the arch goes as far as this: a quarter of its radius.
    assert np.abs(thrust - linkage(stones, 6, path.movement))[-1] > 0.02
    assert path.status == "collapsed"
    # .25409 m with steps of .01 m, .25432 m of .005 m, .25430 m of .0025 m.
    assert path.ultimate == pytest.approx(0.2543, rel=2e-3)
    assert path.proved
    assert path.misfit.max() < 1e-5


def test_a_path_goes_on_from_any_of_its_steps(spreading: tuple[cp.Assemblage, cp.SettlementPath]) -> None:
    stones, path = spreading
    right = int(np.argmax(np.where(stones.fixed, stones.centroid[:, 0], -np.inf)))
    given = stones, cp.find_contacts(stones), [right], (1, 0, 0), 0.75
    kept: list[cp.SettlementPath] = []
    last = len(path.movement) - 4
    again = cp.settlement_path(*given, step=0.01, resume=path.until(last), keep=kept.append)
    assert [len(one.movement) for one in kept] == list(range(last + 1, len(again.movement) + 1))
    assert again.movement[: last + 1] == pytest.approx(path.movement[: last + 1], abs=1e-9)
    assert again.reaction[: last + 1] == pytest.approx(path.reaction[: last + 1], rel=1e-4)
    assert again.ultimate == pytest.approx(path.ultimate, rel=1e-3)
    assert again.dissipation[last] == pytest.approx(path.dissipation[last], abs=1e-9)
    assert f"continued from step {last}" in again.message
    assert again.proved
    block = on_ground(box((0, 1), (0, 1), (0, 1)))
    with pytest.raises(cp.InputError, match=r"settlement_path: resume: steps of another analysis; found another friction"):
        cp.settlement_path(*given[:-1], given[-1] + 0.1, step=0.01, resume=path.until(last))
    with pytest.raises(cp.InputError, match="settlement_path: resume: steps of other stones"):
        cp.settlement_path(block, cp.find_contacts(block), [0], resume=path)


def test_joints_of_the_linkage_open_and_the_others_stay_shut(spreading: tuple[cp.Assemblage, cp.SettlementPath]) -> None:
    stones, path = spreading
    contacts = cp.find_contacts(stones)
    opening, slip = joint_cracks(stones, contacts, path.position[10], path.rotation[10])
    place = contacts.point[contacts.point_ptr[:-1]]
    joint = np.round(np.degrees(np.arctan2(place[:, 2], -place[:, 0])) * VOUSSOIRS / 180).astype(int)
    assert sorted(joint[opening > 1e-5].tolist()) == [7, 20, 33]
    # Both parts turn by the same angle about the haunches, and away from each other by twice as much at the crown.
    wide = opening[np.isin(joint, (7, 33))]
    assert wide[0] == pytest.approx(wide[1], rel=1e-3)
    assert opening[joint == 20] == pytest.approx(DEPTH * np.sin(2 * np.arcsin(wide[:1] / DEPTH)), rel=1e-3)
    assert slip.max() < 1e-3 * path.movement[10]


def test_a_wall_whose_corner_sinks() -> None:
    stones = cp.derive_blocks(
        wall(length=3.2, brick=(0.4, 0.25, 0.2), courses=12, materials=[cp.UnitWeight("default", 18e3)], name="wall")
    )
    cut = footing(stones, cp.find_contacts(stones), ((-0.1, -1.0), (0.8, 1.0)))
    contacts = cp.find_contacts(cut.stones)
    path = cp.settlement_path(cut.stones, contacts, cut.support, friction=0.6, step=0.01, furthest=0.06)
    assert path.status == "unfinished"
    assert path.proved
    # The support does the work of its reaction, friction takes some, and the weight gives the rest.
    weight = cut.stones.weight
    given = -(path.position[-1, :, 2] - path.position[0, :, 2]) @ weight
    taken = np.trapezoid(path.reaction, path.movement) + path.dissipation[-1]
    assert given == pytest.approx(taken, rel=1e-4)
    opening, _ = joint_cracks(cut.stones, contacts, path.position[-1], path.rotation[-1])
    # A wedge goes down with the corner, and the beds above it open by as much.
    bed = contacts.kind == "bed"
    assert opening[bed].max() == pytest.approx(path.movement[-1], rel=1e-2)
    gone = np.abs(path.position[-1, :, 2] - path.position[0, :, 2]) > 1e-3
    assert 3 <= int((gone & ~cut.stones.fixed).sum()) < 30


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"step": 0.0}, "settlement_path: step: out of range"),
        ({"furthest": -1.0}, "settlement_path: furthest: out of range"),
        ({"steps": 0}, "settlement_path: steps: out of range"),
        ({"support": [1]}, "support: a stone that is free"),
    ],
)
def test_bad_arguments(options: dict[str, Any], said: str) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)))
    with pytest.raises(cp.InputError, match=said):
        cp.settlement_path(**({"stones": stones, "contacts": cp.find_contacts(stones), "support": [0]} | options))


def test_stones_that_do_not_stand_have_no_path() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.6, 1.6), (0, 1), (1, 2)))
    path = cp.settlement_path(stones, cp.find_contacts(stones), [0])
    assert (path.status, len(path.movement)) == ("unstable", 0)
    assert "dead load" in path.message
    assert np.isnan(path.ultimate)


def test_a_support_that_nothing_needs_is_left_at_once() -> None:
    stones = cp.Assemblage.from_polyhedra(
        [box((0, 3), (0, 1), (0, 1)), box((3, 4), (0, 1), (0, 1)), box((0, 4), (0, 1), (1, 1.5))], 18e3, fixed=[0, 1]
    )
    path = cp.settlement_path(stones, cp.find_contacts(stones), [1])
    assert path.status == "free"
    assert path.movement[-1] < 0.2


def test_a_path_ends_where_what_rests_on_the_support_has_parted_from_the_rest() -> None:
    # A pile of 1 m goes down with its ground beside a wall that it does not touch: once it has gone by its own height, nothing
    # more will happen.
    pile = box((0, 1), (0, 1), (0, 0.5)), box((0, 1), (0, 1), (0.5, 1))
    stones = cp.Assemblage.from_polyhedra(
        [box((0, 1), (0, 1), (-1, 0)), box((1.5, 3), (0, 1), (-1, 0)), *pile, box((1.5, 3), (0, 1), (0, 3))], 18e3, fixed=[0, 1]
    )
    path = cp.settlement_path(stones, cp.find_contacts(stones), [0], step=0.05)
    assert (path.status, path.fallen) == ("parted", ())
    assert path.reaction == pytest.approx(18e3, rel=1e-6)
    assert 1.0 <= path.movement[-1] < 1.1
    assert np.isnan(path.ultimate)


def test_a_bearing_that_turns() -> None:
    stones = cp.Assemblage.from_polyhedra(
        [box((0, 0.5), (0, 1), (0, 1)), box((3.5, 4), (0, 1), (0, 1)), box((0, 4), (0, 1), (1, 1.5))], 18e3, fixed=[0, 1]
    )
    path = cp.settlement_path(stones, cp.find_contacts(stones), [1], (0, 1, 0), about=(2.0, 0, 1), furthest=0.05, step=0.02)
    assert path.status == "unfinished"
    # The angle of the support, in rad.
    turn = path.rotation[:, 1, 1] - path.rotation[0, 1, 1]
    assert path.movement == pytest.approx(turn, abs=1e-9)


@pytest.mark.parametrize("courses", [0, 12])
def test_a_beam_rests_on_the_edge_about_which_its_bearing_turns(courses: int) -> None:
    # It leans on the edge without any moment about it, and stays until it slides over it. The edge bears 3/7 of the weight and
    # the inner edge of the other bearing 4/7, whose friction holds it: 3/7 tan(angle - atan mu) = 4/7 mu.
    # So it does with a wall upon it that is higher than what is followed round the stones that move.
    friction, step = 0.2, 0.04
    bearings = box((-1, 0.5), (0, 1), (-1, 0)), box((3.5, 4.5), (0, 1), (-1, 0))
    beams = [box((0, 4), (0, 1), (0.25 * k, 0.25 * k + 0.25)) for k in range(courses + 1)]
    stones = cp.Assemblage.from_polyhedra([*bearings, *beams], 18e3, fixed=[0, 1])
    options: dict[str, Any] = {"about": (0, 0, 0), "step": step, "furthest": 0.6}
    path = cp.settlement_path(stones, cp.find_contacts(stones), [0], (0, 1, 0), friction, **options)
    assert path.proved
    assert path.status == "collapsed"
    assert path.reaction == pytest.approx(0.0, abs=1e-6 * stones.weight.sum())
    assert path.ultimate == pytest.approx(np.arctan(friction) + np.arctan(4 / 3 * friction), abs=0.1 * step)


@pytest.mark.parametrize(("friction", "end"), [(0.9, np.arctan(0.25)), (0.2, np.arctan(0.2))])
def test_a_block_on_ground_that_tilts(friction: float, end: float) -> None:
    # It falls where its centroid passes its toe, tan t = b / h, or slides where tan t = mu. Steps of .02 rad.
    b, h = 0.5, 2.0
    axis = np.array([-0.5, 0.0, -0.2])
    stones = cp.Assemblage.from_polyhedra([box((-1, 2), (-1, 2), (-0.4, 0)), box((0, b), (0, 1), (0, h))], 18e3, fixed=[0])
    path = cp.settlement_path(stones, cp.find_contacts(stones), [0], (0, 1, 0), friction, about=axis)
    arm = (b / 2 - axis[0]) * np.cos(path.movement) + (h / 2 - axis[2]) * np.sin(path.movement)
    assert path.status == "collapsed"
    assert path.reaction == pytest.approx(stones.weight.sum() * arm, rel=1e-7)
    # Where it collapses is known to a tenth of a step.
    assert end - 0.002 < path.ultimate <= end


@pytest.mark.parametrize("halo", [0, 5])
def test_a_heavy_neighbour_that_stays_spares_no_stone_that_falls(halo: int) -> None:
    # The block of the test above, and beside it one of two hundred times its weight on ground that does not tilt.
    block = box((-1, 2), (-1, 2), (-0.4, 0)), box((0, 0.5), (0, 1), (0, 2))
    neighbour = box((20, 30), (0, 10), (-1, 0)), box((20, 30), (0, 10), (0, 2))
    options: dict[str, Any] = {"about": (-0.5, 0, -0.2), "step": 0.02, "halo": halo}
    ends = []
    for solids, fixed in ((block, [0]), ((*block, *neighbour), [0, 2])):
        stones = cp.Assemblage.from_polyhedra(solids, 18e3, fixed=fixed)
        path = cp.settlement_path(stones, cp.find_contacts(stones), [0], (0, 1, 0), 0.9, **options)
        ends.append((path.status, path.ultimate))
        assert not path.fallen
    assert ends[0][0] == "collapsed"
    assert ends[1] == pytest.approx(ends[0])


def test_a_neighbour_holds_a_slender_block_by_a_squeeze_that_nothing_makes() -> None:
    """Our own figures of docs/limits.md: alone the block falls where its middle stands over its edge, at atan .3."""
    blocks = [box((-2, 3), (-1, 1), (-0.3, 0)), box((0, 0.3), (-0.2, 0.2), (0, 1)), box((0.3, 1.5), (-0.8, 0.8), (0, 2))]
    ends: list[float] = []
    for count in (2, 3):
        stones = cp.Assemblage.from_polyhedra(blocks[:count], 2e4, fixed=[0])
        path = cp.settlement_path(stones, cp.find_contacts(stones), [0], (0, -1, 0), 0.7, about=(0, 0, 0), steps=60)
        ends += [part.displacement for part in path.fallen] or [path.ultimate]
    assert ends == pytest.approx([np.arctan(0.3), 0.44], abs=0.005)
