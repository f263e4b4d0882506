"""Vaults over the rooms of churches and chapels."""

from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import chapel, church
from churchpipe.stones.soundness import check_soundness

APSE = {"inner_radius": 1.2, "thickness": 0.6, "height": 4.0}
CHAPEL: dict[str, Any] = {
    "course": 0.25, "stone_length": 0.5, "width": 6.0, "length": 6.0, "height": 5.0, "thickness": 0.7, "apse": APSE,
}  # fmt: skip
CROSS: dict[str, Any] = {
    "course": 0.25,
    "stone_length": 0.5,
    "nave": {"width": 4.0, "length": 5.0, "height": 4.0, "thickness": 0.6},
    "triumphal_arch": {"thickness": 0.6},
    "transept": {"width": 9.0, "depth": 4.0, "thickness": 0.6},
    "east": {"thickness": 0.6},
}
BARREL = {"over": "nave", "thickness": 0.3, "courses": 13}
HALF_DOME = {"over": "apse", "kind": "half_dome", "thickness": 0.3, "courses": 6}


MORE = pytest.mark.slow("docs/vaults.md: vaults of a chapel are sound")


def sound(building: cp.Building) -> tuple[cp.Assemblage, cp.Contacts]:
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    check_soundness(stones, contacts)
    return stones, contacts


@pytest.mark.parametrize(
    "vaults",
    [
        (BARREL, HALF_DOME),
        pytest.param(
            (BARREL | {"shape": "segmental", "rise": 1.0, "backing": 0.6}, HALF_DOME | {"heads": "aligned"}), marks=MORE
        ),
        pytest.param((BARREL | {"shape": "pointed", "rise": 3.0},), marks=MORE),
        pytest.param((BARREL | {"kind": "groin", "thickness": 0.4, "backing": 0.8},), marks=MORE),
        pytest.param((BARREL | {"kind": "pavilion", "corner": "alternate"},), marks=MORE),
    ],
)
def test_vaults_of_a_chapel_are_sound(vaults: tuple[dict[str, Any], ...]) -> None:
    stones, contacts = sound(chapel(vaults=vaults, **CHAPEL))
    joined = {tuple(sorted(pair)) for pair in stones.panel[contacts.blocks].tolist()}
    assert any("nave_left" in pair and any(name.startswith("vault_nave") for name in pair) for pair in joined)
    if len(vaults) > 1:
        # The half dome rests on the wall of the apse and leans on the end wall.
        assert ("apse", "vault_apse") in joined
        assert ("east", "vault_apse") in joined


def test_ribs_of_a_room_stand_on_its_walls() -> None:
    ribbed = BARREL | {"kind": "groin", "rib_width": 0.3, "rib_depth": 0.2}
    stones, contacts = sound(chapel(vaults=(ribbed,), **CHAPEL))
    joined = {tuple(sorted(pair)) for pair in stones.panel[contacts.blocks].tolist()}
    assert {("nave_left", "vault_nave_rib"), ("nave_right", "vault_nave_rib"), ("vault_nave", "vault_nave_rib")} <= joined
    # Their soffits spring from the edges of the walls, 4.6 m apart: the vault itself behind them, 5 m.
    rib = stones.points[_nodes(stones, stones.panel == "vault_nave_rib")]
    assert np.abs(rib[rib[:, 2] < 5.0 + 1e-9, 0]).min() == pytest.approx(2.3)
    with pytest.raises(InputError, match=r"rib_width: only a groin has one; found kind = barrel"):
        chapel(vaults=(BARREL | {"rib_width": 0.3, "rib_depth": 0.2},), **CHAPEL)
    with pytest.raises(InputError, match=r"vaults\.0\.rib_width: ribs spring beside the corners; found 0\.6 m"):
        chapel(vaults=(ribbed | {"rib_width": 0.6},), **CHAPEL)


@pytest.mark.slow
def test_arches_of_a_groin_vault_stand_on_the_walls_before_its_ends() -> None:
    arched = BARREL | {"kind": "groin", "arches": 4, "arch_width": 0.3, "arch_depth": 0.2}
    stones, contacts = sound(chapel(vaults=(arched,), **CHAPEL))
    joined = {tuple(sorted(pair)) for pair in stones.panel[contacts.blocks].tolist()}
    assert {("nave_left", "vault_nave_arch"), ("facade", "vault_nave_arch"), ("vault_nave", "vault_nave_arch")} <= joined
    # The vault springs from the edges of the walls, 4.6 m apart, and ends 0.3 m behind; the arches are outside it.
    arch = stones.points[_nodes(stones, stones.panel == "vault_nave_arch")]
    foot = np.abs(arch[arch[:, 2] < 5.0 + 1e-9, 0])
    assert (foot.min(), foot.max()) == pytest.approx((2.1, 2.9))
    # They weigh on walls that turn over: without them .18997.
    assert cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), 0.7).load_factor == pytest.approx(0.16675, abs=2e-5)
    for wrong, message in (
        ({"arches": 2}, r"vault\.arches: a groin vault has four sides; found 2; expected 4"),
        ({"arch_width": 0.5}, r"vaults\.0\.arch_width: the walls are too thin .*; found 0\.5 m; expected <= 0\.4 m"),
        ({"backing": 0.8}, r"vaults\.0\.arch_width: the walls are too thin .*; expected <= 0 m. Leave out backing"),
    ):
        with pytest.raises(InputError, match=message):
            chapel(vaults=(arched | wrong,), **CHAPEL)


