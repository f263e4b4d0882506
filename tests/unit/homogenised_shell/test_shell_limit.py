from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from churchpipe.conic.interior_point.loop import Ending, solve_coupled
from churchpipe.errors import InputError
from churchpipe.homogenised_shell import condensed, limit, point_strength
from churchpipe.homogenised_shell.bounds import Bounds, proved_bounds
from churchpipe.homogenised_shell.element import shell_elements, surface_load
from churchpipe.homogenised_shell.limit import shell_limit_analysis
from churchpipe.homogenised_shell.loads import dead_pressure, live_load, live_pressure
from churchpipe.homogenised_shell.settings import SOLVER, SolverSettings
from churchpipe.homogenised_shell.strength import paper_planes, violation
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.names import Planes
from churchpipe.model.shell import ShellModel
from shell_meshes import grid, shell, wall_points
from shell_reference import reference_load_factor, shell_program

MASONRY = [Material("default", 28.6e3, 0.7)]
ASKEW = LoadCase((1, 1, 0))


def wall(rows: int = 3, **changes: object) -> ShellModel:
    points, triangles = grid(rows, rows, 0.6, 0.6)
    model = shell(wall_points(points), triangles, surface_weight=1144.0, supported=lambda p: p[:, 2] < 1e-9)
    return replace(model, **changes)


def portal(lintel_yields: bool) -> ShellModel:
    """A wall 1.2 m square with a door .4 x .8 m under a lintel .8 x .2 m."""
    flat, triangles = grid(6, 6, 1.2, 1.2)
    centre = flat[triangles].mean(axis=1)
    triangles = triangles[(np.abs(centre[:, 0] - 0.6) > 0.2) | (centre[:, 1] > 0.8)]
    used, new = np.unique(triangles, return_inverse=True)
    flat, triangles = flat[used], new.reshape(-1, 3)
    centre = flat[triangles].mean(axis=1)
    lintel = (np.abs(centre[:, 0] - 0.6) < 0.4) & (centre[:, 1] > 0.8) & (centre[:, 1] < 1.0)
    model = shell(wall_points(flat), triangles, surface_weight=1144.0, supported=lambda p: p[:, 2] < 1e-9)
    return replace(model, yields=~lintel | lintel_yields)


@pytest.mark.parametrize("planes", ["paper", "paper+torsion", "cell"])
@pytest.mark.parametrize("cohesion", [0.0, 500.0])
def test_the_reference_statement_agrees(planes: Planes, cohesion: float) -> None:
    material = [Material("default", 28.6e3, 0.7, cohesion)]
    state = shell_limit_analysis(wall(2), ASKEW, material, planes=planes)
    program = shell_program(shell_elements(wall(2), on_joints=planes == "cell"), ASKEW, material, planes)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(reference_load_factor(program), rel=1e-6)


def test_an_analysis_tells_what_is_solved_and_which_share_of_it() -> None:
    told: list[tuple[str, float]] = []
    shell_limit_analysis(wall(2), ASKEW, MASONRY, progress=lambda what, share: told.append((what, share)))
    assert list(dict.fromkeys(what for what, _ in told)) == ["dead load", "limit load"]
    shares = [share for what, share in told if what == "limit load"]
    assert shares[0] == 0.0
    assert shares[-1] == pytest.approx(1.0)
    assert shares == sorted(shares)


def test_stress_and_velocities_prove_the_load_factor() -> None:
    model = wall()
    state = shell_limit_analysis(model, ASKEW, MASONRY, membrane="CST")
    elements = shell_elements(model, "CST", on_joints=True)
    dead = surface_load(elements, dead_pressure(model))
    live = surface_load(elements, live_pressure(model, ASKEW))
    inner = elements.strain.T @ (elements.weight[:, None] * state.stress).ravel()
    residual = (inner - dead - state.load_factor * live)[~elements.clamped]
    assert np.abs(residual).max() < 1e-8 * model.weight.sum()
    assert violation(paper_planes(0.03, 0.08, 0.04, 0.7), state.stress[: elements.inner]).max() < 1e-6 * model.weight.sum()
    # Without cohesion nothing is dissipated: lifting the weight takes all that the push gives.
    motion = np.concatenate([state.velocities.ravel(), state.edge_rotation])
    assert live @ motion == pytest.approx(model.weight.sum(), rel=1e-6)
    assert -dead @ motion == pytest.approx(state.load_factor * model.weight.sum(), rel=1e-6)
    # At its foot it is lifted, and does not sink.
    assert state.velocities[model.supported, 2].min() > -1e-9
    assert state.velocities[model.supported, 2].max() > 1e-3


