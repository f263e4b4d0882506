"""Capacity curve of rigid blocks: load factor against displacement until it vanishes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.large_displacements.path import (
    FIRST,
    PROGRAMS,
    MovingModel,
    PathState,
    PathStep,
    first_state,
    may_go_on,
    next_state,
    solve_state,
    without,
)
from churchpipe.large_displacements.poses import Poses, rotation_vectors, start_poses
from churchpipe.large_displacements.renewal import first_joints, pair_friction
from churchpipe.large_displacements.travelling import dead_loads, live_loads
from churchpipe.mechanism import moving_stones, stone_speed
from churchpipe.model.arguments import positive, whole
from churchpipe.model.arrays import BoolArray, FloatArray, floats
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve, CurveStatus, FallenStones
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.results import LimitState
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import limit_analysis

Progress = Callable[[str, float], None]
# The largest displacement of a step, and how far apart points may be that can still come to bear, over the thinnest side of the
# stones that move.
_SHARE, _REACH = 0.1, 0.2


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
    control: point (3,) m of the drawing whose displacement along the load the curve is drawn against; None: the mean
        displacement of the pushed stones, weighed by their load.
    step: m, the largest displacement of a step; None: a tenth of the thinnest side of the stones that move.
    steps, furthest: where to stop, after so many steps or when a stone has gone so far, m.
    progress: called with a text and the share done.

    Returns
    -------
    BlockCapacityCurve: status "unstable", "unbounded" or "failed", with no steps, where there is no first load factor.

    Raises
    ------
    InputError: arguments out of range, stones without a path to a support.
    """
    begin = perf_counter()
    _check(ties, step, steps, furthest)
    state = limit_analysis(stones, contacts, load, friction, solver=solver)
    if state.status != "optimal":
        return _nothing(stones, state, perf_counter() - begin)
    measure = _measure(stones, load, control)
    balance = equilibrium(stones, contacts, load)
    moving = moving_stones(stone_speed(stones, state.velocities)) & ~stones.fixed
    thinnest = _thinnest(stones, moving)
    interface = np.broadcast_to(np.asarray(friction, dtype=np.float64), contacts.area.shape)
    model = MovingModel(
        stones=stones,
        dead=dead_loads(stones, load),
        live=live_loads(stones, load),
        friction=pair_friction(contacts.blocks, interface, stones.count),
        held=np.zeros(stones.count, dtype=bool),
        moving=float(stones.weight[moving].sum()),
        force=balance.force,
        length=balance.length,
        step=_SHARE * thinnest if step is None else step,
        reach=_REACH * thinnest,
        solver=solver,
    )
    poses = start_poses(stones)
    first = first_state(first_joints(contacts, stones, poses, model.reach), poses, model.step)
    record = _Record(model, measure)
    status, message = _follow(model, first, record, steps, furthest, progress)
    return record.curve(status, message, perf_counter() - begin)


def _follow(
    model: MovingModel,
    state: PathState,
    record: "_Record",
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


@dataclass(slots=True)
class _Measure:
    """What the displacement of the curve is: weights (nb, 3) of the centroids' displacements, or a point of one stone."""

    weights: FloatArray
    stone: int = -1
    arm: FloatArray = field(default_factory=lambda: np.zeros(3))
    direction: FloatArray = field(default_factory=lambda: np.zeros(3))

    def between(self, before: Poses, after: Poses, standing: BoolArray) -> float:
        """Return how far the control has gone between poses, m; standing (nb,): stones that have not fallen."""
        if self.stone >= 0:
            one = np.array([self.stone])
            return float(((after.place(one, self.arm[None]) - before.place(one, self.arm[None])) @ self.direction)[0])
        weights = np.where(standing[:, None], self.weights, 0.0)
        total = float(np.linalg.norm(weights, axis=1).sum())
        return float((weights * (after.centroid - before.centroid)).sum()) / total


def _measure(stones: Assemblage, load: LoadCase, control: npt.ArrayLike | None) -> _Measure:
    force = live_loads(stones, load).force
    if control is None:
        if not force.any():
            raise InputError("block_pushover: control", "nothing is pushed by a force", expected="a control point (x, y, z) m")
        return _Measure(force)
    point = floats("block_pushover: control", control, (3,))
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))
    free = np.flatnonzero(~stones.fixed[owner])
    distance = np.linalg.norm(stones.points[free] - point, axis=1)
    low, high = stones.points[free].min(axis=0), stones.points[free].max(axis=0)
    stone = int(owner[free[np.argmin(distance)]])
    if ((point < low - 1e-6) | (point > high + 1e-6)).any():
        raise InputError(
            "block_pushover: control",
            "a point outside the free stones",
            found=point.tolist(),
            expected=f"a point between {low.round(4).tolist()} and {high.round(4).tolist()} m",
        )
    return _Measure(force, stone, point - stones.centroid[stone], load.direction)


