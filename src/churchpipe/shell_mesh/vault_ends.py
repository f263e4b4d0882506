"""Where vaults end at the face of a wall, without standing on it: strips from there to the wall's mid-plane.

A strip is a butt joint: stack bond without cohesion and without weight, which bears the pressure of the vault on the wall and the
friction of that pressure. Its far nodes go with the facets of the wall in which they lie.
"""

from dataclasses import replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.shell import ShellModel

# A point is on a face of a wall within this distance, m, and within a facet within this share of it.
_ON_FACE, _WITHIN = 1e-4, 1e-6
# An edge whose direction has less than this share along the beds runs across them.
_ACROSS = 0.7


def with_end_joints(shell: ShellModel, vaulted: BoolArray) -> ShellModel:
    """Return a shell with a strip behind each edge of a vault that lies on the face of a wall; vaulted (nt,): facets of vaults.

    The strips of a macro-element are one of their own, "... front".

    Raises
    ------
    InputError: an end against a fixed body, which would be clamped there.
    """
    edge = np.stack([shell.triangles, np.roll(shell.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    facet = np.repeat(np.arange(len(shell.triangles)), 3)
    _, number, shared = np.unique(np.sort(edge, axis=1), axis=0, return_inverse=True, return_counts=True)
    _check_ends(shell, edge, facet, (shared[number.ravel()] == 1) & vaulted[facet])
    foot = np.isin(edge, shell.ledges[:, 0]).all(axis=1) | shell.supported[edge].all(axis=1)
    foot |= shell.on_beam[edge].all(axis=1)
    border = np.flatnonzero((shared[number.ravel()] == 1) & vaulted[facet] & ~foot)
    node = np.unique(edge[border])
    behind = _behind(shell, shell.points[node], np.flatnonzero(~vaulted))
    on = dict(zip(node[behind >= 0].tolist(), behind[behind >= 0].tolist(), strict=True))
    ends = edge[border]
    kept = np.isin(ends, list(on)).all(axis=1)
    ends, own = ends[kept], facet[border][kept]
    if not len(ends):
        return shell
    near = np.unique(ends)
    wall = np.array([on[one] for one in near.tolist()])
    normal = shell.axes[wall, 2]
    depth = np.einsum("nc,nc->n", shell.points[shell.triangles[wall, 0]] - shell.points[near], normal)
    far = len(shell.points) + np.searchsorted(near, ends)
    triangles = np.concatenate([np.column_stack([ends, far[:, 1]]), np.column_stack([ends[:, 0], far[:, ::-1]])])
    inwards = (normal * np.sign(depth)[:, None])[np.searchsorted(near, ends[:, 0])]
    along = shell.points[ends[:, 1]] - shell.points[ends[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    own = np.tile(own, 2)
    strips = {
        "axes": np.tile(np.stack([inwards, along, np.cross(inwards, along)], axis=1), (2, 1, 1)),
        "thickness": shell.thickness[own],
        "surface_weight": np.zeros(len(own)),
        "cell": len(shell.unit_cells) + shell.cell[own],
        "material": shell.material[own],
        "panel": np.array([f"{part} front" for part in shell.panel[own].tolist()]),
        "yields": np.ones(len(own), dtype=np.bool_),
        "triangles": triangles,
        "points": shell.points[near] + depth[:, None] * normal,
        "supported": np.zeros(len(near), dtype=np.bool_),
        "bed_normal": np.zeros((len(near), 3)),
        "unit_cells": shell.unit_cells,
        "bonds": np.full(len(shell.unit_cells), "butt"),
    }
    grown = {key: np.concatenate([getattr(shell, key), value]) for key, value in strips.items()}
    facet = np.append(np.arange(len(shell.triangles)), np.full(len(triangles), -1))
    beams = shell.beams.on_mesh(len(grown["points"]), facet)
    return replace(shell, **grown, beams=beams, held=np.column_stack([len(shell.points) + np.arange(len(near)), wall]))


def _check_ends(shell: ShellModel, edge: IntArray, facet: IntArray, border: BoolArray) -> None:
    """Raise InputError where an edge of the border is clamped and runs across the beds: it is no springing."""
    along = shell.points[edge[:, 1]] - shell.points[edge[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = np.abs(np.einsum("ec,ec->e", along, shell.axes[facet, 0])) < _ACROSS
    ends = np.flatnonzero(border & across & shell.supported[edge].all(axis=1))
    if len(ends):
        raise InputError(
            f"shell of {shell.panel[facet[ends[0]]]}",
            "ends against a fixed body",
            found=f"at {shell.points[edge[ends[0]]].mean(axis=0).round(4).tolist()} m",
            expected="fixed bodies below it alone: the facets of a shell would not slide on this one",
            remedy="Rigid blocks take it as it is.",
        )


def _behind(shell: ShellModel, points: FloatArray, walls: IntArray) -> IntArray:
    """Return for each point (n, 3) m the facet of `walls` behind it, in the middle of the wall on whose face it is, or -1."""
    corner, normal = shell.points[shell.triangles[walls]], shell.axes[walls, 2]
    found = np.full(len(points), -1, dtype=np.int64)
    sides = corner[:, 1:] - corner[:, :1]
    inverse = np.linalg.pinv(np.swapaxes(sides, 1, 2))
    for k, point in enumerate(points if len(walls) else points[:0]):
        from_corner = point - corner[:, 0]
        off = np.abs(np.abs(np.einsum("wc,wc->w", from_corner, normal)) - shell.thickness[walls] / 2)
        share = np.einsum("wac,wc->wa", inverse, from_corner)
        room = np.minimum(share.min(axis=1), 1.0 - share.sum(axis=1))
        best = int(np.argmax(np.where(off < _ON_FACE, room, -np.inf)))
        if off[best] < _ON_FACE and room[best] > -_WITHIN:
            found[k] = walls[best]
    return found
