"""Capacity curve of rigid blocks: load factor against displacement until it vanishes."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import cast, get_args

import numpy as np
import numpy.typing as npt

from churchpipe.large_displacements.control import Control, ControlPoint, control_of, control_said, furthest_move
from churchpipe.large_displacements.floating import floating
from churchpipe.large_displacements.following import Ending, follow
from churchpipe.large_displacements.halo import held_at_first
from churchpipe.large_displacements.moving_model import MovingModel, bearing, moving_model
from churchpipe.large_displacements.onset import first_load_factor
from churchpipe.large_displacements.path import PathStep, solve_state
from churchpipe.large_displacements.path_arguments import check_path, strengths_of
from churchpipe.large_displacements.path_state import PathState, first_state
from churchpipe.large_displacements.record import Record, vanished
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.state_program import approached, as_in
from churchpipe.large_displacements.travelling import live_loads
from churchpipe.mechanism import moving_stones, stone_speed
from churchpipe.model.arguments import check_call, check_kind, listed, one_of
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve, CurveStatus, vanishing
from churchpipe.model.contacts import Contacts
from churchpipe.model.digests import digests, load_digest
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import ContactModel
from churchpipe.model.progress import Progress
from churchpipe.model.results import LimitState
from churchpipe.model.stone_path import HALO, no_step
from churchpipe.model.ties import Tie
from churchpipe.rigid_blocks.certificate import Strength, certify
from churchpipe.rigid_blocks.coulomb import CoulombState, admissible, bipotential_gap, dead_load_start
from churchpipe.rigid_blocks.crushing import JointParts
from churchpipe.rigid_blocks.equilibrium import Equilibrium, equilibrium
from churchpipe.rigid_blocks.limit import limit_analysis, limit_program
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP
from churchpipe.rigid_blocks.ties import all_forces

# g / alpha of a state that was certified, with the digits that its file and its units may cost.
_CERTIFIED = 2 * BIPOTENTIAL_GAP


def block_pushover(
    stones: Assemblage,
    contacts: Contacts,
    load: LoadCase,
    friction: npt.ArrayLike = 0.6,
    ties: Sequence[Tie] = (),
    control: npt.ArrayLike | None = None,
    *,
    contact_model: ContactModel = "corners",
    compressive_strength: npt.ArrayLike | None = None,
    step: float | None = None,
    steps: int = 400,
    furthest: float | None = None,
    halo: int = HALO,
    halved: bool = False,
    solver: str = "auto",
    state: LimitState | None = None,
    sliding: LimitState | None = None,
    progress: Progress | None = None,
    resume: BlockCapacityCurve | None = None,
    keep: Callable[[BlockCapacityCurve], None] | None = None,
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
        Each stretches from its pretension by its stiffness, at once where it has none, yields, hangs slack when its ends come
        nearer again, and breaks at its ultimate elongation.
    control
        Point (3,) m of the drawing whose displacement along the load the curve is drawn against; None: the mean displacement
        of the pushed stones, weighed by their load.
    contact_model
        "torsion": friction acts about the centre of the pressure of each joint, as in `limit_analysis` without dilatancy.
    compressive_strength
        Pa, a number or one an interface (ni,), infinite for joints that do not crush; None: none does. Each joint is pressed
        in a part of the rectangle within it, and sinks in where its strength is used up.
    step
        Largest displacement of a step, m; None: a tenth of the median thickness of the stones that move.
    steps
        Where to stop, after so many steps.
    furthest
        Where to stop, when a stone has gone so far, m.
    halo
        Contacts from a moving stone to those held still; more where the first load factor asks for it or the motion spreads.
        0: no stone is held, the full model.
    halved
        Whether steps are half as long, and up to twice as many, to see what a curve owes to its steps (`halved_steps`).
    solver
        As in `limit_analysis`.
    state
        The associative `limit_analysis` of the stones as drawn, from which the curve begins, where it has been made. One that
        does not prove a load factor of these stones, strengths and load is made again, and so is that of joints that crush.
    sliding
        The `limit_analysis` without dilatancy of the stones as drawn, at whose state the curve begins, where it has been made.
        One that is not certified for these stones, strengths and load is made again, and so is that of joints that crush or are
        under torsion. A large model does without one.
    progress
        Called with a text and the share done.
    resume
        A curve of these stones, or its first steps (`BlockCapacityCurve.until`), to go on from its last step.
    keep
        Called with the curve so far after each step.

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
    model_of = (("stones", stones, Assemblage), ("contacts", contacts, Contacts), ("load", load, LoadCase))
    for name, given, kind in (*model_of, ("halved", halved, bool)):
        check_kind(f"block_pushover: {name}", given, kind)
    states = (("state", state, LimitState), ("sliding", sliding, LimitState), ("resume", resume, BlockCapacityCurve))
    halo = check_path("block_pushover", stones, step, steps, furthest, halo)
    for name, call in (("progress", progress), ("keep", keep)):
        check_call(f"block_pushover: {name}", call)
    for name, given, kind in states:
        if given is not None:
            check_kind(f"block_pushover: {name}", given, kind)
    ties = listed("block_pushover: ties", ties, Tie)
    doubt_argument("block_pushover: friction", friction, JointStrength, "friction")
    doubt_argument("block_pushover: compressive_strength", compressive_strength, JointStrength, "compressive_strength")
    one_of("block_pushover: contact_model", contact_model, *get_args(ContactModel))
    programmed = partial(limit_program, load=load, ties=ties, contact_model=contact_model)
    strengths = partial(strengths_of, friction, compressive_strength)
    analysed = partial(limit_analysis, contacts=contacts, **programmed.keywords, **strengths(None), solver=solver)
    found = analysed(stones) if state is None else state
    whole = programmed(stones, contacts, **strengths(None))
    state = analysed(stones) if found is state and not _proves(found, *whole) else found
    if state.status != "optimal":
        return _nothing(stones, state, perf_counter() - begin)
    measure = control_of(stones, load, control)
    speed = stone_speed(stones, state.velocities)
    moving = moving_stones(speed) & ~stones.fixed
    balance = equilibrium(stones, contacts, load)
    driven = live_loads(stones, load)
    model = moving_model(
        stones, contacts, load, driven, friction, balance, moving, step, solver, ties, compressive_strength, contact_model
    )
    if halved:
        model, steps = replace(model, step=0.5 * model.step, turn=0.5 * model.turn), 2 * steps

    def held_program(still: BoolArray) -> tuple[Equilibrium, Strength]:
        # Contacts between stones that stand still would only be dragged along.
        bears = bearing(still, contacts.blocks)
        balance, strength, _ = programmed(replace(stones, fixed=still), contacts.selected(bears), **strengths(bears))
        return balance, strength

    model = replace(model, held=held_at_first(model, contacts.blocks, held_program, state, halo)) if halo else model
    record = _Curve(model, measure, furthest, progress, keep)
    made_with = {"friction": friction, "strength": compressive_strength, "ties": ties, "contact_model": contact_model}
    # A displacement is that of its control: those of two points are not one curve.
    place = None if control is None else np.asarray(control, dtype=float)
    record.given = f"{load_digest(load)} {digests(**made_with, control=place)}"
    if resume is not None and len(resume.position):
        start = record.go_on_from(resume, resume.displacement, resume.load_factor, halo=halo > 0)
        model = record.model
        if model.large and model.plain:
            model = _with_dead_load(model, contacts, balance)
        record.resume_ties(resume)
        steps -= len(record.poses)
    else:
        certified = model.plain and sliding is not None and _certifies(sliding, *whole[:2])
        without_dilatancy = partial(analysed, flow="non-associative")
        model, start = _started(model, contacts, sliding if certified else None, without_dilatancy, whole[:2], state)
        record.onset = first_load_factor(stones, load, ties, analysed, exactly=not model.large)
    return record.curve(follow(model, start, int(steps), record, halo, record.departure), perf_counter() - begin)


def _proves(state: LimitState, balance: Equilibrium, strength: Strength, parts: JointParts | None) -> bool:
    """True where the bounds of an associative state hold for joints of this strength that do not crush."""
    if parts is not None or state.flow != "associative" or state.status != "optimal":
        return False
    if not _is_of(state, balance):
        return False
    x, y = all_forces(balance, state), balance.multipliers(state.velocities)
    return certify(balance, strength, x, state.load_factor, y).holds


def _certifies(state: LimitState, balance: Equilibrium, strength: Strength) -> bool:
    """True where forces and velocities are a collapse state without dilatancy of these joints, which do not crush."""
    if state.flow != "non-associative" or state.status != "converged" or not _is_of(state, balance):
        return False
    y = balance.multipliers(state.velocities)
    if not float(balance.live @ y) > 0:
        return False
    x = all_forces(balance, state)
    found = CoulombState(x, state.load_factor, y, bipotential_gap(balance, strength, x, y))
    return found.relative_gap <= _CERTIFIED and admissible(balance, strength, found)


def _is_of(state: LimitState, balance: Equilibrium) -> bool:
    return (
        len(state.forces) == balance.contacts and len(state.tie_forces) == balance.ties and len(state.velocities) == balance.count
    )


def _started(
    model: MovingModel,
    contacts: Contacts,
    sliding: LimitState | None,
    without_dilatancy: Callable[[Assemblage], LimitState],
    program: tuple[Equilibrium, Strength],
    state: LimitState,
) -> tuple[MovingModel, PathState]:
    """Return the model and the state as drawn, with the sliding of a motion without dilatancy.

    More than one such state fits the same drawing. The model's own programs, which begin from nothing, may end at a load factor
    that is higher by a tenth than that of the analysis without dilatancy: the analysis leads where it is lower by more than
    `PATH.higher`, or where those programs do not fit. sliding: that analysis where it is known.

    In a large model it takes many minutes. Where it is not known, the first step begins as it does there, with the forces of the
    dead load in all stones, which do not depend on which are held, and with forces near them that hardly exceed friction. Loose
    stones are known by the motion of the limit analysis, of this program and state.
    """
    first = first_state(model)
    if model.large:
        y = program[0].multipliers(state.velocities)
        fastest = float(stone_speed(model.stones, state.velocities).max()) / float(program[0].live @ y)
        if sliding is not None:
            model = _pressing(model, contacts, sliding.forces)
            return model, as_in(model, replace(first_state(model), fastest=fastest), sliding.velocities)
        gap = bipotential_gap(*program, all_forces(program[0], state), y) if model.plain else 0.0
        if gap > PATH.started * max(abs(state.load_factor), PATH.least):
            model = _with_dead_load(model, contacts, program[0])
            return model, approached(model, replace(first_state(model), fastest=fastest))
        return model, solve_state(model, replace(first, fastest=fastest), 1, 0).state
    step = solve_state(model, first, PATH.first_programs, 0)
    found = without_dilatancy(model.stones) if sliding is None else sliding
    if found.status not in ("converged", "not-converged") or not found.velocities.any():
        return model, step.state
    fits = step.answer.outcome == "solved" and step.answer.misfit < PATH.started
    if fits and step.answer.load_factor <= found.load_factor + PATH.higher * max(abs(found.load_factor), PATH.least):
        return model, step.state
    return model, as_in(model, first_state(_pressing(model, contacts, found.forces)), found.velocities)


def _pressing(model: MovingModel, contacts: Contacts, forces: FloatArray) -> MovingModel:
    """Return the model whose points press as drawn by the forces (nc, 3) N of an analysis, those of held stones too."""
    bears = bearing(model.stones.fixed, contacts.blocks)
    tangents = contacts.frame[contacts.interface_of_point, 1:]
    shear = np.einsum("kac,ka->kc", tangents, forces[:, 1:])
    of_points = bears[contacts.interface_of_point]
    pressing, shear = (part[of_points] / model.force for part in (np.maximum(forces[:, 0], 0.0), shear))
    return replace(model, drawn=replace(model.drawn, pressing=pressing, shear=shear))


def _with_dead_load(model: MovingModel, contacts: Contacts, balance: Equilibrium) -> MovingModel:
    """Return the model that keeps the forces of the dead load in all stones, for those that are freed on the way."""
    bears = bearing(model.stones.fixed, contacts.blocks)[contacts.interface_of_point]
    return replace(model, drawn=replace(model.drawn, pressing=dead_load_start(balance)[bears]))


class _Curve(Record):
    """The steps of a capacity curve."""

    where = "block_pushover"

    def __init__(
        self,
        model: MovingModel,
        control: Control,
        furthest: float | None,
        progress: Progress | None,
        keep: Callable[[BlockCapacityCurve], None] | None,
    ) -> None:
        super().__init__(model, control)
        self.furthest, self.progress, self.keep = furthest, progress, keep
        self.nothing, self.onset = model.least_factor, np.inf
        self.broken: dict[str, float] = {}
        self.tensions: list[FloatArray] = []

    def reached(self) -> Ending | None:
        """Return how the curve ends: the load factor has vanished, a stone has gone far enough, or what moves floats."""
        if vanished(self.load_factor, self.proofs[-1][-1], self.nothing):
            return Ending("vanished")
        if self.furthest is not None and self.largest[-1] >= self.furthest:
            return Ending("unfinished", f"the largest displacement asked for, {self.furthest:g} m, was reached")
        return None if self.step is None else floating(self.step, self.model.stones.fixed)

    def add(self, step: PathStep) -> Ending | None:
        """Take down a step, and return how the curve ends with it."""
        self.note(step)
        ties, state = self.model.ties, step.state
        if ties.name:
            self.tensions.append(step.answer.forces[len(step.rate) - len(ties.name) : len(step.rate), 0] * self.model.force)
        if len(self.poses) == 1 and self.load_factor[0] > self.onset + PATH.higher * max(self.onset, PATH.least):
            # Its ties are as its motion stretches them: as drawn they have their pretension, and less is borne.
            self.load_factor[0] = self.onset
            self.tensions[0] = np.where(np.isfinite(ties.stiffness), ties.pretension, self.tensions[0])
        for name in np.array(ties.name)[ties.broken(state.rest, state.fallen)]:
            self.broken.setdefault(str(name), self.displacement[-1])
        if (ending := self.reached()) is not None:
            return ending
        if self.keep:
            self.keep(self.curve(Ending("unfinished", "interrupted"), 0.0))
        if self.progress:
            # Of a curve that rises again nothing is undone.
            self.progress("capacity curve", 1.0 - max(min(self.load_factor), 0.0) / self.load_factor[0])
        return None

    def resume_ties(self, curve: BlockCapacityCurve) -> None:
        """Take over the tensions of ties, and note where they broke: pulled beyond what they hold, or torn out with a stone."""
        self.tensions = list(curve.tie_forces[: len(self.poses)])
        ties, rest = self.model.ties, self.model.ties.first_rest
        names, torn = np.array(ties.name), [(part.displacement, np.isin(ties.stone, part.stones)) for part in self.fallen]
        for poses, at in zip(self.poses, self.displacement, strict=True):
            rest = ties.yielded(rest, poses)
            for name in names[np.isinf(rest)]:
                self.broken.setdefault(str(name), at)
        for at, ends in torn:
            for name in names[np.unique(ties.owner[ends])]:
                self.broken[str(name)] = min(at, self.broken.get(str(name), at))

    def fall(self, step: PathStep) -> None:
        """Note the stones that fall in a step, and the ties that they tear out."""
        super().fall(step)
        ties = self.model.ties
        for name in np.array(ties.name)[np.unique(ties.owner[step.falling[ties.stone]])]:
            self.broken.setdefault(str(name), self.fallen[-1].displacement)

    def drops(self, step: PathStep, /) -> bool:
        """True where the load factor drops on the way to a step, or falls by more than it would as along the last step.

        In a large model, whose load factors waver, only a drop tells.
        """
        if step.falling.any() or step.answer.outcome != "solved":
            return False
        # The first step may have begun with more than the load factor as drawn.
        last = self.load_factor[-1] if self.step is None else self.step.answer.load_factor
        lost, first = last - step.answer.load_factor, abs(self.load_factor[0])
        if lost > PATH.drop * first:
            return True
        if self.model.large or len(self.load_factor) < 2:
            return False
        way, before = self.gone(step), self.displacement[-1] - self.displacement[-2]
        if isinstance(self.control, ControlPoint) and not (way > 0.0 and before > 0.0):
            # One that goes back or stands still tells nothing of how far the structure went.
            way, before = (furthest_move(one, other) for one, other in ((self.poses[-1], step.state.poses), self.poses[-2:]))
        slope = max((self.load_factor[-2] - self.load_factor[-1]) / before, 0.0) if before > 0.0 else 0.0
        return lost - slope * max(way, 0.0) > PATH.bend * first

    def curve(self, ending: Ending, seconds: float) -> BlockCapacityCurve:
        """Return the curve."""
        gone, factor = self.displacement, self.load_factor
        lost = [f"tie {name} broke at a displacement of {1e3 * at:.3g} mm" for name, at in self.broken.items()]
        lost += control_said(self.control, gone, self.largest, self.fallen)
        d0 = gone[-1] if ending.status == "collapsed" and factor else float("nan")
        if ending.status == "vanished":
            d0 = vanishing(np.array(gone), np.array(factor))
        return BlockCapacityCurve(
            displacement=np.array(gone),
            load_factor=np.array(factor),
            tie_forces=np.array(self.tensions).reshape(len(self.tensions), -1 if self.tensions else 0),
            **self.arrays(),
            status=cast(CurveStatus, ending.status),
            d0=d0,
            fallen=tuple(self.fallen),
            message="; ".join([*filter(None, [ending.message, self.resumed]), *self.jumps(), *lost]),
            seconds=seconds,
        )


def _nothing(stones: Assemblage, state: LimitState, seconds: float) -> BlockCapacityCurve:
    """Return the curve without a step of stones that have no first load factor."""
    none = np.zeros(0)
    status: CurveStatus = "unstable" if state.status == "unstable" else "unbounded" if state.status == "unbounded" else "failed"
    return BlockCapacityCurve(
        displacement=none, load_factor=none, **no_step(stones.count), status=status, message=state.message, seconds=seconds
    )
