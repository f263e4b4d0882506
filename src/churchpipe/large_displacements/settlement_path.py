"""A support that moves on and on: the reaction that is left, the cracks, and how far it may go."""

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from typing import cast

import numpy as np
import numpy.typing as npt

from churchpipe.geometry.clusters import components
from churchpipe.large_displacements.control import SupportTravel
from churchpipe.large_displacements.following import Ending, follow
from churchpipe.large_displacements.halo import held_around
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path import PathStep
from churchpipe.large_displacements.path_arguments import check_path
from churchpipe.large_displacements.path_state import first_state
from churchpipe.large_displacements.record import Record
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.settlement import resistance, settlement_analysis, settlement_model
from churchpipe.large_displacements.supports import SupportMovement
from churchpipe.mechanism import reference_speed, stone_of_point, stone_speed
from churchpipe.model.arguments import check_call, check_kind
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.digests import digests
from churchpipe.model.doubts import doubt, doubt_argument
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import ContactModel
from churchpipe.model.progress import Progress
from churchpipe.model.settlement import SettlementEnding, SettlementPath, SettlementState
from churchpipe.model.stone_path import HALO, no_step
from churchpipe.stones.footing import WHOLE_GROUND, stands_on


def settlement_path(
    stones: Assemblage,
    contacts: Contacts,
    support: npt.ArrayLike,
    direction: npt.ArrayLike = (0, 0, -1),
    friction: npt.ArrayLike = 0.6,
    *,
    about: npt.ArrayLike | None = None,
    dead: LoadCase | npt.ArrayLike | None = None,
    contact_model: ContactModel = "corners",
    compressive_strength: npt.ArrayLike | None = None,
    step: float | None = None,
    steps: int = 400,
    furthest: float | None = None,
    halo: int = HALO,
    solver: str = "auto",
    progress: Progress | None = None,
    resume: SettlementPath | None = None,
    keep: Callable[[SettlementPath], None] | None = None,
) -> SettlementPath:
    """Return what a structure does while a support moves on, until it collapses or the support leaves it.

    As in `settlement_analysis`, but the movement goes on: each step finds the least reaction in the geometry as displaced,
    without dilatancy, and moves support and stones with exact rotations; contacts are found anew.

    Parameters
    ----------
    stones, contacts, support, direction, friction, about, dead, contact_model, compressive_strength, solver
        As in `settlement_analysis`.
    step
        Largest displacement of a step, m; None: a tenth of the median thickness of the stones.
    halo
        Contacts from a moving stone to those held still, as in `block_pushover`; 0: no stone is held.
    steps
        Where to stop, after so many steps.
    furthest
        Where to stop, at a movement so large, m, or rad of one about an axis.
    progress
        Called with a text and the share done.
    resume
        A path of these stones and this support, or its first steps (`SettlementPath.until`), to go on from its last step.
    keep
        Called with the path so far after each step.

    Returns
    -------
    SettlementPath
        Status "unstable", "unbounded" or "failed", with no steps, where the support cannot be moved.

    Raises
    ------
    InputError
        Arguments out of range, a support that is not there, not fixed or bears nothing.
    """
    begin = perf_counter()
    for name, given, kind in (("stones", stones, Assemblage), ("contacts", contacts, Contacts)):
        check_kind(f"settlement_path: {name}", given, kind)
    doubt_argument("settlement_path: friction", friction, JointStrength, "friction")
    doubt_argument("settlement_path: compressive_strength", compressive_strength, JointStrength, "compressive_strength")
    halo = check_path("settlement_path", stones, step, steps, furthest, halo)
    for name, call in (("progress", progress), ("keep", keep)):
        check_call(f"settlement_path: {name}", call)
    if resume is not None:
        check_kind("settlement_path: resume", resume, SettlementPath)
    least = settlement_analysis(
        stones,
        contacts,
        support,
        direction,
        friction,
        about=about,
        dead=dead,
        contact_model=contact_model,
        compressive_strength=compressive_strength,
        solver=solver,
    )
    if least.status not in ("optimal", "not-converged"):
        return _nothing(stones, least, perf_counter() - begin)
    model, *_ = settlement_model(
        stones, contacts, (support, direction, about), friction, dead, step, solver, contact_model, compressive_strength
    )
    if about is None:
        chosen = np.atleast_1d(np.asarray(support, dtype=np.int64))
        doubt([WHOLE_GROUND.format("The support")] if stands_on(stones, contacts, chosen) else ())
    speed = stone_speed(stones, least.velocities)
    # Where nothing follows the support as it begins to move, what will move later is not known: no stone is held, and all count.
    if not _stand_still(model, speed):
        moving = (speed > PATH.still * reference_speed(speed)) | _upon(contacts, np.atleast_1d(support), stones.count)
        # What falls must be light beside what follows the support. Beside a whole building, all that follows it would be.
        model = replace(model, moving=float(stones.weight[moving & ~stones.fixed].sum()))
        if halo:
            model = replace(model, held=held_around(stones, contacts.blocks, moving, halo))
    record = _Movement(model, furthest, int(steps), progress, keep, least.reaction)
    moves = [np.sort(np.atleast_1d(support)), direction, about]
    dead = dead.dead if isinstance(dead, LoadCase) else dead
    record.given = digests(
        movement=moves, dead_load=dead, friction=friction, strength=compressive_strength, contact_model=contact_model
    )
    start = first_state(model)
    if resume is not None and len(resume.position):
        start = record.go_on_from(resume, resume.movement, -resume.reaction / model.force, halo=halo > 0)
        steps -= len(record.poses)
    return record.path(follow(record.model, start, int(steps), record, halo, record.departure), perf_counter() - begin)


