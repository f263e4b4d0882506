"""Stones that friction alone holds between others, as over an opening with a flat head: they may come out whatever pushes."""

from dataclasses import replace

import numpy as np

from churchpipe.conic.wrenches import BODY
from churchpipe.model.arrays import BoolArray, FloatArray, NameArray
from churchpipe.model.names import LOOSE
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.wording import counted

# Stones move that are faster than the first share of the fastest. They are loose, not the mechanism of the building, where they
# weigh no more than the second share of it.
_MOVES, _FEW = 0.02, 0.1
# So many times their friction keeps loose stones in their places.
_FIRM = 10.0
# So many stones are called by their names.
_NAMED = 3


def loose_stones(balance: Equilibrium, y: FloatArray) -> BoolArray:
    """Return which free stones (nf,) move with velocities y (rows,), if these are few; else none."""
    count = balance.rows // BODY
    speed = np.linalg.norm(y[: balance.rows].reshape(count, BODY), axis=1)
    weight = np.linalg.norm(balance.dead[: balance.rows].reshape(count, BODY)[:, :3], axis=1)
    moving = speed > _MOVES * float(speed.max(initial=0.0))
    few = float(weight[moving].sum()) <= _FEW * float(weight.sum())
    return moving if few else np.zeros(count, dtype=bool)


def held_fast(balance: Equilibrium, strength: Strength, stones: BoolArray) -> Strength:
    """Return the strength of the points with so much friction at these free stones (nf,) that they stay in their places."""
    wrenches = balance.wrenches
    point = np.repeat(np.arange(balance.points), np.diff(wrenches.pointer))
    touched = np.zeros(len(strength.friction), dtype=bool)
    touched[point[stones[wrenches.bodies]]] = True
    return replace(strength, friction=np.where(touched, _FIRM * strength.friction, strength.friction))


def loose_words(stones: BoolArray, names: NameArray | None) -> str:
    """Return what is said of loose stones (nf,), by their names (nf,) where these are known."""
    count = int(stones.sum())
    told = counted(count, "stone", "stones")
    if names is not None:
        known = [str(name) for name in names[stones]]
        told += f" ({', '.join(known[:_NAMED])}{', ...' if count > _NAMED else ''})"
    verb, them, need = ("comes", "it", "it needs") if count == 1 else ("come", "them", "they need")
    return f"in it {told} {verb} {LOOSE}: friction alone holds {them}, and over an opening {need} a lintel, an arch or a tie"


def any_load_words(low: float, high: float) -> str:
    """Return what is said of a state whose interval, from low to high, begins at zero or below."""
    if high <= 0.0:
        return "in it stones fall under the dead load alone"
    return f"it fits any load factor from {max(low, 0.0):.4f} to {high:.4f}"
