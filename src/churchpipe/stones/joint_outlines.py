"""What of a joint that is not convex is in contact: contacts keep the corners of its hull and its area."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.planar import Polygons, Region, area, areas, common, common_areas, polygon, polygons_of, united
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.polyhedra import face_normals

# Faces belong to a joint when they lie in its plane to this share of its size, and this near (cosine) to its direction.
_NEAR, _ALONG = 0.02, 0.99
# The faces enclose the area of the joint but for this share. A part may stick out by so much.
_SAME_AREA, _OUTSIDE = 1e-2, 1e-6


def covered(stones: Assemblage, contacts: Contacts, interface: IntArray, quads: FloatArray) -> BoolArray:
    """Return which quadrilaterals (m, 4, 2) lie wholly in their joint, interface (m,), where its two stones touch.

    Coordinates: m along t1 and t2 of the joint, from the mean of its contact points.

    Raises
    ------
    InputError: faces of the two stones do not make the joint.
    """
    out = np.zeros(len(quads), dtype=np.bool_)
    for joint in np.unique(interface).tolist():
        mine = np.flatnonzero(interface == joint)
        parts = polygons_of(quads[mine].reshape(-1, 2), 4 * np.arange(len(mine) + 1))
        out[mine] = common_areas(parts, _outline(stones, contacts, joint)) >= (1.0 - _OUTSIDE) * areas(parts)
    return out


def _outline(stones: Assemblage, contacts: Contacts, joint: int) -> Region:
    """Return where the faces of the two stones of a joint overlap, within the hull of its contact points."""
    frame, size = contacts.frame[joint], float(contacts.area[joint])
    points = contacts.point[contacts.point_ptr[joint] : contacts.point_ptr[joint + 1]]
    middle = points.mean(axis=0)
    whole: Region = polygon((points - middle) @ frame[1:].T)
    for block, sign in zip(contacts.blocks[joint].tolist(), (1.0, -1.0), strict=True):
        whole = common(whole, united(_faces(stones, block, sign, frame, middle, size)))
    if abs(area(whole) - size) > _SAME_AREA * size:
        first, second = stones.block_id[contacts.blocks[joint]]
        raise InputError(
            f"joint of {first} and {second}",
            "it is not convex, and where its material lies, which crushes, is not known",
            found=f"{area(whole):.4g} m2 between its faces",
            expected=f"{size:.4g} m2",
            remedy="Divide the stones into convex ones, or leave out their compressive strength.",
        )
    return whole


def _faces(stones: Assemblage, block: int, sign: float, frame: FloatArray, middle: FloatArray, size: float) -> Polygons:
    """Return the faces of a stone that lie in the plane of a frame and look along its first axis, or with sign -1 against it."""
    first, last = stones.block_face_ptr[block : block + 2]
    pointer = stones.face_ptr[first : last + 1]
    nodes, pointer = stones.face_nodes[pointer[0] : pointer[-1]], pointer - pointer[0]
    _, normal, mean = face_normals(stones.points, nodes, pointer)
    near = (np.abs((mean - middle) @ frame[0]) < _NEAR * np.sqrt(size)) & (sign * normal @ frame[0] > _ALONG)
    flat = (stones.points[nodes] - middle) @ frame[1:].T
    return polygons_of(flat, pointer)[near]
