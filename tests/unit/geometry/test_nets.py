"""Nets of lines drawn by hand: of random masonry, whose lines meet three at a place, no stone is lost and none is added."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from scipy.spatial import Voronoi

from churchpipe.geometry.nets import net_of, without_idle_corners
from churchpipe.model.arrays import FloatArray

LENGTH, HEIGHT, STONES = 2.5, 1.6, 18
# Stones of a net whose shortest line is this long, m, or longer: an end may be off by more than a shorter one is long.
SHORTEST = 0.04


def masonry(seed: int) -> list[FloatArray]:
    """The outlines of random stones that fill a wall; mirrored seeds make its borders straight."""
    seeds = np.random.default_rng(seed).random((STONES, 2)) * [LENGTH, HEIGHT]
    while True:
        mirrored = [seeds * [-1, 1], seeds * [1, -1], [2 * LENGTH, 0] - seeds * [1, -1], [0, 2 * HEIGHT] - seeds * [-1, 1]]
        cells = Voronoi(np.concatenate([seeds, *mirrored]))
        stones = [shapely.MultiPoint(cells.vertices[cells.regions[cells.point_region[k]]]).convex_hull for k in range(STONES)]
        outlines = [shapely.get_coordinates(stone)[:-1] for stone in stones]
        if min(float(np.linalg.norm(np.roll(o, -1, axis=0) - o, axis=1).min()) for o in outlines) >= SHORTEST:
            return outlines
        # Towards stones of one size, in which short sides grow.
        seeds = np.array([shapely.get_coordinates(stone.centroid)[0] for stone in stones])


def drawn(outlines: list[FloatArray], past: float, off: float, seed: int) -> list[FloatArray]:
    """A line for each side; its ends run past their place, or fall short, by up to `past`, and lie beside it by up to `off`."""
    rng = np.random.default_rng(seed)
    sides: dict[tuple[float, ...], FloatArray] = {}
    for outline in outlines:
        for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            sides.setdefault(tuple(np.sort(np.round([a, b], 6), axis=0).ravel().tolist()), np.array([a, b]))
    out: list[FloatArray] = []
    for side in sides.values():
        along = (side[1] - side[0]) / np.linalg.norm(side[1] - side[0])
        out.append(side + rng.uniform(-past, past, (2, 1)) * along + rng.uniform(-off, off, (2, 2)))
    return out


@pytest.mark.parametrize(("past", "off"), [(0.0, 0.0), (0.001, 0.0), (0.005, 0.0), (0.0, 0.0003), (0.0, 0.001), (0.003, 0.001)])
@pytest.mark.parametrize("seed", range(6))
def test_ends_that_miss_each_other_enclose_the_stones_that_were_meant(past: float, off: float, seed: int) -> None:
    outlines = masonry(seed)
    net = net_of(drawn(outlines, past, off, seed), [])
    meshes = [shapely.Polygon(corners) for _, corners in net.meshes]
    assert len(meshes) == STONES
    assert not net.loose
    assert not net.alone
    for stone in map(shapely.Polygon, outlines):
        assert max(stone.intersection(mesh).area / stone.union(mesh).area for mesh in meshes) > 0.95
    assert bool(net.mended) == (past > 0 or off > 0)


@pytest.mark.parametrize(("past", "off"), [(0.005, 0.0), (0.0, 0.0003), (0.0, 0.001), (0.0, 0.002), (0.003, 0.001)])
@pytest.mark.parametrize("seed", range(6))
def test_lines_that_miss_one_place_sideways_leave_no_kink(past: float, off: float, seed: int) -> None:
    # A step in the joint of two stones would hold them like a key.
    outlines = masonry(seed)
    stones = [shapely.Polygon(outline) for outline in outlines]
    net = net_of(drawn(outlines, past, off, seed), [])
    for _, corners in net.meshes:
        # On a grid, since GEOS takes polygons that share but an edge, to 1e-17, for each other.
        meant = max(range(STONES), key=lambda k: shapely.intersection(stones[k], shapely.Polygon(corners), grid_size=1e-9).area)
        assert len(without_idle_corners(corners)) == len(outlines[meant])
    assert max(net.mended.values()) < 0.03


def test_an_end_on_the_middle_of_a_line_does_not_bend_it() -> None:
    rng = np.random.default_rng(3)
    beds = [[[0.0, z / 10], [2.5, z / 10]] for z in range(5)]
    heads = [
        [[x, z / 10], [x, (z + 1) / 10]]
        for z in range(4)
        for x in sorted({0.0, 2.5, *(np.arange(0, 2.5, 0.25) + 0.125 * (z % 2))})
    ]
    net = net_of([np.array(side) + rng.uniform(-0.002, 0.002, (2, 2)) for side in [*beds, *heads]], [])
    assert [len(without_idle_corners(corners)) for _, corners in net.meshes] == [4] * (len(heads) - 4)


def test_pieces_of_a_bed_that_point_at_each_other_beside_no_head_are_joined() -> None:
    # 500 bricks of 250 x 65 mm; where no head joint ends, only the two pieces meet.
    rng = np.random.default_rng(0)
    beds = [[[x / 4, z * 0.065], [(x + 1) / 4, z * 0.065]] for z in range(26) for x in range(20)]
    marks = [sorted({0.0, 5.0, *(np.arange(0, 5, 0.25) + 0.125 * (z % 2))}) for z in range(25)]
    heads = [[[x, z * 0.065], [x, (z + 1) * 0.065]] for z in range(25) for x in marks[z]]
    net = net_of([np.array(side) + rng.uniform(-0.001, 0.001, (2, 2)) for side in [*beds, *heads]], [])
    assert len(net.meshes) == sum(len(row) - 1 for row in marks)
    assert not net.loose
    assert not net.alone


def test_short_chords_of_an_outline_elsewhere_do_not_move_the_ends_of_lines() -> None:
    # Head joints above and below a bed end 8 mm beside each other: farther than lines miss each other, by 1 mm.
    rng = np.random.default_rng(0)
    beds = [[[0.0, z / 10], [2.5, z / 10]] for z in range(5)]
    heads = [
        [[x, z / 10], [x, (z + 1) / 10]]
        for z in range(4)
        for x in sorted({0.0, 2.5, *(np.arange(0.25, 2.5, 0.25) + 0.008 * (z % 2))})
    ]
    lines = [np.array(side) + rng.uniform(-0.001, 0.001, (2, 2)) for side in [*beds, *heads]]
    alone = net_of(lines, [])
    angle = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    beside = net_of(lines, [np.stack([5 + np.cos(angle), np.sin(angle)], axis=1)])
    assert len(alone.meshes) == len(heads) - 4
    for (_, meant), (_, corners) in zip(alone.meshes, beside.meshes, strict=True):
        np.testing.assert_array_equal(corners, meant)


@pytest.mark.parametrize("slip", [[[50, 53], [50, 100]], [[50, 0], [50, 46]]])
def test_a_single_slip_of_the_hand_moves_no_other_line(slip: list[list[float]]) -> None:
    # Of the few lines of a small drawing one is more than a twentieth. Two heads that meet a bed 10 mm apart stay there; cm.
    drawing = [[[0, 0], [200, 0]], [[0, 50], [200, 50]], [[0, 100], [200, 100]], [[0, 0], [0, 100]], [[200, 0], [200, 100]]]
    drawing += [[[100, 0], [100, 50]], [[101, 50], [101, 100]], slip]
    net = net_of([np.array(line, dtype=float) for line in drawing], [])
    assert list(net.mended) == [len(drawing) - 1]
    # Where the end was drawn, not where its line begins.
    np.testing.assert_array_equal(net.mended_at[len(drawing) - 1], min(slip, key=lambda end: abs(end[1] - 50)))
    assert len(net.meshes) == 5


def test_a_side_shorter_than_lines_miss_each_other_is_doubtful() -> None:
    # Four stones about a side of 8 mm, between whose ends nobody can tell when one falls short by 5 mm.
    cross = [[[-1, 0.6], [-0.004, 0]], [[-1, -0.6], [-0.004, 0]], [[0.004, 0], [1, 0.6]], [[0.004, 0], [1, -0.6]]]
    frame = [[[-1, -0.6], [1, -0.6]], [[1, -0.6], [1, 0.6]], [[1, 0.6], [-1, 0.6]], [[-1, 0.6], [-1, -0.6]]]
    side = [[[-0.004, 0], [0.004, 0]]]
    exact = [np.array(line, dtype=float) for line in [*side, *cross, *frame]]
    assert not net_of(exact, []).doubtful
    exact[1][1] -= [0.0043, -0.0026]
    net = net_of(exact, [])
    assert list(net.doubtful) == [0]
    # The distance of the end from the other lines, of which the side is the nearest.
    assert net.doubtful[0][0] == pytest.approx(0.0045, rel=0.05)
    # It is told in the middle of the side, also of a line that begins elsewhere.
    whole = [np.concatenate([exact[2][:1], exact[0], exact[3][1:]]), exact[1], *exact[4:]]
    for lines in (exact, whole):
        np.testing.assert_allclose(net_of(lines, []).doubtful[0][1], [0, 0], atol=1e-12)


@pytest.mark.parametrize("off", [0.0, 0.0003, 0.001])
def test_beds_drawn_in_pieces_that_miss_each_other_are_whole(off: float) -> None:
    # Running bond; the median line is 250 mm long. Where no head joint ends, two pieces of a bed point at each other.
    rng = np.random.default_rng(7)
    beds = [[[x / 4, z / 10], [(x + 1) / 4, z / 10]] for z in range(5) for x in range(10)]
    marks = [sorted({0.0, 2.5, *(np.arange(0, 2.5, 0.25) + 0.125 * (z % 2))}) for z in range(4)]
    heads = [[[x, z / 10], [x, (z + 1) / 10]] for z in range(4) for x in marks[z]]
    lines = [np.array(side) + rng.uniform(-off, off, (2, 2)) for side in [*beds, *heads]]
    net = net_of(lines, [])
    assert not net.loose
    assert len(net.meshes) == sum(len(row) - 1 for row in marks)


def test_an_outline_without_a_side_keeps_off_the_bricks_beyond_its_mortar() -> None:
    # Its two free ends are 10 mm from bricks on either side, as all bricks of the wall are from each other.
    def brick(x: float, y: float) -> np.ndarray:
        return np.array([[x, y], [x + 0.25, y], [x + 0.25, y + 0.065], [x, y + 0.065]])

    closed = [brick(x, y) for y in (0.0, 0.075, 0.15) for x in (0.0, 0.26, 0.52) if (x, y) != (0.26, 0.075)]
    u = brick(0.26, 0.075)[[1, 0, 3, 2]]
    net = net_of([u], closed)
    assert not net.meshes
    assert not net.borders
    assert not net.mended
    assert net.alone == [0]


def fan(count: int, off: float, seed: int) -> list[FloatArray]:
    """Lines 2 m long from one place to a rim of a side between every two of them; each end is off by up to `off` both ways."""
    angle = 2 * np.pi * np.arange(count) / count
    rim = 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    lines = [np.array([[0.0, 0.0], point]) for point in rim] + list(np.stack([rim[:-1], rim[1:]], axis=1))
    rng = np.random.default_rng(seed)
    return [line + rng.uniform(-off, off, (2, 2)) for line in lines]


@pytest.mark.parametrize(("count", "off"), [(100, 0.003), (100, 0.01), (200, 0.005)])
@pytest.mark.parametrize("seed", range(2))
def test_many_ends_of_one_place_move_no_farther_than_they_miss_each_other(count: int, off: float, seed: int) -> None:
    # Two corners of the square within which the ends of a place lie are 2 sqrt(2) off apart.
    net = net_of(fan(count, off, seed), [])
    assert len(net.meshes) == count - 1
    assert max(net.mended.values()) <= 2 * np.sqrt(2) * off


@pytest.mark.parametrize("off", [0.0, 1e-4, 1e-3])
def test_of_very_many_lines_of_one_place_no_wedge_is_lost_in_silence(off: float) -> None:
    # A rim of 7.9 mm between every two lines of 2 m: within each wedge there is room for a circle of 3.9 mm in radius.
    net = net_of(fan(1600, off, 0), [])
    assert len(net.meshes) + len(net.left) >= 1599
    if off < 1e-3:
        assert len(net.meshes) == 1599
        assert not net.left


def test_wedges_on_both_sides_of_a_line_through_their_place_are_whole() -> None:
    # The fan has its lines on one side of a base that runs through its place; below it there is one stone.
    lines = [line for line in fan(400, 0.0, 0) if line[:, 1].min() > -1e-9]
    lines += [np.array(side, dtype=float) for side in ([[-2, 0], [-2, -1]], [[-2, -1], [2, -1]], [[2, -1], [2, 0]])]
    lines = [line for line in lines if abs(line[:, 1]).max() > 1e-9] + [np.array([[-2.0, 0.0], [2.0, 0.0]])]
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    net = net_of([line @ turn for line in lines], [])
    assert len(net.meshes) == 201
    assert not net.loose
    area = sum(shapely.Polygon(corners).area for _, corners in net.meshes)
    np.testing.assert_allclose(area, 4 + 200 * 2 * np.sin(np.pi / 200), rtol=1e-9)


def test_an_area_between_lines_that_nearly_coincide_is_left_out_and_told() -> None:
    # Two stones side by side, each with a side of its own between them: 2 mm apart at one end, where the median is 1.5 m.
    frame = [[[0, 0], [1.5, 0]], [[1.5, 0], [3, 0]], [[3, 0], [3, 1]], [[3, 1], [1.5, 1]], [[1.5, 1], [0, 1]], [[0, 1], [0, 0]]]
    sides = [[[1.5, 0], [1.5, 1]], [[1.502, 0], [1.5, 1]]]
    net = net_of([np.array(line, dtype=float) for line in [*frame, *sides]], [])
    assert len(net.meshes) == 2
    (left,) = net.left
    assert left.narrow
    assert left.length == pytest.approx(1.0, rel=1e-3)
    assert left.width == pytest.approx(0.001, rel=0.01)
    np.testing.assert_allclose(left.at, [1.5007, 1 / 3], atol=1e-3)


@pytest.mark.parametrize("off", [0.0, 1e-5, 1e-4, 3e-4])
def test_films_between_bricks_drawn_by_hand_are_no_stones(off: float) -> None:
    # Four courses of bricks of 500 x 200 mm, each with four lines of its own that miss those of its neighbours.
    rng = np.random.default_rng(0)
    marks = [sorted({0.0, 2.0, *(np.arange(0, 2, 0.5) + 0.25 * (z % 2))}) for z in range(4)]
    boxes = [((x, 0.2 * z), (end, 0.2 * (z + 1))) for z in range(4) for x, end in pairwise(marks[z])]
    corners = [[(a, b), (c, b), (c, d), (a, d)] for (a, b), (c, d) in boxes]
    lines = [
        np.array(side) + rng.uniform(-off, off, (2, 2)) for one in corners for side in zip(one, np.roll(one, -1, 0), strict=True)
    ]
    net = net_of(lines, [])
    assert len(net.meshes) == len(boxes)
    assert bool(net.left) == (off > 0)
    assert all(area.narrow and area.width < 2 * off for area in net.left)


@pytest.mark.parametrize(("past", "off"), [(0.04, 0.0), (0.04, 0.01), (0.05, 0.03)])
@pytest.mark.parametrize("seed", range(4))
def test_no_end_moves_farther_than_a_tenth_of_the_median_line(past: float, off: float, seed: int) -> None:
    # Ends that miss each other by more than the documented tenth are tried too, in several steps.
    lines = drawn(masonry(seed), past, off, seed)
    median = float(np.median([np.linalg.norm(line[1] - line[0]) for line in lines]))
    assert max(net_of(lines, []).mended.values()) <= 0.1 * median


def test_lines_that_cross_in_nearly_one_point_have_no_ends_there() -> None:
    # Two diagonals cross at (2, 1.5); the third line passes by at x = 2.1, where they are .1 apart.
    frame = [[[0, 0], [4, 0]], [[4, 0], [4, 3]], [[4, 3], [0, 3]], [[0, 3], [0, 0]]]
    across = [[[0, 0.5], [4, 2.5]], [[0, 2.5], [4, 0.5]], [[2.1, 0], [2.1, 3]]]
    net = net_of([np.array(line, dtype=float) for line in [*frame, *across]], [])
    assert len(net.meshes) == 6
    assert not net.mended
    (left,) = net.left
    assert not left.narrow
    assert left.length == pytest.approx(np.hypot(0.1, 0.05))
    # The triangle between (2, 1.5), (2.1, 1.45) and (2.1, 1.55).
    np.testing.assert_allclose(left.at, [2 + 0.2 / 3, 1.5])
