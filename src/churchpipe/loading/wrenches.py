"""Placed loads to the wrenches on stones or on facets of a shell that a load case takes."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.locate import facet_at
from churchpipe.loading.placing import place_loads
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import FloatArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.carried import Carried
from churchpipe.model.fill import Fill
from churchpipe.model.loads import LoadCase, nearest_virial, pushed_share
from churchpipe.model.placed_loads import PlacedLoads
from churchpipe.model.shell import ShellModel

# A load bears on what lies below its point: of the facets that meet there, on the one at a point so much lower, m. At the eaves a
# gable goes on above them with a sliver, which would bear the roof on its free edge.
_BELOW = 1e-3


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
        is added to its `live`. One without a direction pushes no mass.
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
        As `place_loads`; wrenches of the load case that are not those of these stones.
    """
    check_kind("loaded: load", load, LoadCase)
    placed = loads if isinstance(loads, PlacedLoads) else place_loads(stones, loads)
    return _with(load, _stones(stones), placed, placed.stone)


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
        As `loaded`.
    """
    check_kind("shell_loaded: shell", shell, ShellModel)
    placed = loads if isinstance(loads, PlacedLoads) else place_loads(stones, loads)
    bodies = _Bodies(shell.body_centroid, shell.body_weight, shell.body_panel, float(shell.points[:, 2].min()))
    return _with(load, bodies, placed, bodies_of(shell, placed.foot, placed.wall))


def bodies_of(shell: ShellModel, point: FloatArray, wall: NameArray) -> IntArray:
    """Return the facet (n,) nearest to each point (n, 3) m, among those of its wall, or of all where the shell lacks that; of a
    beam, nt and its number."""
    out = np.zeros(len(point), dtype=np.int64)
    for number, name in enumerate(shell.beams.name.tolist()):
        out[wall == name] = len(shell.triangles) + number
    on_beam = np.isin(wall, shell.beams.name)
    known = np.isin(wall, shell.panel)
    for name in [*np.unique(wall[known]).tolist(), None]:
        mine = ~(known | on_beam) if name is None else wall == name
        if mine.any():
            out[mine] = facet_at(shell, point[mine] - [0.0, 0.0, _BELOW], name)[0]
    return out


def resultant(centroid: FloatArray, wrench: FloatArray) -> FloatArray:
    """Return force and moment about the origin (6,) of wrenches (n, 6) about centroids (n, 3)."""
    force = wrench[:, :3]
    return np.concatenate([force.sum(axis=0), (wrench[:, 3:] + np.cross(centroid, force)).sum(axis=0)])


def resultants(stones: Assemblage, shell: ShellModel, placed: PlacedLoads) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return what the loads come to (6,) N and Nm on the stones and on the shell: the dead parts, and the masses' push along
    (1, 1, 1), which sees their places in all directions."""
    mass = placed.mass[:, None] * np.full(3, 1 / np.sqrt(3))
    body = bodies_of(shell, placed.foot, placed.wall)
    return {
        name: (
            resultant(stones.centroid, wrenches_of(stones.centroid, placed.point, force, placed.stone)),
            resultant(shell.body_centroid, wrenches_of(shell.body_centroid, placed.point, force, body)),
        )
        for name, force in (("dead", placed.dead), ("masses", mass))
    }


def _with(load: LoadCase, bodies: _Bodies, placed: PlacedLoads, owner: IntArray) -> LoadCase:
    masses = np.zeros_like(placed.dead)
    more = np.zeros_like(bodies.centroid)
    if load.direction.any():
        push = _masses_pushed(load, bodies, placed)
        masses, more = push.masses[:, None] * load.direction, push.more_of_bodies[:, None] * load.direction
    dead, live = (wrenches_of(bodies.centroid, placed.point, force, owner) for force in (placed.dead, masses))
    live[:, :3] += more
    virials = [_virial_of(bodies.centroid, placed.point, force, owner) for force in (placed.dead, masses)]
    for total, virial, wrench, own in (
        (dead, virials[0], load.dead, load.dead_virial),
        (live, virials[1], load.live, load.live_virial),
    ):
        if wrench is not None:
            total += wrench
            virial += nearest_virial(wrench) if own is None else own
    return LoadCase(
        load.direction if load.direction.any() else None,
        load.name,
        load.panels,
        load.profile,
        dead=dead,
        live=live,
        dead_virial=virials[0],
        live_virial=virials[1],
    )


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
