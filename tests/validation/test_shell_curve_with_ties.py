"""Capacity curves of a shell with ties: the law of each tie by the displacements of its anchors, plateaus against limit loads."""

from functools import cache

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.homogenised_shell import ties as tied
from churchpipe.homogenised_shell.condensed import CondensedShell, StressState
from churchpipe.homogenised_shell.step_ties import StepTies
from churchpipe.model.materials import Elastic

MASONRY = [cp.Material("default", 18e3, 0.6, 0.0, Elastic(3e9, 0.2, 0.3e9, 0.2, 0.01))]
ACROSS, ALONG = cp.LoadCase((1, 0, 0)), cp.LoadCase((0, 1, 0))
STEEL, YIELD = 210e9, 235e6
MORE = pytest.mark.slow("docs/strengthening.md: ties on the capacity curve of a shell")


@cache
def between_walls() -> cp.ShellModel:
    """Two walls .4 m thick, 4 m long and 3 m high, 4 m apart, with a third across their ends."""
    walls = [
        {"name": "west", "start": (0, 0), "end": (0, 4)},
        {"name": "east", "start": (4, 0), "end": (4, 4)},
        {"name": "south", "start": (0, 0), "end": (4, 0)},
    ]
    plan = {"course": 0.25, "stone_length": 0.5, "height": 3.0, "thickness": 0.4, "walls": walls}
    return cp.derive_shell(generators.house(materials=tuple(MASONRY), **plan), element_size=1.0)


def facet(wall: str, y: float, z: float) -> int:
    shell = between_walls()
    centre = shell.points[shell.triangles].mean(axis=1)
    far = np.hypot(centre[:, 1] - y, centre[:, 2] - z)
    return int(np.where(np.abs(centre[:, 0] - (0 if wall == "west" else 4)) < 0.3, far, np.inf).argmin())


def tie(name: str, y: float, z: float, area: float, pretension: float = 0.0) -> cp.Tie:
    """A bar from the middle of a facet to that of another, which move as the mean of their corners."""
    shell = between_walls()
    start, end = (shell.points[shell.triangles[facet(wall, y, z)]].mean(axis=0) for wall in ("west", "east"))
    stiffness = STEEL * area / float(np.linalg.norm(end - start))
    return cp.Tie(name, start, end, strength=YIELD * area, stiffness=stiffness, pretension=pretension)


SETS = {
    "thin": [tie("a", 2.0, 2.6, 4e-6), tie("b", 3.4, 2.6, 4e-6)],
    "unlike": [tie("a", 2.0, 2.6, 400e-6), tie("b", 3.4, 1.4, 20e-6)],
    "stiff": [tie("a", 2.0, 2.6, 4e-3), tie("b", 3.4, 2.6, 4e-3)],
    "drawn": [tie("a", 2.0, 2.6, 100e-6, 500.0), tie("b", 3.4, 2.6, 100e-6, 200.0)],
}


def by_displacements(ties: list[cp.Tie], curve: cp.CapacityCurve) -> np.ndarray:
    """Return the tensions (nt,) of ties that have not yielded before the end of the curve."""
    shell = between_walls()
    centre = shell.points[shell.triangles].mean(axis=1)
    moved = curve.displacement[shell.triangles].mean(axis=1)
    found = []
    for bar in ties:
        first, second = (int(((centre - point) ** 2).sum(axis=1).argmin()) for point in (bar.start, bar.end))
        longer = float((moved[second] - moved[first]) @ bar.axis)
        assert bar.stiffness is not None
        found.append(np.clip(bar.pretension + bar.stiffness * longer, 0.0, bar.strength))
    return np.array(found)


@pytest.mark.parametrize("load", [ACROSS, ALONG])
@pytest.mark.parametrize("name", [pytest.param("thin", marks=MORE), "unlike", "stiff", pytest.param("drawn", marks=MORE)])
def test_curve_ends_on_the_limit_load(name: str, load: cp.LoadCase) -> None:
    ties = SETS[name]
    curve = cp.pushover(between_walls(), load, MASONRY, ties=ties)
    limit = cp.shell_limit_analysis(between_walls(), load, MASONRY, ties=ties)
    assert curve.status == "converged"
    assert limit.status == "optimal"
    assert curve.plateau == pytest.approx(limit.load_factor, rel=5e-3)
    assert curve.plateau <= limit.upper_bound * (1 + 1e-6)
    assert max(step.residual for step in curve.steps) < 1e-8
    tension = by_displacements(ties, curve)
    most = max(bar.strength for bar in ties)
    assert curve.tie_forces[-1] == pytest.approx(tension, rel=1e-5, abs=1e-5 * most)


