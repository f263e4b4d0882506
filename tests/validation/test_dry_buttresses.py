"""Walls with buttresses that nobody bonded: what friction in the joint between them is worth, in each flow rule.

Sources: moments and forces on two rigid bodies, by hand, as the docstrings say; linear programs over the same contact points,
with equations of their own, by `scipy.optimize.linprog`.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import linprog

import churchpipe as cp
from churchpipe import generators
from solids import box

T, H, L, W, D, GAMMA, MU = 0.5, 3.0, 4.0, 0.5, 0.75, 18e3, 0.6
WALL, BUTTRESSES = L * T * H * GAMMA, 2 * W * D * H * GAMMA
MATERIALS = [cp.Material("default", GAMMA, MU)]


def bodies(courses: int = 1) -> cp.Assemblage:
    """A wall along x, from y = 0 to T, and two buttresses behind it, each in so many courses of one stone."""
    ends = np.linspace(0.0, H, courses + 1)
    solids, panel = [box((-1.0, L + 1), (-1.0, T + D + 1), (-0.5, 0.0))], [""]
    for level in pairwise(ends.tolist()):
        solids.append(box((0.0, L), (0.0, T), level))
        solids += [box((x - W / 2, x + W / 2), (T, T + D), level) for x in (1.0, 3.0)]
        panel += ["wall", "wall buttress 1", "wall buttress 2"]
    return cp.Assemblage.from_polyhedra(solids, GAMMA, fixed=[0], panel=panel)


def laid(*, bonded: bool = False, parity: int = 0) -> cp.Assemblage:
    """The same as a generator lays them: courses of .25 m, stones of 1 m."""
    wall = generators.wall(length=L, brick=(1.0, T, 0.25), height=H, joints="bay", materials=MATERIALS)
    wall = replace(wall, panels=tuple(replace(panel, runs_through=parity) for panel in wall.panels))
    given = cp.Buttress("wall", along=(1.0, 3.0), toward="+y", width=W, depth=D, bonded=bonded)
    return cp.derive_blocks(cp.with_buttresses(wall, [given]))


def state_of(stones: cp.Assemblage, direction: tuple[float, float, float], flow: str = "associative") -> cp.LimitState:
    return cp.limit_analysis(stones, cp.find_contacts(stones), cp.LoadCase(direction), MU, flow=flow)


def towards(wedged: bool) -> float:
    """Of the wall that leans on its buttresses at their top with N, and turns with them, each about its own toe.

    Wall, about (T, 0): a WALL H / 2 = WALL T / 2 + N H. Buttresses, about (T + D, 0), held down by the friction of N and, wedged,
    of a force N0 between the feet of both: a BUTTRESSES H / 2 + N H = BUTTRESSES D / 2 + mu (N + N0) D. N + N0 is no more than
    friction below the buttresses bears: a BUTTRESSES + N + N0 = mu (BUTTRESSES + mu (N + N0)).
    """
    # Unknown: a, N, N0.
    rows = [
        ([WALL * H / 2, -H, 0.0], WALL * T / 2),
        ([BUTTRESSES * H / 2, H - MU * D, -MU * D], BUTTRESSES * D / 2),
        ([BUTTRESSES, 1 - MU**2, 1 - MU**2], MU * BUTTRESSES) if wedged else ([0.0, 0.0, 1.0], 0.0),
    ]
    left, right = (np.array(part) for part in zip(*rows, strict=True))
    return float(np.linalg.solve(left, right)[0])


def away(wedged: bool) -> float:
    """Of the wall that turns away from its buttresses, about (0, 0): a WALL H / 2 = WALL T / 2 + mu N0 T.

    Wedged, the feet of both press on each other with what friction below the buttresses bears, which N0 lifts:
    N0 = a BUTTRESSES + mu (BUTTRESSES - mu N0).
    """
    rows = [
        ([WALL * H / 2, -MU * T], WALL * T / 2),
        ([-BUTTRESSES, 1 + MU**2], MU * BUTTRESSES) if wedged else ([0.0, 1.0], 0.0),
    ]
    left, right = (np.array(part) for part in zip(*rows, strict=True))
    return float(np.linalg.solve(left, right)[0])


def test_two_bodies_have_the_load_factors_of_hand_calculations() -> None:
    stones = bodies()
    assert (towards(False), away(False)) == pytest.approx((0.1922, 0.1667), abs=5e-5)
    assert (towards(True), away(True)) == pytest.approx((0.2359, 0.2114), abs=5e-5)
    for direction, by_hand in (((0, 1, 0), towards), ((0, -1, 0), away)):
        associative = state_of(stones, direction)
        assert associative.load_factor == pytest.approx(by_hand(True), rel=1e-5)
        without = state_of(stones, direction, "non-associative")
        assert without.status == "converged"
        # What wedges the feet of both is not there unless something made it.
        assert without.interval[0] == pytest.approx(by_hand(False), rel=1e-4)
        assert without.interval[1] == pytest.approx(by_hand(True), rel=1e-4)
        assert without.interval[0] * (1 - 1e-6) <= without.load_factor < by_hand(True)


def program(stones: cp.Assemblage, direction: float) -> float:
    """The associative load factor in the plane across a wall that is alike along x, from equations of its own.

    The same contact points; the forces at each, along its normal and up to mu times that across it, level or upright.
    """
    contacts = cp.find_contacts(stones)
    free = np.flatnonzero(~stones.fixed)
    row = {int(stone): 3 * number for number, stone in enumerate(free)}
    columns: list[np.ndarray] = []
    for joint, (one, other) in enumerate(contacts.blocks):
        corner = contacts.point[slice(*contacts.point_ptr[joint : joint + 2])][:, 1:]
        normal = contacts.frame[joint, 0, 1:]
        for point in corner:
            for across in (-MU, MU):
                force = normal + across * np.array([-normal[1], normal[0]])
                column = np.zeros(3 * len(free))
                for stone, sign in ((int(one), -1.0), (int(other), 1.0)):
                    if stone in row:
                        arm = point - stones.centroid[stone, 1:]
                        moment = arm[0] * force[1] - arm[1] * force[0]
                        column[row[stone] : row[stone] + 3] += sign * np.array([*force, moment])
                columns.append(column)
    weight = stones.weight[free]
    live, dead = (np.zeros(3 * len(free)) for _ in range(2))
    live[::3], dead[1::3] = direction * weight, -weight
    a = np.column_stack([*columns, live])
    cost = np.append(np.zeros(len(columns)), -1.0)
    found = linprog(cost, A_eq=a / weight.mean(), b_eq=-dead / weight.mean(), bounds=(0, None), method="highs")
    assert found.status == 0
    return float(found.x[-1])


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("courses", [1, 3, 12])
def test_a_linear_program_over_the_same_points_has_the_associative_load_factor(courses: int, direction: int) -> None:
    stones = bodies(courses)
    # No head joint in the wall, and two buttresses alike: nothing turns in plan.
    assert state_of(stones, (0, direction, 0)).load_factor == pytest.approx(program(stones, direction), rel=1e-5)


def turned(stones: cp.Assemblage, turn: np.ndarray) -> cp.Assemblage:
    """The stones turned or mirrored (3, 3); the faces of what is mirrored run the other way."""
    order = -1 if np.linalg.det(turn) < 0 else 1
    solids = [(points @ turn.T, [face[::order] for face in faces]) for points, faces in map(stones.solid, range(stones.count))]
    return cp.Assemblage.from_polyhedra(
        solids, GAMMA, stones.fixed, panel=stones.panel.tolist(), course=stones.course.tolist(), butts=stones.butts.tolist()
    )


TURNS = {
    "turned": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "mirrored along x": np.diag([-1.0, 1.0, 1.0]),
    "mirrored along y": np.diag([1.0, -1.0, 1.0]),
}


@pytest.mark.parametrize("bonded", [True, False])
def test_a_wall_with_buttresses_is_as_strong_whichever_way_it_looks(bonded: bool) -> None:
    stones = laid(bonded=bonded)
    for sign, known in ((1.0, {True: 0.5129, False: 0.2359}), (-1.0, {True: 0.2646, False: 0.1988})):
        found = state_of(stones, (0.0, sign, 0.0)).load_factor
        assert found == pytest.approx(known[bonded], abs=5e-5)
        for turn in TURNS.values():
            east, north, _ = (turn @ [0.0, sign, 0.0]).tolist()
            assert state_of(turned(stones, turn), (east, north, 0.0)).load_factor == pytest.approx(found, rel=1e-6)


def of_box(wall: str, *, flipped: bool) -> float:
    """The load factor of a square room towards a dry buttress of one of its walls; flipped: of odd courses for even ones."""
    room = generators.box(length=L, width=L, courses=12, brick=(1.0, T, 0.25), joints="bay", materials=MATERIALS)
    if flipped:
        room = replace(room, panels=tuple(replace(panel, runs_through=1 - (panel.runs_through or 0)) for panel in room.panels))
    side, direction = {"south": ("-y", (0, 1, 0)), "west": ("-x", (1, 0, 0))}[wall]
    given = cp.Buttress(wall, along=(2.0,), toward=side, width=W, depth=D, bonded=False)
    east, north, up = direction
    return state_of(cp.derive_blocks(cp.with_buttresses(room, [given])), (-east, -north, up)).load_factor


def test_walls_along_x_and_along_y_differ_by_which_course_begins_their_bond() -> None:
    # The walls of a room take turns at its corners, so that one bond begins with the course with which the other goes on.
    south, west = of_box("south", flipped=False), of_box("west", flipped=False)
    assert (south, west) == pytest.approx((0.3100, 0.2946), abs=5e-5)
    assert (of_box("west", flipped=True), of_box("south", flipped=True)) == pytest.approx((south, west), rel=1e-6)
    # So it is with a bonded buttress on a wall by itself.
    found = [state_of(laid(bonded=True, parity=1), (0.0, sign, 0.0)).load_factor for sign in (1.0, -1.0)]
    assert found == pytest.approx([0.4824, 0.2751], abs=5e-5)
