"""Ready cases turned, shifted and mirrored keep their contacts and load factors."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from churchpipe.config.case import read_case
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage, assemble
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts

CASES = Path(__file__).parents[3] / "pipeline" / "cases"
# A few thousand stones, or some seconds a limit analysis.
LARGE = ["church", "church_half_stones", "church_r", "church_stone_length", "church_strengthened", "church_vaults"]
SMALL = [
    "apse",
    "apse_window",
    "arch",
    "arch_piers",
    "box",
    "chapel",
    "chapel_variants",
    "dome",
    "house",
    "round_tower",
    "s22",
    "s5",
]
SMALL += ["s5_parity", "s5_uncertain", "thick_wall", "tower", "vault", "wall"]
# One of each kind of walls and vaults, a second or two each.
QUICK = ["arch", "arch_piers", "box", "chapel_variants", "dome", "thick_wall", "vault", "wall"]
# Small enough for three limit analyses.
SOLVED = ["arch", "arch_piers", "wall"]
# Cases of the stones and the load of another, with other analyses.
AGAIN = {"church_friction": "church", "church_sliding": "church", "s22_friction": "s22", "s22_mesh": "s22"}
slow = pytest.mark.slow("docs/contacts.md: any place, any direction")
# Turned about the vertical by this, rad, the apse lost an interface: GEOS gave the crossings of two faces' edges instead.
UNLUCKY = 5.588816891696628


def placed(stones: Assemblage, matrix: FloatArray, shift: FloatArray) -> Assemblage:
    """The stones with each point p at `matrix` (3, 3) p + `shift` (3,); a mirrored solid has its faces turned."""
    names = ("face_nodes", "face_ptr", "block_face_ptr", "block_point_ptr", "unit_weight", "material", "panel", "course", "fixed")
    same = {name: getattr(stones, name) for name in (*names, "block_id")}
    return assemble(points=stones.points @ matrix.T + shift, **same)


def motions(seed: int) -> list[tuple[FloatArray, FloatArray]]:
    """A turn about the vertical, a turn about any axis, and a mirror image of such a turn, each with a shift."""
    rng = np.random.default_rng(seed)
    turns = [Rotation.from_euler("z", rng.uniform(0, 2 * np.pi)), *Rotation.random(2, rng=rng)]
    mirror = np.diag([1.0, -1.0, 1.0])
    matrices = [turn.as_matrix() for turn in turns]
    return [(matrix, rng.uniform(-100, 100, 3)) for matrix in (*matrices[:2], mirror @ matrices[2])]


def test_every_ready_case_is_here() -> None:
    assert sorted([*SMALL, *LARGE, *AGAIN]) == sorted(path.stem for path in CASES.glob("*.toml"))
    for name, like in AGAIN.items():
        case, other = (read_case(CASES / f"{one}.toml") for one in (name, like))
        assert (case.source, case.buttresses, case.ring_beams) == (other.source, other.buttresses, other.ring_beams)


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else slow) for name in (*SMALL, *LARGE)])
def test_contacts_of_a_ready_case_in_any_place(name: str) -> None:
    stones = derive_blocks(read_case(CASES / f"{name}.toml").building())
    here = find_contacts(stones)
    assert not len(here.near_misses)
    areas = np.sort(here.area)
    for matrix, shift in [(Rotation.from_euler("z", UNLUCKY).as_matrix(), np.zeros(3)), *motions(len(name))]:
        there = find_contacts(placed(stones, matrix, shift))
        assert len(there.blocks) == len(here.blocks)
        assert len(there.point) == len(here.point)
        assert np.sort(there.area) == pytest.approx(areas, rel=1e-6)
        assert not len(there.near_misses)


@pytest.mark.parametrize("name", [*SOLVED, *(pytest.param(name, marks=slow) for name in (*SMALL, *LARGE) if name not in SOLVED)])
def test_load_factors_of_a_ready_case_in_any_place(name: str) -> None:
    case = read_case(CASES / f"{name}.toml")
    stones = derive_blocks(case.building())
    push, friction = case.loads[0].direction, case.materials[0].friction
    here = limit_analysis(stones, find_contacts(stones), LoadCase(push), friction)
    assert here.status == "optimal"
    # Weight acts along z: a mirror or a turn about the vertical alone leaves the structure what it was.
    for angle, mirror in ((0.7, 1.0), (2.9, -1.0)):
        matrix = Rotation.from_euler("z", angle).as_matrix() @ np.diag([1.0, mirror, 1.0])
        there = placed(stones, matrix, np.array([31.0, -7.0, 3.0]))
        found = limit_analysis(there, find_contacts(there), LoadCase(matrix @ push), friction)
        assert (found.status, found.load_factor) == ("optimal", pytest.approx(here.load_factor, rel=2e-6))
