"""Stones of vaults of random dimensions, seeded: laid without gaps or overlaps, as large as the shape that they fill."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from churchpipe import generators
from churchpipe.dxf.reader import read_dxf
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.generators.profile import Profile, to_middle, under_soffit
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import check_soundness

Rng = np.random.Generator


def curve(rng: Rng, span: float) -> dict[str, Any]:
    shape = str(rng.choice(["round", "segmental", "pointed"]))
    rise = {"segmental": rng.uniform(0.3, 0.9), "pointed": rng.uniform(1.1, 1.8)}
    return {"shape": shape} | ({"rise": rise[shape] * span / 2} if shape in rise else {})


def barrel(rng: Rng) -> dict[str, Any]:
    span = rng.uniform(2.0, 6.0)
    size = {"span": span, "thickness": rng.uniform(0.05, 0.1) * span, "length": rng.uniform(1.0, 3.0)} | curve(rng, span)
    return size | {"courses": int(2 * rng.integers(4, 9) + 1), "stone_length": rng.uniform(0.3, 0.7)}


def on_walls(rng: Rng) -> dict[str, Any]:
    found = barrel(rng)
    return found | {
        "wall_height": 1.0,
        "wall_course": 0.25,
        "wall_thickness": found["thickness"] * rng.uniform(1.5, 3.0),
        "backing": 0.4 * found["span"] / 2,
    }


def rings_on_walls(rng: Rng) -> dict[str, Any]:
    """With masonry on the haunches, which follows the backs of rings that are staggered and of rings that are not."""
    return on_walls(rng) | {"laid": "rings", "heads": str(rng.choice(["staggered", "aligned"]))}


def ribbed(rng: Rng) -> dict[str, Any]:
    found = barrel(rng)
    return found | {
        "arches": 3,
        "arch_width": 0.3,
        "arch_depth": 0.1 * found["span"] / 2,
        "laid": str(rng.choice(["courses", "rings"])),
    }


def groin(rng: Rng) -> dict[str, Any]:
    found = on_walls(rng) | {"kind": "groin", "second_span": rng.uniform(2.0, 6.0)}
    del found["length"]
    return found | {"corner": str(rng.choice(["round", "alternate", "mitre"]))}


def cloister(rng: Rng) -> dict[str, Any]:
    found = groin(rng) | {"kind": str(rng.choice(["pavilion", "octagonal"]))}
    del found["second_span"]
    return found


def dome(rng: Rng) -> dict[str, Any]:
    span = rng.uniform(2.0, 8.0)
    found: dict[str, Any] = {"span": span, "thickness": rng.uniform(0.04, 0.1) * span, "rings": int(rng.integers(4, 10))}
    found |= {"sides": int(rng.choice([8, 16, 24])), "laid": str(rng.choice(["staggered", "lunes"]))}
    if rng.random() < 0.5:
        found |= {"rise": rng.uniform(0.4, 0.9) * span / 2}
    return found


def wider_above(rng: Rng) -> dict[str, Any]:
    found = dome(rng) | {"sides": int(rng.choice([32, 48, 64])), "laid": "staggered", "plan": str(rng.choice(["full", "half"]))}
    turn = math.pi if found["plan"] == "half" else 2 * math.pi
    return found | {"shortest_stone": rng.uniform(0.5, 0.9) * found["span"] * turn / found["sides"]}


def crowned(rng: Rng) -> dict[str, Any]:
    found = dome(rng)
    found |= {
        "oculus": 0.25 * found["span"],
        "lantern_height": 0.6,
        "lantern_course": 0.2,
        "lantern_thickness": found["thickness"],
    }
    return found | {"drum_height": 1.0, "drum_course": 0.25, "drum_thickness": found["thickness"] * rng.uniform(1.2, 2.0)}


def apse(rng: Rng) -> dict[str, Any]:
    return dome(rng) | {"plan": "half", "front": str(rng.choice(["free", "wall"]))}


def arched_groin(rng: Rng) -> dict[str, Any]:
    found = groin(rng)
    for key in ("wall_height", "wall_course", "wall_thickness", "backing"):
        del found[key]
    deep = 0.1 * min(found["span"], found["second_span"])
    return found | {"shape": "round", "arches": 4, "arch_width": rng.uniform(0.2, 0.5), "arch_depth": deep}


def ribbed_groin(rng: Rng) -> dict[str, Any]:
    found: dict[str, Any] = groin(rng) | {"shape": "round"}
    if rng.random() < 0.5:
        for key in ("wall_height", "wall_course", "wall_thickness", "backing"):
            del found[key]
    deep = 0.08 * min(found["span"], found["second_span"])
    return found | {"rib_depth": deep, "rib_width": rng.uniform(0.3, 0.8) * found["thickness"]}


def vaulted_chapel(rng: Rng) -> dict[str, Any]:
    room = 0.25 * float(rng.integers(12, 24))
    thickness, wall = 0.04 * room + rng.uniform(0.05, 0.15), 0.2 * room
    over: dict[str, Any] = {"over": "nave", "kind": str(rng.choice(["barrel", "groin", "pavilion", "dome"]))}
    over |= {"thickness": thickness, "courses": int(2 * rng.integers(4, 8) + 1)}
    if over["kind"] == "barrel":
        over |= {"arches": 3, "arch_width": 0.3, "arch_depth": wall - thickness}
    if over["kind"] == "groin":
        over |= {"rib_width": rng.uniform(0.5, 1.2) * thickness, "rib_depth": 0.04 * room}
    half = {"over": "apse", "kind": "half_dome", "thickness": 0.15, "courses": 6, "sides": int(rng.choice([8, 12, 16]))}
    half["shortest_stone"] = 0.3 * math.pi * room / half["sides"]
    whole = room + 2 * wall
    found = {"course": 0.5, "stone_length": 0.8, "width": whole, "length": whole, "height": 3.0, "thickness": wall}
    return found | {"apse": {"inner_radius": 0.25 * room, "thickness": 0.2, "height": 2.0}, "vaults": (over, half)}


KINDS: dict[str, tuple[Callable[..., Building], Callable[[Rng], dict[str, Any]]]] = {
    "barrel": (generators.vault, barrel),
    "barrel on walls": (generators.vault, on_walls),
    "rings on walls": (generators.vault, rings_on_walls),
    "barrel on arches": (generators.vault, ribbed),
    "groin": (generators.vault, groin),
    "cloister": (generators.vault, cloister),
    "dome": (generators.dome, dome),
    "dome of wider stones above": (generators.dome, wider_above),
    "dome with drum and lantern": (generators.dome, crowned),
    "half dome": (generators.dome, apse),
    "groin in wall arches": (generators.vault, arched_groin),
    "groin on ribs": (generators.vault, ribbed_groin),
    "chapel": (generators.chapel, vaulted_chapel),
}


@pytest.mark.parametrize("number", [1, pytest.param(3, marks=pytest.mark.slow("docs/vaults.md: random vaults are laid"))])
@pytest.mark.parametrize("kind", KINDS)
def test_random_vaults_are_laid(kind: str, number: int) -> None:
    build, sizes = KINDS[kind]
    rng = np.random.default_rng(list(kind.encode()))
    count = 0
    while count < number:
        try:
            building = build(**sizes(rng))
        except InputError:
            continue  # The generator names what does not fit; what it accepts must be laid.
        laid(building)
        count += 1


def laid(building: Building) -> Assemblage:
    """The stones of a building, sound, each held from below. The volume identity, to 1e-9, is checked while laying.

    The joints of a key in a flat vault are nearly upright: any lean counts.
    """
    stones = derive_blocks(building)
    contacts = find_contacts(stones)
    check_soundness(stones, contacts)
    up = contacts.frame[:, 0, 2]
    held = np.concatenate([contacts.blocks[up > 1e-3, 1], contacts.blocks[up < -1e-3, 0]])
    assert not len(np.setdiff1d(np.flatnonzero(~stones.fixed), held))
    return stones


def under(points: np.ndarray, plan: Callable[[float], float]) -> float:
    """Volume below a curve of half widths and heights (n, 2), straight between them, of the plan area of a half width."""
    return sum((b[1] - a[1]) / 6 * (plan(a[0]) + 4 * plan((a[0] + b[0]) / 2) + plan(b[0])) for a, b in pairwise(points))


def shell_volume(joints: np.ndarray, plan: Callable[[float], float]) -> float:
    """Between back and soffit of a vault closed by a level key, with the joints of half its curve."""
    return under(joints[:, 1], plan) - under(joints[:, 0], plan)


@pytest.mark.parametrize("corner", ["round", "alternate", "mitre"])
def test_volumes_are_those_of_the_shapes(corner: str) -> None:
    size: dict[str, Any] = {"span": 4.0, "thickness": 0.3, "courses": 13, "stone_length": 0.5, "corner": corner}
    joints = Profile("vault", 4.0, 0.3, 13).half.joints
    border = 2.3
    # In plan a cloister vault of n sides covers n w^2 tan(pi/n), a groin vault all but four corners of a square.
    plans = {
        "pavilion": lambda w: 4 * w**2,
        "octagonal": lambda w: 8 * math.tan(math.pi / 8) * w**2,
        "groin": lambda w: 4 * (border**2 - (border - w) ** 2),
    }
    for kind, plan in plans.items():
        stones = laid(generators.vault(kind=kind, **size))
        expected = shell_volume(joints, plan)
        # The groin's back is open above the crown's joint at the borders, and so is its soffit.
        assert stones.volume[~stones.fixed].sum() == pytest.approx(expected, rel=1e-9), kind


def test_ribs_lie_below_the_groins() -> None:
    # Each of their eight halves is its section times a constant length, since its sides are parallel to the groin.
    size: dict[str, Any] = {"span": 4.0, "thickness": 0.3, "courses": 13, "stone_length": 0.5, "kind": "groin"}
    joints = Profile("vault", 4.0, 0.3, 13).half.joints
    section = sum(own.area for own in to_middle(under_soffit(joints, 0.2)))
    for ratio in (1.0, 0.75):
        stones = laid(generators.vault(**size, second_span=4.0 * ratio, rib_width=0.3, rib_depth=0.2))
        ribs = stones.panel == "rib"
        along, across = math.hypot(1, ratio), math.hypot(1, 1 / ratio) * ratio
        assert stones.volume[ribs].sum() == pytest.approx(4 * 0.15 * (along + across) * section, rel=1e-9)
        # Six stones in each of four half ribs, and the boss in which they meet.
        assert ribs.sum() == 4 * 6 + 1
        assert np.ptp(stones.centroid[ribs][:, :2], axis=0) == pytest.approx(np.array([1.0, ratio]) * 3.8, abs=0.1)


def test_volume_of_a_barrel_and_of_a_dome() -> None:
    size: dict[str, Any] = {"span": 3.8, "thickness": 0.4, "courses": 15, "stone_length": 0.5, "length": 2.0}
    area = 15 * math.sin(math.pi / 15) / 2 * (2.3**2 - 1.9**2)
    for laid_in in ("courses", "rings"):
        stones = laid(generators.vault(laid=laid_in, **size))
        of_half_voussoirs = 30 * math.sin(math.pi / 30) / 2 * (2.3**2 - 1.9**2)
        expected = 2.0 * (area if laid_in == "courses" else of_half_voussoirs)
        assert stones.volume[~stones.fixed].sum() == pytest.approx(expected, rel=1e-9)
    stones = laid(generators.dome(span=3.8, thickness=0.4, rings=6, sides=16))
    angle = math.pi / 12 * np.arange(6)
    joints = np.stack([r * np.stack([np.cos(angle), np.sin(angle)], axis=1) for r in (1.9, 2.3)], axis=1)
    expected = shell_volume(joints, lambda w: 8 * math.sin(math.pi / 8) * w**2)
    assert stones.volume[~stones.fixed].sum() == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow("docs/vaults.md: a dome of fewer stones towards the crown")
def test_rings_towards_the_crown_have_half_as_many_stones() -> None:
    size: dict[str, Any] = {"span": 7.6, "thickness": 0.4, "rings": 24, "sides": 64}
    plain, stones = laid(generators.dome(**size)), laid(generators.dome(**size, shortest_stone=0.45))
    # The same rings in fewer stones; the sides of the plan, and so the surfaces, stay.
    assert stones.volume.sum() == pytest.approx(plain.volume.sum(), rel=1e-12)
    rings = np.bincount(stones.course[~stones.fixed]).tolist()
    assert rings == [32] * 14 + [16] * 6 + [8] * 3 + [1]
    # Heads as angles in sides of the plan: none lies over a head of the ring below.
    contacts = find_contacts(stones)
    beside = contacts.blocks[np.ptp(stones.course[contacts.blocks], axis=1) == 0]
    middle = stones.centroid[beside].mean(axis=1)
    turn = np.round(np.arctan2(middle[:, 1], middle[:, 0]) * 32 / np.pi, 6) % 64
    heads = [set(turn[stones.course[beside[:, 0]] == ring].tolist()) for ring in range(23)]
    assert [len(own) for own in heads] == rings[:-1]
    assert not any(lower & upper for lower, upper in pairwise(heads))
    # So a stone of 16 in a ring lies on three of 32, on the middle one wholly.
    first = np.flatnonzero(stones.course == 14)[0]
    touching = contacts.blocks[(contacts.blocks == first).any(axis=1)]
    assert len(np.setdiff1d(touching[(stones.course[touching] == 13).any(axis=1)], [first])) == 3


def test_a_pointed_key_is_one_stone_and_its_halves_meet_at_the_crown() -> None:
    profile = Profile("vault", 2.0, 0.2, 9, "pointed", 1.5)
    key = to_middle(profile.half)[-1]
    assert key.corner[:, 0].min() == pytest.approx(0.0, abs=1e-12)
    assert key.corner[:, 1].max() > profile.half.joints[-2, 1, 1] + 0.01
    stones = laid(generators.vault(span=2.0, thickness=0.2, courses=9, shape="pointed", rise=1.5, stone_length=5.0, length=1.0))
    assert stones.count == 1 + 9


def test_a_vault_goes_to_cad_and_back(tmp_path: Path) -> None:
    sizes: dict[str, Any] = {"span": 3.0, "thickness": 0.3, "rings": 5, "sides": 16}
    drum: dict[str, Any] = {"drum_height": 0.5, "drum_thickness": 0.4, "drum_course": 0.25}
    groin: dict[str, Any] = {"span": 3.0, "thickness": 0.3, "courses": 9, "stone_length": 0.6, "kind": "groin"}
    for building in (generators.dome(**sizes, **drum), generators.vault(**groin)):
        stones = laid(building)
        write_dxf(stones, tmp_path / "vault.dxf")
        drawn, findings = read_dxf(tmp_path / "vault.dxf")
        assert not findings.errors
        assert drawn.volume.sum() == pytest.approx(stones.volume.sum(), rel=1e-12)
        for key in ("panel", "course", "block_id"):
            assert sorted(getattr(drawn, key).tolist()) == sorted(getattr(stones, key).tolist())
        assert len(find_contacts(drawn).area) == len(find_contacts(stones).area)


def test_macro_elements_have_names() -> None:
    building = generators.dome(
        span=4.0, thickness=0.3, rings=6, sides=16, oculus=1.0, drum_height=0.5, drum_thickness=0.4, drum_course=0.25,
        lantern_height=0.4, lantern_thickness=0.2, lantern_course=0.2,
    )  # fmt: skip
    assert building.macro_elements == ("drum", "dome", "lantern")
    stones = laid(building)
    assert set(stones.panel[1:]) == {"drum", "dome", "lantern"}
    assert "lantern-09-000" in stones.block_id


@pytest.mark.parametrize(
    ("build", "change", "message"),
    [
        ("vault", {"courses": 8}, r"vault\.courses: no key in the middle; found 8; expected an odd number, such as 9"),
        ("vault", {"length": None}, r"vault\.length: missing"),
        ("vault", {"shape": "segmental"}, r"vault\.rise: given or left out wrongly"),
        ("vault", {"shape": "segmental", "rise": 1.2}, r"vault\.rise: no segmental vault; found 1\.2 m; expected < half"),
        ("vault", {"kind": "groin"}, r"vault\.length: only a barrel has one"),
        ("vault", {"wall_height": 1.0}, r"vault\.wall_thickness: missing; found wall_height alone"),
        (
            "vault",
            {"wall_height": 1.0, "wall_course": 0.25, "wall_thickness": 0.1},
            r"vault\.wall_thickness: the vault does not fit on its walls; found 0\.1 m; expected >= 0\.2 m",
        ),
        ("vault", {"backing": 0.01}, r"vault\.backing: lower than the first course of the vault; found 0\.01 m"),
        ("vault", {"rib_width": 0.1, "rib_depth": 0.1}, r"vault\.rib_width: only a groin vault has one"),
        (
            "vault",
            {"rib_width": 0.5, "rib_depth": 0.1, "kind": "groin", "length": None},
            r"vault\.rib_width: ribs spring beside the corners; found 0\.5 m; expected <= 0\.2828 m",
        ),
        ("dome", {"sides": 15}, r"dome\.sides: stones do not go round; found 15 sides, 2 a stone"),
        ("dome", {"stone_sides": 1}, r"dome\.stone_sides: stones cannot be shifted by half"),
        ("dome", {"oculus": 5.0}, r"dome\.oculus: no dome is left; found 5 m; expected < 4 m"),
        ("dome", {"lantern_height": 1.0}, r"dome\.lantern_thickness: missing"),
        ("dome", {"shortest_stone": 1.9}, r"dome\.shortest_stone: longer than the stones at the springing; found 1\.9 m"),
        ("dome", {"shortest_stone": 0.5, "laid": "lunes"}, r"dome\.shortest_stone: lunes keep their joints to the crown"),
        ("dome", {"front": "wall"}, r"dome\.front: only a half dome has a front"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_named(build: str, change: dict[str, Any], message: str) -> None:
    base: dict[str, Any] = {
        "vault": {"span": 2.0, "thickness": 0.2, "courses": 9, "stone_length": 0.5, "length": 2.0},
        "dome": {"span": 4.0, "thickness": 0.3, "rings": 6, "sides": 16},
    }[build]
    with pytest.raises(InputError, match=message):
        getattr(generators, build)(**(base | change))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"shape": "segmental", "rise": 0.5}, r"wall_top: no wall goes on beside a segmental vault.* leave wall_top out"),
        (
            dict.fromkeys(("wall_height", "wall_thickness", "wall_course")),
            "wall_top: no wall goes on; expected wall_height and wall_course",
        ),
    ],
)
def test_why_no_wall_goes_on_beside_a_vault_is_said(changes: dict[str, Any], said: str) -> None:
    given: dict[str, Any] = {"span": 3.0, "thickness": 0.3, "courses": 11, "stone_length": 0.6, "length": 2.0}
    walls = {"wall_height": 1.0, "wall_thickness": 0.9, "wall_course": 0.5, "wall_top": 2.0}
    with pytest.raises(InputError, match=said):
        generators.vault(**{key: value for key, value in (given | walls | changes).items() if value is not None})
