"""Small cone programs of rigid blocks, with every kind of point that a solver must know."""

import numpy as np

from churchpipe.conic.program import ConeProgram
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground

# Of all points of a program: what limits their forces and what these cost.
KINDS_OF_POINTS: list[dict[str, float]] = [
    {},
    {"slope": 0.0},
    {"limit": 0.02},
    {"limit": 0.05, "slope": -0.001},
    {"limit": 0.1, "slope": 0.0, "quadratic": 0.3},
    {"limit": 0.1, "slope": -0.1, "quadratic": 0.3, "linear": 0.1},
    {"quadratic": 0.3, "linear": 0.05},
    {"cap": 0.05},
    {"cap": 0.05, "limit": 0.1, "slope": -0.1, "linear": 0.1},
    {"bound": 0.25},
    {"bound": 0.25, "slope": 0.0, "limit": 0.1},
    {"bound": 0.24, "limit": 0.02, "linear": 0.01},
    {"bound": 0.24, "limit": 0.05, "slope": -0.1, "quadratic": 0.3},
    {"bound": 0.25, "cap": 0.05},
]


def stated(
    stones: Assemblage,
    *,
    direction: tuple[float, float, float] = (1, 0, 0),
    limit: float = 0.0,
    slope: float = 0.7,
    linear: float = 0.0,
    quadratic: float = 0.0,
    cap: float = np.inf,
    bound: float = np.inf,
) -> ConeProgram:
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, LoadCase(direction))
    one = np.ones(len(contacts.point))
    return ConeProgram(
        balance.wrenches, balance.dead, balance.live, limit * one, slope * one, linear * one, quadratic * one, cap, bound * one
    )


def three_stones() -> Assemblage:
    return on_ground(box((0, 1), (0, 1), (0, 1)), box((0.2, 1.2), (0, 1), (1, 2)), box((1, 1.6), (0, 1), (0, 1)))
