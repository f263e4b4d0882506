"""Stones that their neighbours cannot carry, even if these stood fast."""

import numpy as np
from scipy.optimize import nnls

from churchpipe.conic.wrenches import Wrenches
from churchpipe.large_displacements.step import StepProgram
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray

# Sides of the pyramid around each friction cone, and the share of a load that may be left over where it is carried.
SIDES = 16
ROUNDING = 1e-9


def unsupported(program: StepProgram, load_factor: float) -> BoolArray:
    """Return which stones of a program (nf,) fall one by one, or each after those that it rested on.

    A stone falls when no forces in the friction cones of its points are in equilibrium with its dead load, or with the dead load
    and so many times the live load, however much its neighbours could bear: there is then no such equilibrium of the structure
    with this stone in it. Each cone is replaced by a pyramid around it, so that no stone falls which stands. Stones that fall
    together, each held by the other, are not found; where joints crush or friction acts beside the points, none are.
    """
    balance = program.balance
    if not isinstance(balance, Wrenches) or balance.shift.any():
        return np.zeros(program.rows // 6, dtype=bool)
    dead, live = program.dead.reshape(-1, 6), program.live.reshape(-1, 6)
    loads = [dead] if load_factor <= 0 else [dead, dead + load_factor * live]
    point = np.repeat(np.arange(len(balance.frame)), np.diff(balance.pointer))
    order = np.argsort(balance.bodies, kind="stable")
    start = np.searchsorted(balance.bodies[order], np.arange(balance.count + 1))
    wrenches, friction = balance.blocks(), program.strength.friction[point]
    fallen, asked = np.zeros(balance.count, dtype=bool), np.ones(balance.count, dtype=bool)
    while True:
        bears = program.strength.bound[point] > 0
        bears &= ~np.isin(point, point[fallen[balance.bodies]])
        new = np.zeros_like(fallen)
        for load in loads:
            for stone in np.flatnonzero(asked & ~new & ~_carried_straight(balance, point, bears, friction, load)):
                touch = order[start[stone] : start[stone + 1]]
                touch = touch[bears[touch]]
                new[stone] = not _carried(wrenches[touch], friction[touch], load[stone])
        if not new.any():
            return fallen
        fallen |= new
        asked = np.zeros_like(asked)
        asked[balance.bodies[np.isin(point, point[new[balance.bodies]])]] = True
        asked &= ~fallen


def _carried_straight(balance: Wrenches, point: IntArray, bears: BoolArray, friction: FloatArray, load: FloatArray) -> BoolArray:
    """Return which stones (nf,) forces against the direction of their loads (nf, 6) carry, which act at the centroids.

    The points that can bear such forces must lie around the line of action. point, bears, friction (touches,): of each touch.
    """
    size = np.linalg.norm(load[:, :3], axis=1)
    up = -load[:, :3] / np.maximum(size, np.finfo(float).tiny)[:, None]
    normal = balance.signs[:, None] * balance.frames[balance.frame[point], 0]
    rise = np.einsum("ki,ki->k", normal, up[balance.bodies])
    near = np.flatnonzero(bears & (rise * np.sqrt(1.0 + friction**2) >= 1.0))
    body = balance.bodies[near]
    aside = np.eye(3)[np.abs(up).argmin(axis=1)]
    one = np.cross(up, aside)
    two = np.cross(up, one)
    angle = np.arctan2(*(np.einsum("ki,ki->k", balance.arms[near], axis[body]) for axis in (two, one)))
    order = np.lexsort((angle, body))
    body, angle = body[order], angle[order]
    held = np.zeros(balance.count, dtype=bool)
    if len(body):
        first = np.flatnonzero(np.diff(body, prepend=-1))
        last = np.append(first[1:], len(body)) - 1
        turn = np.diff(angle, append=0.0)
        turn[last] = angle[first] + 2 * np.pi - angle[last]
        held[body[first]] = np.maximum.reduceat(turn, first) < np.pi - ROUNDING
    return held & (np.abs(load[:, 3:]).max(axis=1) <= ROUNDING * size)


def _carried(wrenches: FloatArray, friction: FloatArray, load: FloatArray) -> bool:
    """Return whether forces at touches, with unit wrenches (k, 3, 6) and friction (k,), balance a load (6,)."""
    if not len(wrenches):
        return not load.any()
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    around = np.stack([np.cos(turn), np.sin(turn)]) / np.cos(np.pi / SIDES)
    edges = wrenches[:, 0, :, None] + friction[:, None, None] * np.einsum("kcr,cs->krs", wrenches[:, 1:], around)
    try:
        left = nnls(np.moveaxis(edges, 0, 1).reshape(6, -1), -load)[1]
    except RuntimeError:
        return True
    return bool(left <= ROUNDING * np.linalg.norm(load))