class _Record:
    """The steps of a curve as they are taken."""

    def __init__(self, model: MovingModel, measure: _Measure) -> None:
        self.model, self.measure = model, measure
        self.poses: list[Poses] = []
        self.answers: list[PathStep] = []
        self.displacement: list[float] = []
        self.load_factor: list[float] = []
        self.largest: list[float] = []
        self.work: list[float] = []
        self.fallen: list[FallenStones] = []

    def add(self, step: PathStep) -> None:
        """Add a step that was solved."""
        poses, standing = step.state.poses, ~step.state.fallen & ~self.model.stones.fixed
        gone = self.displacement[-1] + self.measure.between(self.poses[-1], poses, standing) if self.poses else 0.0
        done = self.work[-1] + self.answers[-1].friction_work * self.model.force if self.work else 0.0
        self.poses.append(poses)
        self.answers.append(step)
        self.displacement.append(gone)
        self.load_factor.append(step.answer.load_factor)
        away = np.linalg.norm(poses.centroid - self.model.stones.centroid, axis=1)[standing]
        self.largest.append(float(away.max(initial=0.0)))
        self.work.append(done)

    def fall(self, step: PathStep) -> None:
        """Note the stones that fall in a step."""
        at = self.displacement[-1] if self.displacement else 0.0
        self.fallen.append(FallenStones(at, np.flatnonzero(step.lost)))

    def curve(self, status: CurveStatus, message: str, seconds: float) -> BlockCapacityCurve:
        """Return the curve."""
        answers = [step.answer for step in self.answers]
        factor, count = self.load_factor, self.model.stones.count
        d0 = float("nan")
        if status == "vanished":
            d0 = self.displacement[-1]
            if len(factor) > 1:
                share = factor[-2] / (factor[-2] - factor[-1])
                d0 = self.displacement[-2] + share * (self.displacement[-1] - self.displacement[-2])
        return BlockCapacityCurve(
            displacement=np.array(self.displacement),
            load_factor=np.array(factor),
            largest=np.array(self.largest),
            position=np.array([pose.centroid for pose in self.poses]).reshape(-1, count, 3),
            rotation=np.array([rotation_vectors(pose.rotation) for pose in self.poses]).reshape(-1, count, 3),
            residual=np.array([answer.residual for answer in answers]),
            violation=np.array([answer.violation for answer in answers]),
            bound_gap=np.array([answer.bound_gap for answer in answers]),
            gap=np.array([answer.gap for answer in answers]),
            dissipation=np.array(self.work),
            status=status,
            d0=d0,
            fallen=tuple(self.fallen),
            message=message,
            seconds=seconds,
        )


def _check(ties: Sequence[object], step: float | None, steps: int, furthest: float | None) -> None:
    if len(ties):
        raise InputError("block_pushover: ties", "not yet followed at large displacements", found=len(ties), expected="none")
    whole("block_pushover: steps", steps, least=1)
    for name, value in (("step", step), ("furthest", furthest)):
        if value is not None:
            positive(f"block_pushover: {name}", value)


def _thinnest(stones: Assemblage, moving: BoolArray) -> float:
    """Return the median over the moving stones of the least side of their boxes, m."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    return float(np.median((high - low)[moving].min(axis=1)))


def _nothing(stones: Assemblage, state: LimitState, seconds: float) -> BlockCapacityCurve:
    """Return the curve without a step of stones that have no first load factor."""
    none, nowhere = np.zeros(0), np.zeros((0, stones.count, 3))
    status: CurveStatus = "unstable" if state.status == "unstable" else "unbounded" if state.status == "unbounded" else "failed"
    return BlockCapacityCurve(
        none, none, none, nowhere, nowhere, none, none, none, none, none, status, message=state.message, seconds=seconds
    )


__all__ = ["block_pushover"]
