"""Supports that settle or spread: the reaction that is left, where the structure cracks, and how far it may go."""

from time import perf_counter
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from churchpipe.conic.solve import solver_for
from churchpipe.large_displacements.moving_model import MovingModel, bearing, moving_model
from churchpipe.large_displacements.path import PathStep, solve_state
from churchpipe.large_displacements.path_state import PathState, first_state
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.supports import support_movement
from churchpipe.model.arguments import check_kind, one_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import ContactModel
from churchpipe.model.settlement import SettlementState, SettlementStatus
from churchpipe.rigid_blocks.associative import dead_load_analysis
from churchpipe.rigid_blocks.limit import limit_program


def settlement_analysis(
    stones: Assemblage,
    contacts: Contacts,
    support: npt.ArrayLike,
    direction: npt.ArrayLike = (0, 0, -1),
    friction: npt.ArrayLike = 0.6,
    *,
    about: npt.ArrayLike | None = None,
    dead: LoadCase | npt.ArrayLike | None = None,
    flow: Literal["associative", "non-associative"] = "associative",
    contact_model: ContactModel = "corners",
    compressive_strength: npt.ArrayLike | None = None,
    solver: str = "auto",
) -> SettlementState:
    """Return the least reaction of a support that moves, and the motion of the structure that follows it.

    The support is set free but for its balance along the movement, and the force that resists it there is made as small as the
    equilibrium of the structure allows.

    Parameters
    ----------
    stones
        The assemblage.
    contacts
        Its joints, from `find_contacts`.
    support
        Indices of fixed stones that move as one body.
    direction
        Direction (3,) of the movement; of its axis, right-handed, where `about` is given.
    about
        A point (3,) m of the axis about which the support turns; None: it is shifted.
    dead
        What acts beside the weight: the dead part of a load case, as `loaded` returns it, or wrenches (nb, 6) N and Nm about
        the centroids.
    friction
        Coefficient, a number or one an interface.
    flow
        "associative", the least reaction of all, its bounds proved; or "non-associative", stones that slide without dilating,
        as they move in `settlement_path`: a reaction as large or larger, and one of several, since more than one set of forces
        may fit a motion. What a support has to resist with is the larger of both.
    contact_model
        As in `limit_analysis`.
    compressive_strength
        Pa, a number or one an interface (ni,), infinite for joints that do not crush; None: none does. Each joint is pressed
        in a part of the rectangle within it, as in `block_pushover`.
    solver
        As in `limit_analysis`.

    Raises
    ------
    InputError
        A support that is not there, not fixed or bears nothing, no direction, arguments out of range.
    """
    begin = perf_counter()
    doubt_argument("settlement_analysis: friction", friction, JointStrength, "friction")
    doubt_argument("settlement_analysis: compressive_strength", compressive_strength, JointStrength, "compressive_strength")
    one_of("settlement_analysis: flow", flow, "associative", "non-associative")
    one_of("settlement_analysis: contact_model", contact_model, *get_args(ContactModel))
    moved = (support, direction, about)
    model, state, status, message = settlement_model(
        stones, contacts, moved, friction, dead, None, solver, contact_model, compressive_strength
    )
    if status != "stable":
        return _nothing(stones, contacts, status, message, perf_counter() - begin)
    step = solve_state(model, state, PATH.first_programs) if flow == "non-associative" else least_step(model, state)
    outcome = step.answer.outcome
    if outcome != "solved":
        return _nothing(
            stones, contacts, "unbounded" if outcome == "unbounded" else "failed", step.answer.message, perf_counter() - begin
        )
    return _state(model, contacts, step, flow, perf_counter() - begin)


def least_step(model: MovingModel, state: PathState) -> PathStep:
    """Return the answer of associative friction, the least reaction of all equilibria: one program."""
    return solve_state(model, state, programs=1, pairs=0, rounds=0)


def settlement_model(
    stones: Assemblage,
    contacts: Contacts,
    moved: tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike | None],
    friction: npt.ArrayLike,
    dead: LoadCase | npt.ArrayLike | None,
    step: float | None,
    solver: str,
    contact_model: ContactModel,
    compressive_strength: npt.ArrayLike | None,
) -> tuple[MovingModel, PathState, Literal["stable", "unstable", "failed"], str]:
    """Return the model of a structure whose support moves, its state as drawn, and whether it stands there.

    moved: the support, the direction of its movement and a point of its axis, as in `settlement_analysis`.
    """
    for name, value, kind in (("stones", stones, Assemblage), ("contacts", contacts, Contacts)):
        check_kind(f"settlement_analysis: {name}", value, kind)
    load = dead if isinstance(dead, LoadCase) else LoadCase((1, 0, 0), dead=dead)
    balance, strength, _ = limit_program(
        stones, contacts, load, friction, contact_model=contact_model, compressive_strength=compressive_strength
    )
    movement = support_movement(stones, contacts, *moved)
    standing, answer = dead_load_analysis(balance, strength, solver_for(balance.balance, solver))
    model = moving_model(
        stones,
        contacts,
        load,
        movement,
        friction,
        balance,
        ~stones.fixed,
        step,
        solver,
        strength=compressive_strength,
        contact_model=contact_model,
    )
    first = first_state(model)
    message = "the dead load alone brings it down" if standing == "unstable" else answer.message
    return model, first, standing, message


def _state(model: MovingModel, contacts: Contacts, step: PathStep, flow: str, seconds: float) -> SettlementState:
    answer = step.answer
    bears = np.repeat(bearing(model.stones.fixed, contacts.blocks), contacts.points_per_interface)
    rate, forces = np.zeros((2, len(bears), 3))
    rate[bears], forces[bears] = step.rate, answer.forces[: len(step.rate)] * model.force
    fits = (
        answer.gap < PATH.flow * max(abs(answer.load_factor), 1e-3)
        if flow == "non-associative"
        else answer.bound_gap < PATH.bounds
    )
    proved = fits and answer.residual < PATH.balance and answer.violation < PATH.balance
    return SettlementState(
        reaction=float(resistance(np.array(answer.load_factor))) * model.force,
        status="optimal" if proved else "not-converged",
        velocities=step.velocity,
        opening=rate[:, 0],
        slip=np.hypot(rate[:, 1], rate[:, 2]),
        forces=forces,
        residual=answer.residual,
        violation=answer.violation,
        bound_gap=answer.bound_gap,
        gap=answer.gap if flow == "non-associative" else float("nan"),
        message=answer.message,
        seconds=seconds,
    )


def resistance(load_factor: FloatArray) -> FloatArray:
    """Return the reactions against a movement, over the weight, of the load factors of a push along it; rounding is none."""
    return np.where(np.abs(load_factor) < PATH.nothing, 0.0, -load_factor)


def _nothing(stones: Assemblage, contacts: Contacts, status: SettlementStatus, message: str, seconds: float) -> SettlementState:
    points, nan = np.zeros(len(contacts.point)), float("nan")
    return SettlementState(
        nan, status, np.zeros((stones.count, 6)), points, points, np.zeros((len(points), 3)), nan, nan, nan, nan, message, seconds
    )
