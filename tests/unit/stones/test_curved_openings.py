"""Arched openings in apses and round towers: straight through, under voussoirs with plane joints; volumes, supports, gate."""

import math

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from churchpipe.config.case import read_case
from churchpipe.dxf.reader import read_dxf
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.generators import apse, chapel, tower
from churchpipe.match import match_models
from churchpipe.model.materials import Material
from churchpipe.resources import pipeline_folder
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.contacts import find_contacts
from sound import laid

PHASES = (Phase.explicit, Phase.generate)
SLOW = pytest.mark.slow("docs/church.md: arched openings in curved walls")
STONE = Material("default", 18e3, 0.6)
APSE = {
    "course": 0.275,
    "stone_length": 0.57,
    "inner_radius": 1.25,
    "thickness": 0.9,
    "height": 5.5,
    "wall_length": 6.5,
    "wall_thickness": 0.9,
    "wall_height": 5.5,
}
WINDOW = {
    "name": "w",
    "wall": "apse",
    "centre": 0.0,
    "width": 0.7,
    "sill": 1.65,
    "springing": 3.025,
    "voussoirs": 7,
    "depth": 0.35,
}
TOWER = {"course": 0.25, "stone_length": 0.5, "width": 4.0, "height": 3.0, "thickness": 0.6, "plan": "round"}
DOOR = {"name": "door", "wall": "round", "centre": 0.0, "width": 1.0, "springing": 1.5, "voussoirs": 9, "depth": 0.3}


@pytest.mark.parametrize("thickness", [0.175, 0.18])
def test_a_point_of_a_piece_may_miss_its_cell_by_rounding(thickness):
    thin = {"course": 0.2, "stone_length": 0.4, "width": 2.0, "height": 1.2, "plan": "round", "thickness": thickness}
    low = {"width": 0.4, "springing": 0.6, "sill": 0.2, "voussoirs": 7, "depth": 0.2, "centre": (0.0, 2.0)}
    laid(tower(**thin, openings=[DOOR | low]))


@pytest.mark.slow
def test_a_window_takes_out_what_a_prism_takes_out():
    whole, _ = laid(apse(**APSE))
    pierced, _ = laid(apse(**APSE, openings=[WINDOW]))
    taken = whole.volume[1:].sum() - pierced.volume[1:].sum()
    # Between circles of 1.25 and 2.15 m; the wall's faces are chords between its joints, a per cent inside of them.
    levels = np.linspace(1.65, 3.375, 20001)
    corner = 0.35 * np.array([[math.cos(k * math.pi / 7), math.sin(k * math.pi / 7)] for k in range(4)])
    half = np.interp(levels - 3.025, corner[:, 1], corner[:, 0], right=0.0)
    half = np.where(levels - 3.025 > corner[-1, 1], 0.0, half)

    def primitive(radius):
        return 0.5 * (half * np.sqrt(radius**2 - half**2) + radius**2 * np.arcsin(half / radius))

    exact = float(np.trapezoid(2 * (primitive(2.15) - primitive(1.25)), levels))
    assert taken == pytest.approx(exact, rel=0.01)
    assert (pierced.course == -1).sum() == 1 + 7


def test_voussoirs_have_plane_joints_that_meet_in_a_line():
    stones, contacts = laid(apse(**APSE, openings=[WINDOW]))
    ring = np.flatnonzero(np.char.startswith(stones.block_id.astype(str), "apse-w-ring"))
    between = np.isin(contacts.blocks, ring).all(axis=1)
    # One plane joint between each two, at right angles to the middle plane's normal and through the axis of the arch.
    assert between.sum() == 6
    normal = contacts.frame[between, 0]
    np.testing.assert_allclose(normal[:, 1], 0.0, atol=1e-9)
    first = contacts.point[contacts.point_ptr[:-1][between]]
    np.testing.assert_allclose(np.einsum("ic,ic->i", normal, first - [0.0, 0.0, 3.025]), 0.0, atol=1e-9)
    turn = np.sort(np.degrees(np.arctan2(np.abs(normal[:, 0]), normal[:, 2] * np.sign(normal[:, 0]))))
    np.testing.assert_allclose(turn, 180 / 7 * np.arange(1, 7), atol=1e-6)


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({"shape": "segmental", "rise": 0.2}, marks=SLOW),
        {"shape": "pointed", "rise": 0.6, "voussoirs": 8},
        pytest.param({"shape": "circle", "voussoirs": 12}, marks=SLOW),
        pytest.param({"sill": 0.0}, marks=SLOW),
        pytest.param({"centre": [-1.5, 0.0, 1.5], "width": 0.4, "depth": 0.25}, marks=SLOW),
    ],
    ids=["segmental", "pointed", "circle", "door", "three"],
)
def test_openings_of_all_shapes_match_their_shell(changes):
    building = apse(**APSE, openings=[WINDOW | changes], materials=(STONE,))
    stones, contacts = laid(building)
    assert stones.volume[1:].min() > 0.25 * 0.275 * 0.3 * 0.57 * 0.9
    match = match_models(stones, contacts, derive_shell(building, element_size=0.25))
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    weight = next(figure for figure in match.figures if figure.name == "weight of apse")
    assert weight.difference < 0.001


