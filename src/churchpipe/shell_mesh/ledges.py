"""Where vaults and thinner walls stand on walls with other mid-planes: the edges of their feet, and those of the tops below."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.clusters import NODE_TOLERANCE
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.shell import ShellModel

# Least part of an edge that is cut off it.
_LEAST = 0.01
_BY_FACET = ("axes", "thickness", "surface_weight", "cell", "material", "panel", "yields")


def with_ledges(shell: ShellModel, vaulted: BoolArray) -> tuple[ShellModel, BoolArray]:
    """Return a shell whose vaults go with the walls below them, and its facets of vaults; vaulted (nt,): these as given.

    A foot (see `feet`) that no beam holds is cut beside the nodes of the wall's
    top, and each part stands on the nearest level edge at its height, of a facet below, within half the thickness of that facet's
    wall; of edges as near, on one along it.

    Raises
    ------
    InputError: a foot that stands on no wall.
    """
    edge, facet, foot, top = _feet_and_tops(shell, vaulted)
    foot = foot[~shell.on_beam[edge[foot]].all(axis=1)]
    if not len(foot):
        return shell, vaulted
    shell, chosen = _on_tops(shell, edge, facet, foot, top)
    return shell, vaulted[chosen]


def with_tiers(shell: ShellModel, levels: Sequence[float]) -> ShellModel:
    """Return a shell whose walls above some heights, m, go with those below, the tiers of which are side by side.

    Over an opening, or where no wall is below, the foot of a wall is free.
    """
    edge, facet, foot, top = _feet_and_tops(shell, shell.centroid[:, 2] > levels[0])
    z = shell.points[edge[:, 0], 2]
    at_level: BoolArray = np.asarray((np.abs(z[:, None] - np.asarray(levels)) < NODE_TOLERANCE).any(axis=1))
    foot = foot[at_level[foot] & ~shell.on_beam[edge[foot]].all(axis=1)]
    return _on_tops(shell, edge, facet, foot, top, may_be_free=True)[0]


def _on_tops(
    shell: ShellModel, edge: IntArray, facet: IntArray, foot: IntArray, top: IntArray, *, may_be_free: bool = False
) -> tuple[ShellModel, IntArray]:
    """Return a shell whose feet (nf,) among its edges go with tops (nt,) among them, and of each of its facets the one before.

    may_be_free: what is above no wall is left free.

    Raises
    ------
    InputError: a foot that stands on no wall.
    """
    nodes, triangles, of_facet = (
        [shell.points],
        [np.delete(shell.triangles, facet[foot], axis=0)],
        [np.delete(np.arange(len(shell.triangles)), facet[foot])],
    )
    ledges: list[IntArray] = []
    count = len(shell.points)
    for own in foot.tolist():
        near = top[np.abs(shell.points[edge[top, 0], 2] - shell.points[edge[own, 0], 2]) < NODE_TOLERANCE]
        bars, reach = shell.points[edge[near], :2], shell.thickness[facet[near]] / 2 + NODE_TOLERANCE
        ends = shell.points[edge[own]]
        share = _cuts(ends[:, :2], bars, reach)
        place = ends[0] + share[:, None] * (ends[1] - ends[0])
        chain = np.concatenate([edge[own, :1], count + np.arange(len(share) - 2), edge[own, 1:]])
        count += len(share) - 2
        nodes.append(place[1:-1])
        apex = np.setdiff1d(shell.triangles[facet[own]], edge[own])
        parts = np.stack([chain[:-1], chain[1:]], axis=1)
        triangles.append(np.column_stack([parts, np.repeat(apex, len(parts))]))
        of_facet.append(np.repeat(facet[own], len(parts)))
        for part, middle in zip(parts, (place[:-1] + place[1:]) / 2, strict=True):
            apart, turned = _distances(middle[:2], ends[:, :2], bars)
            if not (apart < reach).any():
                if may_be_free:
                    continue
                raise InputError(
                    f"shell of {shell.panel[facet[own]]}",
                    "its foot stands on no wall",
                    found=f"at {middle.round(4).tolist()} m"
                    + (f", {apart.min():.4g} m from the middle of the nearest" if len(apart) else ""),
                    expected="within the thickness of a wall that ends there",
                    remedy="Rigid blocks take it as it is.",
                )
            best = near[np.argmin(np.where(apart < reach, apart + reach * turned, np.inf))]
            ledges.append(np.stack([part, edge[best]]))
    chosen = np.concatenate(of_facet)
    cut = replace(
        shell,
        beams=shell.beams.on_mesh(count, chosen),
        points=np.concatenate(nodes),
        triangles=np.concatenate(triangles),
        supported=np.append(shell.supported, np.zeros(count - len(shell.points), np.bool_)),
        bed_normal=np.concatenate([shell.bed_normal, np.zeros((count - len(shell.points), 3))]),
        **{key: getattr(shell, key)[chosen] for key in _BY_FACET},
        ledges=np.concatenate([shell.ledges, np.array(ledges, dtype=np.int64).reshape(-1, 2, 2)]),
    )
    return cut, chosen


def feet(shell: ShellModel, vaulted: BoolArray) -> IntArray:
    """Return the nodes (n, 2) of the feet of vaults: level edges of a facet (nt,) of a vault above, which no other shares."""
    edge, _, foot, _ = _feet_and_tops(shell, vaulted)
    return edge[foot]


def _feet_and_tops(shell: ShellModel, vaulted: BoolArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Return the sides (3 nt, 2) of the facets, the facet of each, and which are feet of vaults and level with a facet below."""
    edge = np.stack([shell.triangles, np.roll(shell.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    facet = np.repeat(np.arange(len(shell.triangles)), 3)
    _, number, shared = np.unique(np.sort(edge, axis=1), axis=0, return_inverse=True, return_counts=True)
    z = shell.points[edge, 2]
    level = np.abs(z[:, 1] - z[:, 0]) < NODE_TOLERANCE
    rise = shell.centroid[facet, 2] - z.mean(axis=1)
    alone = shared[number.ravel()] == 1
    foot = level & alone & vaulted[facet] & (rise > NODE_TOLERANCE) & ~shell.supported[edge].all(axis=1)
    return edge, facet, np.flatnonzero(foot), np.flatnonzero(level & (rise < -NODE_TOLERANCE))


def _cuts(foot: FloatArray, bars: FloatArray, reach: FloatArray) -> FloatArray:
    """Return where the ends of bars (n, 2, 2) m beside an edge (2, 2) m cut it, 0 and 1 with them."""
    along = foot[1] - foot[0]
    length = float(np.linalg.norm(along))
    share = (bars - foot[0]) @ along / length**2
    off = np.abs((bars - foot[0]) @ np.array([-along[1], along[0]])) / length
    inside = share[(off <= reach[:, None]) & (share > _LEAST) & (share < 1 - _LEAST)]
    inside = np.sort(inside)
    return np.concatenate([[0.0], inside[np.diff(inside, prepend=-1.0) > _LEAST], [1.0]])


def _distances(middle: FloatArray, foot: FloatArray, bars: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far a point (2,) m of an edge (2, 2) m is from bars (n, 2, 2) m, and 1 less the cosine between edge and bars."""
    along = bars[:, 1] - bars[:, 0]
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    place = np.clip(np.einsum("nc,nc->n", middle - bars[:, 0], along) / square, 0.0, 1.0)
    apart = np.linalg.norm(bars[:, 0] + place[:, None] * along - middle, axis=1)
    own = foot[1] - foot[0]
    return apart, 1.0 - np.abs(along @ own) / np.sqrt(square * (own @ own))


def side_by_side(first: ShellModel, second: ShellModel) -> ShellModel:
    """Return two shells as one, whose nodes stay apart; the beams are those of the first."""
    facet = np.append(np.arange(len(first.triangles)), np.full(len(second.triangles), -1))
    alike = ("points", "supported", "bed_normal", "unit_cells", "bonds", *(key for key in _BY_FACET if key != "cell"))
    return replace(
        first,
        **{key: np.concatenate([getattr(first, key), getattr(second, key)]) for key in alike},
        triangles=np.concatenate([first.triangles, second.triangles + len(first.points)]),
        cell=np.concatenate([first.cell, second.cell + len(first.unit_cells)]),
        beams=first.beams.on_mesh(len(first.points) + len(second.points), facet),
    )
