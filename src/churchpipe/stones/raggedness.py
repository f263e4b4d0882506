"""How far the corners of a drawing lie off the faces of its walls, as its stones tell, and what is one plane therefore."""

from dataclasses import dataclass

import numpy as np

from churchpipe.model.arrays import FloatArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# Rounded coordinates turn the faces of a stone by up to this, rad, and move them by up to this, m: a drawing in millimetres with
# one decimal has stones of .1 m whose faces turn by so much. What is rounded less is treated as if it were rounded so.
TURN, FLAT = 2e-3, 5e-4
# Faces so short that rounding may turn them further than this, rad, tell nothing of their wall.
_TELLING = 0.02
# Opposite faces that are further from parallel than this, rad, are a wedge that was drawn so.
_WEDGE = 0.1
# Mean square of the smaller one of two values, normally distributed, over that of either.
_SMALLER = 1 - 2 / np.pi
# Corners may be off by this share of the thickness of the median stone in plan. A wall whose corners are off so far on both
# faces is as thick as its stones only to twice that, which is what the match gate allows.
_MOST = 0.01
# Fewer stones of a wall than this share are ragged because each was drawn so.
_SHARE = 0.1
# Faces that miss one another by less than this, m, are parallel but for the rounding of the computer.
_PARALLEL = 1e-8
# Faces with a normal that rises by more than this are not upright.
_UPRIGHT = 1e-4


@dataclass(frozen=True, slots=True)
class Raggedness:
    """How far corners lie off the faces of their walls, m, 0 where these are straight, and how far they may."""

    off: float = 0.0
    most: float = np.inf

    @property
    def too_much(self) -> bool:
        """Whether corners are too far off to tell walls by them."""
        return self.off > self.most

    @property
    def counted(self) -> float:
        """How far corners may be off to be taken for straight, m; 0 where they are too far off."""
        return 0.0 if self.too_much else self.off

    @property
    def flat(self) -> float:
        """How far apart corners, or the middles of stones, may be that lie in one plane, m: they lie on both sides of it."""
        return max(FLAT, 2.0 * self.counted)

    def turn(self, length: FloatArray) -> FloatArray:
        """Return how far faces of these lengths (n,) m may be turned, rad."""
        return np.clip(2.0 * self.counted / np.maximum(length, 1e-9), TURN, _TELLING)


# Walls whose faces are straight.
STRAIGHT = Raggedness()


def raggedness(stones: Assemblage) -> Raggedness:
    """Return how far corners of stones lie off their walls, as opposite upright faces tell that are not quite parallel.

    Each of the four corners of such a pair is off by an amount of its own, s in the mean square in each direction, so the two
    sides miss one another by 2 s; the coordinates of a rounded corner are evenly distributed, and off by 3 ** .5 s at most, the
    corner by 6 ** .5 s. Only stones without any parallel pair tell, and of each the pair that misses less: the ends of a stone
    cut to a large circle are not parallel by design.
    """
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    length = face_lengths(stones)
    block = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    upright = np.flatnonzero((np.abs(normal[:, 2]) < _UPRIGHT) & ~stones.fixed[block])
    of_block = np.bincount(block[upright], minlength=stones.count)
    count = of_block[block[upright]]
    one = np.repeat(upright, count)
    other = upright[ragged_indices((np.cumsum(of_block) - of_block)[block[upright]], count)]
    opposite = np.einsum("pc,pc->p", normal[one], normal[other]) < -np.cos(_WEDGE)
    one, other = one[opposite], other[opposite]
    sine = np.abs(normal[one, 0] * normal[other, 1] - normal[one, 1] * normal[other, 0])
    missed_by = np.full(stones.count, np.inf)
    np.minimum.at(missed_by, block[one], sine * np.minimum(length[one], length[other]))
    # Of a round wall rounding shows at any angle, of the plane ones beside it not along the axes.
    told = np.zeros(stones.count, dtype=np.bool_)
    for name in np.unique(stones.panel):
        own = np.flatnonzero((stones.panel == name) & np.isfinite(missed_by))
        ragged = own[missed_by[own] > _PARALLEL]
        told[ragged] = len(ragged) > _SHARE * len(own)
    if not told.any():
        return STRAIGHT
    # A wall is as thick as its stones are in plan, however low its courses are.
    thickness = np.full(stones.count, np.inf)
    np.minimum.at(thickness, block[one], np.abs(np.einsum("pc,pc->p", mean[other] - mean[one], normal[one])))
    typical = float(np.median(thickness[np.isfinite(thickness)]))
    return Raggedness(0.5 * float(np.sqrt(6.0 / _SMALLER * np.mean(np.square(missed_by[told])))), _MOST * typical)


def face_lengths(stones: Assemblage) -> FloatArray:
    """Return how long each face (nf,) is in plan, m, along its level direction."""
    _, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    count = np.diff(stones.face_ptr)
    level = np.repeat(np.stack([-normal[:, 1], normal[:, 0]], axis=1), count, axis=0)
    place = np.einsum("nc,nc->n", stones.points[stones.face_nodes, :2], level)
    start = stones.face_ptr[:-1]
    return np.maximum.reduceat(place, start) - np.minimum.reduceat(place, start)
