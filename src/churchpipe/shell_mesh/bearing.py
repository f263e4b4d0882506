"""How wide the edges of a shell bear on the ground."""

import numpy as np
from scipy.spatial import cKDTree

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.contacts import Contacts
from churchpipe.model.shell import ShellModel

# Facets of curved walls and vaults carry stones that reach beyond their own edges on one face and less far on the other: their
# volume over area differs from the thickness by less than this share; where walls overlap at junctions, by more.
CURVED = 0.1
# Facets of one stone whose normals differ by more than this (degrees) make it a stone that turns a corner, those of one panel a
# panel that does.
CORNER = 5.0


def across_base(contacts: Contacts, shell: ShellModel, base: BoolArray, ends: IntArray, facet: IntArray) -> FloatArray:
    """Return the sine (n,) of the angle between each facet (n,) with an edge (n, 2) on the base and the joint (ni, base) there.

    Beds of a vault are inclined to its facets, by half the angle of a voussoir: a stone h thick bears on h over this sine.
    """
    joints = np.flatnonzero(base)
    if not len(joints):
        return np.ones(len(facet))
    centre = np.array([contacts.point[slice(*contacts.point_ptr[row : row + 2])].mean(axis=0) for row in joints])
    _, nearest = cKDTree(centre).query(shell.points[ends].mean(axis=1))
    cosine = np.einsum("nc,nc->n", shell.axes[facet, 2], contacts.frame[joints[nearest], 0])
    return np.sqrt(np.maximum(1 - cosine**2, np.finfo(float).eps))


def bearing(shell: ShellModel, carried: FloatArray) -> FloatArray:
    """Return for each facet (nt,) the thickness on which it bears, m: without what overlaps at junctions.

    Of a plane wall it is the mean of all facets that touch the ground: by itself a facet carries a share of its area, and of its
    edge on the ground another share may lie in the junction. What curved facets carry differs from their thickness by some per
    cent, which is no overlap: see `CURVED`. A panel that meets no other on the ground overlaps none, however its stones taper.
    """
    _, first, panel = np.unique(shell.panel, return_index=True, return_inverse=True)
    flattest = np.ones(len(first))
    np.minimum.at(flattest, panel, np.abs(np.einsum("tc,tc->t", shell.axes[:, 2], shell.axes[first, 2][panel])))
    low = shell.supported[shell.triangles].any(axis=1)
    borne, full = (np.bincount(panel[low], (shell.area * part)[low], len(first)) for part in (carried, shell.thickness))
    share = np.divide(borne, full, out=np.ones(len(first)), where=full > 0)
    curved = flattest[panel] < np.cos(np.radians(CORNER))
    on_ground = np.unique(np.column_stack([shell.triangles.ravel(), np.repeat(panel, 3)]), axis=0)
    on_ground = on_ground[shell.supported[on_ground[:, 0]]]
    meeting = np.bincount(on_ground[:, 0], minlength=len(shell.points))[on_ground[:, 0]] > 1
    alone = ~np.isin(np.arange(len(first)), on_ground[meeting, 1])
    own = np.where(alone[panel] | (np.abs(carried / shell.thickness - 1) < CURVED), shell.thickness, carried)
    return np.where(curved, own, shell.thickness * share[panel])


def boundary_edges(shell: ShellModel) -> tuple[IntArray, IntArray]:
    """Return the edges (n, 2) that only one facet has, as node numbers, and that facet (n,)."""
    edges = np.sort(np.concatenate([shell.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    _, first, count = np.unique(edges, axis=0, return_index=True, return_counts=True)
    alone = first[count == 1]
    return edges[alone], alone % len(shell.triangles)
