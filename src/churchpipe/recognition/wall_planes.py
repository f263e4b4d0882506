"""Which plane wall each stone belongs to, and the mid-plane of that wall."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.clusters import clusters
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals
from churchpipe.stones.raggedness import Raggedness, face_lengths

# Faces whose normals or places differ by less than this are of one plane (rad, m).
PLANE_TOLERANCE = 1e-4
# Normals that differ by less are equal but for the rounding of the computer.
_EQUAL = 1e-9
# Least number of stones of a wall.
LEAST_STONES = 3
# The stones of one name are a plane wall only if more than this share of their volume lies across one plane.
LEAST_SHARE = 0.5
# If stones behind one another have at least this share of the volume of their wall, the wall has leaves.
LEAST_LEAF = 0.2


@dataclass(frozen=True, slots=True)
class WallPlane:
    """A wall: its name, its stones (n,), the unit normal (3,) and offset m of its mid-plane, its thickness m."""

    name: str
    stones: IntArray
    normal: FloatArray
    offset: float
    thickness: float


@dataclass(frozen=True, slots=True)
class _Pairs:
    """Pairs of opposite upright faces of a stone: the stone (n,); its plane (n, 4), which is normal x, y, offset and thickness;
    the middle of both faces (n, 3) m; from the middle of one to that of the other in plan (n, 2) m; how far either may be turned
    (n,), rad."""

    stone: IntArray
    plane: FloatArray
    middle: FloatArray
    across: FloatArray
    turn: FloatArray


def wall_planes(stones: Assemblage, free: BoolArray, ragged: Raggedness) -> list[WallPlane]:
    """Return the plane walls among the stones marked in free (nb,); ragged: how far their corners lie off their walls.

    A stone lies across a plane that is midway between two of its upright faces. The stones of one panel name are one wall, in
    the plane that most of them, by volume, lie across. Of the stones without a name those across the plane with the largest
    volume are the next wall, and so on.

    Raises
    ------
    InputError: stones of one name in two leaves.
    """
    pairs = _candidates(stones, ragged)
    stone, plane = pairs.stone, pairs.plane
    label = clusters(plane, PLANE_TOLERANCE) if len(plane) else np.empty(0, dtype=np.int64)
    _level_rounded(pairs, stones.volume[stone], label, ragged.flat)
    walls: list[WallPlane] = []
    for name in sorted(set(stones.panel[free].tolist()) - {""}):
        chosen = free[stone] & (stones.panel[stone] == name)
        wall = _heaviest(str(name), stones, stone, plane, label, chosen) if chosen.any() else None
        if wall:
            _check_one_stone_thick(wall, stones, stone[chosen], plane[chosen], ragged)
        named = free & (stones.panel == name)
        if wall and stones.volume[wall.stones].sum() > LEAST_SHARE * stones.volume[named].sum():
            walls.append(wall)
    loose = free & (stones.panel == "")
    while loose[stone].any():
        wall = _heaviest(f"wall-{len(walls) + 1}", stones, stone, plane, label, loose[stone])
        loose[wall.stones] = False
        if len(wall.stones) < LEAST_STONES:
            break
        walls.append(wall)
    return _in_turn(stones, walls, pairs)


def _in_turn(stones: Assemblage, walls: Sequence[WallPlane], pairs: _Pairs) -> list[WallPlane]:
    """Return the walls, a stone without a name that fills a crossing of two with that wall whose turn it is there.

    Such a stone, as at the end of a lintel beside a corner, lies across the planes of both. Where walls are toothed into one
    another, their courses fill the crossing in turn: the nearest ones are then of the other wall, and the next of its own.
    """
    owner = np.full(stones.count, -1, dtype=np.int64)
    across = np.zeros((stones.count, len(walls)), dtype=np.bool_)
    for number, wall in enumerate(walls):
        owner[wall.stones] = number
        alike = np.abs(pairs.plane - [*wall.normal[:2], wall.offset, wall.thickness]).max(axis=1) < PLANE_TOLERANCE
        across[pairs.stone[alike], number] = True
    in_two = across.sum(axis=1) == 2
    for stone in np.flatnonzero(in_two & (stones.panel == "") & (owner >= 0)).tolist():
        both = set(np.flatnonzero(across[stone]).tolist())
        column = np.concatenate([_at(stones, walls[number], np.flatnonzero(owner == number), stone) for number in both])
        column = column[~in_two[column]]
        height = stones.centroid[:, 2] - stones.centroid[stone, 2]
        column = column[np.argsort(np.abs(height[column]))]
        sides = [owner[column[side * height[column] > 0]].tolist() for side in (-1.0, 1.0)]
        nearest, following = ({side[k] for side in sides if len(side) > k} for k in (0, 1))
        if len(nearest) == 1 and following == both - nearest:
            owner[stone] = following.pop()
    return [replace(wall, stones=np.flatnonzero(owner == number)) for number, wall in enumerate(walls)]


def _at(stones: Assemblage, wall: WallPlane, own: IntArray, stone: int) -> IntArray:
    """Return those of the stones (n,) of a wall that are, along it, where the middle of another stone is."""
    along = np.array([-wall.normal[1], wall.normal[0]])
    place, middle = stones.points[:, :2] @ along, float(stones.centroid[stone, :2] @ along)
    low, high = (edge.reduceat(place, stones.block_point_ptr[:-1])[own] for edge in (np.minimum, np.maximum))
    return own[(low < middle) & (middle < high)]


def _check_one_stone_thick(wall: WallPlane, stones: Assemblage, stone: IntArray, plane: FloatArray, ragged: Raggedness) -> None:
    """Raise InputError for stones in planes that overlap with that of their wall: leaves, tied by headers or not."""
    apart = np.abs(plane[:, 2] - wall.offset)
    side = np.abs(plane[:, :2] - wall.normal[:2]).max(axis=1) < PLANE_TOLERANCE
    near = side & (apart > PLANE_TOLERANCE) & (apart < 0.5 * (plane[:, 3] + wall.thickness) + PLANE_TOLERANCE)
    leaf = np.setdiff1d(stone[near], wall.stones)
    if stones.volume[leaf].sum() > LEAST_LEAF * stones.volume[wall.stones].sum():
        raise behind_one_another(f"stones of {wall.name}", len(leaf), len(wall.stones), ragged)


def behind_one_another(where: str, leaf: int, others: int, ragged: Raggedness) -> InputError:
    """Return what to say of so many stones that lie behind others, or seem to since their corners are off."""
    found = f"{leaf} stones in planes beside that of {others} others"
    off = f"{1e3 * ragged.off:.2g} mm"
    more = "export the drawing with more digits, or with its walls along x and y"
    if ragged.too_much:
        return InputError(
            where,
            "their faces are too ragged to tell which of them stand in one plane",
            found=f"{found}; opposite sides are not parallel, as where rounded coordinates put corners up to {off} off",
            expected=f"corners less than {1e3 * ragged.most:.2g} mm off",
            remedy=f"{more.capitalize()}; or run the rigid blocks alone.",
        )
    if_not = f" If they do not, {more}: corners seem to be up to {off} off." if ragged.off > 0 else ""
    return InputError(
        where,
        "they lie behind one another, as in header-and-stretcher bond",
        found=found,
        expected="walls one stone thick: drawn walls are taken for a shell of running bond",
        remedy="Run the rigid blocks alone, or give each leaf a panel name of its own." + if_not,
    )


def _level_rounded(pairs: _Pairs, weight: FloatArray, label: IntArray, flat: float) -> None:
    """Give planes of stones with rounded coordinates, that are one plane, one normal, offset and label (n,), in place.

    weight (n,). A face that is turned by rounding says little of where its plane is away from it, and of how thick the stone is
    beside it: the middles do. Planes that are not one to `flat` m all along stay as they are.
    """
    plane, middle = pairs.plane, pairs.middle[:, :2]
    alike = clusters(plane[:, :2], float(np.median(pairs.turn))) if len(plane) else label
    for group in range(int(alike.max(initial=-1)) + 1):
        rows = np.flatnonzero(alike == group)
        if np.ptp(plane[rows, :2], axis=0).max() < _EQUAL:
            continue
        normal = weight[rows] @ plane[rows, :2]
        normal = normal / np.hypot(*normal)
        thickness = np.abs(pairs.across[rows] @ normal)
        near = clusters(np.column_stack([middle[rows] @ normal, thickness]), flat)
        for number in range(int(near.max()) + 1):
            own = rows[near == number]
            known = own[_in_one_plane(plane[own], weight[own])]
            fitted = _fitted(plane[known], middle[known], weight[known])
            offset, thickness = middle[own] @ fitted, np.abs(pairs.across[own] @ fitted)
            if np.ptp(offset) <= flat and np.ptp(thickness) <= 2 * flat:
                plane[own, :2], plane[own, 2] = fitted, np.average(middle[known] @ fitted, weights=weight[known])
                plane[own, 3], label[own] = np.median(thickness), label.max() + 1


def _in_one_plane(plane: FloatArray, weight: FloatArray) -> BoolArray:
    """Return which planes (n, 4) are the median one, but for the computer's rounding; all where most weight (n,) is in others.

    Stones put back into line tell their plane, and a few that could not be are no reason to move it.
    """
    exact = np.abs(plane - np.median(plane, axis=0)).max(axis=1) < _EQUAL
    return exact if weight[exact].sum() > 0.5 * weight.sum() else np.ones(len(plane), dtype=np.bool_)


def _fitted(plane: FloatArray, middle: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the normal (2,) of the plane through middles (n, 2) m that stand apart by more than it is thick; else the mean."""
    normal = weight @ plane[:, :2]
    normal = normal / np.hypot(*normal)
    along = np.array([-normal[1], normal[0]])
    beside = middle - np.average(middle, axis=0, weights=weight)
    s, offset = beside @ along, beside @ normal
    if np.ptp(s) <= plane[:, 3].max():
        return normal
    slope = (weight * s) @ offset / ((weight * s) @ s)
    turned = normal - slope * along
    return turned / np.hypot(*turned)


