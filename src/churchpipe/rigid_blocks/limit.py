"""Limit analysis of rigid blocks: eqs. (1)-(2), dead load first, every result certified."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import get_args

import numpy as np
import numpy.typing as npt

from churchpipe.conic.solve import Solve, solver_for
from churchpipe.errors import InputError
from churchpipe.model.arguments import check_call, check_kind, listed, one_of
from churchpipe.model.arrays import FloatArray, NameArray, array_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import ContactModel, Flow, Start
from churchpipe.model.progress import Progress
from churchpipe.model.results import LimitState
from churchpipe.model.ties import Tie
from churchpipe.rigid_blocks.associative import associative_state, dead_load_analysis, fallen_state, unbounded_state, wedge
from churchpipe.rigid_blocks.central import runs_from_centre
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.crushing import PARTS, JointParts, joint_parts
from churchpipe.rigid_blocks.equilibrium import Equilibrium, check_connected, equilibrium
from churchpipe.rigid_blocks.polygons import joint_polygons, parallelograms
from churchpipe.rigid_blocks.pressed import with_pressed
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP
from churchpipe.rigid_blocks.sliding import Method, SlidingOptions, sliding_analysis
from churchpipe.rigid_blocks.ties import with_ties
from churchpipe.rigid_blocks.torsion import shift_about_pressure
from churchpipe.stones.joint_outlines import covered
from churchpipe.wording import counted

# Friction follows the centres of pressure until the load factor changes by no more than this share, or for so many rounds, of
# which the last two may not be told apart. Runs from the centre, after two, follow half of the way, or they would go to and fro.
_AT_REST = 5e-4
_ROUNDS, _WHOLE_WAY, _SHARE = 12, 2, 0.5
# Loads smaller than this share of the dead load are none.
_WEIGHTLESS = 1e-4
# Where friction that dilates holds at any load factor, and the search without dilatancy ends nowhere.
WEDGED = (
    "no load factor is known: the load wedges the stones, so that joints that dilate hold it however large it is; without "
    "dilatancy that proves nothing, and no collapse was found either. Stones that do not crush may never fail so: give their "
    "compressive strength"
)


def limit_analysis(
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    friction: npt.ArrayLike = 0.6,
    cohesion: npt.ArrayLike = 0.0,
    *,
    flow: Flow = "associative",
    method: Method = "default",
    start: Start | Sequence[Start] | None = None,
    ties: Sequence[Tie] = (),
    contact_model: ContactModel = "corners",
    compressive_strength: npt.ArrayLike | None = None,
    crushing_parts: int = PARTS,
    solver: str = "auto",
    bipotential_gap: float = BIPOTENTIAL_GAP,
    progress: Progress | None = None,
) -> LimitState:
    """Return the collapse load factor of an assemblage and its mechanism.

    Parameters
    ----------
    stones
        The assemblage.
    contacts
        Its joints, from `find_contacts`.
    load
        What the load factor multiplies, and what acts beside the weight.
    friction
        Coefficient, scalar or one an interface (ni,).
    cohesion
        Pa, scalar or one an interface (ni,).
    flow
        "associative" (sliding dilates, eq. (1)) or "non-associative" (no dilatancy, by iteration, eq. (3)).
    method
        Of the non-associative analysis: "default" seeks a certified state, "paper" is the iteration of the paper.
    start
        Where the non-associative analysis begins: "centre", "dead-load", "uniform", "associative" or "scattered", one or several;
        the lowest certified load factor leads.
    bipotential_gap
        Gap over load factor at which a non-associative state is certified.
    ties
        Bars that pull stones together; the result has their tensions and what their strength adds.
    contact_model
        "corners", friction acts at the corners of an interface, which overrates its resistance to torsion; "torsion", it acts
        so near to the middle of the interface (non-associative: to the centre of its pressure) that uniform pressure resists
        torsion exactly.
    compressive_strength
        Pa, scalar or one an interface (ni,), infinite for joints that do not crush; None: none does. Joints that are
        parallelograms crush up to a straight line (`conic.pressed`), others in parts. The forces of the result are given at the
        corners of the joints all the same.
    crushing_parts
        Parts along each side of a joint that may crush and is no parallelogram, an even number. With few parts the load factor
        is too low, never too high.
    solver
        "auto" (our own interior point, Clarabel where that fails), "interior-point", "clarabel", "cvxpy", "cvxpy:MOSEK" ...
    progress
        Called with what is solved and the share of that which is done.

    Returns
    -------
    LimitState
        Status "unstable" when dead load alone brings the structure down (velocities: how it falls), "unbounded" when no
        lateral load of this kind does, "not-converged" without a load factor where sliding that dilates alone is known to
        hold any, "failed" when no certified answer was found.

    Raises
    ------
    InputError
        Arguments out of range, stones without a path to a support, ties that are anchored in no stone.
    """
    for name, value, kind in (("stones", stones, Assemblage), ("contacts", contacts, Contacts), ("load", load, LoadCase)):
        check_kind(f"limit_analysis: {name}", value, kind)
    check_call("limit_analysis: progress", progress)
    for name, value in (("friction", friction), ("cohesion", cohesion), ("compressive_strength", compressive_strength)):
        doubt_argument(f"limit_analysis: {name}", value, JointStrength, name)
    one_of("limit_analysis: flow", flow, *get_args(Flow))
    starts: list[Start] = [start] if isinstance(start, str) else []
    if not starts and start is not None:
        starts = listed("limit_analysis: start", start, str)
    begin = perf_counter()
    balance, strength, parts = limit_program(
        stones, contacts, load, friction, cohesion, ties, contact_model, compressive_strength, crushing_parts
    )
    check_connected(stones, contacts, balance)
    if contact_model == "torsion" and method == "default" and not starts:
        # Else the centres of pressure are those of forces with as little self-stress as may be.
        starts = ["centre"] if runs_from_centre(balance, strength) else ["dead-load", "associative"]
    options = SlidingOptions(method, tuple(starts), bipotential_gap)
    solve, names = solver_for(balance.balance, solver), stones.block_id[balance.free]
    state = analysed(balance, strength, solve, flow, options, progress, names=names)
    if contact_model == "torsion" and flow == "non-associative" and state.flow == flow and np.isfinite(state.load_factor):
        points = contacts if parts is None else parts.contacts
        state = _about_pressure(
            balance, strength, state, partial(shift_about_pressure, contacts, points), options, solver, progress
        )
    forces = state.forces if parts is None else np.asarray(parts.shares.T @ state.forces)
    if state.status == "not-converged" and np.isfinite(state.load_factor):
        state = replace(state, message=f"{state.message}; {_advice(state)}")
    return replace(state, forces=forces, seconds=perf_counter() - begin)


def limit_program(
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    friction: npt.ArrayLike,
    cohesion: npt.ArrayLike = 0.0,
    ties: Sequence[Tie] = (),
    contact_model: ContactModel = "corners",
    compressive_strength: npt.ArrayLike | None = None,
    crushing_parts: int = PARTS,
) -> tuple[Equilibrium, Strength, JointParts | None]:
    """Return the equilibrium of an assemblage, the strength of its points, and the parts of its joints where any may crush.

    Arguments and errors as in `limit_analysis`.
    """
    one_of("limit_analysis: contact_model", contact_model, *get_args(ContactModel))
    endless = np.inf if compressive_strength is None else compressive_strength
    endurance = of_interfaces("compressive_strength", endless, contacts, endless=True)
    pressed, parts = np.zeros_like(endurance, dtype=np.bool_), None
    if compressive_strength is not None:
        pressed = parallelograms(joint_polygons(contacts), contacts.area) & np.isfinite(endurance)
        divided = np.isfinite(endurance) & ~pressed
        parts = joint_parts(contacts, crushing_parts, divided, partial(covered, stones, contacts))
    balance = equilibrium(stones, contacts, load, contact_model, parts)
    strength = point_strength(contacts, friction, cohesion, balance.force, compressive_strength, parts)
    balance, strength = with_ties(balance, strength, stones, listed("limit_analysis: ties", ties, Tie))
    if parts is not None:
        capacity = endurance[pressed] * contacts.area[pressed] / balance.force
        balance, strength = with_pressed(balance, strength, parts.contacts.point_ptr[:-1][pressed], capacity)
    return balance, strength, parts


def analysed(
    balance: Equilibrium,
    strength: Strength,
    solve: Solve,
    flow: Flow,
    options: SlidingOptions,
    progress: Progress | None,
    *,
    stands: bool = False,
    names: NameArray | None = None,
) -> LimitState:
    """Return the limit state with this flow, the dead load first; stands: whether that is known to be carried.

    names (nf,): of the free stones, for what is said of them.
    """
    begin = perf_counter()
    if not stands:
        standing, dead_answer = dead_load_analysis(balance, strength, _reporting(solve, "dead load", progress))
        if standing != "stable":
            return fallen_state(balance, standing, dead_answer, flow, perf_counter() - begin)
    state = associative_state(balance, strength, _reporting(solve, "associative", progress), begin)
    if flow == "associative":
        return state
    if state.status == "unbounded":
        # Friction that dilates may wedge stones which slide past each other without dilatancy; geometry alone holds both.
        ray = wedge(balance, replace(strength, friction=np.zeros_like(strength.friction)), solve)
        if ray is not None:
            return unbounded_state(balance, ray, perf_counter() - begin, flow)
        found = sliding_analysis(balance, strength, state, options, solve, progress, names)
        left = balance.dead + found.load_factor * balance.live
        # A load along gravity that is taken away below zero, with all weight, leaves stones that nothing moves: no collapse.
        weightless = found.load_factor < 0 and bool(np.abs(left).max() < _WEIGHTLESS * np.abs(balance.dead).max())
        if found.status == "converged" and not weightless:
            return found
        # The load factor at which the search gave up, even one below zero, says nothing.
        ended = f"the search ended at {found.load_factor:.3g}, where no load is left" if weightless else found.message
        status = "not-converged" if weightless else found.status
        unknown = replace(found, load_factor=np.nan, interval=(np.nan, np.nan), status=status)
        return replace(unknown, message=f"{WEDGED}; {ended}")
    if state.status != "optimal":
        return replace(state, flow=flow)
    return sliding_analysis(balance, strength, state, options, solve, progress, names)


def _advice(state: LimitState) -> str:
    """Return what a person can do with a load factor without dilatancy that is not certified."""
    least = float(np.nanmin([state.load_factor, state.interval[0]]))
    return (
        f"so no load factor is certified: take no more than {least:.4f}, the least found whose forces fit this motion as nearly; "
        "a somewhat smaller friction, with which the load factor is smaller as a rule, may have one that is certified"
    )


def _reporting(solve: Solve, what: str, progress: Progress | None) -> Solve:
    """Return a solver that says what is solved, and which share of it is done."""
    return partial(solve, progress=partial(progress, what)) if progress else solve


def _about_pressure(
    balance: Equilibrium,
    strength: Strength,
    state: LimitState,
    shift_of: Callable[[FloatArray, FloatArray], FloatArray],
    options: SlidingOptions,
    solver: str,
    progress: Progress | None,
) -> LimitState:
    """Return the state without dilatancy in which friction acts about the centres of pressure of that very state.

    shift_of: `torsion.shift_about_pressure` of these joints, whose shifts are in m. From a state to the friction that fits its
    pressure, and from there to the next state, until the load factor comes to rest, or at the end each of the last two lies
    within the interval of the other: no load factor without dilatancy is known better than that.
    """
    change = np.inf
    # The run from the centre needs no start; a search goes on from the state before.
    starts: tuple[Start, ...] = ("centre",) if options.starts == ("centre",) else ("associative",)
    for count in range(1, _ROUNDS + 1):
        shift = balance.wrenches.shift.copy()
        here = slice(0, balance.contacts)
        wanted = shift_of(np.maximum(state.forces[:, 0], 0.0), shift[here] * balance.length) / balance.length
        shift[here] += (_SHARE if count > _WHOLE_WAY and starts == ("centre",) else 1.0) * (wanted - shift[here])
        balance = replace(balance, wrenches=replace(balance.wrenches, shift=shift))
        solve = solver_for(balance.balance, solver)
        associative = associative_state(balance, strength, solve, perf_counter())
        if associative.status != "optimal":
            break
        start = replace(associative, forces=state.forces, tie_forces=state.tie_forces)
        found = sliding_analysis(balance, strength, start, replace(options, starts=starts), solve, progress)
        if not np.isfinite(found.load_factor):
            break
        change = abs(found.load_factor - state.load_factor) / max(abs(found.load_factor), 1e-3)
        alike = state.interval[0] <= found.load_factor <= state.interval[1]
        alike = alike and found.interval[0] <= state.load_factor <= found.interval[1]
        state = found
        if found.status == "converged" and (change <= _AT_REST or (alike and count == _ROUNDS)):
            rounds = (
                f"{counted(count, 'round')} of friction about the centres of pressure, the last of which changed the load factor"
            )
            return replace(found, message=f"{found.message}; {rounds} by {_per_cent(change)}")
    last = f": the load factor still changed by {_per_cent(change)}" if np.isfinite(change) else ""
    return replace(state, status="not-converged", message=f"the centres of pressure did not come to rest{last}; {state.message}")


def _per_cent(share: float) -> str:
    return f"{100 * share:.1g} %" if share >= 1e-4 else "less than 0.01 %"


def point_strength(
    contacts: Contacts,
    friction: npt.ArrayLike,
    cohesion: npt.ArrayLike,
    force: float,
    compressive_strength: npt.ArrayLike | None = None,
    parts: JointParts | None = None,
) -> Strength:
    """Return the strength of each contact point, in units of a force (N), from that of each interface.

    A point stands for an equal share of its interface's area, or for a part of it: for its cohesion (Pa), and for its
    compressive strength (Pa).
    """
    mu, c = (of_interfaces(name, value, contacts) for name, value in (("friction", friction), ("cohesion", cohesion)))
    if np.ndim(cohesion) == 0:
        c = np.where(contacts.kind == "butt", 0.0, c)
    if parts is None:
        interface = contacts.interface_of_point
        area = (contacts.area / np.maximum(contacts.points_per_interface, 1))[interface]
    else:
        interface, area = parts.contacts.interface_of_point, parts.area
    bound = np.full(len(area), np.inf)
    if compressive_strength is not None and parts is not None:
        f = of_interfaces("compressive_strength", compressive_strength, contacts, endless=True)
        bound[parts.divided] = (f[interface] * area / force)[parts.divided]
    return Strength(friction=mu[interface], cohesion=c[interface] * area / force, bound=bound)


def of_interfaces(name: str, value: npt.ArrayLike, contacts: Contacts, *, endless: bool = False) -> FloatArray:
    """Return a value of each interface (ni,); endless: it may be infinite, but not zero.

    Raises
    ------
    InputError: no number, nor one an interface; one out of range.
    """
    array = array_of(name, value, "iuf", "numbers").astype(np.float64)
    if array.ndim > 1 or (array.ndim == 1 and array.shape != contacts.area.shape):
        raise InputError(name, "wrong shape", found=array.shape, expected=f"a number or ({len(contacts.area)},)")
    good = array > 0 if endless else np.isfinite(array) & (array >= 0)
    if not good.all():
        expected = "numbers > 0, infinite where nothing crushes" if endless else "finite numbers >= 0"
        raise InputError(name, "out of range", found=float(array[~good].flat[0]), expected=expected)
    return np.broadcast_to(array, contacts.area.shape)
