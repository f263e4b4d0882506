"""The part of the ground that a movement takes along: the foot of a wall, a fixed stone, or a rectangle of the plan."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.polygons import behind
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import FloatArray, IntArray, floats, pointer_of, ragged_indices
from churchpipe.model.assemblage import Assemblage, assemble
from churchpipe.model.contacts import Contacts

Rectangle = tuple[tuple[float, float], tuple[float, float]]
# Ground is an upright prism, and a strip of it no piece, within this length, m.
_EXACT = 1e-6
WHOLE_GROUND = (
    "{} takes along all ground that the building stands on: it moves as a whole, and nothing cracks. Is it meant? A support that "
    "settles is a part of the ground, such as the foot of one wall of several."
)


@dataclass(frozen=True, slots=True)
class Footing:
    """Stones whose ground is cut where a part of it moves, and which of their fixed stones (k,) that part is.

    cut: whether the ground was cut, so that the contacts of these stones are to be found anew.
    """

    stones: Assemblage
    support: IntArray
    cut: bool


def footing(stones: Assemblage, contacts: Contacts, place: str | Rectangle) -> Footing:
    """Return the support of a name, or that below a rectangle of the plan, m, cut out of the ground where need be.

    place: a fixed stone; or a wall: what its stones stand on, and where others stand there, too, the rectangle around its foot,
    along the longest side of that ground; or two opposite corners (x, y) of a rectangle.

    Raises
    ------
    InputError: neither a wall nor a fixed stone, a wall that does not reach the ground, a rectangle without width or with nothing
        over it, ground that is no upright prism of a convex plan and cannot be cut.
    """
    check_kind("footing: stones", stones, Assemblage)
    check_kind("footing: contacts", contacts, Contacts)
    if not isinstance(place, str):
        (x0, y0), (x1, y1) = floats("footing: place", place, (2, 2)).tolist()
        corners = np.array([[min(x0, x1), min(y0, y1)], [max(x0, x1), max(y0, y1)]])
        return _cut(stones, contacts, np.eye(2), corners, f"from {corners[0].tolist()} to {corners[1].tolist()} m")
    own = np.flatnonzero(stones.fixed & (stones.block_id == place))
    if len(own):
        return Footing(stones, own, cut=False)
    fixed = stones.fixed[contacts.blocks]
    bearing = np.flatnonzero(fixed[:, 0] != fixed[:, 1])
    ground = np.where(fixed[:, 0], contacts.blocks[:, 0], contacts.blocks[:, 1])[bearing]
    wall = stones.panel[np.where(fixed[:, 0], contacts.blocks[:, 1], contacts.blocks[:, 0])[bearing]]
    mine = wall == place
    if not mine.any():
        walls = sorted({*wall.tolist()} - {""})
        expected = ", ".join([*walls, *stones.block_id[stones.fixed].tolist()])
        raise InputError("support", "no wall or stone of this name on the ground", found=place, expected=expected)
    support = np.unique(ground[mine])
    if not np.isin(ground[~mine], support).any():
        return Footing(stones, support, cut=False)
    points = contacts.point[ragged_indices(contacts.point_ptr[bearing[mine]], contacts.points_per_interface[bearing[mine]]), :2]
    frame = _axes(_plan(_corners(stones, int(support[0]))))
    seen = points @ frame.T
    return _cut(stones, contacts, frame, np.array([seen.min(axis=0), seen.max(axis=0)]), f"below {place}")


def whole_ground_question(stones: Assemblage, contacts: Contacts, movement: str, place: str | Rectangle) -> str:
    """Return what to ask about a movement along a direction that takes all ground along, "" where it does not.

    movement: its name. place: as in `footing`, where it is found. stones, contacts: before any ground is cut.
    """
    return WHOLE_GROUND.format(f'The movement "{movement}"') if _bears_all(stones, contacts, place) else ""


def _bears_all(stones: Assemblage, contacts: Contacts, place: str | Rectangle) -> bool:
    fixed = stones.fixed[contacts.blocks]
    bearing = np.flatnonzero(fixed[:, 0] != fixed[:, 1])
    if isinstance(place, str):
        found = footing(stones, contacts, place)
        return not found.cut and stands_on(stones, contacts, found.support)
    low, high = np.sort(floats("footing: place", place, (2, 2)), axis=0)
    points = contacts.point[ragged_indices(contacts.point_ptr[bearing], contacts.points_per_interface[bearing]), :2]
    return bool(((points >= low - _EXACT) & (points <= high + _EXACT)).all())


def stands_on(stones: Assemblage, contacts: Contacts, support: IntArray) -> bool:
    """Return whether the free stones bear on no fixed stones but these (k,)."""
    fixed = stones.fixed[contacts.blocks]
    return bool(np.isin(contacts.blocks[fixed & ~fixed[:, ::-1]], support).all())


def _cut(stones: Assemblage, contacts: Contacts, frame: FloatArray, corners: FloatArray, words: str) -> Footing:
    """Return stones whose ground is cut along a rectangle (2, 2), its lowest and highest places along two axes (2, 2)."""
    if (np.ptp(corners, axis=0) <= _EXACT).any():
        raise InputError("support", "a rectangle without width", found=words, expected="corners that differ in x and in y")
    pairs = contacts.blocks[_upon(stones, contacts, frame, corners)].ravel()
    plates = np.unique(pairs[stones.fixed[pairs]])
    if not len(plates):
        raise InputError("support", "nothing stands on the ground there", found=words, expected="a rectangle with stones in it")
    pieces: list[FloatArray] = []
    moving: list[FloatArray] = []
    for plate in plates.tolist():
        points = _corners(stones, plate)
        plan = _plan(points)
        if plan is None:
            raise InputError(
                "support",
                "ground that cannot be cut",
                found=f"{stones.block_id[plate]}, which is no upright prism of a convex plan",
                expected="such a prism, or a support that is a fixed stone of its own",
            )
        middle, around = _pieces(plan, frame, corners)
        levels = np.array([points[:, 2].min(), points[:, 2].max()])
        moving.append(_prism(middle, levels))
        pieces += [_prism(piece, levels) for piece in around]
    return Footing(*_with_prisms(stones, plates, pieces, moving), cut=True)


def _upon(stones: Assemblage, contacts: Contacts, frame: FloatArray, corners: FloatArray) -> IntArray:
    """Return the joints between ground and free stones that lie over a rectangle (2, 2) along two axes (2, 2), if in part."""
    fixed = stones.fixed[contacts.blocks]
    found: list[int] = []
    for joint in np.flatnonzero(fixed[:, 0] != fixed[:, 1]).tolist():
        points = contacts.point[contacts.point_ptr[joint] : contacts.point_ptr[joint + 1], :2]
        arm = points - points.mean(axis=0)
        above, _ = _pieces(points[np.argsort(np.arctan2(arm[:, 1], arm[:, 0]))], frame, corners)
        if len(above) and (np.ptp(above @ frame.T, axis=0) > _EXACT).all():
            found.append(joint)
    return np.array(found, dtype=np.int64)


def _corners(stones: Assemblage, stone: int) -> FloatArray:
    return stones.points[stones.block_point_ptr[stone] : stones.block_point_ptr[stone + 1]]


def _plan(points: FloatArray) -> FloatArray | None:
    """Return the plan (k, 2) of an upright prism with these corners, counter-clockwise; None where they are none of one."""
    from scipy.spatial import ConvexHull

    level = 0.5 * (points[:, 2].min() + points[:, 2].max())
    below, above = points[points[:, 2] < level], points[points[:, 2] >= level]
    if len(below) != len(above) or len(below) < 3 or max(np.ptp(below[:, 2]), np.ptp(above[:, 2])) > _EXACT:
        return None
    order = ConvexHull(below[:, :2] - below[0, :2]).vertices
    apart = np.linalg.norm(below[:, None, :2] - above[None, :, :2], axis=2).min(axis=1)
    return below[order, :2] if len(order) == len(below) and apart.max() <= _EXACT else None


def _axes(plan: FloatArray | None) -> FloatArray:
    """Return two axes (2, 2) along and across the longest side of a plan (k, 2), the first nearer to x; of none x and y."""
    if plan is None:
        return np.eye(2)
    side = np.roll(plan, -1, axis=0) - plan
    longest = side[np.argmax(np.linalg.norm(side, axis=1))]
    x, y = longest / np.linalg.norm(longest)
    x, y = (x, y) if abs(x) >= abs(y) else (y, -x)
    x, y = (x, y) if x > 0 else (-x, -y)
    return np.array([[x, y], [-y, x]])


def _pieces(plan: FloatArray, frame: FloatArray, corners: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
    """Return the part of a convex plan (k, 2) inside a rectangle (2, 2) along two axes (2, 2), and the parts around it."""
    rest = np.column_stack([plan, np.zeros(len(plan))])
    around: list[FloatArray] = []
    for axis, (low, high) in zip(frame, corners.T, strict=True):
        for way, level in ((np.append(axis, 0.0), low), (-np.append(axis, 0.0), -high)):
            beside = behind(rest, way, float(level))
            if len(beside) and np.ptp(beside @ way) > _EXACT:
                around.append(beside[:, :2])
                rest = behind(rest, -way, -float(level))
    return rest[:, :2], around


def _prism(plan: FloatArray, levels: FloatArray) -> FloatArray:
    """Return the corners (2 k, 3) of an upright prism, those below first; without doubled corners of its plan (k, 2)."""
    own = plan[np.linalg.norm(plan - np.roll(plan, 1, axis=0), axis=1) > 1e-3 * _EXACT]
    return np.column_stack([np.tile(own, (2, 1)), np.repeat(levels, len(own))])


def _faces(corners: int) -> tuple[IntArray, IntArray]:
    """Return the corners of the faces of a prism of so many corners, one after another, and how many each face has."""
    count = corners // 2
    low, high = np.arange(count), np.arange(count) + count
    after = np.roll(low, -1)
    sides = np.stack([low, after, after + count, high], axis=1)
    return np.concatenate([low[::-1], high, sides.ravel()]), np.array([count, count, *[4] * count])


def _with_prisms(
    stones: Assemblage, plates: IntArray, pieces: list[FloatArray], moving: list[FloatArray]
) -> tuple[Assemblage, IntArray]:
    """Return stones with prisms (2 k, 3) in the place of plates (n,), and which of them the moving ones are."""
    solids = [*pieces, *moving]
    keep = np.setdiff1d(np.arange(stones.count), plates)
    counts = {name: np.diff(getattr(stones, name)) for name in ("block_point_ptr", "block_face_ptr", "face_ptr")}
    point = ragged_indices(stones.block_point_ptr[keep], counts["block_point_ptr"][keep])
    face = ragged_indices(stones.block_face_ptr[keep], counts["block_face_ptr"][keep])
    node = stones.face_nodes[ragged_indices(stones.face_ptr[face], counts["face_ptr"][face])]
    place = np.full(len(stones.points), -1)
    place[point] = np.arange(len(point))
    sizes = np.array([len(solid) for solid in solids])
    starts = len(point) + np.cumsum(sizes) - sizes
    made = [_faces(size) for size in sizes.tolist()]
    more, first = len(solids), plates[0]

    def chained(name: str, chosen: IntArray, own: IntArray) -> IntArray:
        return pointer_of(np.concatenate([counts[name][chosen], own]))

    names = [f"{stones.block_id[first]}-{i + 1}" for i in range(len(pieces))] + ["moving support"] * len(moving)
    if len(moving) > 1:
        names[len(pieces) :] = [f"moving support {i + 1}" for i in range(len(moving))]
    found = assemble(
        points=np.concatenate([stones.points[point], *solids]),
        face_nodes=np.concatenate([place[node], *(nodes + start for (nodes, _), start in zip(made, starts, strict=True))]),
        face_ptr=chained("face_ptr", face, np.concatenate([each for _, each in made])),
        block_face_ptr=chained("block_face_ptr", keep, np.array([len(each) for _, each in made])),
        block_point_ptr=chained("block_point_ptr", keep, sizes),
        unit_weight=np.concatenate([stones.unit_weight[keep], np.full(more, stones.unit_weight[first])]),
        material=np.concatenate([stones.material[keep], np.full(more, stones.material[first])]),
        panel=np.concatenate([stones.panel[keep], np.full(more, stones.panel[first])]),
        course=np.concatenate([stones.course[keep], np.full(more, -1)]),
        fixed=np.concatenate([stones.fixed[keep], np.ones(more, dtype=bool)]),
        block_id=np.concatenate([stones.block_id[keep], names]),
        butts=np.concatenate([stones.butts[keep], np.zeros(more, dtype=bool)]),
    )
    return found, np.arange(found.count - len(moving), found.count)
