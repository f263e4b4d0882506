"""Joints with a strength of their own, and what cohesion and weight would add.

Source: a block of width b and height h on a joint of friction mu turns over at b / h or slides at mu, the lesser; cohesion c of a
joint of area A adds c A / W to what it slides at.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.errors import InputError
from churchpipe.stones.joints import check_group
from solids import box

GAMMA = 18e3
DRY = cp.Material("default", unit_weight=GAMMA, friction=0.6)


def piled(*heights: float) -> tuple[cp.Assemblage, cp.Contacts]:
    """Blocks of 1 x 1 m on top of each other, walls "a", "b" ..."""
    levels = np.concatenate([[0.0], np.cumsum(heights)])
    solids = [box((-5, 5), (-5, 5), (-1, 0)), *(box((0, 1), (0, 1), pair) for pair in pairwise(levels))]
    names = ["", *"abcdef"[: len(heights)]]
    stones = cp.Assemblage.from_polyhedra(solids, GAMMA, [0], panel=names)
    return stones, cp.find_contacts(stones)


def load_factor(stones: cp.Assemblage, contacts: cp.Contacts, *groups: cp.JointGroup) -> float:
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), *cp.joint_strength(stones, contacts, [DRY], groups))
    assert state.status == "optimal"
    return state.load_factor


def test_kinds_walls_and_heights_pick_joints() -> None:
    stones, contacts = piled(0.25, 0.25, 0.25)
    assert load_factor(stones, contacts) == pytest.approx(0.6, rel=1e-6)
    slippery = {
        "base": cp.JointGroup("damp course", kind="base", friction=0.3),
        "between": cp.JointGroup("plane", between=("a", "b"), friction=0.3),
        "height": cp.JointGroup("clay", below=0.3, above=0.2, friction=0.3),
    }
    for group in slippery.values():
        # What slides is a part of all, and the load pushes all of it by its weight.
        assert load_factor(stones, contacts, group) == pytest.approx(0.3, rel=1e-6)
    # A joint picked twice has the strength of the later group.
    assert load_factor(stones, contacts, slippery["base"], cp.JointGroup("mended", kind="base", friction=0.5)) == pytest.approx(
        0.5
    )
    # Cohesion in the base alone leaves what is above it as it was; in all joints the base gives way: 0.3 + c A / W.
    groups = [cp.JointGroup(name, kind=kind, friction=0.3, cohesion=900.0) for name, kind in (("f", "base"), ("g", "bed"))]
    assert load_factor(stones, contacts, *groups) == pytest.approx(0.3 + 900.0 / (GAMMA * 0.75), rel=1e-6)


def test_a_group_of_no_joint_is_said() -> None:
    stones, contacts = piled(0.25, 0.25)
    for group, said in (
        (cp.JointGroup("x", walls=("z",), friction=0.1), "joints x: no such wall; found z; expected a, b"),
        (cp.JointGroup("x", kind="radial", friction=0.1), "joints x: no such joint"),
    ):
        with pytest.raises(InputError, match=said):
            cp.joint_strength(stones, contacts, [DRY], [group])
    for arguments, said in (
        ({"kind": "base"}, "joints x: no strength"),
        ({"friction": 0.1}, "joints x: all joints"),
        ({"kind": "bass", "friction": 0.1}, "joints x: kind"),
        ({"kind": "base", "friction": -0.1}, "joints x: friction: out of range"),
        ({"above": 2.0, "below": 1.0, "friction": 0.1}, "joints x: no height"),
        ({"between": ("a", "a"), "friction": 0.1}, "joints x: between: not two walls"),
    ):
        with pytest.raises(InputError, match=said):
            cp.JointGroup("x", **arguments)


def test_the_shell_takes_groups_of_walls_and_heights() -> None:
    building = generators.wall(length=3.0, brick=(0.5, 0.5, 0.25), courses=8, thickness=0.5, materials=(DRY,))
    shell = cp.derive_shell(building, 0.5)
    push = cp.LoadCase((1, 0, 0))
    weak = cp.JointGroup("wet foot", below=0.6, friction=0.2)
    mesh, materials = cp.shell_joint_groups(shell, [DRY], [weak])
    z = shell.points[shell.triangles, 2]
    below, beside = z.max(axis=1) <= 0.6, z.min(axis=1) < 0.6
    beside = np.isin(shell.triangles, shell.triangles[beside]).any(axis=1)
    assert (mesh.material[below] == "default, wet foot").all()
    assert (mesh.material[beside & ~below] == "default, wet foot in part").all()
    assert (mesh.material[~beside] == "default").all()
    # What is above slides on it, within the convergence of this mesh; with the friction of the rest the wall leans first.
    assert cp.shell_limit_analysis(mesh, push, materials).load_factor == pytest.approx(0.2, rel=1e-3)
    assert cp.shell_limit_analysis(shell, push, [DRY]).load_factor > 0.3
    with pytest.raises(InputError, match="joints foot: not in the shell; found base"):
        cp.shell_joint_groups(shell, [DRY], [cp.JointGroup("foot", kind="base", friction=0.2)])


@pytest.mark.parametrize("element", [0.5, 0.25])
@pytest.mark.parametrize("height", [1.25, 1.5])
def test_one_weak_bed_runs_through_the_shell(element: float, height: float) -> None:
    # What is above a damp course slides on it at its friction. The elements are no rows, and the teeth between those that bear
    # the course and the others hold a little. When facets were picked by their middles, most passed the course by: .34 to .36.
    building = generators.wall(length=6.0, brick=(1.0, 0.5, 0.5), courses=6, thickness=0.5, materials=(DRY,))
    shell, push = cp.derive_shell(building, element), cp.LoadCase((1, 0, 0))
    damp = cp.JointGroup("damp course", walls=("wall",), above=height - 0.1, below=height + 0.1, friction=0.1)
    mesh, materials = cp.shell_joint_groups(shell, [DRY], [damp])
    found = cp.shell_limit_analysis(mesh, push, materials).load_factor
    assert 0.1 - 1e-6 < found < 0.11
    # A strength that only part of a facet has is no strength of that facet.
    firm = cp.JointGroup("firm", above=height - 0.1, below=height + 0.1, friction=0.9)
    mesh, materials = cp.shell_joint_groups(shell, [DRY], [firm])
    assert set(mesh.material.tolist()) == {"default"}
    # Of friction and cohesion each is the lesser.
    glued = cp.JointGroup("glued", above=height - 0.1, below=height + 0.1, friction=0.1, cohesion=1e5)
    mesh, materials = cp.shell_joint_groups(shell, [DRY], [glued])
    assert {(one.friction, one.cohesion) for one in materials if one.name in mesh.material} == {(0.6, 0.0), (0.1, 0.0)}


def wall_of(number: int) -> tuple[cp.Assemblage, cp.Contacts, cp.LoadCase, np.ndarray]:
    """A brick wall with a ragged strength of joints, by its number."""
    rng = np.random.default_rng(number)
    courses, bricks = int(rng.integers(4, 8)), int(rng.integers(3, 6))
    building = generators.wall(length=0.5 * bricks, brick=(0.5, 0.25, 0.25), courses=courses, materials=(DRY,))
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    angle = rng.uniform(0, 0.5 * np.pi)
    load = cp.LoadCase((np.cos(angle), np.sin(angle), 0))
    return stones, contacts, load, rng.uniform(0.4, 0.8, len(contacts.area))


@pytest.mark.parametrize(
    "number",
    [
        0,
        1,
        *(
            pytest.param(number, marks=pytest.mark.slow("docs/theory.md: what a change of the joints changes"))
            for number in range(2, 10)
        ),
    ],
)
def test_rates_are_finite_differences(number: int) -> None:
    # Cohesion of all joints, weight of the upper half of the stones, and the strength of a tie, on ten walls.
    stones, contacts, load, friction = wall_of(number)
    base = 2e3
    top = np.flatnonzero(stones.centroid[:, 2] > np.median(stones.centroid[:, 2]))
    panel = np.where(np.isin(np.arange(stones.count), top), "top", stones.panel)
    named = cp.Assemblage(**{**{f: getattr(stones, f) for f in stones.__dataclass_fields__}, "panel": panel})
    low = int(np.flatnonzero(~stones.fixed)[0])
    tie = cp.Tie("t", tuple(stones.centroid[top[-1]]), tuple(stones.centroid[low]), stones=(int(top[-1]), low), strength=50.0)

    def factor(cohesion: float = base, weight: float = 0.0, strength: float = 50.0) -> cp.LimitState:
        spread = np.where(np.isin(np.arange(stones.count), top), stones.volume, 0.0)
        more = weight * spread / spread.sum()
        dead, live = np.zeros((stones.count, 6)), np.zeros((stones.count, 6))
        dead[:, 2], live[:, :3] = -more, more[:, None] * load.direction
        bar = cp.Tie("t", tie.start, tie.end, stones=tie.stones, strength=strength)
        case = cp.LoadCase(load.direction, dead=dead, live=live)
        state = cp.limit_analysis(stones, contacts, case, friction, cohesion, ties=[bar])
        assert state.status == "optimal"
        return state

    asis = factor()
    rates = cp.sensitivities(asis, named, contacts, load)
    total = float(stones.weight.sum())
    by_cohesion = (factor(cohesion=base + 20.0).load_factor - factor(cohesion=base - 20.0).load_factor) / 40.0
    assert rates.joint.sum() == pytest.approx(rates.cohesion.sum(), rel=1e-9)
    assert rates.cohesion.sum() * base == pytest.approx(by_cohesion * base, abs=1e-4 * asis.load_factor)
    # The load factor is of the weight of what is pushed, the added weight included.
    step = 2e-3 * total
    by_weight = (factor(weight=step).load_factor - factor(weight=-step).load_factor) / (2 * step)
    own = rates.weight[rates.panel.tolist().index("top")]
    assert own * total == pytest.approx(by_weight * total, abs=1e-4 * max(1.0, abs(own * total)))
    by_tie = (factor(strength=51.0).load_factor - factor(strength=49.0).load_factor) / 2.0
    assert asis.tie_sensitivity[0] * total == pytest.approx(by_tie * total, abs=1e-4 * max(1.0, by_tie * total))


def test_rates_need_an_associative_mechanism() -> None:
    stones, contacts = piled(0.25)
    load = cp.LoadCase((1, 0, 0))
    state = cp.limit_analysis(stones, contacts, load, 0.6, flow="non-associative")
    with pytest.raises(InputError, match="no rates; found non-associative"):
        cp.sensitivities(state, stones, contacts, load)


def test_what_would_help_most_is_analysed_again() -> None:
    # A cube that slides on the ground at mu + c A / W, W with what is added; one beside it that stands.
    plate = box((-9, 9), (-9, 9), (-1, 0))
    stones = cp.Assemblage.from_polyhedra(
        [plate, box((0, 1), (0, 1), (0, 1)), box((3, 5), (0, 2), (0, 1))], 18e3, [0], panel=["", "weak", "firm"]
    )
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    friction = np.where((contacts.blocks == 1).any(axis=1), 0.3, 0.9)
    state = cp.limit_analysis(stones, contacts, load, friction, 900.0)
    assert state.load_factor == pytest.approx(0.3 + 900 / 18e3, rel=1e-6)
    rates = cp.sensitivities(state, stones, contacts, load)
    found = cp.verify_gains(rates, stones, contacts, load, friction, 900.0, best=1)
    assert found.panel.tolist() == ["firm", "weak"]
    # The tangent of mu + c A / W holds for any c, and that of 1 / W is above the curve; the firm cube does not matter.
    assert found.with_cohesion[1] == pytest.approx(0.3 + 10900 / 18e3, rel=1e-6)
    assert state.load_factor + 10e3 * found.cohesion[1] == pytest.approx(found.with_cohesion[1], rel=1e-5)
    assert found.weight == pytest.approx([0.0, -900 / 18e3**2], abs=1e-10)
    assert found.with_weight[0] == pytest.approx(state.load_factor, rel=1e-6)
    assert np.isnan(found.with_cohesion[0])
    assert np.isnan(found.with_weight[1])


def test_no_wall_gains_more_than_its_tangent() -> None:
    stones, contacts, load, friction = wall_of(3)
    top = stones.centroid[:, 2] > np.median(stones.centroid[:, 2])
    stones = replace(stones, panel=np.where(top, "top", stones.panel))
    state = cp.limit_analysis(stones, contacts, load, friction, 2e3)
    found = cp.verify_gains(cp.sensitivities(state, stones, contacts, load), stones, contacts, load, friction, 2e3, best=2)
    # The load factor is concave in the cohesion.
    most = state.load_factor + 10e3 * found.cohesion
    assert (found.with_cohesion <= most * (1 + 1e-6)).all()
    assert (found.with_cohesion >= state.load_factor * (1 - 1e-6)).all()


def test_walls_apart_have_no_joints() -> None:
    stones, _ = piled(0.5, 0.5, 0.5)
    check_group(stones, cp.JointGroup("j", between=("a", "b"), friction=0.3))
    with pytest.raises(InputError, match="joints j: walls that do not meet; found a and c"):
        check_group(stones, cp.JointGroup("j", between=("a", "c"), friction=0.3))
    with pytest.raises(InputError, match=r"joints j: no stones there; found below -0\.1 m"):
        check_group(stones, cp.JointGroup("j", below=-0.1, friction=0.3))
