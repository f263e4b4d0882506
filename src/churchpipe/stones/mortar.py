"""Stones with mortar between them: the joints between their faces, and stones grown to meet in the middle of the mortar."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.clusters import clusters, components
from churchpipe.geometry.manifolds import trimmed
from churchpipe.geometry.mending import signed_volume
from churchpipe.geometry.planar import area, common, outlined, overlapping, vertices, widened
from churchpipe.geometry.warped import split_warped
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.stones.between import filled

Solid = tuple[FloatArray, Sequence[Sequence[int]]]

# Two faces are opposite when their normals are, within this angle. Joints are this much wider than their
# nominal width at most, in the mean and at the wide end of a wedge.
FACING_ANGLE = np.radians(12.0)
WIDEST_MEAN, WIDEST = 1.5, 2.5
# An overlap smaller than this share of the smaller face is no joint, nor is a gap narrower than this share of the stones' size.
LEAST_OVERLAP = 0.02
TOUCHING = 1e-6
# The faces along a bed are moved into one common plane if it is within this share of the joint's width of the middle of every
# joint. Otherwise each face is moved to the middle of its own joints.
OUT_OF_LINE = 0.05
# The main joint of a face is the one with the largest area over the square of its width. Another joint is dropped if its
# mid-surface is farther from that of the main joint than this.
ASTRAY = 0.25
# Where four stones meet along an edge, grown stones that lie across from each other touch by as much as their faces were drawn
# uneven. Strips narrower than this share of the joint's width are no contacts.
STRIP = 0.2
# The tip of a sharp corner moves farther than its sides, by up to this many joints. One that moves by more than a joint, because
# its angle is less than 60 degrees, is cut off where it reaches beyond the stones that it faces.
FARTHEST = 40.0
# The ends of a face are the faces of its stone that make at least this angle with it (rad).
END = np.radians(45.0)
# Joints are searched up to a width of this share of the stones' smallest dimension.
WIDEST_OF_STONE = 0.35


@dataclass(frozen=True, slots=True)
class Joints:
    """Pairs of faces that face each other: faces (k, 2), indices into all faces in their order; width (k,), the mean of each
    joint; middle: points (m, 3) of its mid-surface for each; joint (k,): its number, one for all triangles of two flat sides."""

    faces: IntArray
    width: FloatArray
    middle: tuple[FloatArray, ...]
    joint: IntArray


@dataclass(frozen=True, slots=True)
class Closed:
    """Stones grown to meet in their joints.

    solids: points and faces; joints: those that were closed; volume_before, volume (nb,): of each stone; stuck: indices of the
    stones that could not be grown and were left as they were; wide: gaps between two stones, (stone, stone, width), that are too
    wide for a joint, or off the main joint of a face, and stay open.
    """

    solids: list[Solid]
    joints: Joints
    volume_before: FloatArray
    volume: FloatArray
    stuck: list[int]
    wide: list[tuple[int, int, float]]


def close_joints(solids: Sequence[Solid], joint: float) -> Closed:
    """Grow stones until they meet in the middle of the joints between them.

    Each face with another opposite across a joint is moved to the mid-surface of the joint, so that each stone gets half of the
    mortar. The mid-surface of a wedge-shaped joint lies between its two faces. A face with no other opposite stays where it is,
    and nothing grows into the ground below all stones.

    Parameters
    ----------
    solids: points (n, 3), z up, in any one unit and outward faces. joint: nominal width of the joints, in that unit.
    """
    flat = _Faces.of(solids)
    joints = _joints(flat, joint)
    plane = _mid_planes(flat, joints, joint)
    opposite = _opposite(joints)
    out: list[Solid] = []
    stuck: list[int] = []
    lowest = min(float(points[:, 2].min()) for points, _ in solids)
    before = np.array([signed_volume(points, [tuple(face) for face in faces]) for points, faces in solids])
    after = before.copy()
    for index, (points, faces) in enumerate(solids):
        own = range(*flat.solid_ptr[index : index + 2])
        shifted = {f - own.start: plane[f] for f in own if f in plane}
        if not shifted:
            out.append((points, faces))
            continue
        normal, level = flat.normal[own.start : own.stop].copy(), flat.level[own.start : own.stop].copy()
        for face, (n, d) in shifted.items():
            normal[face], level[face] = n, d
        shift = np.array(
            [_shift(points[v], v, faces, normal, level, flat.area[own.start : own.stop], joint) for v in range(len(points))]
        )
        grown = points + shift
        split: Sequence[tuple[int, ...]] = split_warped(grown, faces)[0]
        cuts = _beyond_neighbours(flat, plane, opposite, own, faces, points, grown, np.linalg.norm(shift, axis=1) > joint)
        if grown[:, 2].min() < lowest - TOUCHING * flat.size:
            cuts.append((np.array([0.0, 0.0, -1.0]), -lowest))
        if cuts:
            grown, split = trimmed(grown, split, cuts)
        volume = signed_volume(grown, split)
        if not 0.5 * before[index] < volume < 3.0 * before[index]:
            stuck.append(index)
            out.append((points, faces))
            continue
        after[index] = volume
        out.append((grown, tuple(split)))
    return Closed(out, joints, before, after, stuck, _too_wide(flat, joints, joint))


def _too_wide(flat: "_Faces", joints: Joints, joint: float) -> list[tuple[int, int, float]]:
    """Return the stones that face each other across no joint, but across no more than the widest end of one."""
    closed = {tuple(sorted(pair)) for pair in flat.solid[joints.faces].tolist()}
    wider = _joints(flat, WIDEST / WIDEST_MEAN * joint, astray=np.inf)
    found: dict[tuple[int, int], float] = {}
    for pair, width in zip(flat.solid[wider.faces].tolist(), wider.width.tolist(), strict=True):
        first, second = sorted(pair)
        if (first, second) not in closed:
            found[first, second] = max(width, found.get((first, second), 0.0))
    return [(*pair, width) for pair, width in sorted(found.items())]


def with_mortar(stones: Assemblage, joint: float) -> Assemblage:
    """Return stones that meet in the middle of joints `joint` m wide that they leave open; each weighs as before."""
    closed = close_joints([stones.solid(stone) for stone in range(stones.count)], joint)
    return Assemblage.from_polyhedra(
        closed.solids,
        stones.unit_weight * (closed.volume_before / closed.volume),
        fixed=stones.fixed,
        material=stones.material.tolist(),
        panel=stones.panel.tolist(),
        course=stones.course.tolist(),
        block_id=stones.block_id.tolist(),
        butts=stones.butts.tolist(),
    )


def _opposite(joints: Joints) -> dict[int, list[int]]:
    """Return the faces across the joints of each face that has any."""
    out: dict[int, list[int]] = {}
    for i, j in joints.faces.tolist():
        out.setdefault(i, []).append(j)
        out.setdefault(j, []).append(i)
    return out


def _beyond_neighbours(
    flat: "_Faces",
    plane: dict[int, tuple[FloatArray, float]],
    opposite: dict[int, list[int]],
    own: range,
    faces: Sequence[Sequence[int]],
    points: FloatArray,
    grown: FloatArray,
    sharp: BoolArray,
) -> list[tuple[FloatArray, float]]:
    """Return the planes, normal and level, in which the sharp tips of a grown stone are cut off.

    A tip grows into the mortar where three stones meet, and may so reach over the end of the stone that it was drawn along, to
    the next one. It is cut off in the plane of that end, where only tips lie beyond, and nothing that was drawn. Ends of stones
    that the tip itself does not lie on are left out: their planes would cut it far from where they are.
    """
    if not sharp.any():
        return []
    slack = TOUCHING * flat.size
    cuts: list[tuple[FloatArray, float]] = []
    ends = {
        (end, tuple(faces[k - own.start]))
        for k in own
        for face in opposite.get(k, [])
        for end in range(*flat.solid_ptr[flat.solid[face] : flat.solid[face] + 2])
        if abs(flat.normal[end] @ flat.normal[face]) < np.cos(END)
    }
    for end, corners in sorted(ends):
        tips = np.isin(np.arange(len(points)), corners) & sharp
        normal, level = plane.get(end, (flat.normal[end], float(flat.level[end])))
        beyond = grown @ normal > level + slack
        if (beyond & tips).any() and not (beyond & ~sharp).any() and (points @ normal <= level + slack).all():
            cuts.append((normal, level))
    return cuts


def open_joints(solids: Sequence[Solid]) -> Joints:
    """Return the joints between stones that do not touch, as wide as a third of the stones' smallest dimension at most."""
    size = float(np.median([np.ptp(points, axis=0).min() for points, _ in solids]))
    return _joints(_Faces.of(solids), WIDEST_OF_STONE * size / WIDEST_MEAN)


