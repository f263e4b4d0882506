"""Placed loads to the wrenches on stones or on facets of a shell that a load case takes."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.loading.facets import Pieces, pieces_of, pieces_on
from churchpipe.loading.placing import place_loads
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.carried import Carried
from churchpipe.model.fill import Fill
from churchpipe.model.loads import LoadCase, nearest_virial, pushed_share, replaced
from churchpipe.model.placed_loads import PlacedLoads, bare_name, called_names, check_loads_of
from churchpipe.model.shell import ShellModel


@dataclass(frozen=True, slots=True)
class _Bodies:
    """What loads act on: stones, or facets and beams. centroid (n, 3) m, weight (n,) N, panel (n,); lowest: z of the lowest
    point, m."""

    centroid: FloatArray
    weight: FloatArray
    panel: NameArray
    lowest: float


def loaded(load: LoadCase, stones: Assemblage, loads: "PlacedLoads | Iterable[Carried | Fill]") -> LoadCase:
    """Return a load case with what a building carries, for the analyses of its stones.

    The load factor is then base shear over the weight of the pushed stones and of the pushed masses together.

    Parameters
    ----------
    load
        The load case. Dead parts are added to its `dead`; what has mass pushes in its direction, by its panels and profile, and
        is added to its `live`. One without a direction pushes no mass; what it multiplies is added to its `live` instead.
    stones
        With the names of their walls as `panel`.
    loads
        What they carry, or the same already placed.

    Returns
    -------
    LoadCase
        With wrenches (nb, 6) on the stones.

    Raises
    ------
    InputError
        As `place_loads`; loads placed on other stones; wrenches of the load case that are not those of these stones; a name
        that it multiplies and that no load has.
    """
    check_kind("loaded: load", load, LoadCase)
    check_kind("loaded: stones", stones, Assemblage)
    placed = loads if isinstance(loads, PlacedLoads) else place_loads(stones, loads)
    if placed is loads:
        check_loads_of(stones, placed)
    bodies = _stones(stones)
    return _with(load, bodies, placed, _as_placed(placed), _push(load, bodies, placed))


def pushed_masses(load: LoadCase, stones: Assemblage, placed: PlacedLoads) -> tuple[FloatArray, FloatArray]:
    """Return what a load case pushes of the stones (nb,) beyond what it does without masses, and of the masses (n,), N."""
    found = _masses_pushed(load, _stones(stones), placed)
    return found.more_of_bodies, found.masses


def _stones(stones: Assemblage) -> _Bodies:
    free = ~stones.fixed
    lowest = float(stones.points[np.repeat(free, np.diff(stones.block_point_ptr)), 2].min())
    return _Bodies(stones.centroid, stones.weight, stones.panel, lowest)


def shell_loaded(
    load: LoadCase, shell: ShellModel, stones: Assemblage, loads: "PlacedLoads | Iterable[Carried | Fill]"
) -> LoadCase:
    """Return a load case with what a building carries, for the analyses of its shell.

    Parameters
    ----------
    load
        As in `loaded`.
    shell
        The shell.
    stones
        Those of the same building: they say where the loads act. Each force goes to the facet of its wall nearest to it, or to
        its beam.
    loads
        As in `loaded`.

    Returns
    -------
    LoadCase
        With wrenches (nt + nm, 6) on facets and beams, about their centroids.

    Raises
    ------
    InputError
        As `loaded`; loads on walls that the shell does not have.
    """
    check_kind("shell_loaded: load", load, LoadCase)
    check_kind("shell_loaded: shell", shell, ShellModel)
    placed = loads if isinstance(loads, PlacedLoads) else place_loads(stones, loads)
    _check_walls(shell, placed)
    bodies = _Bodies(shell.body_centroid, shell.body_weight, shell.body_panel, float(shell.points[:, 2].min()))
    pieces = pieces_on(shell, placed)
    push = _push(load, bodies, placed)
    whole = _with(load, bodies, placed, pieces, push)
    nodes = [
        _nodes_of(len(shell.triangles), pieces, force) + (0.0 if own is None else own)
        for force, own in zip(_acting(load, placed, push[0]), (load.dead_nodes, load.live_nodes), strict=True)
    ]
    return replaced(whole, dead_nodes=nodes[0], live_nodes=nodes[1])


def _check_walls(shell: ShellModel, placed: PlacedLoads) -> None:
    """Raise InputError for loads on walls that a shell does not have: they are of another building."""
    known = np.union1d(shell.panel, shell.beams.name)
    strange = np.flatnonzero(~np.isin(placed.wall, known))
    if len(strange):
        first = strange[0]
        raise InputError(
            "loads",
            "on a wall that the shell does not have",
            found=f"{placed.load[first]} on {placed.wall[first]}",
            expected=", ".join(known.tolist()),
            remedy="Give the shell and the stones of one building.",
        )


def resultant(centroid: FloatArray, wrench: FloatArray) -> FloatArray:
    """Return force and moment about the origin (6,) of wrenches (n, 6) about centroids (n, 3)."""
    force = wrench[:, :3]
    return np.concatenate([force.sum(axis=0), (wrench[:, 3:] + np.cross(centroid, force)).sum(axis=0)])


def resultants(stones: Assemblage, shell: ShellModel, placed: PlacedLoads) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return what the loads come to (6,) N and Nm on the stones and on the shell: the dead parts, and the masses' push along
    (1, 1, 1), which sees their places in all directions."""
    mass = placed.mass[:, None] * np.full(3, 1 / np.sqrt(3))
    on_stones, on_shell = _as_placed(placed), pieces_on(shell, placed)

    def total(centroid: FloatArray, pieces: Pieces, force: FloatArray) -> FloatArray:
        return resultant(centroid, wrenches_of(centroid, pieces.point, pieces.forces(force), pieces.body))

    return {
        name: (total(stones.centroid, on_stones, force), total(shell.body_centroid, on_shell, force))
        for name, force in (("dead", placed.dead), ("masses", mass))
    }


