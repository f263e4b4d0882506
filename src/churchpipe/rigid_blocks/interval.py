"""The interval of a mechanism: the load factors of all forces that fit given velocities without dilatancy.

Self-stress changes what friction can carry and moves nothing, so that one mechanism has a range of load factors.
"""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram
from churchpipe.conic.solve import Solve, solver_for
from churchpipe.conic.wrenches import BODY, as_matrix
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import LEAST_FACTOR, CoulombState, bipotential_gap, gap_coefficients
from churchpipe.rigid_blocks.equilibrium import Balanced
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP

# Error of the program of an end, over the load factor; and what its gap keeps away from the gap allowed, for rounding.
_ERROR = 1e-5
_KEPT = 1e-4


def mechanism_interval(balance: Balanced, strength: Strength, state: CoulombState) -> tuple[float, float]:
    """Return the least and the greatest load factor of the Coulomb states that fit the mechanism of a given one."""
    found = [end.load_factor for end in mechanism_ends(balance, strength, state)]
    return found[0], found[1]


def mechanism_ends(balance: Balanced, strength: Strength, state: CoulombState) -> tuple[CoulombState, CoulombState]:
    """Return the states with the least and the greatest load factor that fit the mechanism of a given one.

    For fixed velocities the compatible states are convex: equilibrium, friction cones, and a gap g of at most 1e-5 alpha, or that
    much more than the given state has over its alpha where it is not certified. (Its forces may be those of the least gap, and
    then no others are as near.) The self-stress of sliding contacts is statically free, so the interval has a length. g is linear
    in the forces: one more row of the balance, with a point of its own for what is left to the gap allowed. The row is dense, but
    alone, so that the factor of the normal matrix gains no more than a row. The ends are those of states that exist, inside the
    exact ones by some 1e-5 alpha; the given state, where no program was solved.
    """
    rows = _WithGap(balance, strength, state)
    return rows.farthest(-1.0), rows.farthest(1.0)


def no_higher(balance: Balanced, strength: Strength, state: CoulombState, load_factor: float) -> CoulombState:
    """Return the state that fits the mechanism of a given one with this load factor, or with the one nearest to it.

    The given state itself, where its load factor is no higher.
    """
    if state.load_factor <= load_factor:
        return state
    return towards(state, _WithGap(balance, strength, state).farthest(-1.0), load_factor)


def towards(state: CoulombState, end: CoulombState, load_factor: float) -> CoulombState:
    """Return the state between two of one mechanism that has this load factor, or of the two the one nearest to it."""
    way = end.load_factor - state.load_factor
    return _mixed(state, end, min(max((load_factor - state.load_factor) / way, 0.0), 1.0)) if way else state


class _WithGap:
    """The programs of both ends."""

    def __init__(self, balance: Balanced, strength: Strength, state: CoulombState) -> None:
        self._balance, self._strength, self._state = balance, strength, state
        certified = state.relative_gap <= BIPOTENTIAL_GAP
        self._share = BIPOTENTIAL_GAP if certified else BIPOTENTIAL_GAP + state.relative_gap
        self._plain = balance.program(strength.cohesion, strength.friction, strength.bound)
        coefficients, self._constant = gap_coefficients(balance, strength, state.y)
        # In the size of the other rows: what is left to the gap is as large as the largest load.
        size = max(abs(state.load_factor), LEAST_FACTOR)
        self._scale = float(np.abs(balance.dead).max()) / (self._share * size)
        row = np.concatenate([self._scale * coefficients.ravel(), [1.0, 0.0, 0.0]])
        column = np.flatnonzero(row)
        # Rows come in blocks of six.
        below = sp.csc_matrix((row[column], (np.zeros_like(column), column)), shape=(BODY, len(row)))
        above = sp.hstack([as_matrix(self._plain.balance), sp.csc_matrix((len(balance.dead), 3))])
        self._matrix = sp.csc_matrix(sp.vstack([above, below]))
        self._solve: Solve = solver_for(self._matrix)

    def farthest(self, sign: float) -> CoulombState:
        """Return the state whose load factor lies farthest in the direction of `sign`."""
        answer = self._solve(self._program(sign), duality_gap=_ERROR)
        state = self._state
        if answer.outcome != "solved":
            return state
        x, load_factor = answer.x[:-1], sign * answer.tau
        gap = bipotential_gap(self._balance, self._strength, x, state.y)
        end = CoulombState(x, load_factor, state.y, gap)
        # No less than the gap of the given state, which may be all that is allowed.
        allowed = max(self._share * (1.0 - 0.5 * _KEPT), state.relative_gap)
        if not end.relative_gap <= allowed:
            # Both states fit the mechanism, and so do all mixtures of them.
            lack, more = allowed * _size(state) - state.gap, end.gap - state.gap - allowed * (_size(end) - _size(state))
            end = _mixed(state, end, min(max(lack / more, 0.0), 1.0) if more > 0 else 0.0)
        return end if sign * (end.load_factor - state.load_factor) > 0 else state

    def _program(self, sign: float) -> ConeProgram:
        """Return max sign alpha, where g + (what is left) = share alpha, or share times the least factor for a smaller alpha."""
        plain = self._plain
        small = abs(self._state.load_factor) <= LEAST_FACTOR
        share = self._share * (1.0 - _KEPT)
        fixed, growing = (share * LEAST_FACTOR, 0.0) if small else (0.0, share)
        constant, growth = np.zeros((2, BODY))
        constant[0] = self._scale * (self._constant - fixed)
        growth[0] = -sign * self._scale * growing

        def longer(values: FloatArray, last: float = 0.0) -> FloatArray:
            return np.append(values, last)

        return ConeProgram(
            self._matrix,
            np.concatenate([plain.constant, constant]),
            np.concatenate([sign * plain.growth, growth]),
            longer(plain.limit),
            # With friction, though nothing pulls on it, the last point has a cone like all others.
            longer(plain.slope, 1.0),
            # The gap, and with it that of the points, is in the row alone.
            longer(np.zeros_like(plain.linear)),
            longer(np.zeros_like(plain.quadratic)),
            bound=longer(plain.bound, np.inf),
        )


def _size(state: CoulombState) -> float:
    return max(abs(state.load_factor), LEAST_FACTOR)


def _mixed(first: CoulombState, second: CoulombState, share: float) -> CoulombState:
    """Return the mixture of two states of one mechanism, so much of the second; its gap is mixed, too."""
    return replace(
        first,
        x=first.x + share * (second.x - first.x),
        load_factor=first.load_factor + share * (second.load_factor - first.load_factor),
        gap=first.gap + share * (second.gap - first.gap),
    )