@dataclass(frozen=True, slots=True)
class _Faces:
    """All faces of all solids: corners of each, unit normals (nf, 3), levels (nf,) along them, areas (nf,), solids (nf,)."""

    corners: list[FloatArray]
    normal: FloatArray
    level: FloatArray
    area: FloatArray
    solid: IntArray
    solid_ptr: IntArray
    size: float

    @classmethod
    def of(cls, solids: Sequence[Solid]) -> "_Faces":
        corners = [points[list(face)] for points, faces in solids for face in faces]
        pointer = np.cumsum([0, *(len(c) for c in corners)])
        flat = np.concatenate(corners)
        area_vector, normal, mean = face_normals(flat, np.arange(len(flat)), pointer)
        counts = [len(faces) for _, faces in solids]
        return cls(
            corners,
            normal,
            np.einsum("ij,ij->i", normal, mean),
            np.linalg.norm(area_vector, axis=1),
            np.repeat(np.arange(len(counts)), counts),
            np.cumsum([0, *counts]),
            float(np.median([np.ptp(points, axis=0).max() for points, _ in solids])),
        )


def _joints(flat: _Faces, joint: float, *, astray: float = ASTRAY) -> Joints:
    """Return the joints; astray: share of the width by which those of one face may be off its main one.

    Two faces have none where a third stone lies between them: a tile in its bed, a wedge of a fan.
    """
    pairs: list[tuple[int, int]] = []
    width: list[float] = []
    middle: list[FloatArray] = []
    weight: list[float] = []
    near: list[list[int]] = _candidates(flat, WIDEST * joint).tolist()
    found = [(pair, _across(flat, pair, 0.0)) for pair in near]
    facing = {face for (i, j), across in found if across for face in (i, j)}
    # A face narrower than a joint may face another one beyond its end, in the mortar alone. Left where it is, it would keep
    # the faces beside it from meeting their neighbours.
    chips = {face for face in {face for pair in near for face in pair} - facing if _narrow(flat.corners[face], joint)}
    found += [(pair, _across(flat, pair, 0.5 * joint)) for pair in near if not chips.isdisjoint(pair)]
    for (i, j), across in found:
        if across is None:
            continue
        gap, points, size = across
        if gap.max() > WIDEST * joint or gap.mean() > WIDEST_MEAN * joint or gap.min() < -TOUCHING * flat.size:
            continue
        if gap.mean() <= TOUCHING * flat.size:
            continue
        pairs.append((i, j))
        width.append(float(gap.mean()))
        middle.append(points)
        weight.append(size / gap.mean() ** 2)
    places = np.array([points.mean(axis=0) for points in middle]).reshape(-1, 3)
    between = filled(flat.corners, flat.solid, places, flat.solid[np.array(pairs, dtype=np.int64).reshape(-1, 2)])
    clear = np.flatnonzero(~between).tolist()
    pairs, width = [pairs[k] for k in clear], [width[k] for k in clear]
    middle, weight = [middle[k] for k in clear], [weight[k] for k in clear]
    kept = _one_surface_a_face(pairs, middle, weight, astray * joint)
    faces = np.array([pairs[k] for k in kept], dtype=np.int64).reshape(-1, 2)
    return Joints(faces, np.array([width[k] for k in kept]), tuple(middle[k] for k in kept), _numbers(flat, faces, joint))


