"""The interval of a mechanism: the load factors of all forces that fit given velocities without dilatancy.

Self-stress changes what friction can carry and moves nothing, so that one mechanism has a range of load factors.
"""

from dataclasses import replace

import numpy as np

from churchpipe.conic.program import ConeProgram
from churchpipe.conic.solve import Solve
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import CoulombState, bipotential_gap
from churchpipe.rigid_blocks.equilibrium import Equilibrium

# The gap of a state in the interval may exceed that of the given one by this share of the load factor.
_MORE_GAP = 1e-5
# An end is known when its bounds agree to this share of the load factor, or, before a state beyond it is known, to the second;
# so many programs at most.
_AGREE = 1e-4
_NARROW = 1e-6
_PROGRAMS = 10
# The first weight (price) of the gap, and the divisor by which it is reduced as long as the states stay within the gap allowed.
_PRICE = 2.0
_CHEAPER = 8.0


def mechanism_interval(balance: Equilibrium, strength: Strength, state: CoulombState, solve: Solve) -> tuple[float, float]:
    """Return the smallest and largest load factor found of the Coulomb states that fit the mechanism as well as the given one.

    For fixed velocities the compatible states are convex: equilibrium, friction cones, and a gap of at most that of the given
    state plus 1e-5 alpha. The self-stress of sliding contacts is statically free, so the interval has a length. The row of the
    gap is dense and gets a price instead (Lagrange): max +-alpha - price g. By virtual work
    g = -f_D . u - alpha + sum n (mu |v| + 2 max(0, -w)) + sum c |v|, so that this is the program of stage B with the work of
    friction cheaper or dearer, times price / (price +- 1); where price < 1 at the lower end it maximises -alpha. Each program
    gives a state and a bound, and states may be mixed: the ends returned are those of states that exist, inside the exact ones
    by at most 1e-4 alpha unless ten programs were too few.
    """
    low, high = (_end(balance, strength, state, sign, solve) for sign in (-1.0, 1.0))
    return min(low, state.load_factor), max(high, state.load_factor)


def _end(balance: Equilibrium, strength: Strength, state: CoulombState, sign: float, solve: Solve) -> float:
    """Return the load factor farthest in the direction of sign: the sandwich algorithm on gap against load factor."""
    size = max(abs(state.load_factor), 1e-3)
    allowed = state.gap + _MORE_GAP * size
    # Gap and sign * load factor of the farthest states on either side of the gap allowed.
    within, beyond = (state.gap, sign * state.load_factor), None
    reach, bound, price = within[1], np.inf, _PRICE
    for _ in range(_PROGRAMS):
        program = _priced_program(balance, strength, state, sign, price)
        duality_gap = min(max(1e-5 / price, 1e-7), 1e-6)
        answer = solve(program, duality_gap=duality_gap)
        if answer.outcome != "solved":
            break
        load_factor = answer.tau if sign + price > 0 else -answer.tau
        found = bipotential_gap(balance, strength, answer.x, state.y), sign * load_factor
        # The error of the program is relative to its objective, which is larger than the load factor.
        bound = min(bound, found[1] + price * (allowed - found[0]) + duality_gap * abs(sign + price) * size)
        if found[0] > allowed:
            beyond = found
        elif found[1] > within[1]:
            within = found
        reach = within[1]
        if beyond is None:
            price /= _CHEAPER
        else:
            slope = (beyond[1] - within[1]) / (beyond[0] - within[0])
            reach += max(slope, 0.0) * (allowed - within[0])
            # The next state lies farthest from the chord between these two.
            price = max(slope, price / _CHEAPER)
        # At a price of one the lower end has no multiplier.
        price = 1.01 if abs(price - 1.0) < 0.01 else price
        if bound - reach <= (_NARROW if beyond is None else _AGREE) * size:
            break
    return sign * reach


def _priced_program(balance: Equilibrium, strength: Strength, state: CoulombState, sign: float, price: float) -> ConeProgram:
    """Return max (sign + price) alpha - price sum n (mu |v| + 2 max(0, -w)) over equilibrium and the true cones.

    A point whose normal force is bounded may close, at the price of its bound, which is constant: the second term is absent
    there. The multiplier counts once, so it is -alpha where sign + price < 0.
    """
    rate = balance.rates(state.y / (balance.live @ state.y))
    slip = np.hypot(rate[:, 1], rate[:, 2])
    reward = sign + price
    overlap = np.where(strength.bounded, 0.0, np.maximum(-rate[:, 0], 0.0))
    linear = price / abs(reward) * (strength.friction * slip + 2.0 * overlap)
    program = balance.program(strength.cohesion, strength.friction, strength.bound, linear)
    return replace(program, growth=np.sign(reward) * balance.live)
