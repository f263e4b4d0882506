"""Capacity curve of rigid blocks: load factor against displacement until it vanishes."""

from collections.abc import Callable, Sequence
from time import perf_counter

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.large_displacements.control import control_of
from churchpipe.large_displacements.path import (
    FIRST,
    PROGRAMS,
    MovingModel,
    PathState,
    first_state,
    may_go_on,
    next_state,
    solve_state,
    without,
)
from churchpipe.large_displacements.poses import start_poses
from churchpipe.large_displacements.record import Record
from churchpipe.large_displacements.renewal import first_joints, pair_friction
from churchpipe.large_displacements.sizes import REACH, STEP, thinnest
from churchpipe.large_displacements.travelling import dead_loads, live_loads
from churchpipe.mechanism import moving_stones, stone_speed
from churchpipe.model.arguments import check_kind, positive, whole
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve, CurveStatus
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import limit_analysis

Progress = Callable[[str, float], None]


def block_pushover(
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    friction: npt.ArrayLike = 0.6,
    ties: Sequence[object] = (),
    control: npt.ArrayLike | None = None,
    *,
    step: float | None = None,
    steps: int = 400,
    furthest: float | None = None,
    solver: str = "auto",
    progress: Progress | None = None,
) -> BlockCapacityCurve:
    """Return the load factor of an assemblage against its displacement, until it vanishes.

    Each step solves the limit analysis in the geometry as displaced, with the gaps of the contacts and without dilatancy, moves
    the stones by its mechanism with exact rotations, and finds the contacts anew. Load factor as in `limit_analysis`.

    Parameters
    ----------
    stones
        The assemblage.
    contacts
        Its joints, from `find_contacts`.
    load
        What pushes.
    friction
        Coefficient, a number or one an interface (ni,).
    ties
        Ties; none can be given as yet.
    control
        Point (3,) m of the drawing whose displacement along the load the curve is drawn against; None: the mean displacement
        of the pushed stones, weighed by their load.
    step
        Largest displacement of a step, m; None: a tenth of the thinnest side of the stones that move.
    steps
        Where to stop, after so many steps.
    furthest
        Where to stop, when a stone has gone so far, m.
    solver
        As in `limit_analysis`.
    progress
        Called with a text and the share done.

    Returns
    -------
    BlockCapacityCurve
        Status "unstable", "unbounded" or "failed", with no steps, where there is no first load factor.

    Raises
    ------
    InputError
        Arguments out of range, stones without a path to a support.
    """
    begin = perf_counter()
    _check(ties, step, steps, furthest)
    state = limit_analysis(stones, contacts, load, friction, solver=solver)
    if state.status != "optimal":
        return _nothing(stones, state, perf_counter() - begin)
    measure = control_of(stones, load, control)
    balance = equilibrium(stones, contacts, load)
    moving = moving_stones(stone_speed(stones, state.velocities)) & ~stones.fixed
    size = thinnest(stones, moving)
    interface = np.broadcast_to(np.asarray(friction, dtype=np.float64), contacts.area.shape)
    model = MovingModel(
        stones=stones,
        dead=dead_loads(stones, load),
        driven=live_loads(stones, load),
        friction=pair_friction(contacts.blocks, interface, stones.count),
        held=np.zeros(stones.count, dtype=bool),
        moving=float(stones.weight[moving].sum()),
        force=balance.force,
        length=balance.length,
        step=STEP * size if step is None else step,
        reach=REACH * size,
        solver=solver,
    )
    poses = start_poses(stones)
    first = first_state(first_joints(contacts, stones, poses, model.reach), poses, model.step)
    record = Record(model, measure)
    status, message = _follow(model, first, record, int(steps), furthest, progress)
    return record.curve(status, message, perf_counter() - begin)


def _follow(
    model: MovingModel,
    state: PathState,
    record: Record,
    steps: int,
    furthest: float | None,
    progress: Progress | None,
) -> tuple[CurveStatus, str]:
    """Take step after step and record them; return how it ended."""
    for number in range(steps):
        taken = solve_state(model, state, PROGRAMS if number else FIRST)
        while taken.lost.any():
            if not may_go_on(model, taken):
                return "collapsed", f"{int(taken.lost.sum())} stones that cannot be spared fall"
            record.fall(taken)
            state = without(model, taken)
            taken = solve_state(model, state, PROGRAMS)
        if taken.answer.outcome == "unbounded":
            return "unbounded", "the stones have locked: no load of this kind moves them on"
        if taken.answer.outcome != "solved":
            return "not-converged", f"the program of a step was not solved: {taken.answer.message}"
        record.add(taken)
        if taken.answer.load_factor <= 0:
            return "vanished", ""
        if furthest is not None and record.largest[-1] >= furthest:
            return "unfinished", f"the largest displacement asked for, {furthest:g} m, was reached"
        if progress:
            progress("capacity curve", 1.0 - taken.answer.load_factor / record.load_factor[0])
        state = next_state(model, taken)
    return "unfinished", f"all {steps} steps were used up"


def _check(ties: Sequence[object], step: float | None, steps: int, furthest: float | None) -> None:
    check_kind("block_pushover: ties", ties, Sequence)
    if len(ties):
        raise InputError("block_pushover: ties", "not yet followed at large displacements", found=len(ties), expected="none")
    whole("block_pushover: steps", steps, least=1)
    for name, value in (("step", step), ("furthest", furthest)):
        if value is not None:
            positive(f"block_pushover: {name}", value)


def _nothing(stones: Assemblage, state: LimitState, seconds: float) -> BlockCapacityCurve:
    """Return the curve without a step of stones that have no first load factor."""
    none, nowhere = np.zeros(0), np.zeros((0, stones.count, 3))
    status: CurveStatus = "unstable" if state.status == "unstable" else "unbounded" if state.status == "unbounded" else "failed"
    return BlockCapacityCurve(
        none, none, none, nowhere, nowhere, none, none, none, none, none, status, message=state.message, seconds=seconds
    )
