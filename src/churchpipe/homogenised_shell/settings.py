"""Numbers that the solvers of the shell go by, each with its reason, checked."""

from dataclasses import dataclass, fields, replace

from churchpipe.conic.interior_point.settings import CENTRAL
from churchpipe.errors import InputError


@dataclass(frozen=True, slots=True)
class SolverSettings:
    """Tolerances and lengths of limit analysis and capacity curve. Shares are relative unless a unit is given.

    Proof of a limit load:
    duality_gap: how far the bounds may be apart, as a share of the load factor, or of `least_load_factor` if that is larger, so
        that a structure that nearly falls by itself can be decided; residual of equilibrium over the weight, and excess over the
        strength in units of stress, may be as large.
    standing: share of the dead load that may be missing of a shell that stands; a hundred times what solves reach.
    lintel_dissipation: from this share of the dissipation in parts that do not yield nothing else limits the load.
    clarabel_facets: meshes beyond take Clarabel minutes, so it is no fallback there.

    Parts that do not yield:
    lintel_tension: in units of stress (weight over the longest side of the shell, N/m); with no limit a wall of fine facets
        jams at the corner of a lintel. lintel_friction: of the running bond that has this tension. Tuned on S22 alone: 100 units
        give 2e-4 less than 300 there (docs/shell.md).

    Regularisation of a limit analysis with planes, which nothing holds in M12 and far from all planes; it adds a compliance to
    the steps and leaves no trace in the solution:
    by_area: of the whole shell, shared out by area, tuned on S22 from 500 to 60 000 facets; by_point: of each point, tried where
        that fails, tuned on the church at .2 m; by_point_last: from where that ends, for the last digits.
    near: error up to which a failed attempt is the start of the next.

    Capacity curve:
    first_step: in displacements that a load factor of one would cause if nothing yielded. rise: by which share of itself a step
        should raise the load factor; growth: of a step over the one before, at most. plateau: a step that makes the path longer
        by `longer` and raises the load factor by less than this share has reached it. shrink: of a step that was not solved;
        shortest: share of the first step below which none is tried. They set the number of points on the curve, no result.
    correctors: centrality correctors at an iteration of a step with the exact cell, whose linear solves cost more than the
        factorisation: with 2 instead of 12 the curve of S5 takes 14 % more iterations and 30 % less time.
    """

    duality_gap: float = 1e-6
    least_load_factor: float = 1e-3
    standing: float = 1e-4
    lintel_dissipation: float = 0.5
    clarabel_facets: int = 10_000
    lintel_tension: float = 100.0
    lintel_friction: float = 0.5
    by_area: float = 2e-6
    by_point: float = 1e-8
    by_point_last: float = 1e-9
    near: float = 1e-4
    first_step: float = 0.1
    rise: float = 0.2
    growth: float = 3.0
    plateau: float = 5e-4
    longer: float = 1.5
    shrink: float = 0.25
    shortest: float = 1e-4
    correctors: int = 2

    def __post_init__(self) -> None:
        for field in fields(self):
            _check(field.name, getattr(self, field.name), getattr(self, field.name) > 0, "> 0")
        for name in ("growth", "longer"):
            _check(name, getattr(self, name), getattr(self, name) > 1, "> 1")
        for name in ("duality_gap", "standing", "lintel_dissipation", "near", "plateau", "shrink", "shortest"):
            _check(name, getattr(self, name), getattr(self, name) < 1, "< 1")


def _check(name: str, value: float, good: bool, expected: str) -> None:
    if not good:
        raise InputError(f"SolverSettings.{name}", "out of range", found=value, expected=expected)


SOLVER = SolverSettings()
# The loop of a limit analysis aims below what its bounds must meet, a step of a curve further: errors of some twenty add up.
LIMIT = replace(CENTRAL, duality_gap=1e-7, acceptable=SOLVER.duality_gap, residual=1e-9)
STEP = replace(CENTRAL, duality_gap=1e-10, acceptable=SOLVER.duality_gap, residual=1e-10)
