"""Clusters of points that are close to each other, and connected parts of a graph."""

import numpy as np

from churchpipe.model.arrays import FloatArray, IntArray

# Points closer than this are one node, m. Two walls compute the same place by different sums, so it differs by rounding.
NODE_TOLERANCE = 4e-6


def clusters(points: FloatArray, tolerance: float = NODE_TOLERANCE) -> IntArray:
    """Return for each of the points (n, d) the number of its cluster: neighbours closer than the tolerance, m, are one."""
    # SciPy takes .2 s to load, and many modules need this one that never call it.
    from scipy.spatial import cKDTree

    return components(len(points), cKDTree(points).query_pairs(tolerance, output_type="ndarray"))


def components(count: int, pairs: IntArray) -> IntArray:
    """Return for each of `count` nodes the number of the connected part it is in; pairs (n, 2) are the links."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    links = (np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1]))
    graph = coo_matrix(links, shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