def _as_placed(placed: PlacedLoads) -> Pieces:
    return pieces_of(np.arange(len(placed.stone)), placed.point, placed.stone)


def _with(load: LoadCase, bodies: _Bodies, placed: PlacedLoads, pieces: Pieces, push: tuple[FloatArray, FloatArray]) -> LoadCase:
    masses, more = push
    forces = [pieces.forces(force) for force in _acting(load, placed, masses)]
    dead, live = (wrenches_of(bodies.centroid, pieces.point, force, pieces.body) for force in forces)
    live[:, :3] += more
    virials = [_virial_of(bodies.centroid, pieces.point, force, pieces.body) for force in forces]
    for total, virial, wrench, own in (
        (dead, virials[0], load.dead, load.dead_virial),
        (live, virials[1], load.live, load.live_virial),
    ):
        if wrench is not None:
            total += wrench
            virial += nearest_virial(wrench) if own is None else own
    return replaced(load, dead=dead, live=live, dead_virial=virials[0], live_virial=virials[1])


def _acting(load: LoadCase, placed: PlacedLoads, masses: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the forces (n, 3) N of placed loads that act always, and those that grow with the load factor; masses: pushed."""
    grows = multiplied(load, placed)[:, None]
    return np.where(grows, 0.0, placed.dead), np.where(grows, placed.dead, masses)


def multiplied(load: LoadCase, placed: PlacedLoads) -> BoolArray:
    """Return which parts (n,) of placed loads a load case multiplies.

    Raises
    ------
    InputError: a name that no load has, or one that only has mass.
    """
    out = np.zeros(len(placed.load), dtype=bool)
    for name in load.multiplies or ():
        own = np.isin(placed.load, called_names(name))
        if not (own[:, None] & (placed.dead != 0)).any():
            problem = "a mass alone, which nothing pushes" if own.any() else "no such load"
            expected = ", ".join(sorted({bare_name(each) for each in placed.load.tolist()})) or "loads that the building carries"
            raise InputError(f"load {load.name}: multiplies", problem, found=name, expected=expected)
        out |= own
    return out


def _push(load: LoadCase, bodies: _Bodies, placed: PlacedLoads) -> tuple[FloatArray, FloatArray]:
    """Return what a load case pushes of the masses (n, 3) and of the bodies (nb, 3) beyond what it does without masses, N."""
    if not load.direction.any():
        return np.zeros_like(placed.dead), np.zeros_like(bodies.centroid)
    push = _masses_pushed(load, bodies, placed)
    return push.masses[:, None] * load.direction, push.more_of_bodies[:, None] * load.direction


def _nodes_of(facets: int, pieces: Pieces, force: FloatArray) -> FloatArray:
    """Return what forces (n, 3) N of placed loads put on facets' corners and sides (nt, 9, 3), N, Nm: `LoadCase.dead_nodes`."""
    on = np.flatnonzero(pieces.body < facets)
    own = pieces.forces(force)[on]
    acts = np.repeat(np.stack([own, np.cross(pieces.arm[on], own)], axis=1), (6, 3), axis=1)
    out = np.zeros((facets, 9, 3))
    np.add.at(out, pieces.body[on], pieces.shape[on, :, None] * acts)
    return out


@dataclass(frozen=True, slots=True)
class _Pushed:
    """masses (n,) N: of each part of the loads; more_of_bodies (nb,) N: what the profile pushes of the bodies' own weight beyond
    what it does without masses."""

    masses: FloatArray
    more_of_bodies: FloatArray


def _masses_pushed(load: LoadCase, bodies: _Bodies, placed: PlacedLoads) -> _Pushed:
    weighs = bodies.weight > 0
    alone = np.zeros(len(bodies.weight))
    own, height = bodies.weight[weighs], bodies.centroid[weighs, 2] - bodies.lowest
    alone[weighs] = own * pushed_share(load, bodies.panel[weighs], own, height)
    weight = np.concatenate([own, placed.mass])
    share = pushed_share(
        load,
        np.concatenate([bodies.panel[weighs], placed.wall]),
        weight,
        np.concatenate([height, placed.point[:, 2] - bodies.lowest]),
    )
    together = np.zeros(len(bodies.weight))
    together[weighs] = own * share[: len(own)]
    return _Pushed(placed.mass * share[len(own) :], together - alone)


def _virial_of(centroid: FloatArray, point: FloatArray, force: FloatArray, owner: IntArray) -> FloatArray:
    """Return the sums (nb, i, j) of r_i F_j, Nm, of forces as in `wrenches_of`."""
    out = np.zeros((len(centroid), 3, 3))
    np.add.at(out, owner, (point - centroid[owner])[:, :, None] * force[:, None, :])
    return out


def wrenches_of(centroid: FloatArray, point: FloatArray, force: FloatArray, owner: IntArray) -> FloatArray:
    """Return the wrenches (nb, 6) about centroids (nb, 3) of forces (n, 3) N at points (n, 3) m of these bodies (n,)."""
    out = np.zeros((len(centroid), 6))
    moment = np.cross(point - centroid[owner], force)
    np.add.at(out, owner, np.concatenate([force, moment], axis=1))
    return out
