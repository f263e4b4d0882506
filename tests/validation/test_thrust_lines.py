"""Lines of thrust, hoop and meridian forces: by the balance of the stones, exactly."""

from itertools import pairwise

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import arch, dome, vault

SLICE = {"span": 1.85, "thickness": 0.15, "courses": 27, "stone_length": 0.5, "length": 1.0}
DOME = {"span": 1.9, "thickness": 0.1, "rings": 9, "sides": 32, "oculus": 0.5}
DRUM = {"drum_height": 0.6, "drum_thickness": 0.14, "drum_course": 0.15}


def test_thrust_of_a_barrel_at_collapse_touches_its_edges_in_four_hinges() -> None:
    stones = cp.derive_blocks(vault(**SLICE))
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), friction=0.7)
    line = cp.thrust_line(stones, contacts, state.forces, "vault", through=(0, 0.5))
    # 26 joints between 27 courses and the two springings.
    assert len(line.force) == 28
    assert line.half == pytest.approx(0.075, abs=1e-6)
    assert np.abs(line.eccentricity).max() <= 0.075 * (1 + 1e-6)
    hinges = np.flatnonzero(np.abs(line.eccentricity) > 0.075 * (1 - 1e-4))
    # A collapse of four hinges, outside and inside in turn along the arch.
    assert len(hinges) == 4
    assert (np.diff(np.sign(line.eccentricity[hinges])) != 0).all()
    # The springings carry the weight: their joints are level.
    springing = line.place[:, 1] < 1e-9
    assert line.force[springing].sum() == pytest.approx(stones.weight.sum(), rel=1e-8)


def test_masonry_on_the_back_of_a_vault_is_no_bed_of_it() -> None:
    walls = {"wall_height": 1.0, "wall_thickness": 0.5, "wall_course": 0.5, "backing": 0.5}
    stones = cp.derive_blocks(vault(**SLICE, **walls))
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), friction=0.7)
    line = cp.thrust_line(stones, contacts, state.forces, "vault", through=(0, 0.5))
    assert len(line.force) == 28
    assert line.half == pytest.approx(0.075, abs=1e-6)


@pytest.mark.parametrize("through", [0.0, 0.17, -0.3])
@pytest.mark.parametrize(("laid", "heads"), [("rings", "staggered"), ("rings", "aligned"), ("courses", "staggered")])
def test_thrust_passes_through_the_centres_of_pressure(laid: str, heads: str, through: float) -> None:
    # Wherever the section is said to pass, and in rings of voussoirs as in courses.
    stones = cp.derive_blocks(vault(**SLICE, laid=laid, heads=heads))
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), friction=0.7)
    line = cp.thrust_line(stones, contacts, state.forces, "vault", through=(through, 0.5), width=2.0)
    # By the middles of the joints that do not look along the vault, in the section.
    middle = np.add.reduceat(contacts.point, contacts.point_ptr[:-1]) / contacts.points_per_interface[:, None]
    crossing = (np.abs(contacts.frame[:, 0, 1]) < 0.5) & ~stones.fixed[contacts.blocks].all(axis=1)
    _, label = np.unique(middle[crossing][:, [0, 2]].round(6) + 0.0, axis=0, return_inverse=True)
    of_point = np.full(len(crossing), -1)
    of_point[crossing] = label.ravel()
    of_point = of_point[contacts.interface_of_point]
    assert len(line.force) == label.max() + 1
    for k in range(label.max() + 1):
        own = of_point == k
        force = state.forces[own, 0]
        centre = force @ contacts.point[own][:, [0, 2]] / force.sum()
        away = np.abs(line.place + np.array([through, 0.0]) - centre).max(axis=1)
        assert away.min() == pytest.approx(0.0, abs=1e-6)
        assert line.force[away.argmin()] == pytest.approx(force.sum(), rel=1e-9)
    assert (np.abs(line.eccentricity) <= line.half * (1 + 1e-9)).all()
    # From one springing over the crown to the other, joint after joint.
    assert (np.diff(line.place[:, 0]) < 0.075).all()
    assert line.place[[0, -1], 1] == pytest.approx(0.0, abs=1e-9)


def test_thrust_of_an_arch() -> None:
    stones = cp.derive_blocks(arch(mean_radius=1.0, thickness=0.15, width=0.5, voussoirs=26))
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), friction=0.7)
    line = cp.thrust_line(stones, contacts, state.forces, "arch", through=(0, 0.25))
    assert len(line.force) == 27
    assert line.half == pytest.approx(0.075, abs=1e-6)
    hinges = np.flatnonzero(np.abs(line.eccentricity) > 0.075 * (1 - 1e-4))
    assert len(hinges) == 4
    assert (np.diff(np.sign(line.eccentricity[hinges])) != 0).all()
    assert (line.course == -1).all()


def test_each_ring_of_a_dome_carries_what_is_above_it() -> None:
    stones = cp.derive_blocks(dome(**DOME, **DRUM))
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), friction=0.7)
    rings = cp.ring_forces(stones, contacts, state.forces, ("drum", "dome"))
    above = [stones.weight[~stones.fixed & (stones.course >= ring)].sum() for ring in rings.course]
    assert rings.vertical == pytest.approx(np.array(above), rel=1e-8)
    # Beds of the drum are level, those of the dome lean: there the meridian force is larger than the weight it carries.
    level = rings.course <= 4
    assert rings.meridian[level] == pytest.approx(rings.vertical[level], rel=1e-8)
    assert (rings.meridian[~level] > rings.vertical[~level]).all()
    assert (rings.hoop >= 0).all()


def test_bad_arguments_are_named() -> None:
    stones = cp.derive_blocks(vault(**SLICE))
    contacts = cp.find_contacts(stones)
    forces = np.zeros((len(contacts.point), 3))
    with pytest.raises(InputError, match="panels: no such panel; found roof; expected vault"):
        cp.thrust_line(stones, contacts, forces, "roof")
    with pytest.raises(InputError, match="thrust_line: no bed joint in the strip"):
        cp.thrust_line(stones, contacts, forces, "vault", through=(0, 50))
    with pytest.raises(InputError, match="forces: wrong shape"):
        cp.ring_forces(stones, contacts, forces[1:], "vault")


@pytest.mark.parametrize("heads", ["staggered", "aligned"])
def test_the_thrusts_of_strips_add_up_to_that_of_the_vault(heads: str) -> None:
    """A joint counts in a strip by its share there: whole, two joints whose middles lie on the edges of a strip had twice its
    thrust."""
    building = vault(span=4.0, thickness=0.45, courses=11, length=1.2, stone_length=0.6, heads=heads)
    stones = cp.derive_blocks(building)
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), friction=0.7)

    def thrust(low: float, high: float) -> np.ndarray:
        line = cp.thrust_line(stones, contacts, state.forces, "vault", (0.0, (low + high) / 2), width=high - low)
        assert len(line.force) == 12
        return line.force

    whole = thrust(0.0, 1.2)
    assert whole == pytest.approx(thrust(-1.0, 2.2), rel=1e-9)
    # The ground bears the weight, at two feet that are level.
    assert whole[[0, -1]].sum() == pytest.approx(stones.weight[~stones.fixed].sum(), rel=1e-6)
    for cuts in ([0.6], [0.3, 0.9], [0.5], [0.1, 0.35, 1.0]):
        ends = [0.0, *cuts, 1.2]
        assert sum(thrust(*pair) for pair in pairwise(ends)) == pytest.approx(whole, rel=1e-9)