def test_a_tie_that_breaks_is_told() -> None:
    whole = tie("bar", 2.0, 2.6, 4e-6)
    brittle = cp.Tie("bar", whole.start, whole.end, strength=whole.strength, stiffness=whole.stiffness, ultimate=1e-3)
    curve = cp.pushover(between_walls(), ACROSS, MASONRY, ties=[brittle])
    without = cp.pushover(between_walls(), ACROSS, MASONRY)
    # Under the dead load the bar is slack.
    held = int((curve.tie_forces[:, 0] > 0).sum())
    # It pulls to the step at whose end it breaks, and no further: at a hundredth beyond its elongation there, at the most.
    assert brittle.stiffness is not None
    assert curve.tie_forces[held, 0] == pytest.approx(brittle.stiffness * 1.005e-3, rel=5e-3)
    at = 1e3 * curve.steps[held].displacement
    assert curve.message == f"tie bar broke at a displacement of {at:.3g} mm"
    assert (curve.tie_forces[held + 1 :] == 0).all()
    assert curve.load_factor[-1] == pytest.approx(without.plateau, rel=1e-3)


def test_pretension_that_pulls_a_wall_down_is_named() -> None:
    tight = tie("bar", 2.0, 2.6, 4e-4, pretension=2e4)
    curve = cp.pushover(between_walls(), ACROSS, MASONRY, ties=[tight])
    assert curve.status == "unstable"
    assert curve.message.startswith("the dead load and the pretension of the ties bring it down")
    slack = cp.shell_limit_analysis(between_walls(), ACROSS, MASONRY, ties=[tight])
    assert slack.status == "optimal"


def test_without_cracks_the_tensions_grow_with_the_load() -> None:
    firm = [cp.Material("default", 18e3, 0.6, 1e7, MASONRY[0].elastic)]
    pulled = cp.LoadCase((1, 0, 0), panels=("east",))
    curve = cp.pushover(between_walls(), pulled, firm, ties=SETS["unlike"], steps=3)
    over = curve.tie_forces[1:] / curve.load_factor[1:, None]
    assert over == pytest.approx(np.broadcast_to(over[0], over.shape), rel=1e-4)
    assert curve.tie_forces[-1] == pytest.approx(by_displacements(SETS["unlike"], curve), rel=1e-5)
    assert over[0, 0] > 0


@pytest.mark.parametrize("name", ["unlike", pytest.param("stiff", marks=MORE)])
def test_cutting_planes_find_the_same_tensions(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    ties = SETS[name]
    together = cp.pushover(between_walls(), ALONG, MASONRY, ties=ties, steps=6)
    own = CondensedShell.elastic_step

    def without_ties(*args: object, **options: object) -> StressState | None:
        return None if any(isinstance(arg, StepTies) for arg in args) else own(*args, **options)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(CondensedShell, "elastic_step", without_ties)
    apart = cp.pushover(between_walls(), ALONG, MASONRY, ties=ties, steps=6)
    assert apart.load_factor == pytest.approx(together.load_factor, rel=1e-4)
    assert apart.tie_forces == pytest.approx(together.tie_forces, abs=2e-5 * between_walls().body_weight.sum())


def test_load_factor_whose_last_digits_take_many_analyses(monkeypatch: pytest.MonkeyPatch) -> None:
    sharp = cp.shell_limit_analysis(between_walls(), ACROSS, MASONRY, ties=SETS["drawn"])
    assert sharp.upper_bound - sharp.lower_bound <= 1e-6 * sharp.load_factor
    assert not sharp.message
    monkeypatch.setattr(tied, "ALL_DIGITS", 1)
    found = cp.shell_limit_analysis(between_walls(), ACROSS, MASONRY, ties=SETS["drawn"])
    assert found.status == "optimal"
    assert found.load_factor <= sharp.upper_bound * (1 + 1e-9)
    assert found.upper_bound >= sharp.load_factor
    apart = found.upper_bound - found.lower_bound
    assert 1e-6 * found.load_factor < apart <= 1e-5 * found.load_factor
    assert found.message == f"bounds {found.lower_bound:.8g} and {found.upper_bound:.8g}"
    monkeypatch.setattr(tied, "MOST_ANALYSES", 2)
    given_up = cp.shell_limit_analysis(between_walls(), ACROSS, MASONRY, ties=SETS["drawn"])
    assert given_up.status == "not-converged"