@SLOW
def test_a_round_tower_with_a_door_and_windows_all_round(tmp_path):
    windows = {"name": "w", "wall": "round", "centre": [2.67, 5.34, 8.01], "width": 0.5, "sill": 1.0, "springing": 1.75}
    windows |= {"voussoirs": 7, "depth": 0.3}
    building = tower(**TOWER, openings=[DOOR, windows], materials=(STONE,))
    stones, contacts = laid(building)
    assert match_models(stones, contacts, derive_shell(building, element_size=0.25)).passed
    door = stones.centroid[np.char.startswith(stones.block_id.astype(str), "round-door-ring")]
    assert door[:, 0].min() > 1.4
    assert abs(door[:, 1].mean()) < 1e-3
    write_dxf(stones, tmp_path / "tower.dxf", materials=[STONE])
    read, findings = read_dxf(tmp_path / "tower.dxf")
    assert not len(findings)
    order, again = np.argsort(stones.block_id), np.argsort(read.block_id)
    np.testing.assert_allclose(read.volume[again], stones.volume[order], rtol=1e-9)
    assert len(find_contacts(read).point) == len(contacts.point)


def test_a_chapel_has_a_window_in_its_apse():
    window = WINDOW | {"springing": 2.0, "sill": 1.0, "width": 0.5, "depth": 0.25}
    half_round = {"inner_radius": 1.0, "thickness": 0.6, "height": 3.5}
    building = chapel(
        course=0.25, stone_length=0.5, width=5.0, length=6.0, height=4.0, thickness=0.6, apse=half_round, openings=[window]
    )
    stones, _ = laid(building)
    assert (stones.panel[stones.course == -1] == "apse").sum() == 7


@pytest.mark.slow
def test_a_door_that_filled_again_leaves_a_slit_is_laid():
    door = {"name": "d", "wall": "apse", "centre": -0.425, "width": 0.95, "shape": "segmental", "rise": 0.25, "depth": 0.45}
    half_round = {"inner_radius": 1.6, "thickness": 0.388, "height": 3.575, "centre": 0.11}
    size = {"course": 0.275, "stone_length": 0.57, "width": 5.917, "length": 4.695, "height": 4.95, "thickness": 0.374}
    laid(chapel(**size, apse=half_round, openings=[door | {"springing": 2.675, "voussoirs": 19}]))


@SLOW
@settings(max_examples=4, deadline=None, derandomize=True, phases=PHASES)
@given(
    radius=st.floats(1.2, 3.0),
    thickness=st.floats(0.4, 0.9),
    share=st.floats(0.3, 0.8),
    centre=st.floats(-0.4, 0.4),
    stone=st.floats(0.4, 0.6),
    springing=st.floats(1.6, 2.4),
    shape=st.sampled_from(["round", "segmental", "pointed", "circle"]),
)
def test_any_window_in_any_apse(radius, thickness, share, centre, stone, springing, shape):
    width = share * radius
    rise = {"segmental": 0.3 * width, "pointed": 0.9 * width}.get(shape)
    opening = {"name": "w", "wall": "apse", "centre": centre * radius, "width": width, "springing": springing, "voussoirs": 8}
    opening |= {"depth": 0.25, "shape": shape} | ({} if rise is None else {"rise": rise})
    opening |= {} if shape == "circle" else {"sill": 0.9}
    sizes = {"inner_radius": radius, "thickness": thickness, "height": 5.5, "stone_length": stone}
    stones, contacts = laid(apse(**(APSE | sizes | {"course": 0.25, "wall_length": 9.0}), openings=[opening]))
    ring = np.char.startswith(stones.block_id.astype(str), "apse-w-ring")
    assert ring.sum() == 8
    assert (np.isin(contacts.blocks, np.flatnonzero(ring)).sum(axis=1) == 2).sum() == (8 if shape == "circle" else 7)