def test_a_crossing_with_level_walls_takes_a_groin_vault() -> None:
    groin = {"over": "crossing", "kind": "groin", "thickness": 0.4, "courses": 13}
    stones, _ = sound(church(vaults=(BARREL, groin), **CROSS))
    assert {"vault_nave", "vault_crossing"} <= set(stones.panel)
    crossing = stones.centroid[stones.panel == "vault_crossing"]
    # Between the walls before and behind it, 5.3 m and 8.7 m.
    assert crossing[:, 1].mean() == pytest.approx(7.0, abs=1e-6)


SQUARE: dict[str, Any] = CROSS | {"transept": {"width": 9.0, "depth": 4.0, "thickness": 0.6, "height": 4.0}}
DOME = {"over": "crossing", "kind": "dome", "thickness": 0.3, "courses": 8}


@pytest.mark.slow
def test_a_square_crossing_takes_a_dome_on_slabs_across_its_corners() -> None:
    stones, contacts = sound(church(vaults=(DOME,), **SQUARE))
    parts = {"vault_crossing", "vault_crossing_slab_1", "vault_crossing_springer_4"}
    assert parts <= set(stones.panel)
    joined = {tuple(sorted(pair)) for pair in stones.panel[contacts.blocks].tolist()}
    assert {("vault_crossing", "vault_crossing_slab_1"), ("transept_left_inner", "vault_crossing_slab_2")} <= joined
    # The slabs' free edges are 1.7 m from the middle of the room, 3.4 m wide: an octagon.
    slabs = np.char.startswith(stones.panel, "vault_crossing_slab")
    assert slabs.sum() == 4
    corner = stones.points[_nodes(stones, slabs), :2] - [0.0, 7.0]
    assert np.abs(corner).sum(axis=1).min() == pytest.approx(1.7 * np.sqrt(2))
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), 0.7)
    assert state.status == "optimal"


def test_arches_below_a_barrel_stand_on_the_walls() -> None:
    arched = BARREL | {"arches": 3, "arch_width": 0.4, "arch_depth": 0.25}
    stones, contacts = sound(chapel(vaults=(arched,), **CHAPEL))
    joined = {tuple(sorted(pair)) for pair in stones.panel[contacts.blocks].tolist()}
    assert {("nave_left", "vault_nave_arch_2"), ("vault_nave", "vault_nave_arch_2")} <= joined
    arch, barrel = (stones.points[_nodes(stones, stones.panel == name)] for name in ("vault_nave_arch_1", "vault_nave"))
    on_wall = arch[arch[:, 2] < 5 + 1e-9], barrel[barrel[:, 2] < 5 + 1e-9]
    assert [np.abs(points[:, 0]).min() for points in on_wall] == pytest.approx([2.3, 2.55])


@pytest.mark.slow("docs/vaults.md: a barrel pushes its walls apart")
def test_a_barrel_pushes_its_walls_apart() -> None:
    # The load factor falls by more than half where a barrel presses on the walls without ties.
    factors = []
    for vaults in ((), (BARREL,)):
        stones, contacts = sound(chapel(vaults=vaults, **CHAPEL))
        factors.append(cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), 0.7).load_factor)
    assert factors[1] < 0.5 * factors[0]


