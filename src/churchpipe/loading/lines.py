"""Lines of load that reach beyond the shell of their wall, as over the outer half of a corner."""

import numpy as np

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, NameArray
from churchpipe.model.placed_loads import PlacedLoads

# Parts belong to one line if their directions, their places across it in m, and the directions of their forces agree to so many
# digits.
_DIGITS = 6
# A line whose rest lies in so few places has no second moment.
_SINGULAR = 1e12


def lines_of(placed: PlacedLoads, chosen: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the line of load that each of these parts (n,) is on (n,), and where along it its middle lies (n,), m."""
    foot, reach = placed.foot[chosen], placed.reach[chosen]
    axis = reach / np.linalg.norm(reach, axis=1, keepdims=True)
    place = np.einsum("nc,nc->n", foot, axis)
    across = foot - place[:, None] * axis
    _, load = np.unique(placed.load[chosen], return_inverse=True)
    # Two loads may have one name. Where one of them ends, what the other bears is not to change.
    force = placed.dead[chosen]
    force = force / np.maximum(np.linalg.norm(force, axis=1, keepdims=True), np.finfo(float).tiny)
    key = np.column_stack([load, np.round(np.concatenate([axis, across, force], axis=1), _DIGITS) + 0.0])
    return np.unique(key, axis=0, return_inverse=True)[1].ravel(), place


def main_walls(line: IntArray, length: FloatArray, wall: NameArray) -> NameArray:
    """Return for each part (n,) the wall that most of its line lies on, by lengths (n,)."""
    names, number = np.unique(wall, return_inverse=True)
    total = np.zeros((int(line.max(initial=-1)) + 1, len(names)))
    np.add.at(total, (line, number), length)
    return names[np.argmax(total, axis=1)][line]


def shares_within(share: FloatArray, amount: FloatArray, place: FloatArray, line: IntArray, within: BoolArray) -> FloatArray:
    """Return the shares (k,) of pieces of lines once what lies outside is spread over the rest of its line.

    The density of the rest grows by a linear factor, by which force and moment of the line stay what they are. Where that would
    leave some of the rest less than nothing, as on a short line, the shares are left as they are.

    Parameters
    ----------
    share, amount
        Of each piece, and the force N that it is the share of (k,).
    place, line
        Where along its line each piece lies (k,), m, and which line that is (k,).
    within
        Which pieces (k,) lie on a facet.
    """
    out, weight = share.copy(), share * amount
    for number in np.unique(line[~within]).tolist():
        own, beyond = np.flatnonzero(within & (line == number)), np.flatnonzero(~within & (line == number))
        if not (weight[own].any() and weight[beyond].any()):
            continue
        at = place - place[own].mean()
        rows = np.stack([np.ones(len(own)), at[own]])
        moments = (rows * weight[own]) @ rows.T
        if not np.linalg.cond(moments) < _SINGULAR:
            continue
        factor = 1.0 + np.linalg.solve(moments, [weight[beyond].sum(), weight[beyond] @ at[beyond]]) @ rows
        if factor.min() >= 0:
            out[own] *= factor
            out[beyond] = 0.0
    return out
