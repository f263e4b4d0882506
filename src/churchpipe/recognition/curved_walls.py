"""Walls on an upright cylinder. They are recognised by wedge stones, whose two head joints turn about one axis."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.charts import along, normals
from churchpipe.geometry.clusters import clusters
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, ragged_indices
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import CylinderChart
from churchpipe.model.polyhedra import face_normals
from churchpipe.stones.raggedness import Raggedness, face_lengths

# Normals that differ by less than this are in one direction, rad.
TOLERANCE = 1e-4
# Corners less far off their circles than this, m, are on them but for the rounding of the computer.
_ROUND = 1e-8
# Axes found from single stones are taken as one if they differ by less than this, m. Short joints determine them only roughly.
AXIS_TOLERANCE = 1e-3
# So many times as far as corners are off, joints miss the axis: a stone is as much further from it than it is deep.
AXIS_OFF = 10.0
# Least number of stones of a wall.
LEAST_STONES = 3
# The stones of one panel name are a curved wall only if more than this share of their volume is on the cylinder.
LEAST_SHARE = 0.5
# So many steps of Newton bring a centre that is known to a millimetre to its place.
_STEPS = 3
# A chord comes nearer to the centre than its ends by less than this share of the thickness of its wall.
SAGITTA = 0.25
# If the distance of two neighbouring joints is this many times the usual one, an opening is between them, not a stone.
OPEN = 3.0


@dataclass(frozen=True, slots=True)
class CurvedWall:
    """A wall on a cylinder: its name ("" for stones without one), its stones (n,), chart and thickness m."""

    name: str
    stones: IntArray
    chart: CylinderChart
    thickness: float


@dataclass(frozen=True, slots=True)
class _Joints:
    """Upright faces without a parallel one in their stone: stone (n,), unit normal (n, 2), offset (n,) m."""

    stone: IntArray
    normal: FloatArray
    offset: FloatArray


def curved_walls(stones: Assemblage, base: float, ragged: Raggedness) -> tuple[list[CurvedWall], IntArray]:
    """Return the walls on cylinders among the free stones, by panel name; stones without a name are grouped by their axis.

    A wall extends along the arc between the two circles on which the corners of its wedge stones lie. It continues straight
    along the tangents as far as there are stones of its thickness. Where some of its wedge stones are cut, as beside an arched
    opening, the others tell the circles, and stones within the wall that have corners off them are returned beside the walls:
    they fit none. base: height of t = 0, m. ragged: how far corners lie off their walls.
    """
    joints = _turning_joints(stones, ragged)
    found: list[CurvedWall] = []
    used, cut = stones.fixed.copy(), np.zeros(stones.count, dtype=np.bool_)
    for wedges in _wedge_groups(stones, joints, ragged):
        chart, thickness = _cylinder(stones, joints, wedges, base, ragged)
        whole = chart is not None
        if chart is None and len(uncut := _uncut(stones, joints, wedges, ragged)) >= LEAST_STONES:
            chart, thickness = _cylinder(stones, joints, uncut, base, ragged)
        if chart is None:
            continue
        name = str(stones.panel[wedges[0]])
        free = np.flatnonzero((stones.panel == name) & ~used)
        own = free[_lies_on(stones, free, chart, thickness, ragged.flat)]
        share = stones.volume[own].sum() / stones.volume[free].sum() if len(free) else 0.0
        if len(own) >= LEAST_STONES and (not name or share > LEAST_SHARE):
            used[own] = True
            found.append(CurvedWall(name, own, chart, thickness))
            # Where walls have names, stones within one that have none fit none.
            asked = (stones.panel == name) & (not whole) | (stones.panel == "") & bool(name)
            beside = np.flatnonzero(asked & ~used)
            cut[beside[within_arc(stones, beside, chart, thickness)]] = True
    return found, np.flatnonzero(cut & ~used)


def curved_coordinates(chart: CylinderChart, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the chart coordinates (n, 2) of points (n, 3) and their distance (n,) outwards from the mid-surface, m.

    s of a full circle lies between 0 and its girth.
    """
    flat = np.stack([along(chart, points[:, :2]), points[:, 2] - chart.centre[2]], axis=1)
    return flat, np.einsum("nc,nc->n", points - chart.centre, normals(chart, flat)) - chart.radius


