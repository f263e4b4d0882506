"""Constants of the solvers of the shell, checked. How they were chosen: docs/development.md."""

from dataclasses import dataclass, replace

from churchpipe.conic.interior_point.settings import CENTRAL
from churchpipe.model.arguments import check_constants


@dataclass(frozen=True, slots=True)
class SolverSettings:
    """Tolerances and lengths of limit analysis and capacity curve. Shares are relative unless a unit is given.

    Mesh:
        fold: sine of the angle between two facets from which on their edge is a fold, whose mid-side may move normal to them.
        Corners of walls are folds, the edges between the facets of an apse are not.
        level: an edge that rises by less than this share of its length is level; its mid-side has no motion normal to a fold.

    Proof of a limit load:
        duality_gap: greatest distance of the bounds, as a share of the load factor, or of `least_load_factor` if that is larger,
        so that a structure that nearly falls under its own weight can be decided. The residual of equilibrium over the weight,
        and the excess over the strength in units of stress, may be as large. last_digits: the same, where the solver cannot
        come nearer: a load factor that is approached by ever larger motions, and reached by none, has no last digits.
        standing: greatest share of the dead load that may be missing for a shell to count as standing.
        lintel_dissipation: if this share of the dissipation or more is in parts that do not yield, nothing else limits the load.
        clarabel_facets: on larger meshes Clarabel takes minutes, so it is no fallback there.

    Parts that do not yield:
        lintel_tension: their tensile strength in units of stress (weight over the longest side of the shell, N/m). With infinite
        strength a wall of fine facets could not move at the corner of a lintel. lintel_friction: their friction.

    Joints at feet:
        foot_stiffness: on a capacity curve, over that of a course. What a shell stands on does not yield.

    Regularisation of a limit analysis with planes. The planes do not bound M12, and points far from all planes have no compliance
        of their own; the steps of the solver get a small one, which does not change the solution.
        by_area: compliance of the whole shell, distributed by area. by_point: of each point, tried where the first fails.
        by_point_last: of each point, started from the end of the second, for the last digits.
        near: up to this error a failed attempt is used as the start of the next.

    Capacity curve (these set the number of points on the curve, not the result):
        first_step: as a share of the displacement that a load factor of one would cause if nothing yielded. rise: by which share
        of itself a step should raise the load factor. growth: greatest ratio of a step to the one before. plateau, longer: the
        plateau is reached by a step that makes the path longer by the factor `longer` and raises the load factor by less than
        `plateau`. shrink: factor on a step that was not solved. shortest: as a share of the first step, no shorter one is tried.
        start_margin: a step begins at the stresses before it with so much compression more, in units of stress, which takes them
        inside the strength. The nearer the start, the fewer iterations; but on the boundary itself the solver cannot move.
        correctors: centrality correctors in an iteration of a step with the exact cell, where linear solves cost more than the
        factorisation. step_gap, step_residual, step_iterations: tolerances and limit of the method for these steps alone
        (`elastic_step`), whose errors add up to some 1e-6 of the load factor. step_margin, step_work, step_corner_work:
        where it begins: slack of the corners that neither open nor bear, in units of force; work of all corners together, as a
        share of the reward; the least work of one corner, likewise, which is more than its part of that where there are many.
        tie_rounds: at most so many solutions of a step under given tensions of ties; tie_tension: how far a tension may be from
        what its elongation says, as a share of the largest tension.

    Flow rule with planes, solved at each point by Hildreth's sweeps over the planes:
        flow_sweeps: between two looks at which points still change. flow_rounds: at most so many looks; planes that nearly
        coincide need many. flow_tolerance: change of a rate, as a share of the largest, at which a point is left alone: rounding.
    """

    foot_stiffness: float = 1e4
    fold: float = 0.5
    level: float = 1e-6
    duality_gap: float = 1e-6
    last_digits: float = 1e-5
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
    start_margin: float = 0.03
    correctors: int = 2
    step_gap: float = 1e-8
    step_residual: float = 1e-10
    step_iterations: int = 60
    step_margin: float = 0.005
    step_work: float = 0.25
    step_corner_work: float = 4e-6
    tie_rounds: int = 40
    tie_tension: float = 1e-4
    flow_sweeps: int = 50
    flow_rounds: int = 40
    flow_tolerance: float = 1e-13

    def __post_init__(self) -> None:
        shares = ("fold", "level", "duality_gap", "last_digits", "standing", "lintel_dissipation", "near")
        steps = ("plateau", "shrink", "shortest", "flow_tolerance")
        check_constants(self, below_one=(*shares, *steps), above_one=("growth", "longer"))


SOLVER = SolverSettings()
# The solver of a limit analysis aims at a smaller gap than its bounds must meet. Points that start with little work settle before
# the forces balance: steps become short, and the last digits of the balance are lost. A few of many would hold every step.
LIMIT = replace(CENTRAL, duality_gap=3e-7, acceptable=SOLVER.duality_gap, residual=1e-9, rate=1e4, correctors=4, ignored=1e-3)
STARTED_LOW = replace(LIMIT, rate=1.0, correctors=CENTRAL.correctors, ignored=CENTRAL.ignored)
# The steps of a curve aim at a smaller gap still, because the errors of about twenty steps add up.
STEP = replace(CENTRAL, duality_gap=1e-10, acceptable=SOLVER.duality_gap, residual=1e-10)
# Under dead load joints may be at rest, with no stress inside their strength: then the last digits are out of reach. Its stresses
# are but where the first step of a curve starts from.
FIRST_STEP = replace(STEP, acceptable=SOLVER.standing)