@pytest.mark.parametrize(
    ("build", "vault", "message"),
    [
        ("chapel", {"over": "tower"}, r"chapel\.vaults\.0\.over: no such room; found tower; expected nave, apse"),
        ("chapel", {"thickness": 0.9}, r"vaults\.0\.thickness: thicker than the walls .*; found 0\.9 m; expected <= 0\.7 m"),
        ("chapel", {"springing": 4.5}, r"springing: the walls go on beside the vault; found z = 4\.5 m; expected z = 5 m"),
        ("chapel", {"courses": 12}, r"chapel\.vaults\.0\.courses: no key in the middle; found 12"),
        ("chapel", {"kind": "half_dome"}, r'vaults\.0\.kind: no vault for nave; found half_dome; expected kind = "barrel"'),
        ("chapel", {"over": "apse"}, r'chapel\.vaults\.0\.kind: no vault for apse; found barrel; expected kind = "half_dome"'),
        ("gabled", {"kind": "groin"}, r"the wall facade is not level under the vault; found z = .*; expected z = 5 m from -2\.3"),
        ("gabled", {}, r"vaults\.0: the vault rises above the ridge of the wall facade; found .* 7\.581 m; expected <= 7\.25"),
        (
            "window",
            {"shape": "segmental", "rise": 1.0},
            r"vaults\.0: springs below the head of the opening rose in .* facade; found head at z = 6\.4 m, soffit .* z = 5\.8",
        ),
        ("chapel", {"arches": 2}, r"vault\.arch_width: missing; found arches alone"),
        ("chapel", {"slab": 0.2}, r"slab: only a dome has one; found kind = barrel"),
        (
            "chapel",
            {"arches": 2, "arch_width": 0.3, "arch_depth": 0.5},
            r"thickness: thicker than .*; found 0\.8 m with the arches or ribs below it; expected <= 0\.7 m",
        ),
        ("chapel", {"kind": "dome", "courses": 8, "thickness": 0.5}, r"vaults\.0\.thickness: the dome reaches beyond .*"),
        ("chapel", {"kind": "dome", "courses": 8, "rise": 2.0}, r"vaults\.0\.rise: a dome has none of its own; found 2 m"),
        ("cross", {"over": "crossing", "kind": "pavilion"}, r"vaults\.0\.kind: the room is no square; found 3\.4 by 4\.4 m"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_named_with_its_numbers(build: str, vault: dict[str, Any], message: str) -> None:
    base: dict[str, Any] = CHAPEL | {"ridge": 7.25} if build == "gabled" else CROSS if build == "cross" else CHAPEL
    if build == "window":
        rose = {"name": "rose", "wall": "facade", "centre": 0.0, "width": 1.0, "springing": 5.5, "shape": "circle"}
        base = CHAPEL | {"ridge": 8.0, "openings": (rose | {"voussoirs": 12, "depth": 0.4},)}
    make = church if build == "cross" else chapel
    if build == "cross":
        base = CROSS | {"transept": {"width": 9.0, "depth": 5.0, "thickness": 0.6}}
    with pytest.raises(InputError, match=message):
        make(vaults=(BARREL | vault,), **base)


@pytest.mark.parametrize("kind", ["groin", "pavilion", "dome"])
def test_a_vault_on_the_corners_of_its_room_is_refused_beside_a_tower(kind: str) -> None:
    # The tower takes the whole arm: its walls rise from the corner of the nave, and stood in the vault.
    nave, facade = CROSS["nave"] | {"length": 4.0}, {"thickness": 0.6}
    tower = CROSS | {"nave": nave, "facade": facade, "tower": {"height": 6.0}}
    message = r"church\.vaults\.0: the wall nave_left goes on beside the vault.*; found z = 6 m at y = 3\.7 m; expected z = 4 m"
    with pytest.raises(InputError, match=message):
        church(vaults=({"over": "nave", "kind": kind, "thickness": 0.2, "courses": 9},), **tower)
    # A barrel ends before the triumphal arch, and a tower that takes a part of the arm leaves the corner free.
    sound(church(vaults=({"over": "nave", "thickness": 0.2, "courses": 9},), **tower))
    narrow = tower | {"transept": CROSS["transept"] | {"width": 12.0}, "tower": {"height": 6.0, "width": 2.0}}
    sound(church(vaults=({"over": "nave", "kind": kind, "thickness": 0.2, "courses": 9},), **narrow))


def test_a_room_has_one_vault() -> None:
    with pytest.raises(InputError, match=r"chapel\.vaults\.1\.over: has a vault already; found nave"):
        chapel(vaults=(BARREL, BARREL), **CHAPEL)


def test_a_barrel_lies_between_walls_of_unequal_thickness() -> None:
    walls = ({"wall": "nave_left", "thickness": 1.0},)
    stones, _ = sound(chapel(vaults=(BARREL,), walls=walls, **CHAPEL))
    inner = {name: stones.points[_nodes(stones, stones.panel == name), 0] for name in ("nave_left", "nave_right", "vault_nave")}
    clear = inner["nave_right"].min() - inner["nave_left"].max()
    assert np.ptp(inner["vault_nave"]) == pytest.approx(clear + 2 * 0.3)


def _nodes(stones: cp.Assemblage, chosen: np.ndarray) -> np.ndarray:
    return np.repeat(chosen, np.diff(stones.block_point_ptr))


def test_springings_lie_on_the_walls() -> None:
    building = chapel(vaults=(BARREL, HALF_DOME), **CHAPEL)
    assert [vault.foot for vault in building.vaults] == pytest.approx([5.0, 4.0])
    nave = building.vaults[0]
    inner = min(float(np.abs(run.section.corner[:, 0]).max()) for run in nave.runs if run.section.corner[:, 1].min() < 5.0 + 1e-9)
    assert inner == pytest.approx(2.3 + 0.3)
