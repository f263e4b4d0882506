"""Stones that their neighbours cannot carry, even if these stood fast."""

import numpy as np
from scipy.optimize import nnls

from churchpipe.conic.wrenches import Wrenches
from churchpipe.large_displacements.step import StepProgram
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray

# Sides of the pyramid around each friction cone, and the share of the dead load that may be left over where it is carried.
SIDES = 16
ROUNDING = 1e-9


def unsupported(program: StepProgram) -> BoolArray:
    """Return which stones of a program (nf,) the dead load alone brings down, one by one or each after those it rested on.

    A stone falls when no forces in the friction cones of its points are in equilibrium with its dead load, however much its
    neighbours could bear: it then falls in any equilibrium of the dead load. Each cone is replaced by a pyramid around it, so
    that no stone falls which stands. Stones that fall together, each held by the other, are not found; where joints crush or
    friction acts beside the points, none are.
    """
    balance = program.balance
    if not isinstance(balance, Wrenches) or balance.shift.any():
        return np.zeros(program.rows // 6, dtype=bool)
    dead = program.dead.reshape(-1, 6)
    point = np.repeat(np.arange(len(balance.frame)), np.diff(balance.pointer))
    order = np.argsort(balance.bodies, kind="stable")
    start = np.searchsorted(balance.bodies[order], np.arange(balance.count + 1))
    wrenches = balance.blocks()
    fallen, asked = np.zeros(balance.count, dtype=bool), np.ones(balance.count, dtype=bool)
    while True:
        bears = program.strength.bound > 0
        bears[point[fallen[balance.bodies]]] = False
        left = asked & ~_carried_upright(balance, point, bears[point], program.strength.friction[point], dead)
        new = []
        for stone in np.flatnonzero(left):
            touch = order[start[stone] : start[stone + 1]]
            touch = touch[bears[point[touch]]]
            if not _carried(wrenches[touch], program.strength.friction[point[touch]], dead[stone]):
                new.append(stone)
        if not new:
            return fallen
        fallen[new] = True
        asked = np.zeros_like(asked)
        asked[balance.bodies[np.isin(point, point[np.isin(balance.bodies, new)])]] = True
        asked &= ~fallen


def _carried_upright(balance: Wrenches, point: IntArray, bears: BoolArray, friction: FloatArray, dead: FloatArray) -> BoolArray:
    """Return which stones (nf,) vertical forces at their points carry: the points that can bear them lie around the centroid.

    point, bears, friction (touches,): of each touch; dead (nf, 6).
    """
    rise = balance.signs * balance.frames[balance.frame[point], 0, 2]
    upright = np.flatnonzero(bears & (rise * np.sqrt(1.0 + friction**2) >= 1.0))
    body, arm = balance.bodies[upright], balance.arms[upright]
    angle = np.arctan2(arm[:, 1], arm[:, 0])
    order = np.lexsort((angle, body))
    body, angle = body[order], angle[order]
    held = np.zeros(balance.count, dtype=bool)
    if len(body):
        first = np.flatnonzero(np.diff(body, prepend=-1))
        last = np.append(first[1:], len(body)) - 1
        turn = np.diff(angle, append=0.0)
        turn[last] = angle[first] + 2 * np.pi - angle[last]
        held[body[first]] = np.maximum.reduceat(turn, first) < np.pi - ROUNDING
    other = np.abs(dead[:, [0, 1, 3, 4, 5]]).max(axis=1)
    return held & (other <= -ROUNDING * dead[:, 2])


def _carried(wrenches: FloatArray, friction: FloatArray, dead: FloatArray) -> bool:
    """Return whether forces at touches, with unit wrenches (k, 3, 6) and friction (k,), balance a dead load (6,)."""
    if not len(wrenches):
        return not dead.any()
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    around = np.stack([np.cos(turn), np.sin(turn)]) / np.cos(np.pi / SIDES)
    edges = wrenches[:, 0, :, None] + friction[:, None, None] * np.einsum("kcr,cs->krs", wrenches[:, 1:], around)
    try:
        left = nnls(np.moveaxis(edges, 0, 1).reshape(6, -1), -dead)[1]
    except RuntimeError:
        return True
    return bool(left <= ROUNDING * np.linalg.norm(dead))
