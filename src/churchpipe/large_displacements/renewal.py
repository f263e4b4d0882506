"""Contacts found anew where stones have moved, with what the old points carried."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from churchpipe.large_displacements.crushed import rectangles_of
from churchpipe.large_displacements.joints import Joints, joints_of
from churchpipe.large_displacements.poses import Poses
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.touching import touching
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.rigid_blocks.polygons import joint_polygons


@dataclass(frozen=True, slots=True)
class PairValues:
    """A strength of each pair of stones that bore on each other as drawn; of others, the least of what both have."""

    pair: IntArray
    value: FloatArray
    least: FloatArray

    def of(self, blocks: IntArray, count: int) -> FloatArray:
        """Return the values (ni,) of interfaces of stones (ni, 2)."""
        key = _key(blocks, count)
        place = np.minimum(np.searchsorted(self.pair, key), len(self.pair) - 1)
        return np.where(self.pair[place] == key, self.value[place], self.least[blocks].min(axis=1))


def pair_values(blocks: IntArray, value: FloatArray, count: int) -> PairValues:
    """Return the values of pairs of stones from those of their interfaces (ni,), the least where there are several."""
    pair, place = np.unique(_key(blocks, count), return_inverse=True)
    of_pair = np.full(len(pair), np.inf)
    np.minimum.at(of_pair, place, value)
    least = np.full(count, float(value.max()))
    np.minimum.at(least, blocks.ravel(), np.repeat(value, 2))
    return PairValues(pair, of_pair, least)


def first_joints(contacts: Contacts, stones: Assemblage, poses: Poses, reach: float, *, crushing: bool = False) -> Joints:
    """Return the joints of the contacts as drawn: what gap the drawing leaves in them, or what overlap, counts as closed."""
    real, gap, *_ = touching(stones, np.zeros(stones.count, dtype=bool), reach, reach, PATH.narrow * reach)
    known, found = joints_of(contacts, poses), joints_of(real, poses, gap)
    origin = _origin(found, real, contacts.point, known.pair, contacts.frame[known.interface, 0], stones)
    rest = np.where(origin >= 0, gap[origin], 0.0)
    joints = replace(joints_of(contacts, poses, rest), rest=rest)
    if not crushing:
        return joints
    polygons = joint_polygons(contacts)
    place, share = rectangles_of(polygons.corner, polygons.start)
    return replace(joints, place=place, rectangle=share * contacts.area)


def renewed(
    joints: Joints,
    stones: Assemblage,
    poses: Poses,
    left_out: BoolArray,
    reach: float,
    as_drawn: float,
    *,
    crushing: bool = False,
) -> Joints:
    """Return the joints of displaced stones (nb) that come within reach, m; what points carried goes to the nearest new ones.

    as_drawn m: the largest gap or overlap that any joint has as drawn.
    """
    wide = reach + as_drawn
    contacts, gap, *crushed = touching(stones, left_out, wide, PATH.deeper * wide, PATH.narrow * reach, crushing=crushing)
    new = joints_of(contacts, poses, gap, *crushed)
    before, _ = joints.at(poses)
    origin = _origin(joints, before, contacts.point, new.pair, contacts.frame[new.interface, 0], stones)
    known = origin >= 0
    rest = np.where(known, joints.rest[origin], 0.0)
    gap = gap - rest
    least, seen = np.full(len(new.blocks), np.inf), np.zeros(len(new.blocks), dtype=bool)
    np.minimum.at(least, new.interface, gap)
    np.logical_or.at(seen, new.interface, known)
    keep = (least <= reach) & (seen | (least >= -PATH.depth * reach))
    sliding, lever = np.where(known, joints.sliding[origin], 0.0), np.where(known[:, None], joints.lever[origin], 0.0)
    heirs = np.bincount(origin[known], minlength=len(joints.pressing))[origin]
    share = np.where(known, 1.0 / np.maximum(heirs, 1), 0.0)
    pressing, shear = share * joints.pressing[origin], share[:, None] * joints.shear[origin]
    return replace(new, sliding=sliding, rest=rest, lever=lever, pressing=pressing, shear=shear).selected(keep)


def _key(blocks: IntArray, count: int) -> IntArray:
    return np.minimum(*blocks.T) * count + np.maximum(*blocks.T)


def _origin(joints: Joints, contacts: Contacts, place: FloatArray, pair: IntArray, n: FloatArray, stones: Assemblage) -> IntArray:
    """Return for each place (k, 3) between a pair of stones (k, 2) the nearest point of their joint, -1 where there is none."""
    if not len(contacts.point) or not len(place):
        return np.full(len(place), -1)
    # A fourth coordinate holds points of different pairs apart.
    key = np.concatenate([_key(joints.pair, stones.count), _key(pair, stones.count)])
    label = np.unique(key, return_inverse=True)[1] * (4.0 * stones.size + 1.0)
    known = np.column_stack([contacts.point, label[: len(joints.first)]])
    bound = 2.0 * stones.size + 0.5
    _, origin = cKDTree(known).query(np.column_stack([place, label[len(joints.first) :]]), distance_upper_bound=bound)
    found = origin < len(known)
    origin = np.where(found, origin, 0)
    along = np.einsum("kc,kc->k", contacts.frame[joints.interface[origin], 0], n)
    return np.where(found & (np.abs(along) > PATH.same), origin, -1)
