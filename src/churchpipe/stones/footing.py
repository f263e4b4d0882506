"""The part of the ground that a movement takes along: the foot of a wall, a fixed stone, or a rectangle of the plan."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray, ragged_indices
from churchpipe.model.assemblage import Assemblage, assemble
from churchpipe.model.contacts import Contacts

Rectangle = tuple[tuple[float, float], tuple[float, float]]
# Ground is an upright box, and a strip of it no piece, within this length, m.
_EXACT = 1e-6


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

    place: a fixed stone; or a wall: what its stones stand on, and where others stand there, too, the rectangle around its foot;
    or two opposite corners (x, y) of a rectangle.

    Raises
    ------
    InputError: neither a wall nor a fixed stone, a wall that does not reach the ground, nothing within the rectangle, ground that
        is no upright box and cannot be cut.
    """
    if not isinstance(place, str):
        (x0, y0), (x1, y1) = place
        corners = np.array([[min(x0, x1), min(y0, y1)], [max(x0, x1), max(y0, y1)]])
        return _cut(stones, contacts, corners, f"from {corners[0].tolist()} to {corners[1].tolist()} m")
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
    return _cut(stones, contacts, np.array([points.min(axis=0), points.max(axis=0)]), f"below {place}")


def _cut(stones: Assemblage, contacts: Contacts, corners: FloatArray, words: str) -> Footing:
    """Return stones whose ground is cut along the sides of a rectangle (2, 2), lowest and highest x and y."""
    inside = ((contacts.point[:, :2] > corners[0] - _EXACT) & (contacts.point[:, :2] < corners[1] + _EXACT)).all(axis=1)
    fixed = stones.fixed[contacts.blocks]
    bears = fixed[:, 0] != fixed[:, 1]
    stands = inside & bears[contacts.interface_of_point]
    pairs = contacts.blocks[contacts.interface_of_point[stands]].ravel()
    plates = np.unique(pairs[stones.fixed[pairs]])
    if not len(plates):
        raise InputError("support", "nothing stands on the ground there", found=words, expected="a rectangle with stones in it")
    pieces: list[FloatArray] = []
    moving: list[FloatArray] = []
    for plate in plates:
        points = stones.points[stones.block_point_ptr[plate] : stones.block_point_ptr[plate + 1]]
        box = np.array([points.min(axis=0), points.max(axis=0)])
        if len(points) != 8 or np.abs(np.sort(points, axis=0) - np.repeat(box, 4, axis=0)).max() > _EXACT:
            raise InputError(
                "support",
                "ground that cannot be cut",
                found=f"{stones.block_id[plate]}, which is no upright box",
                expected="an upright box, or a support that is a fixed stone of its own",
            )
        middle, around = _pieces(box, corners)
        moving.append(middle)
        pieces += around
    return Footing(*_with_boxes(stones, plates, pieces, moving), cut=True)


def _pieces(box: FloatArray, corners: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
    """Return the part of a box (2, 3) inside a rectangle (2, 2), and the parts around it."""
    (x0, y0), (x1, y1) = np.clip(corners, box[0, :2], box[1, :2])
    (low_x, low_y, low), (high_x, high_y, high) = box
    spans = [
        ((low_x, x0), (low_y, high_y)),
        ((x1, high_x), (low_y, high_y)),
        ((x0, x1), (low_y, y0)),
        ((x0, x1), (y1, high_y)),
    ]
    around = [np.array([[a, c, low], [b, d, high]]) for (a, b), (c, d) in spans if min(b - a, d - c) > _EXACT]
    return np.array([[x0, y0, low], [x1, y1, high]]), around


def _with_boxes(
    stones: Assemblage, plates: IntArray, pieces: list[FloatArray], moving: list[FloatArray]
) -> tuple[Assemblage, IntArray]:
    """Return stones with boxes (2, 3) in the place of plates (k,), and which of them the moving boxes are."""
    boxes = [*pieces, *moving]
    keep = np.setdiff1d(np.arange(stones.count), plates)
    counts = {name: np.diff(getattr(stones, name)) for name in ("block_point_ptr", "block_face_ptr", "face_ptr")}
    point = ragged_indices(stones.block_point_ptr[keep], counts["block_point_ptr"][keep])
    face = ragged_indices(stones.block_face_ptr[keep], counts["block_face_ptr"][keep])
    node = stones.face_nodes[ragged_indices(stones.face_ptr[face], counts["face_ptr"][face])]
    place = np.full(len(stones.points), -1)
    place[point] = np.arange(len(point))
    corner = np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)])
    sides = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]])
    solids = [np.take_along_axis(box, corner, axis=0) for box in boxes]
    more, first = len(boxes), plates[0]

    def chained(name: str, chosen: IntArray, each: int, number: int) -> IntArray:
        return np.concatenate([[0], np.cumsum(np.concatenate([counts[name][chosen], np.full(number, each)]))])

    names = [f"{stones.block_id[first]}-{i + 1}" for i in range(len(pieces))] + ["moving support"] * len(moving)
    if len(moving) > 1:
        names[len(pieces) :] = [f"moving support {i + 1}" for i in range(len(moving))]
    found = assemble(
        points=np.concatenate([stones.points[point], *solids]),
        face_nodes=np.concatenate([place[node], *(sides.ravel() + len(point) + 8 * i for i in range(more))]),
        face_ptr=chained("face_ptr", face, 4, 6 * more),
        block_face_ptr=chained("block_face_ptr", keep, 6, more),
        block_point_ptr=chained("block_point_ptr", keep, 8, more),
        unit_weight=np.concatenate([stones.unit_weight[keep], np.full(more, stones.unit_weight[first])]),
        material=np.concatenate([stones.material[keep], np.full(more, stones.material[first])]),
        panel=np.concatenate([stones.panel[keep], np.full(more, stones.panel[first])]),
        course=np.concatenate([stones.course[keep], np.full(more, -1)]),
        fixed=np.concatenate([stones.fixed[keep], np.ones(more, dtype=bool)]),
        block_id=np.concatenate([stones.block_id[keep], names]),
        butts=np.concatenate([stones.butts[keep], np.zeros(more, dtype=bool)]),
    )
    return found, np.arange(found.count - len(moving), found.count)
