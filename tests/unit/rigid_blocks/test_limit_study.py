"""What-if studies of one structure give what analyses one by one give, at a part of the time."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.conic.cholesky import Cholesky
from churchpipe.conic.interior_point import solver
from churchpipe.errors import InputError
from churchpipe.rigid_blocks import limit
from churchpipe.rigid_blocks.associative import dead_load_analysis


@pytest.fixture(scope="module")
def wall() -> tuple[cp.Assemblage, cp.Contacts]:
    stones = cp.derive_blocks(generators.box(length=3.0, width=2.0, courses=6, brick=(0.5, 0.25, 0.25)))
    return stones, cp.find_contacts(stones)


TIE = cp.Tie("rod", start=(0.125, 0.0, 1.3), end=(0.125, 2.0, 1.3), strength=2e3)


def test_a_study_agrees_with_analyses_one_by_one(wall: tuple[cp.Assemblage, cp.Contacts]) -> None:
    study = cp.LimitStudy(*wall, ties=[TIE])
    pushed = cp.LoadCase((0, -1, 0)), cp.LoadCase((0, -1, 0), profile="linear"), cp.LoadCase((1, 0, 0))
    for load, friction, cohesion, strength in [
        (pushed[0], 0.6, 0.0, 2e3),
        (pushed[0], 0.4, 0.0, 2e3),
        (pushed[1], 0.6, 5e3, 5e3),
        (pushed[2], 0.7, 0.0, 0.0),
    ]:
        found = study.limit_analysis(load, friction, cohesion, tie_strengths=[strength])
        tie = cp.Tie("rod", start=TIE.start, end=TIE.end, strength=strength) if strength else None
        alone = cp.limit_analysis(*wall, load, friction, cohesion, ties=[tie] if tie else [])
        assert found.status == alone.status == "optimal"
        assert found.load_factor == pytest.approx(alone.load_factor, abs=2e-7)
        assert found.upper_bound - found.lower_bound < 1e-6


def test_what_is_known_to_stand_is_not_asked_again(wall: tuple[cp.Assemblage, cp.Contacts], monkeypatch) -> None:
    asked: list[float] = []
    whether = dead_load_analysis

    def counted(balance, strength, solve):
        asked.append(float(strength.friction.max()))
        return whether(balance, strength, solve)

    monkeypatch.setattr(limit, "dead_load_analysis", counted)
    study, load = cp.LimitStudy(*wall), cp.LoadCase((0, -1, 0))
    for friction in (0.5, 0.6, 0.4, 0.45):
        study.limit_analysis(load, friction)
    study.limit_analysis(cp.LoadCase((1, 0, 0)), 0.5, cohesion=1e3)
    # Stronger joints bear what weaker ones bear; another lateral load changes nothing of the weight.
    assert asked == [0.5, 0.4]
    study.limit_analysis(cp.LoadCase((1, 0, 0), dead=np.tile([0, 0, -1.0, 0, 0, 0], (wall[0].count, 1))), 0.5)
    assert asked == [0.5, 0.4, 0.5]


def test_a_structure_that_falls_is_told_each_time() -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    # A cube that rests on less than half of its foot.
    bodies = [(corners, faces), (np.add(corners, (0.6, 0, 1)), faces)]
    stones = cp.Assemblage.from_polyhedra(bodies, unit_weight=18e3, fixed=[0])
    study = cp.LimitStudy(stones, cp.find_contacts(stones))
    assert [study.limit_analysis(cp.LoadCase((1, 0, 0)), mu).status for mu in (0.5, 0.6)] == ["unstable", "unstable"]


def test_the_order_of_the_factorisation_is_found_once(wall: tuple[cp.Assemblage, cp.Contacts], monkeypatch) -> None:
    made: list[int] = []

    class Counted(Cholesky):
        def __init__(self, lower, body: int) -> None:
            made.append(lower.shape[0])
            super().__init__(lower, body)

    monkeypatch.setattr(solver, "Cholesky", Counted)
    study, load = cp.LimitStudy(*wall), cp.LoadCase((0, -1, 0))
    for friction in (0.5, 0.6, 0.4):
        study.limit_analysis(load, friction)
    assert len(made) == 1
    cp.limit_analysis(*wall, load, 0.6)
    assert len(made) == 2


def test_arguments_of_a_study(wall: tuple[cp.Assemblage, cp.Contacts]) -> None:
    with pytest.raises(InputError, match=r"LimitStudy: tie_strengths: wrong length; found 2; expected one a tie \(1\)"):
        cp.LimitStudy(*wall, ties=[TIE]).limit_analysis(cp.LoadCase((1, 0, 0)), tie_strengths=[1.0, 2.0])
    torsion = cp.LimitStudy(*wall, contact_model="torsion")
    with pytest.raises(InputError, match=r"LimitStudy: flow: no study without dilatancy with contact_model"):
        torsion.limit_analysis(cp.LoadCase((1, 0, 0)), flow="non-associative")
    with pytest.raises(InputError, match="LimitStudy: stones: wrong kind"):
        cp.LimitStudy(None, wall[1])
