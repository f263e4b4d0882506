"""Records made of results: what was asked, what came out, what an analysis left out of it."""

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from churchpipe.io.records import Analysis, HalvedSteps, common
from churchpipe.io.tie_records import candidates_of, gains_of, tie_forces_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve, step_difference
from churchpipe.model.gains import Sensitivities
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import CONTACT_MODEL, RIGID_BLOCKS, SHELL, ContactModel, Planes, ShellMethod
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState, Status
from churchpipe.model.shell import ShellModel
from churchpipe.model.ties import RankedTie, Tie


def _question(load: LoadCase, materials: Sequence[JointStrength], joints: Sequence[JointGroup]) -> dict[str, Any]:
    """Return what an analysis of a structure of these materials, and of these joints of their own, is asked; no name as yet."""
    crushing = {one.name: one.compressive_strength for one in materials if one.compressive_strength is not None}
    return {
        "name": "",
        "variant": None,
        "load": load.name,
        "direction": tuple(load.direction.tolist()),
        "multiplies": load.multiplies or (),
        "friction": common({material.name: material.friction for material in materials}),
        "cohesion": common({material.name: material.cohesion for material in materials}),
        "compressive_strength": (common(crushing) if len(crushing) == len(materials) else crushing) if crushing else None,
        "joints": tuple(joints),
    }


_BOUNDED = ("load_factor", "lower_bound", "upper_bound", "status", "iterations", "solver", "equilibrium_residual", "message")


def _ending(state: LimitState | ShellLimitState) -> dict[str, Any]:
    return {key: getattr(state, key) for key in _BOUNDED} | {"seconds": round(state.seconds, 3)}


def record_of(
    state: LimitState,
    load: LoadCase,
    materials: Sequence[JointStrength],
    contact_model: ContactModel = CONTACT_MODEL,
    ties: Sequence[Tie] = (),
    ranked: Sequence[RankedTie] = (),
    rates: Sensitivities | None = None,
    joints: Sequence[JointGroup] = (),
) -> Analysis:
    """Return the record of a rigid-block analysis with these ties, the ranking of others, and what would help its walls."""
    sliding: dict[str, Any] = {}
    if state.flow == "non-associative":
        sliding = {key: getattr(state, key) for key in ("gap", "interval", "friction_violation", "fixed_points")}
        sliding["history"] = tuple(step.load_factor for step in state.history)
    return Analysis(
        model=RIGID_BLOCKS,
        flow=state.flow,
        contact_model=contact_model,
        **_question(load, materials, joints),
        **_ending(state),
        cone_violation=state.cone_violation,
        tie_candidates=candidates_of(ranked),
        gains=gains_of(rates) if rates else (),
        **sliding,
        tie_forces=tie_forces_of(ties, state),
    )


def curve_record_of(
    curve: BlockCapacityCurve,
    stones: Assemblage,
    load: LoadCase,
    materials: Sequence[JointStrength],
    joints: Sequence[JointGroup] = (),
    contact_model: ContactModel | None = None,
) -> Analysis:
    """Return the record of a capacity curve of the stones; its load factor is that which starts the motion.

    status: "converged" when all of its steps are proved, however it ends: `ending`.
    """
    lost = ["cohesion, which opening joints lose, is left out"] if any(one.cohesion for one in (*materials, *joints)) else []
    status: Status = "converged" if curve.proved and curve.status != "not-converged" else "not-converged"
    if curve.proved_steps < len(curve.misfit):
        proved = f"only the first {curve.proved_steps} of its {len(curve.misfit)} steps are proved; a shorter step may prove more"
        lost = [proved, *lost]
    if curve.status in ("unstable", "failed") or (curve.status == "unbounded" and not len(curve.displacement)):
        status = curve.status
    return Analysis(
        model=RIGID_BLOCKS,
        method="curve",
        contact_model=contact_model,
        **_question(load, materials, joints),
        load_factor=curve.initial,
        status=status,
        seconds=round(curve.seconds, 3),
        equilibrium_residual=float(curve.residual.max(initial=0.0)),
        cone_violation=float(curve.violation.max(initial=0.0)),
        message="; ".join(said for said in (curve.message, *lost) if said),
        ending=curve.status,
        d0=curve.d0,
        displacement=tuple(curve.displacement.tolist()),
        load_factors=tuple(curve.load_factor.tolist()),
        largest_displacement=float(curve.largest.max(initial=0.0)),
        fallen_stones=tuple(str(name) for part in curve.fallen for name in stones.block_id[part.stones].tolist()),
        fell_at=tuple(part.displacement for part in curve.fallen for _ in part.stones),
        misfit=float(curve.misfit.max(initial=0.0)),
        no_equilibria=tuple((1 + np.flatnonzero(curve.jumps)).tolist()),
        proved_steps=curve.proved_steps,
        steps=len(curve.displacement),
    )


def halved_record(curve: BlockCapacityCurve, halved: BlockCapacityCurve) -> HalvedSteps:
    """Return the record of a capacity curve with steps half as long, beside that with whole ones."""
    difference, place = step_difference(curve, halved)
    return HalvedSteps(
        displacement=tuple(halved.displacement.tolist()),
        load_factors=tuple(halved.load_factor.tolist()),
        ending=halved.status,
        d0=halved.d0,
        difference=difference,
        difference_at=place,
    )


def shell_record_of(
    result: ShellLimitState | CapacityCurve | str,
    load: LoadCase,
    materials: Sequence[JointStrength],
    *,
    method: ShellMethod,
    planes: Planes,
    ties: Sequence[Tie] = (),
    joints: Sequence[JointGroup] = (),
    mesh: ShellModel | None = None,
    status: Literal["failed", "left-out"] = "failed",
) -> Analysis:
    """Return the record of an analysis of the shell; result: a text where it was not made, and why, with its status. mesh: tells
    where the control point of a capacity curve lies.

    The load factor of a capacity curve is the largest one reached.
    """
    match result:
        case ShellLimitState():
            ending: dict[str, Any] = _ending(result) | {"yield_violation": result.yield_violation}
        case CapacityCurve():
            ending = {
                "load_factor": result.plateau if result.status in ("converged", "not-converged") else np.nan,
                "status": result.status,
                "iterations": sum(step.iterations for step in result.steps),
                "seconds": round(result.seconds, 3),
                "equilibrium_residual": max((step.residual for step in result.steps), default=np.nan),
                "yield_violation": max((step.violation for step in result.steps), default=np.nan),
                "message": result.message,
                "steps": len(result.control),
                "control_point": int(result.control_point),
                "control_at": None if mesh is None else tuple(mesh.points[result.control_point].tolist()),
                "control": tuple(result.control.tolist()),
                "load_factors": tuple(result.load_factor.tolist()),
            }
        case str():
            ending = {"load_factor": np.nan, "status": status, "seconds": 0.0, "equilibrium_residual": np.nan, "message": result}
    tensions = () if isinstance(result, str) else tie_forces_of(ties, result)
    strong = any(material.compressive_strength is not None for material in materials)
    lost = 'nothing crushes here: compressive_strength enters analyses of stones, and shells with planes = "cell"'
    ending["message"] = "; ".join(words for words in (ending["message"], lost if strong and planes != "cell" else "") if words)
    asked = _question(load, materials, joints)
    return Analysis(model=SHELL, method=method, planes=planes, **asked, **ending, tie_forces=tensions)