def _turning_joints(stones: Assemblage, ragged: Raggedness) -> _Joints:
    _, normal, mean = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    turn = ragged.turn(face_lengths(stones))
    owner: list[int] = []
    kept: list[IntArray] = []
    for block in np.flatnonzero(~stones.fixed):
        faces = np.arange(*stones.block_face_ptr[block : block + 2])
        faces = faces[np.abs(normal[faces, 2]) < TOLERANCE]
        most = np.maximum.outer(turn[faces], turn[faces])
        alone = faces[(normal[faces] @ normal[faces].T > most**2 / 2 - 1).all(axis=1)]
        owner += [int(block)] * len(alone)
        kept.append(alone)
    face = np.concatenate(kept) if kept else np.empty(0, dtype=np.int64)
    offset = np.einsum("fc,fc->f", normal[face, :2], mean[face, :2])
    return _Joints(np.array(owner, dtype=np.int64), normal[face, :2], offset)


def _wedge_groups(stones: Assemblage, joints: _Joints, ragged: Raggedness) -> Iterator[IntArray]:
    """Yield the wedge stones of one panel name and one axis, where there are enough of them."""
    wedges, axes = [], []
    for block in np.unique(joints.stone):
        rows = joints.stone == block
        normal = joints.normal[rows]
        if np.linalg.matrix_rank(normal, tol=TOLERANCE) == 2:
            wedges.append(int(block))
            axes.append(np.linalg.lstsq(normal, joints.offset[rows], rcond=None)[0])
    if not wedges:
        return
    wedge = np.array(wedges)
    names = np.unique(stones.panel[wedge], return_inverse=True)[1].astype(np.float64)
    label = clusters(np.column_stack([np.array(axes), names.ravel()]), max(AXIS_TOLERANCE, AXIS_OFF * ragged.counted))
    for number in np.unique(label):
        if (label == number).sum() >= LEAST_STONES:
            yield wedge[label == number]


def _cylinder(
    stones: Assemblage, joints: _Joints, wedges: IntArray, base: float, ragged: Raggedness
) -> tuple[CylinderChart | None, float]:
    """Return the chart of the wall that wedge stones stand in, without one where their corners lie on more than two circles."""
    rows = np.isin(joints.stone, wedges)
    centre = np.linalg.lstsq(joints.normal[rows], joints.offset[rows], rcond=None)[0].astype(np.float64)
    corner = _corners(stones, wedges)[0][:, :2]
    near, far, off = _circles(corner, centre)
    flat = ragged.flat
    if _ROUND < off < max(AXIS_TOLERANCE, AXIS_OFF * ragged.counted):
        centre = _centred(corner, centre)
        near, far, off = _circles(corner, centre)
    if off > flat:
        return None, 0.0
    # A stone that continues into a straight leg has one joint through the axis, too.
    radial = joints.stone[np.abs(joints.normal @ centre - joints.offset) < flat]
    ringed = np.unique(radial[stones.panel[radial] == stones.panel[wedges[0]]])
    spoke = _corners(stones, ringed)[0][:, :2] - centre
    reach = np.linalg.norm(spoke, axis=1)
    spoke = spoke[(np.abs(reach - near) < flat) | (np.abs(reach - far) < flat)]
    if not len(spoke):
        return None, 0.0
    angle = np.sort(np.arctan2(spoke[:, 1], spoke[:, 0]))
    gap = np.diff(angle, append=angle[0] + 2 * np.pi)
    steps = gap[gap > flat / near]
    widest = int(np.argmax(gap))
    start = float(angle[(widest + 1) % len(angle)])
    sweep = 2 * np.pi - float(gap[widest]) if gap[widest] > OPEN * np.median(steps) else 2 * np.pi
    return CylinderChart(np.array([*centre, base]), 0.5 * (near + far), start, sweep), round(far - near, 9)


