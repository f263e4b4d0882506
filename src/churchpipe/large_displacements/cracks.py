"""Where the joints of displaced stones are open, and how far they have slid."""

import numpy as np

from churchpipe.large_displacements.joints import joints_of
from churchpipe.large_displacements.poses import Poses, screw, start_poses
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import FloatArray, floats
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.contacts import Contacts
from churchpipe.model.settlement import SettlementPath


def path_cracks(
    stones: Assemblage, contacts: Contacts, path: BlockCapacityCurve | SettlementPath, step: int
) -> tuple[FloatArray, FloatArray]:
    """Return how wide the joints as drawn (ni,) are open, m, and how far they have slid, m, at a step of a path, the last one for
    -1: see `joint_cracks`. Joints of stones that have fallen by then, which are left where they fell, are shut.

    Raises
    ------
    InputError: arguments of the wrong kind, places of other stones.
    """
    opening, slip = joint_cracks(stones, contacts, path.position[step], path.rotation[step])
    last = len(path.position) + step if step < 0 else step
    gone = [part.stones for part in path.fallen if part.step < last]
    there = ~np.isin(contacts.blocks, np.concatenate([*gone, np.zeros(0, dtype=np.int64)])).any(axis=1)
    return np.where(there, opening, 0.0), np.where(there, slip, 0.0)


def joint_cracks(
    stones: Assemblage, contacts: Contacts, position: FloatArray, rotation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return how wide the joints as drawn (ni,) are open, m, at the widest of their points, and how far they have slid, m, at the
    point that is open the least: one that turns about an edge has not slid.

    position (nb, 3) m and rotation (nb, 3) rad, rotation vectors from the drawing, of the stones as they are.

    Raises
    ------
    InputError: arguments of the wrong kind, places of other stones.
    """
    check_kind("joint_cracks: stones", stones, Assemblage)
    check_kind("joint_cracks: contacts", contacts, Contacts)
    position = floats("joint_cracks: position", position, (stones.count, 3))
    rotation = floats("joint_cracks: rotation", rotation, (stones.count, 3))
    start = joints_of(contacts, start_poses(stones))
    poses = Poses(position, screw(rotation)[0])
    now, gap = start.at(poses)
    apart = now.point - poses.place(start.pair[:, 0], start.first)
    along = apart - gap[:, None] * now.frame[start.interface, 0]
    opening = np.maximum.reduceat(gap, contacts.point_ptr[:-1])
    closed = np.lexsort((gap, start.interface))[contacts.point_ptr[:-1]]
    return np.maximum(opening, 0.0), np.linalg.norm(along, axis=1)[closed]