def test_a_flat_soffit_falls_without_a_lintel_and_stands_with_one() -> None:
    for planes in ("paper", "cell"):
        state = shell_limit_analysis(portal(True), ASKEW, MASONRY, planes=planes, membrane="CST")
        assert state.status == "unstable"
        assert np.isnan(state.load_factor)
        assert "flat soffit" in state.message
        over_door = portal(True).points[:, 2] > 0.79
        assert state.velocities[over_door, 2].min() < 0
        held = shell_limit_analysis(portal(False), ASKEW, MASONRY, planes=planes, membrane="CST")
        assert held.status == "optimal"
        assert held.load_factor > 0.02


def test_facets_that_do_not_yield_never_limit() -> None:
    state = shell_limit_analysis(wall(yields=np.zeros(36, dtype=bool)), ASKEW, MASONRY, membrane="CST")
    assert state.status == "unbounded"
    assert state.load_factor == np.inf


@pytest.mark.parametrize("planes", ["paper", "cell"])
def test_lintels_limit_only_when_weak_and_are_told_then(planes: Planes, monkeypatch: pytest.MonkeyPatch) -> None:
    model, along = portal(False), LoadCase((1, 0, 0))
    factors: dict[float, float] = {}
    for tension in (1.0, 100.0, 1000.0):
        monkeypatch.setattr(point_strength, "SOLVER", replace(SOLVER, lintel_tension=tension))
        state = shell_limit_analysis(model, along, MASONRY, planes=planes, membrane="CST", solver="interior-point")
        assert state.status == "optimal"
        assert ("lintels reach their tension" in state.message) == (tension == 1.0)
        factors[tension] = state.load_factor
    # Without a limit to the strength of lintels.
    program = shell_program(shell_elements(model, "CST", on_joints=planes == "cell"), along, MASONRY, planes)
    assert factors[100.0] == pytest.approx(reference_load_factor(program), rel=1e-5)
    # By cvxpy and Clarabel, lintels of the same tension: .44588845 with planes, .44588843 with the cell.
    assert factors[1.0] == pytest.approx(0.44588845, rel=1e-6)
    assert factors[100.0] == pytest.approx(factors[1000.0], rel=1e-6)


def test_load_factor_knows_no_units() -> None:
    # The same wall ten times as large and three times as heavy.
    model = wall()
    large = replace(
        model,
        points=model.points * 10,
        thickness=model.thickness * 10,
        unit_cells=model.unit_cells * 10,
        surface_weight=model.surface_weight * 30,
    )
    factors = [shell_limit_analysis(m, ASKEW, MASONRY).load_factor for m in (model, large)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-6)


def test_cohesion_and_friction_raise_the_load_factor() -> None:
    factors = [
        shell_limit_analysis(wall(), LoadCase((1, 0, 0)), [Material("default", 28.6e3, mu, c)], membrane="CST").load_factor
        for mu, c in ((0.4, 0.0), (0.7, 0.0), (0.7, 1e3))
    ]
    assert factors[0] < factors[1] < factors[2]


def test_cohesion_shifts_planes_and_cell_alike() -> None:
    material, push = [Material("default", 28.6e3, 0.7, 5e3)], LoadCase((0, 1, 0))

    def clamped(planes: Planes, given: list[Material]) -> float:
        """Return the load factor without joints at the foot, which only the cell has."""
        shell = condensed.CondensedShell(shell_elements(wall(), "CST"), push, given, planes)
        dead, live = shell.loads.dead, shell.loads.live
        return proved_bounds(shell, shell.solve(dead, live), dead, live).lower

    planes, cell, without = clamped("paper", material), clamped("cell", material), clamped("paper", MASONRY)
    assert without < 0.8 * planes
    assert cell == pytest.approx(planes, rel=1e-5)
    # With them half of the width bears the cohesion over friction, and the weight, at the height of the centroid.
    found = shell_limit_analysis(wall(), push, material, membrane="CST").load_factor
    assert found == pytest.approx((1144.0 * 0.6 + 5e3 / 0.7 * 0.04) * 0.02 / (1144.0 * 0.6 * 0.3), rel=1e-6)


@pytest.mark.parametrize("change", [{"duality_gap": 0.0}, {"growth": 1.0}, {"plateau": 1.0}, {"lintel_tension": -1.0}])
def test_numbers_of_the_solvers_are_checked(change: dict[str, float]) -> None:
    with pytest.raises(InputError, match=f"SolverSettings.{next(iter(change))}: out of range"):
        SolverSettings(**change)  # pyright: ignore[reportArgumentType]


