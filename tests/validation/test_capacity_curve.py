"""Capacity curves at large displacements against closed forms and independent rigid-body calculations written here.

Rocking block (Housner 1963): alpha = (b/2 - d)/sqrt(R^2 - (b/2 - d)^2), R half the diagonal, d the displacement of the centroid,
so that d0 = b/2. Two-block wall and arch: linkages, their load factor by virtual work in the displaced geometry.
"""

import itertools

import numpy as np
import pytest
from scipy.optimize import brentq, linprog

from churchpipe.generators import arch
from churchpipe.large_displacements.pushover import block_pushover
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.loads import LoadCase
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground

PUSH = LoadCase((1, 0, 0))
BLOCKS = pytest.mark.slow("docs/capacity_curve.md: rocking blocks and stacks")
ARCH = pytest.mark.slow("docs/capacity_curve.md: arch, its hinges travel")


def curve_of(stones: Assemblage, friction: float, **options: float) -> BlockCapacityCurve:
    return block_pushover(stones, find_contacts(stones), PUSH, friction, **options)


def assert_certified(curve: BlockCapacityCurve) -> None:
    assert curve.residual.max() < 1e-8
    assert curve.violation.max() < 1e-8
    assert curve.proved


def energies(stones: Assemblage, curve: BlockCapacityCurve) -> tuple[float, float]:
    """The work of the lateral load, and what weight and friction have taken of it."""
    weight = stones.weight
    work = np.trapezoid(curve.load_factor, curve.displacement) * weight.sum()
    lifted = (curve.position[-1, :, 2] - curve.position[0, :, 2]) @ weight
    return float(work), float(lifted + curve.dissipation[-1])


@pytest.mark.parametrize(
    ("step", "courses"),
    [
        (0.05, 1),
        pytest.param(0.05, 8, marks=BLOCKS),
        pytest.param(0.0125, 1, marks=BLOCKS),
        pytest.param(0.0125, 8, marks=BLOCKS),
    ],
)
def test_rocking_block_and_stack(courses: int, step: float) -> None:
    b, h = 0.5, 4.0
    stones = on_ground(*[box((0, b), (0, 1), (h * i / courses, h * (i + 1) / courses)) for i in range(courses)])
    curve = curve_of(stones, 0.7, step=step)
    lever = b / 2 - curve.displacement
    expected = lever / np.sqrt((b**2 + h**2) / 4 - lever**2)
    assert curve.status == "vanished"
    assert curve.load_factor == pytest.approx(expected, abs=1e-7)
    assert curve.d0 == pytest.approx(b / 2, abs=1e-6)
    assert_certified(curve)
    assert curve.misfit.max() < 1e-5
    work, taken = energies(stones, curve)
    assert work == pytest.approx(taken, rel=1e-4)


def test_corner_wedge_that_leans_out_of_two_walls() -> None:
    # The wedge of an overturning corner, wider at its top, on a pedestal that ends across the diagonal: it rocks about that edge.
    foot, top, edge, h = 0.5, 0.8, 0.2, 2.0
    low = [(1, 1 - foot, 0), (1, 1, 0), (1 - foot, 1, 0)]
    high = [(1, 1 - top, h), (1, 1, h), (1 - top, 1, h)]
    wedge = np.array([*low, *high], dtype=float), [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]
    plan = [(-1, -1), (1, -1), (1, 1 - edge), (1 - edge, 1), (-1, 1)]
    below = np.array([(x, y, z) for z in (-1, 0) for x, y in plan], dtype=float)
    sides = [[i, (i + 1) % 5, (i + 1) % 5 + 5, i + 5] for i in range(5)]
    stones = Assemblage.from_polyhedra([(below, [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], *sides]), wedge], 18e3, fixed=[0])
    push = LoadCase((1, 1, 0))
    curve = block_pushover(stones, find_contacts(stones), push, 0.7, step=0.01)
    centre = stones.centroid[1]
    lever, height = (2 - edge - centre[0] - centre[1]) / np.sqrt(2), centre[2]
    left = lever - curve.displacement
    assert curve.status == "vanished"
    assert curve.load_factor == pytest.approx(left / np.sqrt(lever**2 + height**2 - left**2), abs=1e-6)
    assert curve.d0 == pytest.approx(lever, abs=1e-6)
    assert_certified(curve)
    work, taken = energies(stones, curve)
    assert work == pytest.approx(taken, rel=1e-3)


def test_sliding_block_keeps_its_friction() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 0.5)))
    curve = curve_of(stones, 0.4, step=0.05, furthest=0.6)
    assert curve.status == "unfinished"
    assert "0.6 m" in curve.message
    assert curve.load_factor == pytest.approx(0.4, abs=1e-7)
    # It never leaves the ground.
    assert np.ptp(curve.position[:, 1, 2]) < 1e-7
    work, taken = energies(stones, curve)
    assert work == pytest.approx(taken, rel=1e-6)