def _uncut(stones: Assemblage, joints: _Joints, wedges: IntArray, ragged: Raggedness) -> IntArray:
    """Return those of the wedge stones about one axis that have all corners on the two circles on which most corners lie."""
    rows = np.isin(joints.stone, wedges)
    centre = np.linalg.lstsq(joints.normal[rows], joints.offset[rows], rcond=None)[0].astype(np.float64)
    # The joints tell the centre roughly, and the corners of whole stones tell it better.
    for tolerance in (max(AXIS_TOLERANCE, AXIS_OFF * ragged.counted), ragged.flat):
        corner, owner = _corners(stones, wedges)
        radius = np.linalg.norm(corner[:, :2] - centre, axis=1)
        near, far, _ = _circles(corner[:, :2], centre)
        off = np.minimum(np.abs(radius - near), np.abs(radius - far)) > tolerance
        wedges = wedges[np.bincount(owner, off, minlength=len(wedges)) == 0]
        if len(wedges) < LEAST_STONES:
            break
        centre = _centred(_corners(stones, wedges)[0][:, :2], centre)
    return wedges


def _circles(corner: FloatArray, centre: FloatArray) -> tuple[float, float, float]:
    """Return the radii of the two circles about a centre that corners (n, 2) lie on, and how far they lie off them at most, m."""
    radius = np.linalg.norm(corner - centre, axis=1)
    outside = radius > 0.5 * (radius.min() + radius.max())
    near, far = float(np.median(radius[~outside])), float(np.median(radius[outside]))
    return near, far, float(np.abs(radius - np.where(outside, far, near)).max())


def _centred(corner: FloatArray, centre: FloatArray) -> FloatArray:
    """Return the centre (2,) from which corners (n, 2) on two circles, off by their rounding, lie off these least in the mean."""
    for _ in range(_STEPS):
        spoke = corner - centre
        radius = np.linalg.norm(spoke, axis=1)
        outside = radius > 0.5 * (radius.min() + radius.max())
        unknown = np.column_stack([spoke / radius[:, None], outside, ~outside])
        centre = centre + np.linalg.lstsq(unknown, radius, rcond=None)[0][:2]
    return centre


def points_of(stones: Assemblage, blocks: IntArray) -> IntArray:
    """Return the numbers of the corners of some stones."""
    return ragged_indices(stones.block_point_ptr[blocks], np.diff(stones.block_point_ptr)[blocks])


def _corners(stones: Assemblage, blocks: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the corners (n, 3) m of some stones, and the place of each one's stone among them (n,)."""
    count = np.diff(stones.block_point_ptr)[blocks]
    return stones.points[points_of(stones, blocks)], np.repeat(np.arange(len(blocks)), count)


def _lies_on(stones: Assemblage, blocks: IntArray, chart: CylinderChart, thickness: float, flat: float) -> BoolArray:
    """Return which stones have all their corners on the two faces of a wall, to `flat` m."""
    points, owner = _corners(stones, blocks)
    distance = curved_coordinates(chart, points)[1]
    off = np.abs(np.abs(distance) - 0.5 * thickness) > flat
    return np.bincount(owner, off, minlength=len(blocks)) == 0


def within_arc(stones: Assemblage, blocks: IntArray, chart: CylinderChart, thickness: float) -> BoolArray:
    """Return which stones lie between the two faces of the round part of a wall, but for the depth of a chord."""
    points, owner = _corners(stones, blocks)
    place, outwards = curved_coordinates(chart, points)
    half = 0.5 * chart.radius * chart.sweep
    beyond = np.abs(place[:, 0] - half) > half + AXIS_TOLERANCE
    off = beyond | (np.abs(outwards) > (0.5 + SAGITTA) * thickness)
    return np.bincount(owner, off, minlength=len(blocks)) == 0
