"""Clarabel's kinematic form against the plain statement in cvxpy, for every kind of point."""

import numpy as np
import pytest

from churchpipe.conic.clarabel import solve_clarabel
from churchpipe.conic.cvxpy import solve_cvxpy
from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram
from churchpipe.conic.solve import solve
from churchpipe.errors import InputError
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.stones.contacts import find_contacts
from solids import box, on_ground


def program(
    *,
    limit: float = 0.0,
    slope: float = 0.7,
    linear: float = 0.0,
    quadratic: float = 0.0,
    cap: float = np.inf,
    bound: float = np.inf,
) -> ConeProgram:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0.2, 1.2), (0, 1), (1, 2)), box((1, 1.6), (0, 1), (0, 1)))
    contacts = find_contacts(stones)
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)))
    one = np.ones(len(contacts.point))
    return ConeProgram(
        balance.wrenches, balance.dead, balance.live, limit * one, slope * one, linear * one, quadratic * one, cap, bound * one
    )


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"slope": 0.0},
        {"limit": 0.02},
        {"limit": 0.05, "slope": -0.001},
        {"limit": 0.1, "slope": 0.0, "quadratic": 0.3},
        {"limit": 0.1, "slope": -0.1, "quadratic": 0.3, "linear": 0.1},
        {"quadratic": 0.3, "linear": 0.05},
        {"cap": 0.05},
        {"cap": 0.05, "limit": 0.1, "slope": -0.1, "linear": 0.1},
        {"bound": 0.25},
        {"bound": 0.25, "slope": 0.0, "limit": 0.1},
        {"bound": 0.24, "limit": 0.02, "linear": 0.01},
        {"bound": 0.24, "limit": 0.05, "slope": -0.1, "quadratic": 0.3},
        {"bound": 0.25, "cap": 0.05},
    ],
)
def test_clarabel_agrees_with_cvxpy(options: dict[str, float]) -> None:
    stated = program(**options)
    ours, reference = solve_clarabel(stated), solve_cvxpy(stated)
    assert ours.outcome == reference.outcome == "solved"

    def value(x: np.ndarray, tau: float) -> float:
        return tau - stated.linear @ x[:, 0] - 0.5 * stated.quadratic @ x[:, 0] ** 2

    assert value(ours.x, ours.tau) == pytest.approx(value(reference.x, reference.tau), abs=1e-6)
    residual = stated.residual(ours.x, ours.tau)
    assert np.abs(residual).max() < 1e-8
    shear = np.hypot(ours.x[:, 1], ours.x[:, 2])
    assert (shear <= stated.limit + stated.slope * ours.x[:, 0] + 1e-8).all()
    assert ours.x[:, 0].min() > -1e-8
    assert (ours.x[:, 0] <= stated.bound + 1e-8).all()
    if stated.cap == np.inf:
        assert stated.growth @ ours.y == pytest.approx(1.0, abs=1e-6)
        assert stated.growth @ reference.y == pytest.approx(1.0, abs=1e-6)


def test_restored_forces_balance_to_rounding() -> None:
    stated = program()
    answer = solve_clarabel(stated, duality_gap=1e-6)
    x, tau = restore_balance(stated, answer.x, answer.tau)
    assert np.abs(stated.residual(x, tau)).max() < 1e-14
    assert (np.hypot(x[:, 1], x[:, 2]) - 0.7 * x[:, 0]).max() < 1e-9
    assert tau == pytest.approx(answer.tau, abs=1e-5)


def test_a_program_without_feasible_forces_is_never_called_solved() -> None:
    # Shear too small for any stone to stand on: no friction at all, pushed by a constant lateral load.
    stated = program(slope=0.0)
    pushed = ConeProgram(
        stated.balance,
        stated.constant + 0.1 * stated.growth,
        stated.constant,
        stated.limit,
        stated.slope,
        stated.linear,
        stated.quadratic,
    )
    assert solve(pushed, "clarabel").outcome != "solved"


def test_unknown_solver_is_refused() -> None:
    with pytest.raises(InputError, match="unknown solver"):
        solve(program(), "simplex")
    with pytest.raises(InputError, match="not installed"):
        solve(program(), "cvxpy:NOSUCH")
