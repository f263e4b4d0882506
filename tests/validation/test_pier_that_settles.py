"""A wall on two piers, one of which settles, against linear programming in the plane, written here.

Of a support that moves the least reaction is that of all equilibria: forces at the corners of the joints, within their friction.
"""

import itertools
from functools import cache

import numpy as np
import pytest
from scipy.optimize import linprog

import churchpipe as cp
from solids import box

# x0, x1, z0, z1 of stones one metre wide; the first two are the ground below the piers.
Place = tuple[float, float, float, float]
WEIGHT = 18e3


def _wall() -> list[Place]:
    """Seven courses of stones half a metre long, a lintel over the opening from 1 to 2 m."""
    out: list[Place] = [(-1, 1, -0.5, 0), (2, 4, -0.5, 0)]
    for course in range(7):
        low, high = 0.25 * course, 0.25 * (course + 1)
        head = [x for x in np.arange(-0.5 + 0.25 * (course % 2), 3.5, 0.5) if 0 < x < 3]
        clear = [(0.0, 1.0), (2.0, 3.0)] if course < 4 else [(0.0, 3.0)]
        for begin, end in clear:
            ends = [begin, *(x for x in head if begin < x < end), end]
            if course == 4:
                ends = [0.0, 0.75, 2.25, 3.0]
            out += [(float(a), float(b), low, high) for a, b in itertools.pairwise(ends)]
    return out


STONES = _wall()


@cache
def _assemblage() -> cp.Assemblage:
    return cp.Assemblage.from_polyhedra([box(p[:2], (0, 1), p[2:]) for p in STONES], WEIGHT, fixed=[0, 1])


def _least(friction: float, direction: tuple[float, float], about: tuple[float, float] | None = None) -> float:
    """Least reaction over the weight; about: the ground turns about this point, right-handed about +y."""
    free = range(2, len(STONES))
    centre = np.array([((p[0] + p[1]) / 2, (p[2] + p[3]) / 2) for p in STONES])
    weight = np.array([(p[1] - p[0]) * (p[3] - p[2]) * WEIGHT for p in STONES])
    columns, power = [], []
    for one, other in itertools.combinations(range(len(STONES)), 2):
        first, second = STONES[one], STONES[other]
        x0, x1 = max(first[0], second[0]), min(first[1], second[1])
        z0, z1 = max(first[2], second[2]), min(first[3], second[3])
        if other < 2 or (x1 - x0 < -1e-9) or (z1 - z0 < -1e-9) or (x1 - x0 < 1e-9) == (z1 - z0 < 1e-9):
            continue
        upright = x1 - x0 < 1e-9
        normal, along = (np.array([1.0, 0.0]), np.array([0.0, 1.0])) if upright else (np.array([0.0, 1.0]), np.array([1.0, 0.0]))
        normal = normal * np.sign(normal @ (centre[other] - centre[one]))
        for point, side in itertools.product(np.array([(x0, z0), (x1, z1)]), (friction, -friction)):
            force = normal + side * along
            column = np.zeros((len(STONES), 3))
            for stone, sign in ((one, -1), (other, 1)):
                arm = point - centre[stone]
                column[stone] += sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
            # What the structure does to the ground that moves, along its movement.
            rate = np.array(direction) if about is None else np.array([point[1] - about[1], about[0] - point[0]])
            columns.append(column[free].ravel())
            power.append(-float(force @ rate) if one == 1 else 0.0)
    dead = np.zeros((len(STONES), 3))
    dead[:, 1] = -weight
    found = linprog(power, A_eq=np.column_stack(columns) / 1e3, b_eq=-dead[free].ravel() / 1e3)
    return float(found.fun / weight[free].sum())


PIER = pytest.mark.slow("docs/settlement.md: a pier that moves")


@pytest.mark.parametrize("friction", [pytest.param(0.3, marks=PIER), 0.6, pytest.param(0.9, marks=PIER)])
@pytest.mark.parametrize("direction", [(0.0, -1.0), (0.4, -1.0), (1.0, 0.0)])
def test_a_pier_that_moves(friction: float, direction: tuple[float, float]) -> None:
    stones = _assemblage()
    x, z = np.array(direction) / np.hypot(*direction)
    found = cp.settlement_analysis(stones, cp.find_contacts(stones), [1], (x, 0, z), friction)
    assert found.status == "optimal"
    assert found.reaction / stones.weight.sum() == pytest.approx(_least(friction, (x, z)), abs=1e-7)
    without = cp.settlement_analysis(stones, cp.find_contacts(stones), [1], (x, 0, z), friction, flow="non-associative")
    assert without.reaction > found.reaction - 1e-6 * stones.weight.sum()


@pytest.mark.parametrize("friction", [0.3, 0.9])
def test_a_pier_whose_ground_turns(friction: float) -> None:
    stones = _assemblage()
    found = cp.settlement_analysis(stones, cp.find_contacts(stones), [1], (0, 1, 0), friction, about=(2, 0, 0))
    assert found.reaction / stones.weight.sum() == pytest.approx(_least(friction, (0, 0), (2, 0)), abs=1e-7)