def _numbers(flat: _Faces, faces: IntArray, joint: float) -> IntArray:
    """Return the number of the joint of each pair of faces (k, 2): pairs of the same two stones in one plane are one joint."""
    if len(faces) == 0:
        return np.empty(0, dtype=np.int64)
    stones = flat.solid[faces]
    first = faces[np.arange(len(faces)), np.argmin(stones, axis=1)]
    level = flat.level[first] * FACING_ANGLE / joint
    return clusters(np.column_stack([np.sort(stones, axis=1).astype(np.float64), flat.normal[first], level]), FACING_ANGLE)


def _one_surface_a_face(pairs: list[tuple[int, int]], middle: list[FloatArray], weight: list[float], off: float) -> list[int]:
    """Return the pairs whose mid-surface is, for either face, within `off` of that of the joint of the face that weighs most."""
    main: dict[int, int] = {}
    for k in np.argsort(weight).tolist():
        main |= dict.fromkeys(pairs[k], k)
    surface = {k: _fitted([middle[k]]) for k in set(main.values())}
    out: list[int] = []
    for k, pair in enumerate(pairs):
        planes = [surface[main[face]] for face in pair]
        if all(np.abs(middle[k] @ normal - level).max() <= off for normal, level, _ in planes):
            out.append(k)
    return out


