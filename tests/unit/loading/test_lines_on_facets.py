"""Lines of load on the facets of a shell: the work of what reaches corners and mid-sides is that of the line itself.

An element whose membrane has linear strain moves by any field that is quadratic in the plane of its wall, corner by corner and
mid-side by mid-side, so that the work of the forces there must be the integral of load and motion along the line: worked out
here by hand, as an integral of polynomials.
"""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.homogenised_shell.element import ShellElements, shell_elements
from churchpipe.homogenised_shell.loads import dead_load, live_load
from churchpipe.loading.bearing import pressed_length
from churchpipe.loading.lines import shares_within
from churchpipe.loading.wrenches import resultant
from churchpipe.model.placed_loads import PlacedLoads
from churchpipe.model.shell import ShellModel
from shell_meshes import grid, shell, wall_points

LENGTH, HEIGHT = 2.0, 1.2
STONES = generators.wall(length=LENGTH, brick=(0.25, 0.25, 0.1), courses=12)


def crooked_wall() -> ShellModel:
    """A wall in the plane y = 0, its inner nodes moved about."""
    points, triangles = grid(7, 5, LENGTH, HEIGHT)
    inside = (points > 1e-9).all(axis=1) & (points < np.array([LENGTH, HEIGHT]) - 1e-9).all(axis=1)
    points[inside] += np.random.default_rng(3).uniform(-0.03, 0.03, (int(inside.sum()), 2))
    return shell(wall_points(points), triangles, thickness=0.25, surface_weight=1e3, supported=lambda p: p[:, 2] < 1e-9)


def motion(at: np.ndarray) -> np.ndarray:
    """A motion (n, 3) in the plane of the wall, quadratic in x and z."""
    x, z = at[:, 0], at[:, 2]
    along = 0.3 + 0.2 * x - 0.4 * z + 0.7 * x * x - 0.1 * x * z + 0.2 * z * z
    up = -0.1 + 0.5 * x + 0.3 * z - 0.6 * x * x + 0.8 * x * z - 0.3 * z * z
    return np.stack([along, np.zeros(len(at)), up], axis=1)


def as_unknowns(elements: ShellElements) -> np.ndarray:
    """The unknowns that describe `motion`."""
    points, ends = elements.shell.points, elements.edges.nodes
    nodes = motion(points)
    beyond = motion(points[ends].mean(axis=1)) - nodes[ends].mean(axis=1)
    bubbles = np.einsum("bc,bc->b", beyond[elements.bubble_edge], elements.bubble_direction)
    return np.concatenate([nodes.ravel(), np.zeros(len(ends)), bubbles])


def placed(start: np.ndarray, end: np.ndarray, force: np.ndarray, parts: int, lean: float) -> PlacedLoads:
    """A line from start to end whose density over the mean is 1 + 3 lean s, s from -1 to 1, in parts of one length."""
    stops = np.linspace(-1.0, 1.0, parts + 1)
    low, high = stops[:-1], stops[1:]
    share = (high - low) / 2 + 3 * lean * (high**2 - low**2) / 4
    moment = (high**2 - low**2) / 4 + lean * (high**3 - low**3) / 2
    way, middle = (end - start) / 2, (start + end) / 2
    return PlacedLoads(
        point=middle + (moment / share)[:, None] * way,
        foot=middle + ((low + high) / 2)[:, None] * way,
        reach=((high - low) / 2)[:, None] * way,
        stone=np.zeros(parts, dtype=np.int64),
        wall=np.full(parts, "wall"),
        load=np.full(parts, "line"),
        dead=share[:, None] * force,
        mass=share * 5e3,
    )


LINES = {
    "top": ([0.0, 0.0, HEIGHT], [LENGTH, 0.0, HEIGHT]),
    "part of the top": ([0.31, 0.0, HEIGHT], [1.57, 0.0, HEIGHT]),
    "within a facet": ([0.30, 0.0, 1.15], [0.36, 0.0, 1.15]),
    "across": ([0.13, 0.0, 0.71], [1.91, 0.0, 0.71]),
    "askew": ([0.13, 0.0, 0.31], [1.91, 0.0, 1.13]),
}


@pytest.mark.parametrize("lean", [0.0, 0.3])
@pytest.mark.parametrize("parts", [1, 9])
@pytest.mark.parametrize("line", LINES)
def test_the_work_is_that_of_the_line(line: str, parts: int, lean: float) -> None:
    model = crooked_wall()
    start, end = (np.array(place) for place in LINES[line])
    force = np.array([300.0, 0.0, -1000.0])
    stones = cp.derive_blocks(STONES)
    load = cp.shell_loaded(cp.LoadCase((1, 0, 0)), model, stones, placed(start, end, force, parts, lean))
    elements = shell_elements(model)
    unknowns = as_unknowns(elements)
    # Gauss's rule of four points is exact for the line's linear density times the square of the motion.
    place, weight = np.polynomial.legendre.leggauss(4)
    moved = motion((start + end) / 2 + place[:, None] * (end - start) / 2)
    mean = (weight * (1 + 3 * lean * place) / 2) @ moved
    alone = dead_load(elements, cp.LoadCase((1, 0, 0)))
    assert float((dead_load(elements, load) - alone) @ unknowns) == pytest.approx(force @ mean, rel=1e-9)
    pushed = live_load(elements, load) - live_load(elements, cp.LoadCase((1, 0, 0)))
    assert float(pushed @ unknowns) == pytest.approx(5e3 * mean[0], rel=1e-9)


