"""Walls unlike each other: thickness, height and material of each wall of a chapel or church, and how they are bonded."""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.errors import InputError
from sound import laid

COURSE = 0.25
CHAPEL: dict[str, Any] = {
    "course": COURSE,
    "stone_length": 0.5,
    "width": 5.0,
    "length": 7.0,
    "height": 4.0,
    "thickness": 0.6,
    "ridge": 5.5,
}
TWO = (cp.UnitWeight("default", 18e3), cp.UnitWeight("rubble", 20e3))


def volume_of(stones: cp.Assemblage, wall: str | None = None) -> float:
    return float(stones.volume[~stones.fixed & ((stones.panel == wall) if wall else True)].sum())


def test_left_and_right_are_unlike() -> None:
    walls = [{"wall": "nave_right", "thickness": 0.9, "height": 3.5, "material": "rubble"}, {"wall": "east", "thickness": 0.5}]
    building = generators.chapel(**CHAPEL, walls=walls, materials=TWO)
    panels = {panel.name: panel for panel in building.panels}
    assert {name: panel.thickness for name, panel in panels.items()} == {
        "facade": 0.6,
        "nave_left": 0.6,
        "nave_right": 0.9,
        "east": 0.5,
    }
    assert [panels[name].material for name in ("nave_left", "nave_right")] == ["default", "rubble"]
    assert [panels[name].outline[:, 1].max() for name in ("nave_left", "nave_right", "facade")] == [4.0, 3.5, 5.5]
    stones, _ = laid(building)
    free = stones.points[stones.points[:, 2] > 0]
    # Over all it is as wide and as long as it was.
    np.testing.assert_allclose(np.ptp(free[:, :2], axis=0), [5.0, 7.0], atol=1e-9)
    # The gables slope from the eaves of each side, over the whole width, to the ridge above the middle of the room's centrelines.
    centre = (4.25 + 0.6) / 2
    gable = 0.5 * centre * (4.0 + 5.5) + 0.5 * (5.0 - centre) * (3.5 + 5.5)
    sides = (7.0 - 0.6 - 0.5) * (0.6 * 4.0 + 0.9 * 3.5)
    assert volume_of(stones) == pytest.approx(gable * (0.6 + 0.5) + sides, rel=1e-9)
    assert set(stones.material[stones.panel == "nave_right"]) == {"rubble"}


@pytest.mark.parametrize(
    "seed", [0, 3, *(pytest.param(seed, marks=pytest.mark.slow("docs/church.md: random chapels")) for seed in (1, 2, 4, 5))]
)
def test_random_chapels_are_sound_and_as_large_as_their_walls(seed: int) -> None:
    rng = np.random.default_rng([15, seed])
    thick = {name: float(rng.uniform(0.4, 1.1)) for name in ("facade", "nave_left", "nave_right", "east")}
    high = {side: COURSE * int(rng.integers(10, 18)) for side in ("nave_left", "nave_right")}
    walls = [{"wall": name, "thickness": value, "height": high.get(name)} for name, value in thick.items()]
    size = {
        "width": float(rng.uniform(4.5, 7)),
        "length": float(rng.uniform(5, 9)),
        "ridge": max(high.values()) + float(rng.uniform(0.3, 2)),
    }
    junctions = [
        {"walls": pair, "every": int(rng.choice([0, 2, 4])), "cracked": (1.0, 2.0) if rng.random() < 0.5 else None}
        for pair in (("facade", "nave_left"), ("nave_right", "facade"), ("nave_left", "east"))
    ]
    joints = str(rng.choice(["grid", "bay"]))
    building = generators.chapel(**CHAPEL | size, walls=walls, junctions=junctions, joints=joints)
    stones, _ = laid(building)
    left, right = thick["nave_left"], thick["nave_right"]
    centre = size["width"] - (left + right) / 2
    outer = (centre + left) / 2, (centre + right) / 2
    gable = sum(
        0.5 * reach * (high[side] + size["ridge"]) for side, reach in zip(("nave_left", "nave_right"), outer, strict=True)
    )
    clear = size["length"] - thick["facade"] - thick["east"]
    expected = gable * (thick["facade"] + thick["east"]) + clear * (left * high["nave_left"] + right * high["nave_right"])
    assert volume_of(stones) == pytest.approx(expected, rel=1e-9)


def test_both_models_of_unlike_walls_match() -> None:
    walls = [{"wall": "nave_left", "thickness": 0.9, "height": 3.5}, {"wall": "facade", "thickness": 0.8}]
    building = generators.chapel(**CHAPEL, walls=walls)
    stones = cp.derive_blocks(building)
    match = cp.match_models(stones, cp.find_contacts(stones), cp.derive_shell(building, 0.8))
    assert match.passed, [figure for figure in match.figures if not figure.passed]


def test_a_church_with_a_transept_has_unlike_walls_too() -> None:
    parts: dict[str, Any] = {
        "nave": {"width": 4.0, "length": 6.0, "height": 4.0, "thickness": 0.6},
        "facade": {"thickness": 0.6, "ridge": 5.5},
        "triumphal_arch": {"thickness": 0.8, "ridge": 5.5},
        "transept": {"width": 9.0, "depth": 3.0, "thickness": 0.7},
        "east": {"thickness": 0.8, "ridge": 5.5},
    }
    walls = [{"wall": ["nave_left", "transept_right"], "thickness": 0.9}, {"wall": "triumphal_arch", "thickness": 1.0}]
    building = generators.church(course=COURSE, stone_length=0.5, walls=walls, **parts)
    thick = {panel.name: panel.thickness for panel in building.panels}
    assert (thick["nave_left"], thick["nave_right"], thick["transept_right"], thick["triumphal_arch"]) == (0.9, 0.6, 0.9, 1.0)
    laid(building)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"walls": [{"wall": "nave_middle", "thickness": 1.0}]}, r'chapel: walls: no such wall; found "nave_middle"'),
        (
            {"walls": [{"wall": "facade", "height": 4.0}]},
            r"chapel\.walls\.0\.height: no wall with eaves of its own; found facade",
        ),
        ({"walls": [{"wall": "nave_left", "height": 4.1}]}, r"chapel\.walls\.0\.height: not a whole number of courses"),
        ({"walls": [{"wall": "nave_left", "height": 6.0}]}, r"ridge: below the eaves; found 5\.5 m; expected >= 6 m"),
        ({"walls": [{"wall": "nave_left", "material": "brick"}]}, r"wall nave_left\.material: unknown material"),
        (
            {"junctions": [{"walls": ["facade", "nave_left"], "every": 3}]},
            r"chapel\.junctions\.0\.every: an odd number of courses",
        ),
        ({"junctions": [{"walls": ["facade", "apse"]}]}, r"junction of facade and apse: no such wall"),
    ],
)
def test_what_does_not_fit_is_named(change: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        generators.chapel(**CHAPEL | change)