def _candidates(stones: Assemblage, ragged: Raggedness) -> _Pairs:
    """Return all pairs of opposite upright faces of the free stones."""
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    turn = ragged.turn(face_lengths(stones))
    owner: list[int] = []
    planes: list[FloatArray] = []
    middles: list[FloatArray] = []
    across: list[FloatArray] = []
    turns: list[float] = []
    for block in np.flatnonzero(~stones.fixed):
        faces = np.arange(*stones.block_face_ptr[block : block + 2])
        faces = faces[np.abs(normal[faces, 2]) < PLANE_TOLERANCE]
        most = np.maximum.outer(turn[faces], turn[faces])
        opposite = np.argwhere(np.triu(normal[faces] @ normal[faces].T < most**2 / 2 - 1))
        for first, second in faces[opposite]:
            # The normal that points to +x, or to -y in walls along x: s then runs along +x or +y.
            n = normal[first] if outward(normal[first]) else normal[second]
            near, far = sorted((float(mean[first] @ n), float(mean[second] @ n)))
            planes.append(np.array([n[0], n[1], 0.5 * (near + far), far - near]))
            middles.append(0.5 * (mean[first] + mean[second]))
            across.append((mean[second] - mean[first])[:2])
            turns.append(float(max(turn[first], turn[second])))
            owner.append(int(block))
    return _Pairs(
        np.array(owner, dtype=np.int64),
        np.array(planes).reshape(-1, 4),
        np.array(middles).reshape(-1, 3),
        np.array(across).reshape(-1, 2),
        np.array(turns),
    )


def outward(normal: FloatArray) -> bool:
    """Return whether a level normal is the one of its two that a wall is given: s then runs along +x or +y."""
    return bool(normal[1] < -PLANE_TOLERANCE or (abs(normal[1]) <= PLANE_TOLERANCE and normal[0] > 0))


def _heaviest(
    name: str, stones: Assemblage, stone: IntArray, plane: FloatArray, label: IntArray, chosen: Sequence[bool] | np.ndarray
) -> WallPlane:
    rows = np.flatnonzero(chosen)
    best = int(np.argmax(np.bincount(label[rows], stones.volume[stone[rows]])))
    rows = rows[label[rows] == best]
    n1, n2, offset, thickness = np.median(plane[rows], axis=0)
    normal = np.array([n1, n2, 0.0]) / np.hypot(n1, n2)
    return WallPlane(name, np.unique(stone[rows]), normal, round(float(offset), 9), round(float(thickness), 9))