def bent(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A motion (n,) out of the plane of the wall, quadratic in x and z, and its slopes (n, 2) along them."""
    x, z = at[:, 0], at[:, 2]
    slope = np.stack([0.4 + 0.6 * x - 0.5 * z, -0.3 - 0.5 * x + 0.8 * z], axis=1)
    return 0.2 + 0.4 * x - 0.3 * z + 0.3 * x * x - 0.5 * x * z + 0.4 * z * z, slope


@pytest.mark.parametrize("line", LINES)
def test_beside_the_middle_of_the_wall_it_bends_it(line: str) -> None:
    """A fibre at y moves in the plane of the wall by -y grad w. Morley's triangle has any quadratic w, and its slopes."""
    model = crooked_wall()
    aside = np.array([0.0, 0.08, 0.0])
    start, end = (np.array(place) for place in LINES[line])
    force, lean = np.array([300.0, 0.0, -1000.0]), 0.3
    load = cp.shell_loaded(
        cp.LoadCase((1, 0, 0)), model, cp.derive_blocks(STONES), placed(start + aside, end + aside, force, 9, lean)
    )
    elements = shell_elements(model)
    ends = elements.edges.nodes
    out = np.zeros((len(model.points), 3))
    out[:, 1] = bent(model.points)[0]
    _, slope = bent(model.points[ends].mean(axis=1))
    # A rotation omega moves the fibre at r by omega x r: omega = (-dw/dz, 0, dw/dx).
    turn = np.stack([-slope[:, 1], np.zeros(len(ends)), slope[:, 0]], axis=1)
    along = elements.edges.directions(model.points)
    unknowns = np.concatenate([out.ravel(), np.einsum("ec,ec->e", turn, along), np.zeros(len(elements.bubble_edge))])
    place, weight = np.polynomial.legendre.leggauss(4)
    _, there = bent((start + end) / 2 + place[:, None] * (end - start) / 2)
    fibre = -aside[1] * np.stack([there[:, 0], np.zeros(len(place)), there[:, 1]], axis=1)
    expected = force @ ((weight * (1 + 3 * lean * place) / 2) @ fibre)
    carried = dead_load(elements, load) - dead_load(elements, cp.LoadCase((1, 0, 0)))
    assert float(carried @ unknowns) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("start", "end", "force", "lean"),
    [
        ([0.13, 0.1, 0.71], [1.91, 0.1, 0.71], [300.0, 70.0, -1000.0], 0.2),
        # Beyond the end of the facets, as over the outer half of a corner.
        ([-0.12, 0.0, HEIGHT], [LENGTH, 0.0, HEIGHT], [0.0, 0.0, -1000.0], 0.0),
    ],
)
def test_force_and_moment_of_a_line_arrive(start: list[float], end: list[float], force: list[float], lean: float) -> None:
    model = crooked_wall()
    first, last, push = np.array(start), np.array(end), np.array(force)
    stones = cp.derive_blocks(STONES)
    load = cp.shell_loaded(cp.LoadCase((1, 0, 0)), model, stones, placed(first, last, push, 9, lean))
    elements = shell_elements(model)
    carried = dead_load(elements, load) - dead_load(elements, cp.LoadCase((1, 0, 0)))
    nodes = carried[: 3 * len(model.points)].reshape(-1, 3)
    rotations = carried[3 * len(model.points) :][: len(elements.edges.nodes)]
    moment = np.cross(model.points, nodes).sum(axis=0) + rotations @ elements.edges.directions(model.points)
    expected = np.concatenate([push, np.cross((first + last) / 2 + lean * (last - first) / 2, push)])
    assert load.dead is not None
    for found in (np.concatenate([nodes.sum(axis=0), moment]), resultant(model.centroid, load.dead)):
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-6)


def test_what_lies_beyond_the_wall_is_spread_over_the_rest_of_its_line() -> None:
    """Force and moment of the line stay: by hand, 1.2 m of 1 N/m from -.2 m on becomes, from 0 to 1 m, 1.92 - 1.44 x N/m."""
    place = np.linspace(-0.2, 1.0, 1201)[:-1] + 0.0005
    share = np.full(1200, 1e-3)
    found = shares_within(share, np.ones(1200), place, np.zeros(1200, dtype=np.int64), place > 0)
    assert not found[place < 0].any()
    np.testing.assert_allclose(found[place > 0], 1e-3 * (1.92 - 1.44 * place[place > 0]), rtol=1e-5)
    assert found.sum() == pytest.approx(1.2, rel=1e-12)
    assert found @ place == pytest.approx(1.2 * 0.4, rel=1e-12)
    # Half of it beyond the wall: the rest would have to pull.
    kept = shares_within(share, np.ones(1200), place, np.zeros(1200, dtype=np.int64), place > 0.4)
    np.testing.assert_array_equal(kept, share)
    # Nothing to bear, as of masses where no weight is pushed.
    np.testing.assert_array_equal(shares_within(share, np.zeros(1200), place, np.zeros(1200, dtype=np.int64), place > 0), share)