@pytest.mark.slow
def test_block_that_slides_off_a_pedestal_tips_when_its_centre_nears_the_edge() -> None:
    # min(mu, (b/2 - s)/(h/2)) with the slip s: it slides until .44 m and rocks about the pedestal's edge from then on.
    b, h, friction = 1.0, 0.3, 0.4
    stones = Assemblage.from_polyhedra([box((0, b), (0, 1), (-h, 0)), box((0, b), (0, 1), (0, h))], 18e3, fixed=[0])
    curve = curve_of(stones, friction, step=0.02)
    slides = np.ptp(curve.rotation[:, 1], axis=1) < 1e-6
    assert curve.status == "vanished"
    assert curve.load_factor[slides] == pytest.approx(
        np.minimum(friction, (b / 2 - curve.displacement[slides]) / (h / 2)), abs=1e-5
    )
    centre = curve.position[:, 1] - [b, 0, 0]
    assert curve.load_factor[~slides] == pytest.approx((-centre[:, 0] / centre[:, 2])[~slides], abs=1e-4)
    assert curve.d0 == pytest.approx(b / 2, rel=1e-3)
    # Friction takes its share of the whole of the last step that slides, though nothing slides any more where that ends.
    work, taken = energies(stones, curve)
    assert work == pytest.approx(taken, rel=1e-3)


@BLOCKS
@pytest.mark.parametrize(("breadth", "d0"), [(0.3, 0.15), (0.36, 0.18)])
def test_stack_that_may_slide(breadth: float, d0: float) -> None:
    # .3: it rocks as one; .36: it slides first, mu = .35 < .36, and d0 may lie a little further.
    stones = on_ground(*[box((0, breadth), (0, 1), (i / 8, (i + 1) / 8)) for i in range(8)])
    curve = curve_of(stones, 0.35, step=0.01)
    assert curve.load_factor[0] == pytest.approx(min(breadth, 0.35), abs=1e-6)
    assert curve.d0 == pytest.approx(d0, rel=1e-5 if breadth < 0.35 else 1e-2)
    assert_certified(curve)


def test_wall_of_two_blocks_that_leans_on_a_prop() -> None:
    thickness, low, high, foot = 0.3, 1.6, 1.4, 2.9
    prop = box((thickness, 0.6), (0, 1), (foot, 3.6))
    wall = [box((0, thickness), (0, 1), (0, low)), box((0, thickness), (0, 1), (low, low + high))]
    stones = Assemblage.from_polyhedra([box((-5, 5), (-5, 5), (-1, 0)), prop, *wall], 18e3, fixed=[0, 1])
    contacts = find_contacts(stones)
    friction = np.where((contacts.blocks == 1).any(axis=1), 0.0, 0.7)
    curve = block_pushover(stones, contacts, PUSH, friction, step=0.02)
    angle = np.linspace(0, 0.3, 6001)
    parts = [_two_blocks(a, thickness, low, high, foot) for a in angle]
    centre, hinge = (np.array(part) for part in zip(*parts, strict=True))
    weight = np.array([low, high]) / (low + high)
    x, z = centre[:, :, 0] @ weight, centre[:, :, 1] @ weight
    rises = np.gradient(z, angle, edge_order=2) / np.gradient(x, angle, edge_order=2)
    expected = np.interp(curve.displacement, x - x[0], rises)
    assert curve.load_factor == pytest.approx(expected, abs=1e-4)
    assert_certified(curve)
    work, taken = energies(stones, curve)
    assert work == pytest.approx(taken, rel=2e-3)
    # Nothing holds the upper block on the other side: it falls back when its centre passes its hinge, before the load vanishes.
    overhang = np.interp(curve.displacement, x - x[0], centre[:, 1, 0] - hinge[:, 0])
    assert curve.status == "collapsed"
    assert 0 < overhang[-1] < 2 * (overhang[-2] - overhang[-1])


def _two_blocks(angle: float, thickness: float, low: float, high: float, foot: float) -> tuple[FloatArray, FloatArray]:
    """Centroids (2, 2) x, z and the hinge between: the lower block has turned about its toe, the upper one leans on it and on the
    foot of the prop."""

    def turned(a: float, x: float, z: float) -> FloatArray:
        return np.array([x * np.cos(a) + z * np.sin(a), z * np.cos(a) - x * np.sin(a)])

    toe, prop = np.array([thickness, 0.0]), np.array([thickness, foot])
    hinge = toe + turned(angle, -thickness, low)
    # The upper block's face, `thickness` from the hinge in its own axes, passes through the foot of the prop.
    back = brentq(lambda a: float(turned(-a, *(prop - hinge))[0]) - thickness, -1.0, 0.5)
    return np.array([toe + turned(angle, -thickness / 2, low / 2), hinge + turned(back, thickness / 2, high / 2)]), hinge