def _candidates(flat: _Faces, reach: float) -> IntArray:
    """Return pairs (k, 2) of faces of different solids with opposite normals and boxes closer than `reach`."""
    low = np.array([c.min(axis=0) for c in flat.corners]) - 0.5 * reach
    high = np.array([c.max(axis=0) for c in flat.corners]) + 0.5 * reach
    # The tree of boxes has two dimensions: those in which the stones spread most.
    a, b = np.argsort(np.ptp(np.concatenate([low, high]), axis=0))[1:]
    i, j = overlapping(np.column_stack([low[:, a], low[:, b], high[:, a], high[:, b]])).T
    keep = flat.solid[i] != flat.solid[j]
    i, j = i[keep], j[keep]
    keep = np.einsum("ij,ij->i", flat.normal[i], flat.normal[j]) < -np.cos(FACING_ANGLE)
    keep &= ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
    return np.stack([i[keep], j[keep]], axis=1)


def _narrow(corners: FloatArray, joint: float) -> bool:
    """Return whether a face is narrower than the joint: the second of its extents is."""
    return bool(np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)[1] < 0.5 * joint * np.sqrt(len(corners)))


def _across(flat: _Faces, pair: list[int], margin: float) -> tuple[FloatArray, FloatArray, float] | None:
    """Return the gap between two faces at the corners of what they have in common, the points halfway there, and its area.

    margin: by how much the faces are drawn on all round.
    """
    i, j = pair
    n = flat.normal[i] - flat.normal[j]
    n /= np.linalg.norm(n)
    u = np.cross(n, [1.0, 0.0, 0.0] if abs(n[0]) < 0.7 else [0.0, 1.0, 0.0])
    u /= np.linalg.norm(u)
    axes = np.stack([u, np.cross(n, u)])
    corners = [flat.corners[f] @ axes.T for f in (i, j)]
    first, second = (
        widened(shape, margin)
        for shape in outlined(np.concatenate(corners), np.array([len(c) for c in corners]), np.array([1, 1]))
    )
    shared = common(first, second)
    if area(shared) <= LEAST_OVERLAP * min(area(first), area(second)):
        return None
    place = np.unique(vertices(shared), axis=0) @ axes
    at = [(flat.level[f] - place @ flat.normal[f]) / (n @ flat.normal[f]) for f in (i, j)]
    return at[1] - at[0], place + 0.5 * (at[0] + at[1])[:, None] * n, area(shared)


def _mid_planes(flat: _Faces, joints: Joints, joint: float) -> dict[int, tuple[FloatArray, float]]:
    """Return for each face with a joint the plane it is moved to: its normal (3,) and its level along it."""
    label = components(len(flat.normal), joints.faces)
    groups: dict[int, list[int]] = {}
    of_face: dict[int, list[int]] = {}
    for k, (i, j) in enumerate(joints.faces.tolist()):
        groups.setdefault(int(label[i]), []).append(k)
        of_face.setdefault(i, []).append(k)
        of_face.setdefault(j, []).append(k)
    planes: dict[int, tuple[FloatArray, float]] = {}
    of_group = {group: _fitted([joints.middle[k] for k in own]) for group, own in groups.items()}
    for face, own in of_face.items():
        normal, level, off = of_group[int(label[face])]
        if off > OUT_OF_LINE * joint:
            normal, level, _ = _fitted([joints.middle[k] for k in own])
        turned = 1.0 if normal @ flat.normal[face] > 0 else -1.0
        planes[face] = (turned * normal, turned * level)
    return planes


def _fitted(parts: list[FloatArray]) -> tuple[FloatArray, float, float]:
    """Return normal, level and main distance of the plane that fits points best."""
    points = np.concatenate(parts)
    centre = points.mean(axis=0)
    normal = np.linalg.svd(points - centre)[2][2]
    return normal, float(normal @ centre), float(np.abs((points - centre) @ normal).max())


def _shift(
    point: FloatArray,
    vertex: int,
    faces: Sequence[Sequence[int]],
    normal: FloatArray,
    level: FloatArray,
    area: FloatArray,
    joint: float,
) -> FloatArray:
    """Return how far a vertex moves to lie on the planes of all its faces; the least way where these leave it free.

    Where that is too far, because faces are nearly parallel there, the larger ones decide.
    """
    around = sorted((k for k, face in enumerate(faces) if vertex in face), key=lambda k: -area[k])
    step = np.zeros(3)
    while around:
        lacking = level[around] - normal[around] @ point
        if not lacking.any():
            return np.zeros(3)
        step = np.linalg.pinv(normal[around], rcond=5e-3) @ lacking
        if np.linalg.norm(step) <= FARTHEST * joint:
            break
        around = around[:-1]
    return step