# A window and a leg of the apse lie within one stone's length of each other, or far apart; both rules of joints.
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=SLOW) for seed in range(1, 4))])
def test_an_apse_with_a_window_on_the_grid_fills_its_walls(seed):
    rng = np.random.default_rng(seed)
    radius, thickness = rng.uniform(1.2, 2.5), rng.uniform(0.5, 0.9)
    opening = {"centre": rng.uniform(-0.8, 0.8) * radius, "width": rng.uniform(0.3, 0.6) * radius, "voussoirs": 8, "sill": 0.8}
    shape = ["round", "segmental", "pointed", "circle"][seed]
    opening |= {"shape": shape, "springing": rng.uniform(1.6, 2.4), "depth": 0.25}
    opening |= {"segmental": {"rise": 0.3 * opening["width"]}, "pointed": {"rise": 0.9 * opening["width"]}}.get(shape, {})
    sizes = {"inner_radius": radius, "thickness": thickness, "stone_length": rng.uniform(0.4, 0.7), "joints": "grid"}
    first = ["x", "y"][seed % 2]
    laid(apse(**(APSE | sizes | {"wall_length": 9.0, "first_course": first}), openings=[WINDOW | opening]))


@pytest.mark.slow
@pytest.mark.parametrize("turns", [-1, pytest.param(0, marks=SLOW), pytest.param(1, marks=SLOW)])
def test_a_centre_on_a_round_tower_may_be_negative_or_beyond_one_turn(turns):
    girth = math.pi * (TOWER["width"] - TOWER["thickness"])
    door = next(iter(tower(**TOWER, openings=[DOOR | {"centre": -0.2}]).panels[0].openings))
    same = next(iter(tower(**TOWER, openings=[DOOR | {"centre": -0.2 + turns * girth}]).panels[0].openings))
    np.testing.assert_allclose(same.outline, door.outline, atol=1e-9)
    stones, _ = laid(tower(**TOWER, openings=[DOOR | {"centre": -0.2 + turns * girth}]))
    ring = stones.centroid[np.char.startswith(stones.block_id.astype(str), "round-door-ring")]
    assert ring[:, 0].min() > 1.4
    assert -0.2 < ring[:, 1].mean() < -0.15


@pytest.mark.slow
@pytest.mark.parametrize("centre", [pytest.param(-0.2, marks=SLOW), -0.05])
def test_a_stone_beside_a_door_may_cross_the_seam(centre):
    windows = DOOR | {"name": "windows", "centre": (2.67, 5.34, 8.01), "width": 0.5, "sill": 1.0, "voussoirs": 7, "depth": 0.25}
    laid(tower(**TOWER, openings=[DOOR | {"centre": centre, "springing": 2.0}, windows]))


MISTAKES = [
    (
        {"width": 1.5, "depth": 0.45},
        r"opening w: too wide for the curve of its wall; found 2\.4 m .*at most 2\.165 m, 120 degrees",
    ),
    (
        {"centre": 2.4},
        r"opening w: reaches beyond the arc of its wall; found 136\.8 to 204\.9 degrees .*expected 4\.803 to 175\.2 degrees",
    ),
    ({"centre": [0.0, 1.4]}, r"openings w-1 and w-2: too near to each other .*at least 142\.5 mm, a quarter of a stone"),
    ({"springing": 5.0}, r"opening w: reaches beyond the top .*z = 1\.65 to 5\.682 m .*within 0 to 5\.5 m"),
]


@pytest.mark.parametrize(("changes", "said"), MISTAKES)
def test_what_does_not_fit_is_told_with_the_numbers(changes, said):
    with pytest.raises(InputError, match=said):
        apse(**APSE, openings=[WINDOW | changes])


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    ["inner_radius_m=1.5", *(pytest.param(change, marks=SLOW) for change in ("inner_radius_m=2.0", "thickness_m=1.2"))],
)
def test_joints_of_two_courses_that_differ_in_the_last_digit_are_one(change):
    laid(read_case(pipeline_folder() / "cases" / "apse_window.toml", [f"source.{change}"]).building())
