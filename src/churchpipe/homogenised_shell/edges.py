"""The edges of a triangle mesh, shared by any number of facets."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Edges:
    """nodes (ne, 2), lower number first; of_facet (nt, 3): edge k joins corners k and k + 1; facets (ne,): how many share it;
    first (ne,): one of them.
    """

    nodes: IntArray
    of_facet: IntArray
    facets: IntArray
    first: IntArray

    def directions(self, points: FloatArray) -> FloatArray:
        """Return unit vectors (ne, 3) from the first node to the second."""
        along = points[self.nodes[:, 1]] - points[self.nodes[:, 0]]
        return along / np.sqrt((along**2).sum(axis=1))[:, None]


def find_edges(triangles: IntArray) -> Edges:
    """Return the edges of triangles (nt, 3)."""
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    nodes, first, of_side, facets = np.unique(sides, axis=0, return_index=True, return_inverse=True, return_counts=True)
    return Edges(nodes, of_side.reshape(-1, 3), facets, first // 3)
