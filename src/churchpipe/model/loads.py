"""Load cases: what pushes, or which of the loads that a building carries grow."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import listed, one_of, text
from churchpipe.model.arrays import FloatArray, NameArray, floats, store, unit_vector
from churchpipe.model.card import Shown
from churchpipe.model.quantities import as_written, declared

_MULTIPLIES = (
    "In place of a direction: names of line, point and area loads, pressures and fills that the load factor multiplies, such as "
    "a vehicle. At the load factor 1 they are as given, at 0 they are not there."
)
# What belongs to the stones or facets of one model, and has no place in a case file.
WRENCHES = ("dead", "live", "dead_virial", "live_virial", "dead_nodes", "live_nodes")
_A_LOAD = "a direction, live wrenches (nb, 6), or multiplies, names of loads that the building carries"


@dataclass(frozen=True, slots=True, repr=False)
class LoadCase(Shown):
    """A lateral load proportional to weight, or loads that the building carries, multiplied by the load factor.

    direction (3,) is normalised; None, kept as zeros: no weight is pushed, nothing grows but `live`. `name` defaults to the
    direction ("+x", "-y", "(0.5, 0.866, 0)"), to the names that are multiplied, or to "live"; `panels`: names of the panels that
    are pushed, None = all; profile "uniform", or "linear": f_i = W_i z_i (sum W) / (sum W z), z above the lowest free point, so
    that the load factor stays base shear over weight of the loaded part. `multiplies`: in place of a direction, names of what the
    building carries that the load factor multiplies, such as a vehicle: at the load factor 0 these loads are not there. `dead`
    and `live` are extra wrenches (nb, 6) N and Nm about the centroids: dead ones act always, live ones grow with the load factor.
    `dead_virial` and `live_virial` (nb, i, j) Nm are the sums of r_i F_j of their forces F at points r from the centroids (i, j:
    axes), for paths on which stones turn, and their forces with them; left out, each force acts at the point of its line nearest
    to the centroid. `dead_nodes` and `live_nodes` (nt, k, c), of a shell, are what of the wrenches acts on corners and sides of
    each facet, components c: forces N on the corners (k = 0, 1, 2) and on the sides from corner k - 3 to the next (k = 3, 4, 5),
    with the motion of the middle beyond the mean of the ends, and moments Nm on the same sides (k = 6, 7, 8), with the rotation
    of the middle. What they leave of the wrenches acts on the facet as a whole.
    """

    direction: Annotated[FloatArray, "Where the load pushes: a vector of any length; z is up. Needed without `multiplies`."]
    name: Annotated[str, 'For tables and pictures; by default the direction, such as "+x", or what it multiplies.'] = ""
    panels: Annotated[tuple[str, ...] | None, "Names of the walls that are pushed; by default all."] = None
    profile: Annotated[Literal["uniform", "linear"], "Over the height: as the weights, or growing from the ground."] = "uniform"
    multiplies: Annotated[tuple[str, ...] | None, _MULTIPLIES] = None
    dead: FloatArray | None = None
    live: FloatArray | None = None
    dead_virial: FloatArray | None = None
    live_virial: FloatArray | None = None
    dead_nodes: FloatArray | None = None
    live_nodes: FloatArray | None = None

    def __init__(
        self,
        direction: npt.ArrayLike | None = None,
        name: str = "",
        panels: "tuple[str, ...] | list[str] | None" = None,
        profile: Literal["uniform", "linear"] = "uniform",
        dead: npt.ArrayLike | None = None,
        live: npt.ArrayLike | None = None,
        dead_virial: npt.ArrayLike | None = None,
        live_virial: npt.ArrayLike | None = None,
        dead_nodes: npt.ArrayLike | None = None,
        live_nodes: npt.ArrayLike | None = None,
        multiplies: "tuple[str, ...] | list[str] | None" = None,
    ) -> None:
        if isinstance(direction, str):
            raise InputError(
                "LoadCase.direction", "a text", found=repr(direction), expected='a vector, such as [1, 0, 0] for "+x"'
            )
        unit = np.zeros(3) if direction is None else unit_vector("LoadCase.direction", direction)
        pushed = None if panels is None else tuple(listed("LoadCase.panels", panels, str))
        if pushed is not None and not pushed:
            raise InputError("LoadCase.panels", "nothing is pushed", expected="names of panels; left out, all are pushed")
        one_of("LoadCase.profile", profile, "uniform", "linear")
        grows = None if live is None else floats("LoadCase.live", live, (None, 6))
        named = None if multiplies is None else tuple(listed("LoadCase.multiplies", multiplies, str))
        if named is not None and not (named and all(named)):
            raise InputError("LoadCase.multiplies", "nothing grows", expected="names of loads that the building carries")
        if named is not None and direction is not None:
            remedy = "Analyse them one after the other, as two loads."
            raise InputError("LoadCase", "two loads in one", expected="either direction or multiplies", remedy=remedy)
        if direction is None and named is None and (grows is None or not grows.any()):
            found = "no live wrenches" if grows is None else "live wrenches that are all zero"
            raise InputError("LoadCase", "nothing is pushed", found=found, expected=_A_LOAD)
        if direction is None and (pushed is not None or profile != "uniform"):
            raise InputError("LoadCase", "no weight is pushed", found="panels or a profile", expected="a direction with them")
        store(
            self,
            direction=floats("LoadCase.direction", unit, (3,)),
            name=_named(name, unit, named),
            panels=pushed,
            profile=profile,
            multiplies=named,
            dead=None if dead is None else floats("LoadCase.dead", dead, (None, 6)),
            live=grows,
            dead_virial=_of_wrenches("dead_virial", dead_virial, dead, (3, 3)),
            live_virial=_of_wrenches("live_virial", live_virial, live, (3, 3)),
            dead_nodes=_of_wrenches("dead_nodes", dead_nodes, dead, (9, 3)),
            live_nodes=_of_wrenches("live_nodes", live_nodes, live, (9, 3)),
        )

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows: dict[str, object] = {"name": self.name, "pushes": "all" if self.panels is None else ", ".join(self.panels)}
        if self.multiplies is not None:
            rows["multiplies"] = ", ".join(self.multiplies)
        if not self.direction.any():
            rows["pushes"] = "no weight"
        elif self.profile != "uniform":
            rows["profile"] = self.profile
        for name, wrench in (("dead", self.dead), ("live", self.live)):
            if wrench is not None:
                parts = [round(float(1e-3 * wrench[:, axis].sum()), 9) + 0.0 for axis in range(3)]
                rows[f"{name} (x, y, z), kN"] = f"({', '.join(f'{part:.4g}' for part in parts)})"
        return "Load case", rows


def nearest_virial(wrench: FloatArray) -> FloatArray:
    """Return r_i F_j (nb, i, j), Nm, of wrenches (nb, 6) about the centroids: r the points of their lines nearest to these."""
    force, moment = wrench[:, :3], wrench[:, 3:]
    square = (force**2).sum(axis=1, keepdims=True)
    arm = np.cross(force, moment) / np.where(square > 0, square, 1.0)
    return arm[:, :, None] * force[:, None, :]


def replaced(load: LoadCase, **wrenches: FloatArray | None) -> LoadCase:
    """Return a load case with other wrenches, or with other virials or forces on nodes of them, by their names."""
    kept = {name: getattr(load, name) for name in WRENCHES}
    direction = load.direction if load.direction.any() else None
    return LoadCase(direction, load.name, load.panels, load.profile, multiplies=load.multiplies, **{**kept, **wrenches})


def _of_wrenches(
    name: str, value: npt.ArrayLike | None, wrench: npt.ArrayLike | None, shape: tuple[int, int]
) -> FloatArray | None:
    if value is None:
        return None
    if wrench is None:
        raise InputError(f"LoadCase.{name}", "no wrenches", expected=f"{name.partition('_')[0]} with it")
    # Of a shell there are wrenches of beams besides, so that only the analysis knows how many facets there are.
    rows = len(np.asarray(wrench)) if shape == (3, 3) else None
    return floats(f"LoadCase.{name}", value, (rows, *shape))


def way_of(load: LoadCase) -> FloatArray:
    """Return the unit vector (3,) along which a load pushes: its direction, or that of its live forces; zeros of none."""
    if load.direction.any() or load.live is None:
        return load.direction
    force = load.live[:, :3].sum(axis=0)
    return np.asarray(force / max(float(np.linalg.norm(force)), np.finfo(float).tiny))


def load_keys() -> tuple[str, ...]:
    """Return the keys of a load in a case file or a drawing: of the fields with a meaning there; wrenches belong to stones."""
    return tuple(item.key for item in declared(LoadCase).values() if item.meaning)


def load_table(load: LoadCase, *, defaults: bool = True) -> dict[str, Any]:
    """Return a load by the keys that it has in a case file; without `defaults` only where a value is not the default."""
    table = as_written(load, defaults=defaults)
    if load.direction.any():
        table["direction"] = load.direction.tolist()
    else:
        del table["direction"]
    return {key: table[key] for key in load_keys() if key in table}


def _named(name: object, direction: FloatArray, multiplies: tuple[str, ...] | None) -> str:
    return default_name(direction, multiplies) if isinstance(name, str) and not name else text("LoadCase.name", name)


def default_name(direction: FloatArray, multiplies: tuple[str, ...] | None) -> str:
    """Return the name of a load that is given none: what it multiplies, or `direction_name`."""
    return ", ".join(multiplies) if multiplies else direction_name(direction)


def direction_name(direction: FloatArray) -> str:
    """Return "+x", "-y" ... for a direction along an axis, "live" for none, else its components."""
    if not direction.any():
        return "live"
    axis = int(np.argmax(np.abs(direction)))
    if abs(abs(direction[axis]) - 1) < 1e-9:
        return ("+" if direction[axis] > 0 else "-") + "xyz"[axis]
    return "(" + ", ".join(f"{c:.3g}" for c in direction) + ")"


def pushed_share(load: LoadCase, panel: NameArray, weight: FloatArray, height: FloatArray) -> FloatArray:
    """Return what share of the weight of each item (n,) the load factor multiplies, by the panels and the profile of a load.

    panel, weight (N) and height (m, above the lowest point) of the stones or facets that weigh: one rule for both models.

    Raises
    ------
    InputError: a panel that none of them belongs to.
    """
    share = np.ones(len(weight))
    if load.panels is not None:
        known = np.unique(panel).tolist()
        missing = sorted(set(load.panels) - set(known))
        if missing:
            raise InputError(f"load {load.name}: panels", "no such panel", found=", ".join(missing), expected=", ".join(known))
        share = np.isin(panel, load.panels).astype(np.float64)
    if load.profile == "linear":
        moment = float((share * weight) @ height)
        share = share * height * (float(share @ weight) / moment if moment > 0 else 0.0)
    return share
