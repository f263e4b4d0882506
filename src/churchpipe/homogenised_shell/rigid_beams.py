"""Ring beams on a shell: the nodes and edges under a rigid body move as it does, and in the joint between both (`foot_joints`).

With planes for a strength there are no such joints. The facets below then bear the beam by their own strength: friction across
a bed joint, and the pressure that lies within the thickness.
"""

import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.edges import Edges
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.shell import ShellModel


def carried_by_beams(shell: ShellModel, edges: Edges, bubble_edge: IntArray) -> "tuple[sp.csr_matrix[np.float64], BoolArray]":
    """Return how beams move the unknowns of a shell, (n, 6 nm) for a motion (nm, 6) about their centroids, and which unknowns
    (n,) have no motion but that."""
    beams, nn, ne = shell.beams, len(shell.points), len(edges.nodes)
    rows = 3 * nn + ne + len(bubble_edge)
    if not beams.count:
        return sp.csr_matrix((rows, 0)), np.zeros(rows, dtype=np.bool_)
    of_node = np.where(shell.supported, -1, beams.of_node)
    node = np.flatnonzero(of_node >= 0)
    first, second = of_node[edges.nodes].T
    between = (first >= 0) & (second >= 0)
    edge = np.flatnonzero(between & (first == second))
    # A translation of a node is v + w x r: of its component c the rows are e_c and r x e_c.
    arm = shell.points[node] - beams.centroid[of_node[node]]
    turn = np.cross(arm[:, None], np.eye(3))
    moved = np.concatenate([np.broadcast_to(np.eye(3), turn.shape), turn], axis=2)
    along = np.concatenate([np.zeros((len(edge), 3)), edges.directions(shell.points)[edge]], axis=1)
    values: FloatArray = np.concatenate([moved.reshape(-1, 6), along])
    row = np.concatenate([(3 * node[:, None] + np.arange(3)).ravel(), 3 * nn + edge])
    column = 6 * np.concatenate([np.repeat(of_node[node], 3), first[edge]])[:, None] + np.arange(6)
    matrix = sp.csr_matrix((values.ravel(), (np.repeat(row, 6), column.ravel())), shape=(rows, 6 * beams.count))
    matrix.eliminate_zeros()
    follows = np.zeros(rows, dtype=np.bool_)
    follows[row] = True
    # The side of a rigid body stays straight: its middle moves as the mean of its ends. So does a side from one body to the next,
    # which would be a free soffit else.
    follows[3 * nn + ne :] = between[bubble_edge]
    return matrix, follows
