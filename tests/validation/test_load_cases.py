"""Load cases on two unit cubes, one on the other, by hand."""

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.equilibrium import lateral_weight
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground

PLATE = box((-5, 5), (-5, 5), (-1, 0))
CUBES = Assemblage.from_polyhedra(
    [PLATE, box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2))], 20e3, fixed=[0], panel=["ground", "lower", "upper"]
)
CONTACTS = find_contacts(CUBES)


def load_factor(load: LoadCase, friction: float = 0.7) -> float:
    state = limit_analysis(CUBES, CONTACTS, load, friction=friction)
    assert state.status == "optimal"
    return state.load_factor


def test_linear_profile_overturns_both() -> None:
    # Pushes 0.5 W and 1.5 W at 0.5 and 1.5 m against 2 W at 0.5 m: 2.5 alpha = 1.
    load = LoadCase((1, 0, 0), profile="linear")
    assert lateral_weight(CUBES, load) == pytest.approx([0, 10e3, 30e3])
    assert load_factor(load) == pytest.approx(0.4, rel=1e-6)


@pytest.mark.parametrize(("friction", "expected"), [(0.7, 2 / 3), (0.6, 0.6)])
def test_push_on_the_upper_cube_alone(friction: float, expected: float) -> None:
    # Both overturn at 1.5 alpha W = 2 W 0.5; the upper one slides at mu.
    assert load_factor(LoadCase((1, 0, 0), panels=("upper",)), friction) == pytest.approx(expected, rel=1e-6)


def test_push_on_the_lower_cube_alone_drags_the_upper() -> None:
    # Both slide at alpha W = 2 mu W, before the lower one slips out (3 mu) or they overturn (2).
    assert load_factor(LoadCase((1, 0, 0), panels=["lower"]), 0.6) == pytest.approx(1.2, rel=1e-6)


def test_extra_dead_weight_on_top_steadies() -> None:
    # A further W at the top centroid, not pushed: overturning of both at 2 alpha W = 3 W 0.5.
    dead = np.zeros((3, 6))
    dead[2, 2] = -20e3
    assert load_factor(LoadCase((1, 0, 0), dead=dead), 1.0) == pytest.approx(0.75, rel=1e-6)


def test_names_and_directions() -> None:
    assert LoadCase((0, -2, 0)).name == "-y"
    assert LoadCase((3, 4, 0)).direction == pytest.approx([0.6, 0.8, 0])
    assert LoadCase((3, 4, 0)).name == "(0.6, 0.8, 0)"


def test_refusals() -> None:
    with pytest.raises(InputError, match="no such panel; found tower; expected lower, upper"):
        load_factor(LoadCase((1, 0, 0), panels=("tower",)))
    with pytest.raises(InputError, match="no direction"):
        LoadCase((0, 0, 0))
    with pytest.raises(InputError, match="profile: unknown value"):
        LoadCase((1, 0, 0), profile="parabolic")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="friction"):
        load_factor(LoadCase((1, 0, 0)), -0.1)
    with pytest.raises(InputError, match="wrong shape"):
        load_factor(LoadCase((1, 0, 0), dead=np.zeros((2, 6))))
    loose = Assemblage.from_polyhedra([PLATE, box((0, 1), (0, 1), (3, 4))], 20e3, fixed=[0])
    with pytest.raises(InputError, match="no path of contacts to a support; found B1"):
        limit_analysis(loose, find_contacts(loose), LoadCase((1, 0, 0)))


def test_nothing_but_live_is_pushed() -> None:
    # A pull of 1 N at the top of a block 1 x 4 m: it overturns under W b / 2 h.
    stones = on_ground(box((0, 1), (0, 1), (0, 4)))
    live = np.zeros((2, 6))
    live[1] = [1, 0, 0, 0, 2, 0]
    load = LoadCase(live=live)
    assert load.name == "live"
    state = limit_analysis(stones, find_contacts(stones), load, friction=0.7)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(4 * 18e3 / 8, rel=1e-6)


def test_live_on_the_ground_alone_pushes_nothing() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 4)))
    live = np.zeros((2, 6))
    live[0, 0] = 1.0
    with pytest.raises(InputError, match="load live: nothing is pushed; expected a load on at least one free stone"):
        limit_analysis(stones, find_contacts(stones), LoadCase(live=live))
