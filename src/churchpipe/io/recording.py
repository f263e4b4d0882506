"""Records made of results: what was asked, what came out, what an analysis left out of it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.io.records import BlockCurveRecord, BlockPath, Curve, Outcome, Question, RigidRecord, ShellRecord, Sliding
from churchpipe.io.tie_records import candidates_of, gains_of, tie_forces_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.gains import Sensitivities
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import CONTACT_MODEL, ContactModel, Planes, ShellMethod
from churchpipe.model.quantities import as_written
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState, Status
from churchpipe.model.ties import RankedTie, Tie


def question_of(load: LoadCase, materials: Sequence[JointStrength], joints: Sequence[JointGroup] = ()) -> Question:
    """Return what an analysis of a structure of these materials, and of these joints of their own, is asked."""
    return Question(
        load.name,
        tuple(load.direction.tolist()),
        {material.name: material.friction for material in materials},
        {material.name: material.cohesion for material in materials},
        {one.name: one.compressive_strength for one in materials if one.compressive_strength is not None},
        tuple(as_written(group, defaults=False) for group in joints),
    )


def record_of(
    state: LimitState,
    load: LoadCase,
    materials: Sequence[JointStrength],
    contact_model: ContactModel = CONTACT_MODEL,
    ties: Sequence[Tie] = (),
    ranked: Sequence[RankedTie] = (),
    rates: Sensitivities | None = None,
    joints: Sequence[JointGroup] = (),
) -> RigidRecord:
    """Return the record of a rigid-block analysis with these ties, the ranking of others, and what would help its walls."""
    outcome = Outcome(
        state.status,
        state.load_factor,
        state.lower_bound,
        state.upper_bound,
        state.equilibrium_residual,
        state.cone_violation,
        state.iterations,
        state.seconds,
        state.solver,
        state.message,
    )
    sliding = None
    if state.flow == "non-associative":
        history = tuple(step.load_factor for step in state.history)
        sliding = Sliding(state.gap, state.interval, state.friction_violation, state.fixed_points, history)
    tied = tie_forces_of(ties, state), candidates_of(ranked), gains_of(rates) if rates else ()
    return RigidRecord(question_of(load, materials, joints), outcome, state.flow, sliding, contact_model, *tied)


def curve_record_of(
    curve: BlockCapacityCurve,
    stones: Assemblage,
    load: LoadCase,
    materials: Sequence[JointStrength],
    joints: Sequence[JointGroup] = (),
) -> BlockCurveRecord:
    """Return the record of a capacity curve of the stones; its load factor is that which starts the motion.

    status: "converged" when all of its steps are proved, however it ends: `ending`.
    """
    lost = ["cohesion, which opening joints lose, is left out"] if any(one.cohesion for one in (*materials, *joints)) else []
    status: Status = "converged" if curve.proved and curve.status != "not-converged" else "not-converged"
    if curve.status in ("unstable", "failed") or (curve.status == "unbounded" and not len(curve.displacement)):
        status = curve.status
    outcome = Outcome(
        status,
        load_factor=curve.initial,
        equilibrium_residual=float(curve.residual.max(initial=0.0)),
        violation=float(curve.violation.max(initial=0.0)),
        seconds=curve.seconds,
        message="; ".join(said for said in (curve.message, *lost) if said),
    )
    path = BlockPath(
        ending=curve.status,
        d0=curve.d0,
        displacement=tuple(curve.displacement.tolist()),
        load_factors=tuple(curve.load_factor.tolist()),
        largest=float(curve.largest.max(initial=0.0)),
        fallen=tuple(str(name) for part in curve.fallen for name in stones.block_id[part.stones].tolist()),
        fell_at=tuple(part.displacement for part in curve.fallen for _ in part.stones),
        misfit=float(curve.misfit.max(initial=0.0)),
    )
    return BlockCurveRecord(question_of(load, materials, joints), outcome, path)


def shell_record_of(
    result: ShellLimitState | CapacityCurve | str,
    load: LoadCase,
    materials: Sequence[JointStrength],
    *,
    method: ShellMethod,
    planes: Planes,
    ties: Sequence[Tie] = (),
    joints: Sequence[JointGroup] = (),
) -> ShellRecord:
    """Return the record of an analysis of the shell; result: a text where it was refused, and why.

    The load factor of a capacity curve is the largest one reached.
    """
    curve = None
    match result:
        case ShellLimitState():
            outcome = Outcome(
                result.status,
                result.load_factor,
                result.lower_bound,
                result.upper_bound,
                result.equilibrium_residual,
                result.yield_violation,
                result.iterations,
                result.seconds,
                result.solver,
                result.message,
            )
        case CapacityCurve():
            outcome = Outcome(
                result.status,
                result.plateau if result.status in ("converged", "not-converged") else np.nan,
                equilibrium_residual=max((step.residual for step in result.steps), default=np.nan),
                violation=max((step.violation for step in result.steps), default=np.nan),
                iterations=sum(step.iterations for step in result.steps),
                seconds=result.seconds,
                message=result.message,
            )
            curve = Curve(int(result.control_point), tuple(result.control.tolist()), tuple(result.load_factor.tolist()))
        case str():
            outcome = Outcome("failed", message=result)
    tensions = () if isinstance(result, str) else tie_forces_of(ties, result)
    strong = any(material.compressive_strength is not None for material in materials)
    lost = 'nothing crushes here: compressive_strength enters analyses of stones, and shells with planes = "cell"'
    said = "; ".join(words for words in (outcome.message, lost if strong and planes != "cell" else "") if words)
    return ShellRecord(question_of(load, materials, joints), replace(outcome, message=said), method, planes, curve, tensions)