RADIUS, DEPTH, VOUSSOIRS = 1.0, 0.2, 24
# Of the weight: a hundredth of what is missing at the first step past such an edge.
UNBALANCED = 1e-5


def _corner(joint: float, side: float) -> FloatArray:
    angle = np.pi * joint / VOUSSOIRS
    # Straight-sided voussoirs: the corners of the joints lie on the circles.
    return (RADIUS + side * DEPTH / 2) * np.array([-np.cos(angle), np.sin(angle)])


@pytest.fixture(scope="module")
def pushed_arch() -> tuple[Assemblage, BlockCapacityCurve]:
    stones = derive_blocks(arch(mean_radius=RADIUS, thickness=DEPTH, width=1.0, voussoirs=VOUSSOIRS))
    return stones, curve_of(stones, 0.75, step=0.005)


def test_arch_as_a_linkage_of_four_hinges() -> None:
    stones = derive_blocks(arch(mean_radius=RADIUS, thickness=DEPTH, width=1.0, voussoirs=VOUSSOIRS))
    curve = curve_of(stones, 0.75, step=0.005, steps=10)
    assert curve.residual.max() < 1e-8
    assert curve.violation.max() < 1e-8
    assert curve.load_factor[0] == pytest.approx(0.284226, abs=1e-6)
    assert curve.load_factor[:9] == pytest.approx(_linkage(stones, curve.displacement[:9]), abs=1e-4)
    # There its hinges begin to travel.
    assert curve.proved_steps == 9
    assert curve.misfit[9] > 0.1
    assert "step 10 is no equilibrium: from 16 mm on the structure jumps" in curve.message


@ARCH
def test_arch_as_a_linkage_of_four_hinges_and_beyond(pushed_arch: tuple[Assemblage, BlockCapacityCurve]) -> None:
    stones, curve = pushed_arch
    assert curve.status == "vanished"
    assert curve.residual.max() < 1e-8
    assert curve.violation.max() < 1e-8
    first = curve.displacement < 0.0145
    assert curve.proved_steps == first.sum()
    expected = _linkage(stones, curve.displacement[first])
    assert curve.load_factor[0] == pytest.approx(0.284226, abs=1e-6)
    assert curve.load_factor[first] == pytest.approx(expected, abs=1e-4)
    # The hinges travel, so that the arch loses its strength long before the first linkage would.
    assert curve.d0 == pytest.approx(0.0371, rel=5e-3)
    assert _linkage(stones, np.array([0.0375]))[0] > 0.06


@ARCH
def test_forces_of_the_displaced_arch(pushed_arch: tuple[Assemblage, BlockCapacityCurve]) -> None:
    stones, curve = pushed_arch
    differences = []
    for step in range(len(curve.displacement)):
        value = _thrust_line(stones, curve, step)
        if np.isfinite(value):
            differences.append(value - curve.load_factor[step])
    assert len(differences) > 10
    assert np.abs(differences).max() < 1e-4


@ARCH
def test_a_step_is_proved_where_a_line_of_thrust_goes_through_closed_joints(
    pushed_arch: tuple[Assemblage, BlockCapacityCurve],
) -> None:
    """Where hinges travel the arch jumps: no forces across closed joints hold it, under whatever load."""
    stones, curve = pushed_arch
    held = np.isfinite([_thrust_line(stones, curve, step, closed=1e-4) for step in range(len(curve.displacement))])
    loosely = np.isfinite([_thrust_line(stones, curve, step, closed=1e-3) for step in range(len(curve.displacement))])
    proved = curve.misfit < 0.01
    # Where a step falls on the way is a matter of rounding, and so is one of them.
    assert len(held) - held.sum() in (14, 15)
    assert (proved == held).all()
    assert (loosely != held).sum() <= 1
    assert curve.misfit[~proved].min() > 0.1
    assert "steps 10 to 20 are no equilibria: from 16 mm on the structure jumps" in curve.message


