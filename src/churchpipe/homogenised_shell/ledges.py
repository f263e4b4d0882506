"""Vaults on the ledges of walls: the foot of a vault moves as if rigid arms joined it to the middle of the wall's top.

A vault stands near the inner face of a wall, away from the mid-plane in which the shell has the wall. Each edge of its foot goes
with the edge at the wall's top that bears it: along this edge as it bends, and about it as a bar turns. So the thrust reaches the
wall with its moment about the wall's mid-plane, spread as the vault spreads it, and the wall stays free to bend along its length.
"""

import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.edges import Edges
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.shell import ShellModel


def borne_by_walls(
    shell: ShellModel, edges: Edges, bubble_edge: IntArray, bubble_direction: FloatArray
) -> "tuple[sp.csr_matrix[np.float64], BoolArray]":
    """Return how the unknowns (n,) of translations, rotations and bubbles move all of them, (n, n), and which of them (n,) have
    no motion of their own.

    A bar that moves by u0 and u1 at its ends, by a bubble b more in its middle, and turns by theta about its direction s moves a
    point beside its place t, from 0 to 1, by (1 - t) u0 + t u1 + 4 t (1 - t) b + (theta s + s x (u1 - u0) / length) x arm. A node
    between two edges of a foot moves as the mean of what both prescribe.
    """
    nn, ne = len(shell.points), len(edges.nodes)
    rows = 3 * nn + ne + len(bubble_edge)
    follows = np.zeros(rows, dtype=np.bool_)
    whole = sp.identity(rows, format="csr")
    if not len(shell.ledges):
        return sp.csr_matrix(whole), follows
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
    parts: list[tuple[FloatArray, IntArray, IntArray]] = []
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
    values, row, column = (np.concatenate(same) for same in zip(*parts, strict=True))
    follows[row] = True
    return sp.csr_matrix(whole + sp.csr_matrix((values, (row, column)), shape=(rows, rows))), follows


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


def _entries(row: IntArray, column: IntArray, values: FloatArray) -> tuple[FloatArray, IntArray, IntArray]:
    """Return triplets of blocks (l, i, j) whose first rows and columns are (l,)."""
    i, j = np.indices(values.shape[1:])
    return values.ravel(), (row[:, None, None] + i).ravel(), (column[:, None, None] + j).ravel()
