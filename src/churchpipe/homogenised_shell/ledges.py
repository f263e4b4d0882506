"""Vaults on and against walls: their feet and ends move as the mid-planes of the walls do.

A vault stands near the inner face of a wall, away from the mid-plane in which the shell has the wall. Each edge of its foot goes
with the edge at the wall's top that bears it: along this edge as it bends, and about it as a bar turns. So the thrust reaches the
wall with its moment about the wall's mid-plane, spread as the vault spreads it, and the wall stays free to bend along its length.
Where a vault ends against a wall the far nodes of the strip between them go with the facet of the wall in which they lie.
"""

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.edges import Edges
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.shell import ShellModel

# Values, rows and columns of a sparse matrix.
_Triplets: TypeAlias = tuple[FloatArray, IntArray, IntArray]


def carried_by_walls(
    shell: ShellModel, edges: Edges, bubble_edge: IntArray, bubble_direction: FloatArray
) -> "tuple[sp.csr_matrix[np.float64], BoolArray]":
    """Return how the unknowns (n,) of translations, rotations and bubbles move all of them, (n, n), and which of them (n,) have
    no motion of their own.
    """
    count = 3 * len(shell.points) + len(edges.nodes) + len(bubble_edge)
    follows = np.zeros(count, dtype=np.bool_)
    parts = [*_ends(shell)] if len(shell.held) else []
    parts += _feet(shell, edges, bubble_edge, bubble_direction) if len(shell.ledges) else []
    motion = sp.csr_matrix(sp.identity(count))
    if not parts:
        return motion, follows
    values, row, column = (np.concatenate(same) for same in zip(*parts, strict=True))
    follows[row] = True
    # The edges between held nodes stay straight.
    first, second = (np.isin(edges.nodes[bubble_edge, end], shell.held[:, 0]) for end in (0, 1))
    follows[count - len(bubble_edge) :] |= first & second
    return sp.csr_matrix(motion + sp.csr_matrix((values, (row, column)), shape=motion.shape)), follows


def _ends(shell: ShellModel) -> Iterator[_Triplets]:
    """Yield how the corners of facets move the nodes in them."""
    node, corner = shell.held[:, 0], shell.points[shell.triangles[shell.held[:, 1]]]
    inverse = np.linalg.pinv(np.swapaxes(corner[:, 1:] - corner[:, :1], 1, 2))
    share = np.einsum("hac,hc->ha", inverse, shell.points[node] - corner[:, 0])
    share = np.column_stack([1.0 - share.sum(axis=1), share])
    for k in range(3):
        column = 3 * shell.triangles[shell.held[:, 1], k]
        yield _entries(3 * node, column, share[:, k, None, None] * np.eye(3))


def _feet(shell: ShellModel, edges: Edges, bubble_edge: IntArray, bubble_direction: FloatArray) -> list[_Triplets]:
    """Return how the tops of walls move the feet on them.

    A bar that moves by u0 and u1 at its ends, by a bubble b more in its middle, and turns by theta about its direction s moves a
    point beside its place t, from 0 to 1, by (1 - t) u0 + t u1 + 4 t (1 - t) b + (theta s + s x (u1 - u0) / length) x arm. A node
    between two edges of a foot moves as the mean of what both prescribe.
    """
    nn, ne = len(shell.points), len(edges.nodes)
    foot, top = (_numbers(shell.ledges[:, k], edges, nn) for k in (0, 1))
    begin, end = edges.nodes[top].T
    along, length = edges.directions(shell.points), np.linalg.norm(shell.points[end] - shell.points[begin], axis=1)
    s, own = along[top], along[foot]
    reach = shell.points[edges.nodes[foot]] - shell.points[begin][:, None]
    place = np.einsum("lnc,lc->ln", reach, s) / length[:, None]
    arm = reach - (place * length[:, None])[..., None] * s[:, None]
    share = 1.0 / np.bincount(edges.nodes[foot].ravel(), minlength=nn)[edges.nodes[foot]]
    # Bubbles of the edge above and of the one below: every pair of them.
    over, under = (_matches(edge, bubble_edge) for edge in (foot, top))
    parts: list[_Triplets] = []
    for k in (0, 1):
        node, t = 3 * edges.nodes[foot, k], place[:, k, None, None]
        swing = np.einsum("li,lj->lij", s, arm[:, k]) / length[:, None, None]
        of_node = [
            (3 * begin, (1 - t) * np.eye(3) + swing),
            (3 * end, t * np.eye(3) - swing),
            (3 * nn + top, np.cross(s, arm[:, k])[:, :, None]),
        ]
        parts += [_entries(node, column, share[:, k, None, None] * value) for column, value in of_node]
        ledge, bubble = under
        bent = (share * 4 * place * (1 - place))[ledge, k, None, None] * bubble_direction[bubble][:, :, None]
        parts.append(_entries(node[ledge], 3 * nn + ne + bubble, bent))
    tilt = np.cross(own, s)[:, None] / length[:, None, None]
    parts.append(_entries(3 * nn + foot, 3 * nn + top, np.einsum("lc,lc->l", own, s)[:, None, None]))
    parts += [_entries(3 * nn + foot, 3 * nodes, sign * tilt) for nodes, sign in ((begin, -1.0), (end, 1.0))]
    # The middle of the edge above, beyond the mean of its ends.
    middle = place.mean(axis=1)
    bend = 4 * middle * (1 - middle) - (2 * place * (1 - place)).sum(axis=1)
    first, second = np.nonzero(over[0][:, None] == under[0])
    mine, below = over[1][first], under[1][second]
    value = bend[over[0][first]] * np.einsum("bc,bc->b", bubble_direction[mine], bubble_direction[below])
    parts.append(_entries(3 * nn + ne + mine, 3 * nn + ne + below, value[:, None, None]))
    return parts


def _numbers(ends: IntArray, edges: Edges, nn: int) -> IntArray:
    """Return the numbers (nl,) of edges with these ends (nl, 2)."""
    low, high = np.sort(ends, axis=1).T
    return np.searchsorted(edges.nodes[:, 0] * nn + edges.nodes[:, 1], low * nn + high)


def _matches(edge: IntArray, bubble_edge: IntArray) -> tuple[IntArray, IntArray]:
    """Return ledges and bubbles (k,): each bubble of the edge (nl,) of each ledge."""
    order = np.argsort(bubble_edge, kind="stable")
    start, stop = (np.searchsorted(bubble_edge[order], edge, side=side) for side in ("left", "right"))
    ledge = np.repeat(np.arange(len(edge)), stop - start)
    return ledge, order[np.arange(len(ledge)) - np.repeat(np.cumsum(stop - start) - stop, stop - start)]


def _entries(row: IntArray, column: IntArray, values: FloatArray) -> _Triplets:
    """Return triplets of blocks (l, i, j) whose first rows and columns are (l,)."""
    i, j = np.indices(values.shape[1:])
    return values.ravel(), (row[:, None, None] + i).ravel(), (column[:, None, None] + j).ravel()
