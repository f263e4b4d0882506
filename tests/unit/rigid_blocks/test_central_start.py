"""The first steps of the run from the centre: those of associative friction."""

from typing import Any

import numpy as np
import pytest

from churchpipe.conic.interior_point.second_order import SecondOrder
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.central_start import first_rates
from churchpipe.rigid_blocks.central_steps import LEAST, least_product
from churchpipe.rigid_blocks.contact_newton import ContactSystem
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.rigid_blocks.settings import CentralSettings
from churchpipe.stones.contacts import find_contacts
from models import FERRIS_TIN_LOI_LOAD, facade, ferris_tin_loi_wall


def wall(number: int) -> tuple[Assemblage, Contacts]:
    stones = ferris_tin_loi_wall(number)
    return stones, find_contacts(stones)


def system_of(stones: Assemblage, contacts: Contacts, load: LoadCase = FERRIS_TIN_LOI_LOAD, **options: Any) -> ContactSystem:
    balance = equilibrium(stones, contacts, load)
    return ContactSystem(balance, point_strength(contacts, 0.65, 0.0, balance.force), CentralSettings(**options))


@pytest.mark.parametrize(("name", "factorisations"), [("wall3", 4), ("wall6", 5), ("small", 8)])
def test_all_points_open_after_a_few_factorisations(name: str, factorisations: int) -> None:
    system = system_of(*(wall(int(name[4:])) if name.startswith("wall") else facade(name)))
    at = first_rates(system)
    assert 0 < system.factorisations <= factorisations
    assert at.rates[0].min() > 0
    assert SecondOrder(3, 1, system.points).margin(at.forces[:, None]) > 0
    assert float(system.live @ at.y) == pytest.approx(1.0, abs=0.1)
    assert at.rates == pytest.approx(system.rates(at.y), abs=1e-12)
    # The load that is left of the balance is less than what the heaviest stone weighs.
    assert np.abs(system.residual(at)).max() < np.abs(system.dead).max()
    # The products of the run that follows are within its reach.
    assert least_product(system, at.forces, system.multipliers(at.rates)) > LEAST


def test_loads_on_a_part_of_the_stones_do_not_hold_the_first_steps() -> None:
    """A load on the uppermost course alone: the other stones gain no work from their motion."""
    stones, contacts = facade("small")
    high = stones.centroid[:, 2] > np.quantile(stones.centroid[:, 2], 0.9)
    live = np.zeros((stones.count, 6))
    live[high, 0] = stones.weight[high]
    everywhere = system_of(stones, contacts)
    first_rates(everywhere)
    system = system_of(stones, contacts, LoadCase(live=live))
    at = first_rates(system)
    assert at.rates[0].min() > 0
    assert system.factorisations <= 2 * everywhere.factorisations
