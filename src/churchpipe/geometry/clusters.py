"""Clusters of points that are close to each other, and connected parts of a graph."""

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray

# Points closer than this are one node, m. Two walls compute the same place by different sums, so it differs by rounding.
NODE_TOLERANCE = 4e-6


def clusters(points: FloatArray, tolerance: float = NODE_TOLERANCE) -> IntArray:
    """Return for each of the points (n, d) the number of its cluster: neighbours closer than the tolerance, m, are one.

    Clusters are numbered in the order of their first points.
    """
    # SciPy takes .2 s to load, and many modules need this one that never call it.
    from scipy.spatial import cKDTree

    # Of points at one place, as normals of all stones of a wall are, one stands for all: their pairs would be too many.
    first, place = _places(points)
    return components(len(first), cKDTree(points[first]).query_pairs(tolerance, output_type="ndarray"))[place]


def _places(points: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the first point at each place among points (n, d), in their order, and the number of each point's place."""
    order = np.lexsort(points.T)
    new = np.append(True, (np.diff(points[order], axis=0) != 0).any(axis=1))[: len(order)]
    start = order[new]
    rank = np.argsort(np.argsort(start))
    place = np.empty_like(order)
    place[order] = rank[np.cumsum(new) - 1]
    return np.sort(start), place


def components(count: int, pairs: IntArray) -> IntArray:
    """Return for each of `count` nodes the number of the connected part it is in; pairs (n, 2) are the links."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    links = (np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1]))
    graph = coo_matrix(links, shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