def test_lateral_load_profiles() -> None:
    model = wall(panel=np.repeat(["left", "right"], 18))
    uniform = live_pressure(model, LoadCase((3, 4, 0)))
    np.testing.assert_allclose(uniform, np.tile([0.6 * 1144, 0.8 * 1144, 0], (36, 1)))
    linear = live_pressure(model, LoadCase((1, 0, 0), profile="linear"))
    assert (model.area * linear[:, 0]).sum() == pytest.approx(model.weight.sum())
    assert linear[:, 0].max() / linear[:, 0].min() == pytest.approx(
        np.ptp(model.points[model.triangles, 2].mean(axis=1)) / model.points[model.triangles, 2].mean(axis=1).min() + 1
    )
    lifted = replace(model, points=model.points + np.array([0.0, 0.0, 100.0]))
    np.testing.assert_allclose(live_pressure(lifted, LoadCase((1, 0, 0), profile="linear")), linear, rtol=1e-9)
    one = live_pressure(model, LoadCase((1, 0, 0), panels=("left",)))
    np.testing.assert_array_equal(one[:, 0] > 0, model.panel == "left")


def test_what_cannot_be_analysed_is_named() -> None:
    with pytest.raises(InputError, match="no such panel; found tower; expected wall"):
        live_pressure(wall(), LoadCase((1, 0, 0), panels=("tower",)))
    with pytest.raises(InputError, match=r"LoadCase.live: wrong shape; found \(3, 6\)"):
        live_load(shell_elements(wall()), LoadCase((1, 0, 0), live=np.zeros((3, 6))))
    with pytest.raises(InputError, match="a material of the shell is not given; found default; expected stone"):
        shell_limit_analysis(wall(), ASKEW, [Material("stone", 1.0, 0.5)])
    with pytest.raises(InputError, match="shell: wrong kind; found None; expected a ShellModel"):
        shell_limit_analysis(None, ASKEW, MASONRY)
    with pytest.raises(InputError, match="load: wrong kind"):
        shell_limit_analysis(wall(), (1, 1, 0), MASONRY)
    with pytest.raises(InputError, match="materials: wrong kind; found Material; expected a list of JointStrength"):
        shell_limit_analysis(wall(), ASKEW, MASONRY[0])
    with pytest.raises(InputError, match="no weight"):
        shell_limit_analysis(wall(surface_weight=np.zeros(36)), ASKEW, MASONRY)
    with pytest.raises(InputError, match="valid for"):
        shell_limit_analysis(wall(), ASKEW, [Material("default", 1.0, 1.2)], planes="paper")


def test_where_one_regularisation_fails_the_next_is_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    options = {"planes": "paper", "membrane": "CST", "solver": "interior-point"}
    expected = shell_limit_analysis(portal(False), ASKEW, MASONRY, **options)  # pyright: ignore[reportArgumentType]
    tried: list[int] = []
    starts: list[Any] = []
    ends: list[Any] = []

    def failing(*arguments: Any) -> Ending:
        ending = solve_coupled(*arguments)
        tried.append(ending.info.iteration)
        starts.append(arguments[3])
        # The first of the dead load ends near, the first of the limit load far from the solution.
        if len(tried) in (1, 3):
            error = 1e-5 if len(tried) == 1 else 1e-2
            ending = replace(ending, status="failed", info=replace(ending.info, error=error))
        ends.append(ending.at)
        return ending

    monkeypatch.setattr(condensed, "solve_coupled", failing)
    state = shell_limit_analysis(portal(False), ASKEW, MASONRY, **options)  # pyright: ignore[reportArgumentType]
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(expected.load_factor, rel=1e-6)
    # Dead load and limit load twice each; what the first attempt took counts.
    assert len(tried) == 4
    assert state.iterations == tried[2] + tried[3]
    assert starts[1] is ends[0]
    assert starts[3] is not ends[2]


@pytest.mark.parametrize(("apart", "status"), [(4e-6, "optimal"), (4e-5, "failed")])
def test_last_digits_that_are_out_of_reach_are_told(monkeypatch: pytest.MonkeyPatch, apart: float, status: str) -> None:
    whole = shell_limit_analysis(wall(), ASKEW, MASONRY)

    def short(*arguments: Any) -> Bounds:
        found = proved_bounds(*arguments)
        return replace(found, upper=found.lower * (1 + apart), message="no further progress")

    monkeypatch.setattr(limit, "proved_bounds", short)
    state = shell_limit_analysis(wall(), ASKEW, MASONRY, solver="interior-point")
    assert whole.message == ""
    assert state.status == status
    assert state.message.startswith(f"bounds {whole.load_factor:.8g} and ")
    assert state.message.endswith("no further progress")
    if status == "optimal":
        assert state.load_factor == state.lower_bound == whole.load_factor