def _linkage(stones: Assemblage, displacement: FloatArray) -> FloatArray:
    """Load factor of the linkage with hinges at joints 2, 10, 18, 24 at mean displacements of the weight (n,)."""
    hinges = [_corner(k, side) for k, side in zip((2, 10, 18, 24), (-1, 1, -1, 1), strict=True)]
    centre = stones.centroid[~stones.fixed][:, [0, 2]]
    weight = stones.weight[~stones.fixed] / stones.weight.sum()
    joint = np.degrees(np.arctan2(centre[:, 1], -centre[:, 0])) * VOUSSOIRS / 180
    part = np.digitize(joint, (2, 10, 18, 24))
    lengths = [float(np.linalg.norm(hinges[i + 1] - hinges[i])) for i in range(3)]
    angles = np.linspace(0.0, 0.4, 4001)
    path = []
    bearing = [np.arctan2(*(hinges[i + 1] - hinges[i])[::-1]) for i in range(3)]
    for turn in angles:
        b = hinges[0] + lengths[0] * np.array([np.cos(bearing[0] - turn), np.sin(bearing[0] - turn)])
        reach = hinges[3] - b
        span = float(np.linalg.norm(reach))
        inner = np.arccos((lengths[1] ** 2 + span**2 - lengths[2] ** 2) / (2 * lengths[1] * span))
        middle = np.arctan2(reach[1], reach[0]) + inner
        c = b + lengths[1] * np.array([np.cos(middle), np.sin(middle)])
        last = np.arctan2(*(hinges[3] - c)[::-1])
        moved = centre.copy()
        for number, (start, old, new) in enumerate(
            zip((hinges[0], b, c), bearing, (bearing[0] - turn, middle, last), strict=True)
        ):
            cos, sin = np.cos(new - old), np.sin(new - old)
            arm = centre[part == number + 1] - hinges[number]
            moved[part == number + 1] = start + arm @ np.array([[cos, sin], [-sin, cos]])
        path.append(weight @ moved)
    x, z = np.array(path).T
    return np.interp(displacement, x - x[0], np.gradient(z, angles, edge_order=2) / np.gradient(x, angles, edge_order=2))


def _thrust_line(stones: Assemblage, curve: BlockCapacityCurve, step: int, closed: float = 1e-4) -> float:
    """The largest load factor that forces at the closed corners of the joints carry, in the plane; NaN where there is none.

    They carry it where no more than `UNBALANCED` of the weight, and of its moment about a place one metre off, is missing.
    """
    free = np.flatnonzero(~stones.fixed)
    order = free[np.argsort(stones.centroid[free, 0])]
    rotation = -curve.rotation[step, :, 1]

    def placed(stone: int, point: FloatArray) -> FloatArray:
        if stones.fixed[stone]:
            return point
        cos, sin = np.cos(rotation[stone]), np.sin(rotation[stone])
        arm = point - stones.centroid[stone, [0, 2]]
        return curve.position[step, stone, [0, 2]] + np.array([[cos, -sin], [sin, cos]]) @ arm

    ground = np.flatnonzero(stones.fixed)[0]
    chain = [int(ground), *order.tolist(), int(ground)]
    columns, limit = [], []
    for joint, (before, after) in enumerate(itertools.pairwise(chain)):
        sides = [[placed(stone, _corner(joint, side)) for side in (-1.0, 1.0)] for stone in (before, after)]
        along = np.subtract(*sides[1][::-1])
        along /= np.linalg.norm(along)
        n = np.array([along[1], -along[0]])
        for corner in (0, 1):
            if abs((sides[1][corner] - sides[0][corner]) @ n) > closed:
                continue
            for direction in (n + 0.75 * along, n - 0.75 * along):
                column = np.zeros(3 * VOUSSOIRS)
                for stone, sign in ((joint - 1, -1.0), (joint, 1.0)):
                    if 0 <= stone < VOUSSOIRS:
                        arm = sides[1][corner] - curve.position[step, order[stone], [0, 2]]
                        force = sign * direction
                        column[3 * stone : 3 * stone + 3] = [*force, arm[0] * force[1] - arm[1] * force[0]]
                columns.append(column)
                limit.append((0, None))
    weight = stones.weight[order] / stones.weight.sum()
    load, dead = np.zeros(3 * VOUSSOIRS), np.zeros(3 * VOUSSOIRS)
    load[0::3], dead[1::3] = weight, -weight
    # Where a hinge goes over to the next joint, a step lies at the edge of what forces can hold: on one side or the other of it.
    missing = np.hstack([np.eye(len(load)), -np.eye(len(load))])
    found = linprog(
        np.concatenate([np.zeros(len(columns)), [-1.0], np.zeros(missing.shape[1])]),
        A_ub=np.concatenate([np.zeros(len(columns) + 1), np.ones(missing.shape[1])])[None],
        b_ub=[UNBALANCED],
        A_eq=np.column_stack([*columns, load, missing]),
        b_eq=-dead,
        bounds=[*limit, (None, None), *[(0, None)] * missing.shape[1]],
    )
    return float(found.x[len(columns)]) if found.status == 0 else float("nan")