def _upon(contacts: Contacts, support: IntArray, count: int) -> BoolArray:
    """Return which stones (nb,) stand on a support (k,)."""
    first, second = (np.isin(side, support) for side in contacts.blocks.T)
    out = np.zeros(count, dtype=bool)
    out[contacts.blocks[first | second]] = True
    return out


def _stand_still(model: MovingModel, speed: FloatArray) -> bool:
    """Return whether all free stones, of these speeds (nb,), stay where they are while the support moves."""
    support = cast(SupportMovement, model.driven).stones
    return float(speed[~model.stones.fixed].max(initial=0.0)) < PATH.left_behind * float(speed[support].max())


class _Movement(Record):
    """The steps of a movement; least: the least reaction as drawn, N."""

    where = "settlement_path"

    def __init__(
        self,
        model: MovingModel,
        furthest: float | None,
        steps: int,
        progress: Progress | None,
        keep: Callable[[SettlementPath], None] | None,
        least: float,
    ) -> None:
        super().__init__(model, SupportTravel(cast(SupportMovement, model.driven)))
        self.furthest, self.steps, self.progress, self.keep, self.least = furthest, steps, progress, keep, least
        self.parted_at = np.inf

    @property
    def left(self) -> float:
        """How far the support may still go: its movement is the work of a unit force."""
        return np.inf if self.furthest is None else self.furthest - self.displacement[-1]

    def reached(self) -> Ending | None:
        """Return that the support has gone far enough."""
        if self.furthest is not None and self.displacement[-1] >= self.furthest * (1 - 1e-9):
            unit = "m" if cast(SupportMovement, self.model.driven).about is None else "rad"
            return Ending("unfinished", f"the largest movement asked for, {self.furthest:g} {unit}, was reached")
        return None

    def add(self, step: PathStep) -> Ending | None:
        """Take down a step; it ends the path when the support has gone far enough, or nothing rests on it any more."""
        self.note(step)
        if (ending := self.reached()) is not None:
            return ending
        # What leans on an edge about which its support turns resists no turn, and rests on it all the same.
        upon = np.isin(step.state.joints.pair, cast(SupportMovement, self.model.driven).stones).any(axis=1)
        pressed = float(step.answer.forces[: len(step.rate), 0][upon].sum())
        if max(-step.answer.load_factor, pressed) < PATH.nothing and _stand_still(self.model, step.speed):
            return Ending("free", "nothing rests on the support any more: the structure stands without it")
        apart = self._apart(step)
        self.parted_at = min(self.parted_at, self.displacement[-1]) if apart else np.inf
        if self.displacement[-1] - self.parted_at > apart:
            return Ending("parted", "what rests on the support has parted from the structure, which stands without it")
        if self.keep:
            self.keep(self.path(Ending("unfinished", "interrupted"), 0.0))
        if self.progress:
            share = self.displacement[-1] / self.furthest if self.furthest else len(self.displacement) / self.steps
            self.progress("movement of a support", min(share, 1.0))
        return None

    def _apart(self, step: PathStep) -> float:
        """Return how long what rests on the support is along its movement, m, if it presses on nothing else; 0 if it does.

        Once it has gone so far, it can meet nothing that was beside it. What turns may.
        """
        driven, joints = cast(SupportMovement, self.model.driven), step.state.joints
        pressed = joints.pair[step.answer.forces[: len(step.rate), 0] > PATH.nothing]
        part = components(self.model.stones.count, pressed)
        own = np.isin(part, part[driven.stones])
        own[driven.stones] = False
        if driven.about is not None or not own.any() or self.model.stones.fixed[own].any():
            return 0.0
        along = self.model.stones.points[own[stone_of_point(self.model.stones)]] @ driven.direction
        return float(np.ptp(along))

    def drops(self, step: PathStep, /) -> bool:
        """True where the structure falls on the way to a step."""
        return bool(step.falling.any())

    def path(self, ending: Ending, seconds: float) -> SettlementPath:
        """Return the path."""
        return SettlementPath(
            movement=np.array(self.displacement),
            reaction=resistance(np.array(self.load_factor)) * self.model.force,
            **self.arrays(),
            least=self.least,
            status=cast(SettlementEnding, ending.status),
            fallen=tuple(self.fallen),
            message="; ".join([*filter(None, [ending.message, self.resumed]), *self.jumps()]),
            seconds=seconds,
        )


def _nothing(stones: Assemblage, state: SettlementState, seconds: float) -> SettlementPath:
    none = np.zeros(0)
    return SettlementPath(
        movement=none,
        reaction=none,
        **no_step(stones.count),
        least=np.nan,
        status=cast(SettlementEnding, state.status),
        message=state.message,
        seconds=seconds,
    )
