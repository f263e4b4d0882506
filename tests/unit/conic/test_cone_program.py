"""Clarabel's kinematic form against the plain statement in cvxpy, for every kind of point."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.conic import solve as choice
from churchpipe.conic.clarabel import solve_clarabel
from churchpipe.conic.cvxpy import solve_cvxpy
from churchpipe.conic.polish import restore_balance
from churchpipe.conic.program import ConeProgram
from churchpipe.conic.solve import solve
from churchpipe.errors import InputError
from cone_programs import KINDS_OF_POINTS, stated, three_stones


@pytest.mark.parametrize("options", KINDS_OF_POINTS)
def test_clarabel_agrees_with_cvxpy(options: dict[str, float]) -> None:
    program = stated(three_stones(), **options)
    ours, reference = solve_clarabel(program), solve_cvxpy(program)
    assert ours.outcome == reference.outcome == "solved"

    def value(x: np.ndarray, tau: float) -> float:
        return float(tau - program.linear @ x[:, 0] - 0.5 * program.quadratic @ x[:, 0] ** 2)

    assert value(ours.x, ours.tau) == pytest.approx(value(reference.x, reference.tau), abs=1e-6)
    residual = program.residual(ours.x, ours.tau)
    assert np.abs(residual).max() < 1e-8
    shear = np.hypot(ours.x[:, 1], ours.x[:, 2])
    assert (shear <= program.limit + program.slope * ours.x[:, 0] + 1e-8).all()
    assert ours.x[:, 0].min() > -1e-8
    assert (ours.x[:, 0] <= program.bound + 1e-8).all()
    if program.cap == np.inf:
        assert program.growth @ ours.y == pytest.approx(1.0, abs=1e-6)
        assert program.growth @ reference.y == pytest.approx(1.0, abs=1e-6)


def test_restored_forces_balance_to_rounding() -> None:
    program = stated(three_stones())
    answer = solve_clarabel(program, duality_gap=1e-6)
    x, tau = restore_balance(program, answer.x, answer.tau)
    assert np.abs(program.residual(x, tau)).max() < 1e-14
    assert (np.hypot(x[:, 1], x[:, 2]) - 0.7 * x[:, 0]).max() < 1e-9
    assert tau == pytest.approx(answer.tau, abs=1e-5)


def test_a_program_without_feasible_forces_is_never_called_solved() -> None:
    # Shear too small for any stone to stand on: no friction at all, pushed by a constant lateral load.
    program = stated(three_stones(), slope=0.0)
    pushed = ConeProgram(
        program.balance,
        program.constant + 0.1 * program.growth,
        program.constant,
        program.limit,
        program.slope,
        program.linear,
        program.quadratic,
    )
    assert solve(pushed, "clarabel").outcome != "solved"


def test_unknown_solver_is_refused() -> None:
    with pytest.raises(InputError, match="unknown solver"):
        solve(stated(three_stones()), "simplex")
    with pytest.raises(InputError, match="not installed"):
        solve(stated(three_stones()), "cvxpy:NOSUCH")


def test_a_solver_that_fails_is_paid_for(monkeypatch: pytest.MonkeyPatch) -> None:
    program = stated(three_stones())
    reference = solve_clarabel(program)
    failed = replace(reference, outcome="failed", iterations=7)
    monkeypatch.setattr(choice, "_interior_point", lambda _: lambda *_: failed)
    assert solve(program).iterations == 7 + reference.iterations
