"""Vaults on the ledges of walls in the shell: moments about the toes of walls by hand, and the stones of the same building."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.config.case import Generated
from churchpipe.errors import InputError
from churchpipe.generators import chapel, dome, vault
from churchpipe.generators.profile import wall
from churchpipe.model.building import Building
from churchpipe.model.ring_beam import RingBeam
from churchpipe.model.vault import Side
from churchpipe.shell_mesh.ledges import with_ledges
from churchpipe.vaults.barrel import add_barrel
from churchpipe.vaults.sweep import Courses
from shell_meshes import check_follows_rigid_motions

MATERIAL = (cp.Material("default", 18e3, 0.7),)
APSE = {"inner_radius": 1.2, "thickness": 0.6, "height": 2.0}
THICK, LOW, THIN, HIGH = 0.6, 2.0, 0.2, 1.0


def stepped(thin: float = THIN, length: float = 0.5) -> Building:
    """A wall with its faces at x = 0 and THICK, and a thinner one on its inner edge, x = 0 to `thin`."""
    courses = Courses()
    side = Side(np.zeros(2), np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    for part, sections in (("lower", wall(0.0, THICK, 0.0, 4, LOW / 4)), ("upper", wall(0.0, thin, LOW, 2, HIGH / 2))):
        add_barrel(courses, sections, side, (0.0, length), 0.5, stagger=True, part=part)
    return Building("stepped", (), MATERIAL, vaults=(courses.vault("walls", "default"),))


@pytest.mark.parametrize(
    ("thin", "way"),
    [
        pytest.param(0.3, 1.0, marks=pytest.mark.slow("docs/vault_validation.md: walls on ledges")),
        pytest.param(0.3, -1.0, marks=pytest.mark.slow),
        (0.15, 1.0),
    ],
)
def test_a_wall_turns_with_what_stands_on_its_edge(thin: float, way: float) -> None:
    # About the toe ahead: (W1 T/2 + W2 arm) / (W1 h1/2 + W2 (h1 + h2/2)), arm = T - t/2 outwards and t/2 inwards; the upper wall
    # alone: t/h2.
    lower, upper = THICK * LOW, thin * HIGH
    arm = THICK - thin / 2 if way > 0 else thin / 2
    turned = (lower * THICK / 2 + upper * arm) / (lower * LOW / 2 + upper * (LOW + HIGH / 2))
    expected = min(turned, thin / HIGH)
    stones, load = cp.derive_blocks(stepped(thin)), cp.LoadCase((way, 0, 0))
    assert cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.7).load_factor == pytest.approx(expected, rel=1e-6)
    state = cp.shell_limit_analysis(cp.derive_shell(stepped(thin), 0.25), load, MATERIAL)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected, rel=1e-6)


def barrel(**sizes: float) -> Building:
    """A barrel on the inner ledges of walls .9 m thick."""
    walls = {"wall_height": 4.0, "wall_thickness": 0.9, "wall_course": 0.5} | sizes
    return vault(span=4.7, thickness=0.3, courses=27, stone_length=0.5, length=1.0, materials=MATERIAL, **walls)


def vaulted_chapel() -> Building:
    """A chapel with a flat barrel between its gables."""
    case = cp.read_case("pipeline/cases/chapel.toml")
    over = {"over": "nave", "kind": "barrel", "thickness": 0.3, "courses": 19, "rise": 1.5, "shape": "segmental"}
    source = case.source
    assert isinstance(source, Generated)
    return replace(case, source=replace(source, parameters=source.parameters | {"vaults": (over,)})).building()


@pytest.mark.parametrize("build", [barrel, vaulted_chapel])
def test_a_foot_follows_every_rigid_motion_of_its_wall(build: Callable[[], Building]) -> None:
    # Then forces and moments at the foot reach the wall in full: the transpose of the same map carries them.
    shell = cp.derive_shell(build(), 0.7)
    assert len(shell.ledges) > 3
    check_follows_rigid_motions(shell, seed=0)


@pytest.mark.slow("docs/vault_validation.md: a barrel between walls that go on")
@pytest.mark.parametrize("sizes", [{}, {"wall_top": 5.0}])
def test_two_walls_and_a_barrel_fall_as_their_stones_do(sizes: dict[str, float]) -> None:
    building, load = barrel(**sizes), cp.LoadCase((1, 0, 0))
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    expected = cp.limit_analysis(stones, contacts, load, 0.7).load_factor
    shell = cp.derive_shell(building, 0.25)
    assert cp.match_models(stones, contacts, shell).passed
    # .0452: walls and vault fall together; .0484: walls that go on leave it to the vault, whose hinges the shell spreads.
    assert cp.shell_limit_analysis(shell, load, MATERIAL).load_factor == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
def test_a_vaulted_chapel_passes_the_gate() -> None:
    building = vaulted_chapel()
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, 0.7)
    match = cp.match_models(stones, cp.find_contacts(stones), shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    assert shell.weight[shell.panel == "vault_nave"].sum() == pytest.approx(stones.weight[stones.panel == "vault_nave"].sum())


def test_a_foot_beside_its_wall_is_named() -> None:
    shell = cp.derive_shell(barrel(), 0.5)
    high = shell.centroid[:, 2] > 4.0
    apart = np.unique(shell.triangles[high])
    points = shell.points.copy()
    points[apart, 1] += 5.0
    with pytest.raises(InputError, match=r"shell of vault: its foot stands on no wall; found at \[.* m from the middle"):
        with_ledges(replace(shell, points=points, ledges=np.empty((0, 2, 2), dtype=np.int64)), high)


def test_a_half_dome_against_a_fixed_wall_has_no_shell() -> None:
    # Clamped along its front, against pulling off and sliding too, it came out "unbounded"; its stones have .74 along the wall.
    fixed = dome(span=1.8, thickness=0.2, rings=8, sides=16, plan="half", front="wall", materials=MATERIAL)
    with pytest.raises(InputError, match=r"shell of dome: ends against a fixed body; found at \[.*0\.0, .* m; expected fixed"):
        cp.derive_shell(fixed, 0.25)


def test_the_end_of_a_barrel_presses_on_the_wall_before_it() -> None:
    # Strips reach from the ends to the middles of both gables, as far as these rise.
    shell = cp.derive_shell(vaulted_chapel(), 0.7)
    front = shell.panel == "vault_nave front"
    assert front.any()
    assert shell.weight[front].sum() == 0
    assert set(shell.bonds[shell.cell[front]].tolist()) == {"butt"}
    assert np.unique(shell.panel[shell.held[:, 1]]).tolist() == ["east", "facade"]
    assert np.unique(shell.points[shell.held[:, 0], 1].round(9)).tolist() == pytest.approx([0.0, 8.3])


def domed() -> Building:
    """A square room of 4.6 m, its walls 0.7 x 3 m, and on slabs across its corners a dome 0.3 m thick."""
    over = {"over": "nave", "kind": "dome", "thickness": 0.3, "courses": 8}
    room = {"width": 6.0, "length": 6.0, "height": 3.0, "thickness": 0.7}
    return chapel(course=0.25, stone_length=0.5, vaults=(over,), materials=MATERIAL, **room)


def test_a_dome_on_slabs_passes_the_gate() -> None:
    building = domed()
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, 0.75)
    match = cp.match_models(stones, cp.find_contacts(stones), shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    # Four slabs and four stones between them, rigid in both models, hold the foot of the dome and the walls below it.
    assert shell.beams.count == 8
    assert shell.body_weight.sum() == pytest.approx(stones.weight.sum(), rel=1e-6)
    foot = (np.abs(shell.points[:, 2] - 3.3) < 1e-9) & np.isin(
        np.arange(len(shell.points)), shell.triangles[shell.panel == "vault_nave"]
    )
    assert foot.sum() >= 16
    assert (shell.beams.of_node[foot] >= 0).all()
    # Each holds the foot above it, and the wall below to its ends.
    assert len(np.unique(shell.beams.of_node[foot])) == 8
    assert np.bincount(shell.beams.of_node[~foot & shell.on_beam]).min() >= 3
    assert not len(shell.ledges)


def test_a_vaulted_apse_stands_beside_ring_beams() -> None:
    over = {"over": "apse", "kind": "half_dome", "thickness": 0.3, "courses": 6}
    room = {"width": 6.0, "length": 6.0, "height": 3.0, "thickness": 0.7, "apse": APSE}
    building = chapel(course=0.25, stone_length=0.5, vaults=(over,), materials=MATERIAL, **room)
    building = replace(building, ring_beams=(RingBeam(("nave_left", "nave_right"), 0.3),))
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, 0.7)
    match = cp.match_models(stones, cp.find_contacts(stones), shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    assert (shell.beams.count, len(shell.ledges) > 0) == (2, True)


@pytest.mark.slow("docs/vault_validation.md: a dome on slabs, as stones and as a shell of finer and finer elements")
@pytest.mark.parametrize(("size", "expected"), [(0.75, 0.4400), (0.5, 0.4342)])
def test_a_dome_on_slabs_as_a_shell(size: float, expected: float) -> None:
    building, load = domed(), cp.LoadCase((1, 0, 0))
    stones = cp.derive_blocks(building)
    assert cp.limit_analysis(stones, cp.find_contacts(stones), load, 0.7).load_factor == pytest.approx(0.5728, abs=5e-5)
    assert cp.shell_limit_analysis(cp.derive_shell(building, size), load, MATERIAL).load_factor == pytest.approx(
        expected, abs=2e-4
    )
