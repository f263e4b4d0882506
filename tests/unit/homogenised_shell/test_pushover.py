"""Capacity curves: elastic strips by hand, plateaus against limit loads, one step against its statement in cvxpy."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.homogenised_shell.condensed import CondensedShell
from churchpipe.homogenised_shell.element import shell_elements
from churchpipe.homogenised_shell.limit import shell_limit_analysis
from churchpipe.homogenised_shell.pushover import pushover
from churchpipe.homogenised_shell.stiffness import facet_stiffness
from churchpipe.homogenised_shell.strength import paper_planes
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from churchpipe.model.names import Planes
from churchpipe.model.results import CapacityCurve, CapacityStep
from churchpipe.model.shell import ShellModel
from shell_meshes import grid, shell, wall_points
from shell_reference import reference_step, shell_program

# Malena et al. 2019, Table 1.
ELASTIC = Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
MASONRY = [Material("default", 28.6e3, 0.7, 0.0, ELASTIC)]
OUT, ASKEW = LoadCase((0, 1, 0)), LoadCase((1, 1, 0))
PRESSURE = 1144.0


def wall(rows: int = 3, size: float = 0.63, columns: int | None = None) -> ShellModel:
    points, triangles = grid(columns or rows, rows, size * (columns or rows) / rows, size)
    return shell(wall_points(points), triangles, surface_weight=PRESSURE, supported=lambda p: p[:, 2] < 1e-9)


def check(curve: CapacityCurve) -> None:
    assert curve.status == "converged"
    assert curve.load_factor[0] == curve.control[0] == 0.0
    # A plateau is flat to the last digits of a solve.
    assert (np.diff(curve.load_factor) > -1e-9).all()
    assert (np.diff(curve.control) > 0).all()
    assert [step.load_factor for step in curve.steps] == curve.load_factor.tolist()
    for step in curve.steps:
        assert step.residual < 1e-8
        assert step.violation < 1e-12
        assert step.gap < 1e-6


def test_column_stretches_by_hand() -> None:
    # Without lateral contraction N22 is linear over the height and u quadratic: the element is exact, d = lambda w H^2 / 3 C22.
    # The joint on the ground is ten thousand times as stiff as a course of 30 mm, and bears all of it: lambda w H over that.
    # Stones between beds of another material are hindered by these; of one material the wall does not contract.
    straight = replace(ELASTIC, block_poisson=0.0, joint_poisson=0.0, joint_modulus=ELASTIC.block_modulus)
    model = wall(6, columns=2)
    curve = pushover(model, LoadCase((0, 0, -1)), [Material("default", 28.6e3, 0.7, 0.0, straight)], steps=3)
    stiffness = facet_stiffness(model, [Material("default", 28.6e3, 0.7, 0.0, straight)])[0, 1, 1]
    assert curve.status == "not-converged"
    displacement = np.array([step.displacement for step in curve.steps])
    softness = PRESSURE * 0.63 * (0.63 / 3 + 0.03 / 1e4) / stiffness
    np.testing.assert_allclose(curve.load_factor, displacement / softness, rtol=1e-6)
    # The top goes down by w H^2 / 2 C22.
    np.testing.assert_allclose(
        curve.control, curve.load_factor * PRESSURE * 0.63 * (0.63 / 2 + 0.03 / 1e4) / stiffness, rtol=1e-6
    )
    assert model.points[curve.control_point, 2] == pytest.approx(0.63)
    assert np.abs(curve.plastic).max() < 1e-6 * np.abs(curve.control[-1] / 0.63)


def test_wall_bends_by_hand_until_it_cracks() -> None:
    # With cohesion the first step is elastic: d = lambda w H^4 / 20 D22, and the top moves by w H^4 / 8 D22.
    straight = replace(ELASTIC, block_poisson=0.0, joint_poisson=0.0)
    masonry = [Material("default", 28.6e3, 0.7, 3e4, straight)]
    model = wall(16, columns=4)
    curve = pushover(model, OUT, masonry, steps=1)
    bending = facet_stiffness(model, masonry)[0, 4, 4]
    expected = curve.load_factor[1] * PRESSURE * 0.63**4 / bending
    assert curve.steps[1].displacement == pytest.approx(expected / 20, rel=0.01)
    assert curve.control[1] == pytest.approx(expected / 8, rel=0.01)


@pytest.mark.parametrize(
    ("planes", "membrane", "load"),
    [
        pytest.param("paper", "CST", OUT, marks=pytest.mark.slow("docs/shell.md: curves end on the limit load")),
        ("paper", "LST", ASKEW),
        ("paper+torsion", "LST", ASKEW),
    ],
)
def test_plateau_is_the_limit_load(planes: Planes, membrane: str, load: LoadCase) -> None:
    model = wall(4)
    curve = pushover(model, load, MASONRY, planes=planes, membrane=membrane)  # pyright: ignore[reportArgumentType]
    limit = shell_limit_analysis(model, load, MASONRY, planes=planes, membrane=membrane)  # pyright: ignore[reportArgumentType]
    check(curve)
    assert curve.plateau == pytest.approx(limit.load_factor, rel=5e-3)
    assert curve.plateau <= limit.upper_bound * (1 + 1e-6)
    assert model.points[curve.control_point, 2] == pytest.approx(0.63)


def test_plateau_with_the_exact_cell() -> None:
    model = wall(2)
    curve = pushover(model, OUT, MASONRY, planes="cell", membrane="CST")
    check(curve)
    limit = shell_limit_analysis(model, OUT, MASONRY, planes="cell", membrane="CST")
    assert curve.plateau == pytest.approx(limit.load_factor, rel=5e-3)
    assert curve.multipliers.shape == (len(model.triangles), 12)


def test_plastic_strain_is_the_flow_of_the_planes() -> None:
    model = wall(4)
    curve = pushover(model, ASKEW, MASONRY, planes="paper")
    planes = paper_planes(0.03, 0.08, 0.04, 0.7)
    assert curve.multipliers.min() >= 0
    flow = curve.multipliers @ planes.normal
    np.testing.assert_allclose(flow, curve.plastic, atol=1e-5 * np.abs(curve.plastic).max())


@pytest.mark.slow
@pytest.mark.parametrize("planes", ["paper", "cell"])
def test_a_step_agrees_with_its_statement_in_cvxpy(planes: Planes) -> None:
    model = wall(3)
    seen: list[CapacityStep] = []
    curve = pushover(model, ASKEW, MASONRY, planes=planes, membrane="CST", steps=1, progress=seen.append)
    assert tuple(seen) == curve.steps
    elements = shell_elements(model, "CST", on_joints=planes == "cell")
    program = shell_program(elements, ASKEW, MASONRY, planes)
    stiffness = elements.point_stiffness(facet_stiffness(model, MASONRY))
    flexibility = np.linalg.inv(stiffness) * elements.weight[:, None, None]
    displacement = curve.steps[1].displacement
    condensed = CondensedShell(elements, ASKEW, MASONRY, planes)
    unit = condensed.loads.unit.T
    work = program.weight * displacement
    compliance = np.moveaxis(flexibility, 0, 2) * unit[:, None] * unit[None, :] / work
    standing = condensed.solve(condensed.loads.dead, None, compliance=compliance, cap=1.0)
    assert standing.holds
    before = standing.stress.T * condensed.loads.unit
    # Clarabel does not converge on the joints of the cell with rows and columns scaled anew.
    options = {"tol_gap_abs": 1e-10, "tol_gap_rel": 1e-10, "equilibrate_enable": False}
    factor, stress = reference_step(program, flexibility, before, displacement, **options)
    assert curve.load_factor[1] == pytest.approx(factor, rel=1e-6)
    state = condensed.solve(condensed.loads.dead, condensed.loads.live, compliance=compliance, before=standing)
    np.testing.assert_allclose(state.stress.T * condensed.loads.unit, stress, atol=1e-4 * np.abs(stress).max())


def test_a_wall_that_does_not_stand_is_called_unstable() -> None:
    points, triangles = grid(6, 6, 1.2, 1.2)
    centre = points[triangles].mean(axis=1)
    triangles = triangles[(np.abs(centre[:, 0] - 0.6) > 0.2) | (centre[:, 1] > 0.8)]
    used, new = np.unique(triangles, return_inverse=True)
    model = shell(wall_points(points[used]), new.reshape(-1, 3), surface_weight=PRESSURE, supported=lambda p: p[:, 2] < 1e-9)
    curve = pushover(model, ASKEW, MASONRY, membrane="CST")
    assert curve.status == "unstable"
    assert "flat soffit" in curve.message
    assert not curve.steps
    over_door = (model.points[:, 2] > 0.79) & (np.abs(model.points[:, 0] - 0.6) < 0.1)
    # The soffit falls further than anything else moves.
    assert curve.displacement[over_door, 2].min() == curve.displacement[:, 2].min() < -10 * curve.displacement.max()


def test_what_cannot_be_pushed_is_named() -> None:
    assert cp.pushover is pushover
    model = wall(2)
    with pytest.raises(InputError, match="material default: no elastic constants"):
        pushover(model, OUT, [Material("default", 28.6e3, 0.7)])
    with pytest.raises(InputError, match="a material of the shell is not given; found default"):
        pushover(model, OUT, [Material("stone", 28.6e3, 0.7)])
    with pytest.raises(InputError, match="no such node; found 99; expected 0 to 12"):
        pushover(model, OUT, MASONRY, control_point=99)
    with pytest.raises(InputError, match="not a node or a point"):
        pushover(model, OUT, MASONRY, control_point=(0.0, 1.0))
    # Its nearest node was followed.
    with pytest.raises(
        InputError, match=r"control_point: a point outside the shell; found \[0\.0, 0\.0, 900\.0\]; expected a point"
    ):
        pushover(model, OUT, MASONRY, control_point=(0.0, 0.0, 900.0))
    with pytest.raises(InputError, match="steps: out of range"):
        pushover(model, OUT, MASONRY, steps=0)
    with pytest.raises(InputError, match="steps: not a whole number; found 'a'; expected >= 1"):
        pushover(model, OUT, MASONRY, steps="a")
    with pytest.raises(InputError, match="shell: wrong kind; found None; expected a ShellModel"):
        pushover(None, OUT, MASONRY)
    with pytest.raises(InputError, match=r"materials\[0\]: wrong kind"):
        pushover(model, OUT, ["default"])
    with pytest.raises(InputError, match="nothing holds it"):
        pushover(replace(model, supported=np.zeros(13, dtype=bool)), OUT, MASONRY)


def test_control_point_by_number_and_by_place() -> None:
    model = wall(2)
    by_number = pushover(model, OUT, MASONRY, membrane="CST", control_point=1, steps=2)
    by_place = pushover(model, OUT, MASONRY, membrane="CST", control_point=model.points[1] + 0.01, steps=2)
    assert by_number.control_point == by_place.control_point == 1
    # What the wall stands on does not yield.
    assert 0 < by_number.control[1] < 1e-6 * by_number.steps[1].displacement


@pytest.mark.parametrize("planes", ["paper", "cell"])
def test_what_does_not_yield_is_elastic_from_no_stress(planes: Planes) -> None:
    # Cohesion moves the strength; the stresses of a shell that nothing has loaded are zero all the same.
    firm = [replace(material, cohesion=1e6) for material in MASONRY]
    curve = pushover(wall(3), ASKEW, firm, planes=planes, steps=1)
    assert curve.load_factor[1] == pytest.approx(0.1, rel=1e-6)
