"""What a certificate must refuse, whatever proposed it."""

import numpy as np
import pytest

from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.certificate import certify
from churchpipe.rigid_blocks.coulomb import CoulombState, admissible, bipotential_gap
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import limit_analysis, point_strength
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground

PUSH = LoadCase((1, 0, 0))


def test_the_fall_of_a_chip_is_seen() -> None:
    """Measured by the total weight alone, the block's .4 would be certified, with nothing to hold the chip."""
    block, chip = box((0, 2), (0, 2), (0, 2)), box((5, 5.001), (0, 0.001), (0, 0.004))
    alone = on_ground(block)
    state = limit_analysis(alone, find_contacts(alone), PUSH, 0.4)
    stones = on_ground(block, chip)
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, PUSH)
    strength = point_strength(contacts, 0.4, 0.0, balance.force)
    x = np.zeros((len(contacts.point), 3))
    x[: len(state.forces)] = state.forces / balance.force
    certificate = certify(balance, strength, x, state.load_factor, np.concatenate([state.velocities[1], np.zeros(6)]))
    assert certificate.upper_bound == pytest.approx(0.4, rel=1e-6)
    assert certificate.equilibrium_residual < 1e-8
    assert not certificate.holds


def test_no_mechanism_passes_through_a_wall() -> None:
    """A block of 1 x 1 x 2 pushed against a wall never falls; tipped about its edge into the wall it would at b / h = .5."""
    wall = box((1, 2), (0, 1), (0, 4))
    stones = Assemblage.from_polyhedra([box((-9, 9), (-9, 9), (-1, 0)), wall, box((0, 1), (0, 1), (0, 2))], 18e3, fixed=[0, 1])
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, PUSH)
    strength = point_strength(contacts, 0.7, 0.0, balance.force)
    edge = (np.abs(contacts.point[:, 0] - 1) < 1e-9) & (contacts.point[:, 2] < 1e-9)
    bed = contacts.blocks[contacts.interface_of_point].min(axis=1) == 0
    x = np.zeros((len(contacts.point), 3))
    for k in np.flatnonzero(edge & bed):
        # Half of the weight and of the thrust each, in the frame of the point.
        normal, *tangents = contacts.frame[contacts.interface_of_point[k]]
        force = np.array([-0.25, 0.0, 0.5])
        force *= np.sign(force @ normal)
        x[k] = [force @ normal, *(force @ tangent for tangent in tangents)]
    about_edge = np.array([0.0, 1.0, 0.0]) / balance.length
    arm = stones.centroid[2] - np.array([1.0, 0.5, 0.0])
    turn = np.concatenate([np.cross(about_edge, arm), about_edge * balance.length])
    turn /= balance.live @ turn
    certificate = certify(balance, strength, x, 0.5, turn)
    assert certificate.equilibrium_residual < 1e-12
    assert (certificate.lower_bound, certificate.upper_bound) == pytest.approx((0.5, 0.5), abs=1e-12)
    assert certificate.flow_violation > 0.1
    assert not certificate.holds
    state = CoulombState(x, 0.5, turn, bipotential_gap(balance, strength, x, turn))
    assert state.gap < 1e-12
    assert not admissible(balance, strength, state)
    assert limit_analysis(stones, contacts, PUSH, 0.7).status == "unbounded"
