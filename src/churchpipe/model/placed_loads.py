"""Loads at their places: forces and masses at points of stones, the form that both models take."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray, NameArray, floats, rows_of, store, store_arrays
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.card import Shown
from churchpipe.model.ties import Tie

# How the loads of each kind are called, before their names.
_KINDS = ("line load", "point load", "area load", "diaphragm", "pressure", "fill")
# How far beside its stone a load may stand, over the diagonal of the stone.
_SLACK = 0.1


@dataclass(frozen=True, slots=True, repr=False)
class PlacedLoads(Shown):
    """n small parts of loads.

    Parameters
    ----------
    point
        Where each acts (n, 3), m.
    stone
        The stone (n,) that bears it.
    wall
        Name of the panel (n,) of that stone.
    load
        Name (n,) of the load that it is a part of.
    dead
        Its force (n, 3), N.
    mass
        Weight (n,), N, that a lateral load multiplies there.
    foot
        Where on the stone it stands (n, 3), m, such as below the middle of a column of fill; left out: where it acts. Of a part
        of a line the middle.
    reach
        Of a part of a line, the way (n, 3) m from its middle to its end; its density is linear, so that `point` is its centre.
        Zero, as where left out: a part at one point.
    rise
        How far above its foot each acts (n,), m, such as the centroid of a chimney; `point` has it. Left out: not at all, or what
        `point` says of a part at one point.
    """

    point: FloatArray
    stone: IntArray
    wall: NameArray
    load: NameArray
    dead: FloatArray
    mass: FloatArray
    foot: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    reach: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    rise: FloatArray = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        n = rows_of("PlacedLoads.stone", self.stone)
        store_arrays(self, point=(n, 3), stone=(n,), wall=(n,), load=(n,), dead=(n, 3), mass=(n,))
        store(
            self,
            foot=floats("PlacedLoads.foot", self.foot if np.size(self.foot) else self.point, (n, 3)),
            reach=floats("PlacedLoads.reach", self.reach if np.size(self.reach) else np.zeros((n, 3)), (n, 3)),
            rise=floats("PlacedLoads.rise", self.rise if np.size(self.rise) else np.zeros(n), (n,)),
        )

    @property
    def weight(self) -> FloatArray:
        """What presses downwards (n,), N."""
        return np.asarray(-self.dead[:, 2])

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows: dict[str, object] = {
            "parts": len(self.stone),
            "stones": len(np.unique(self.stone)),
            "mass, kN": float(self.mass.sum()) / 1e3,
        }
        for name in dict.fromkeys(self.load.tolist()):
            force = self.dead[self.load == name].sum(axis=0) / 1e3
            rows[f"{name} (x, y, z), kN"] = f"({', '.join(f'{part:z.4g}' for part in force)})"
        return "Placed loads", rows


def called_names(name: str) -> list[str]:
    """Return what the parts of a load of this name may be called."""
    return [name, *(f"{kind} {name}" for kind in _KINDS)]


def bare_name(called: str) -> str:
    """Return the name of a load of which parts are called so."""
    return next((called.removeprefix(f"{kind} ") for kind in _KINDS if called.startswith(f"{kind} ")), called)


def joined_loads(parts: Sequence[PlacedLoads]) -> PlacedLoads:
    """Return the parts of several loads, one load after another."""
    number, name = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.str_)
    none = PlacedLoads(np.zeros((0, 3)), number, name, name, np.zeros((0, 3)), np.zeros(0))
    every = [none, *parts]
    merged = {item.name: np.concatenate([getattr(each, item.name) for each in every]) for item in fields(PlacedLoads)}
    return PlacedLoads(**merged)


def check_loads_of(stones: Assemblage, placed: PlacedLoads) -> None:
    """Raise InputError for loads placed on another assemblage: on stones that are not there, of other walls or elsewhere."""
    on, remedy = placed.stone, "Place the loads on these stones."
    away = on[(on < 0) | (on >= stones.count)]
    if len(away):
        expected = f"stones 0 to {stones.count - 1}"
        raise InputError("loads", "placed on another assemblage", found=int(away.max()), expected=expected, remedy=remedy)
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0)[on] for edge in (np.minimum, np.maximum))
    slack = _SLACK * np.linalg.norm(high - low, axis=1)[:, None]
    beside = np.any((placed.foot < low - slack) | (placed.foot > high + slack), axis=1)
    bad = np.flatnonzero(beside | (placed.wall != stones.panel[on]))
    if len(bad):
        first = bad[0]
        raise InputError(
            "loads",
            "placed on another assemblage",
            found=f"{placed.load[first]} on {stones.block_id[on[first]]} at {placed.foot[first].round(4).tolist()} m, beside it",
            remedy=remedy,
        )


@dataclass(frozen=True, slots=True)
class Applied:
    """What a building carries, its ties, and others that might be added, all at their stones."""

    loads: PlacedLoads
    ties: tuple[Tie, ...] = ()
    candidates: tuple[Tie, ...] = ()
