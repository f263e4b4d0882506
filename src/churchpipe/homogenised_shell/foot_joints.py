"""The joints at the feet of a shell: on the ground, where a vault or a thinner wall stands on a wall, and at its ring beams.

No part of a shell slides across its thickness, and a hinge within it is as wide as a row of facets. Both come about first of all
at a foot. So each edge there is the rim of a bed joint as long as the edge and as wide as its facet is thick, with a contact
point at each of its four corners, which opens and slides by Coulomb's law as those of stones do.

Two corners lie at each end of the edge. They move as the node at that end does, and as the edge turns: about itself, and in the
plane of the joint.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.edges import Edges
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.shell import ShellModel

# A normal whose part square to an edge is no more than this share runs along the edge, and tells nothing of its joint.
_ALONG = 1e-6


@dataclass(frozen=True, slots=True)
class FootJoints:
    """The joints under edges of a shell, as pairs of corners at the ends of the edges.

    node, edge, facet (np,): of each pair its node, its edge and the facet on it; length (np,): half of the edge, m. frame
    (np, 3, 3), `frame_pkc`: unit vectors away from the joint, along it and across it. motion (6 np, n): how the corners move, m,
    with the translations of nodes and rotations of edges, relative to what they stand on: the first corner away from the joint,
    along it and across it, then the second.
    """

    node: IntArray
    edge: IntArray
    facet: IntArray
    length: FloatArray
    frame: FloatArray
    motion: sp.csr_matrix[np.float64]

    @property
    def count(self) -> int:
        """Number of pairs."""
        return len(self.node)

    def free(self, nodes: int, edges: int) -> BoolArray:
        """Return which translations of so many nodes and which rotations of so many edges (3 nn + ne,) joints leave free."""
        out = np.zeros(3 * nodes + edges, dtype=np.bool_)
        out[3 * self.node[:, None] + np.arange(3)] = True
        out[3 * nodes + self.edge] = True
        return out


def foot_joints(shell: ShellModel, edges: Edges) -> FootJoints:
    """Return the joints at border edges between two supported nodes, at the feet of what stands on walls, and at ring beams.

    A joint is square to the normal of what its nodes stand on (`ShellModel.bed_normal`), level on a wall and at a beam, and
    square to its facet where neither is known, or runs along its edge. Leaves that nothing ties stand each on a joint of half
    the width.
    """
    nn, ne = len(shell.points), len(edges.nodes)
    grounded = shell.supported[edges.nodes].all(axis=1)
    low, high = np.sort(shell.ledges[:, 0], axis=1).T
    on_walls = np.zeros(ne, dtype=np.bool_)
    on_walls[np.searchsorted(edges.nodes[:, 0] * nn + edges.nodes[:, 1], low * nn + high)] = True
    below = np.where(shell.on_beam & ~shell.supported, shell.beams.of_node if shell.beams.count else -1, -1)[edges.nodes]
    at_beams = (below[:, 0] >= 0) & (below[:, 0] == below[:, 1])
    edge = np.flatnonzero((grounded | on_walls | at_beams) & (edges.facets == 1))
    facet, nodes = edges.first[edge], edges.nodes[edge]
    begin = shell.points[nodes[:, 0]]
    along, length = edges.directions(shell.points)[edge], np.linalg.norm(shell.points[nodes[:, 1]] - begin, axis=1)
    known = np.where(on_walls[edge, None], [0.0, 0.0, 1.0], shell.bed_normal[nodes].sum(axis=1))
    above = np.sign(shell.centroid[facet, 2] - begin[:, 2])
    known[at_beams[edge]] = (above[:, None] * [0.0, 0.0, 1.0])[at_beams[edge]]
    away = _square(known, along)
    unknown = np.linalg.norm(away, axis=1) <= _ALONG * np.linalg.norm(known, axis=1)
    away[unknown] = _square((shell.centroid[facet] - begin)[unknown], along[unknown])
    away /= np.linalg.norm(away, axis=1)[:, None]
    across = np.cross(away, along)
    frame = np.stack([away, along, across], axis=1)
    leaves = (shell.bonds == "leaves")[shell.cell[facet]]
    width = np.where(leaves, 0.5, 1.0) * shell.thickness[facet]
    values: list[FloatArray] = []
    rows: list[IntArray] = []
    columns: list[IntArray] = []
    for end in (0, 1):
        for corner, side in enumerate((-1.0, 1.0)):
            row = 6 * (2 * np.arange(len(edge)) + end) + 3 * corner
            arm = side * 0.5 * width
            # A turn about the normal, by what the ends move across, takes a corner along the joint.
            swing = (arm / length)[:, None] * across
            turning = ((0, swing), (1, -swing))
            parts = [(k, nodes[:, end], frame[:, k]) for k in range(3)] + [(1, nodes[:, at], value) for at, value in turning]
            for component, node, value in parts:
                values.append(value.ravel())
                rows.append(np.repeat(row + component, 3))
                columns.append((3 * node[:, None] + np.arange(3)).ravel())
            values.append(arm)
            rows.append(row)
            columns.append(3 * nn + edge)
    triplets = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return FootJoints(
        nodes.ravel(),
        np.repeat(edge, 2),
        np.repeat(facet, 2),
        np.repeat(length / 2, 2),
        np.repeat(frame, 2, axis=0),
        sp.csr_matrix(triplets, shape=(12 * len(edge), 3 * nn + ne)),
    )


def _square(vectors: FloatArray, along: FloatArray) -> FloatArray:
    """Return what vectors (n, 3) have square to unit vectors (n, 3)."""
    return vectors - np.einsum("nc,nc->n", vectors, along)[:, None] * along


def pair_closing(*, crushes: bool = False) -> FloatArray:
    """Return how two corners close (2, 3, 6): square to the joint and along it, for each motion of `FootJoints.motion`.

    Of a joint that crushes each corner is two in one place (4, 3, 6), in order as of `rigid_cell`: the joint is pressed in a part
    that is as long as the edge.
    """
    corners = -np.eye(6).reshape(2, 3, 6)
    return corners[[0, 1, 1, 0]] if crushes else corners


def pair_stiffness(shell: ShellModel, joints: FootJoints, stiffness: FloatArray) -> FloatArray:
    """Return the stiffness (np, 6, 6) of a metre of each pair, for that of its facet (np, 6, 6): many times that of a course.

    Joints of the masonry are in the stiffness of the facets, and what it stands on does not yield.
    """
    course = shell.unit_cells[shell.cell[joints.facet], 0]
    press, shear = stiffness[:, 1, 1], stiffness[:, 2, 2]
    corner = np.stack([press, shear, shear], axis=1) / (2 * course[:, None])
    return SOLVER.foot_stiffness * np.tile(corner, 2)[:, :, None] * np.eye(6)