SQUARE = [
    {"name": "south", "start": (0, 0), "end": (4, 0), "toward": "+y"},
    {"name": "north", "start": (0, 3), "end": (4, 3), "toward": "-y"},
    {"name": "west", "start": (0, 0), "end": (0, 3), "toward": "+x"},
    {"name": "east", "start": (4, 0), "end": (4, 3), "toward": "-x"},
]


def test_two_lines_of_one_name_keep_what_each_bears() -> None:
    """One along all of a wall, out over its corners, and one that pushes the middle of it outwards."""
    masonry = (cp.Material("default", 20e3, 0.6),)
    house = generators.house(walls=SQUARE, course=0.25, stone_length=0.6, height=2.5, thickness=0.4, materials=masonry)
    stones, model = cp.derive_blocks(house), cp.derive_shell(house, 0.8)
    lines = [cp.LineLoad("south", dead=4e3), cp.LineLoad("south", thrust=500.0, toward="-y", begin=1.3, end=1.9)]
    held, borne = cp.loaded(cp.LoadCase((1, 0, 0)), stones, lines), cp.shell_loaded(cp.LoadCase((1, 0, 0)), model, stones, lines)
    assert held.dead is not None
    assert borne.dead is not None
    expected = resultant(stones.centroid, held.dead)
    np.testing.assert_allclose(resultant(model.centroid, borne.dead), expected, rtol=1e-9, atol=1e-9 * 16e3)


def test_where_one_wall_is_pushed_the_masses_of_its_own_stones_alone_are() -> None:
    """The corner stones of the walls across bear a part of the line, and are not pushed."""
    masonry = (cp.Material("default", 20e3, 0.6),)
    house = generators.house(walls=SQUARE, course=0.25, stone_length=0.6, height=2.5, thickness=0.4, materials=masonry)
    stones, model = cp.derive_blocks(house), cp.derive_shell(house, 0.8)
    load = cp.LoadCase((0, 1, 0), panels=("south",))
    line = [cp.LineLoad("south", dead=4e3)]
    held, borne = cp.loaded(load, stones, line), cp.shell_loaded(load, model, stones, line)
    assert held.live is not None
    assert borne.live is not None
    pushed = resultant(stones.centroid, held.live)
    assert 0 < pushed[1] < 16e3
    np.testing.assert_allclose(resultant(model.centroid, borne.live), pushed, rtol=1e-9, atol=1e-9 * 16e3)


@pytest.mark.parametrize("eccentricity", [0.0, 0.15])
def test_a_line_over_the_corners_of_a_house_is_borne_by_its_own_wall(eccentricity: float) -> None:
    """Some stones of the corners are those of the walls across, which would bear part of the line on their free edge. A load
    .15 m from the middle of a wall of .4 m bends it within its strength."""
    masonry = (cp.Material("default", 20e3, 0.6),)
    house = generators.house(walls=SQUARE, course=0.25, stone_length=0.6, height=2.5, thickness=0.4, materials=masonry)
    stones, model = cp.derive_blocks(house), cp.derive_shell(house, 0.5)
    line = cp.LineLoad("south", dead=4e3, eccentricity=eccentricity, toward="-y")
    load = cp.shell_loaded(cp.LoadCase((1, 0, 0)), model, stones, [line])
    assert load.dead is not None
    on = np.linalg.norm(load.dead[:, :3], axis=1) > 0
    assert set(model.panel[on[: len(model.panel)]]) == {"south"}
    held = cp.loaded(cp.LoadCase((1, 0, 0)), stones, [line])
    assert held.dead is not None
    np.testing.assert_allclose(
        resultant(model.centroid, load.dead), resultant(stones.centroid, held.dead), rtol=1e-9, atol=1e-9 * 16e3
    )
    state = cp.shell_limit_analysis(model, load, masonry)
    assert state.status == "optimal"
    # It holds the wall down as much as one in the middle: as measured .356, without load .335.
    assert 0.335 < state.load_factor < 0.37


@pytest.mark.parametrize(
    ("place", "most", "middle", "half"),
    [
        (0.5, 9.0, 0.0, 0.5),
        (0.4, 9.0, 0.1, 0.5),
        (0.9, 9.0, -0.05, 0.15),
        (0.1, 9.0, 0.05, 0.15),
        (1.0, 9.0, 0.0, 0.0),
        (0.5, 0.4, 0.0, 0.2),
        (0.85, 0.4, -0.05, 0.2),
        (0.1, 0.4, 0.05, 0.15),
    ],
)
def test_a_stone_presses_on_its_bed_without_pull(place: float, most: float, middle: float, half: float) -> None:
    """Over its whole length of 1 m under a force on the middle third, else over three times the distance to the end."""
    assert pressed_length(np.array([0.0, 1.0, 1.0, 0.0]), place, most) == pytest.approx((middle, half))
