"""The way of the stones, step by step: what the capacity curve and a support that moves have in common."""

from dataclasses import dataclass, field, fields, replace
from typing import Any, Self, TypedDict

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, listed, whole
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, ReadOnly, flags, floats, indices, rows_of, store
from churchpipe.model.assemblage import Assemblage

# A path is proved when forces balance and keep to their friction cones to the first, and motions fit forces to the second.
_EXACT, FITS = 1e-8, 1e-2
# A step that misses more is no equilibrium at all.
CREDIBLE = 0.1
# Contacts from a stone that moves to those that are held.
HALO = 5
# A path begins where its stones are, to this share of their size: what a file of coordinates rounds away.
_SAME = 1e-6


@dataclass(frozen=True, slots=True)
class FallenStones(ReadOnly):
    """Stones that nothing held any more and that were taken out: which, the displacement or movement at that moment, and the last
    step that has them, from 0. The displacement does not tell the step: a control point may stand still, or go to and fro."""

    displacement: float
    stones: IntArray
    step: int

    def __post_init__(self) -> None:
        store(self, stones=indices("FallenStones.stones", self.stones, (None,)))
        store(self, step=whole("FallenStones.step", self.step, least=0))


@dataclass(frozen=True, slots=True)
class LastStep(ReadOnly):
    """Forces and motion of the last step of a path, with which it goes on as if it had not been interrupted.

    pair (k, 2): the stones of each point of contact; point (k, 3) m: where it lies, displaced. pressing (k,) and shear (k, 3), in
    the axes of the drawing: its force over the weight; sliding (k,): its rate of sliding times the friction, per unit of work.
    before (nb, 6): velocities of the step before at the origin, no rows where there was none; way: how far it went, and length:
    what steps charge their gaps for, m per unit of work; fastest: the speed by which falls are measured (`falling.usual_speed`).
    velocity (nb, 6): of the step itself, onward: how far it goes, and power: what friction takes, N m per unit of work. held
    (nb,): stones that were held still in it. Empty where nothing is known.
    """

    pair: IntArray = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    point: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    pressing: FloatArray = field(default_factory=lambda: np.zeros(0))
    shear: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    sliding: FloatArray = field(default_factory=lambda: np.zeros(0))
    before: FloatArray = field(default_factory=lambda: np.zeros((0, 6)))
    way: float = 0.0
    length: float = 0.0
    fastest: float = np.inf
    velocity: FloatArray = field(default_factory=lambda: np.zeros((0, 6)))
    onward: float = 0.0
    power: float = 0.0
    held: BoolArray = field(default_factory=lambda: np.zeros(0, dtype=bool))

    def __post_init__(self) -> None:
        count = rows_of("LastStep.pair", self.pair)
        store(self, pair=indices("LastStep.pair", self.pair, (count, 2)))
        for name, shape in (("point", (count, 3)), ("pressing", (count,)), ("shear", (count, 3)), ("sliding", (count,))):
            store(self, **{name: floats(f"LastStep.{name}", getattr(self, name), shape)})
        for name in ("before", "velocity"):
            store(self, **{name: floats(f"LastStep.{name}", getattr(self, name), (None, 6))})
        store(self, held=flags("LastStep.held", self.held, (None,)))


@dataclass(frozen=True, slots=True, kw_only=True)
class StonePath(ReadOnly):
    """Where stones are at each step of a path, and what proves that they may be there.

    position (ns, nb, 3) m, the centroids; rotation (ns, nb, 3) rad, rotation vectors from the drawing. largest (ns,) m, the
    largest displacement of a centroid. dissipation (ns,) J: work of friction, and of ties that yield, on the way there.
    residual, violation (ns,): of the balance and of the friction cones, over the weight. misfit (ns,): what the motion of the
    step lacks of one without dilatancy, over the load factor (at least .01): how far the kinematic value of the motion lies above
    the static value of the forces, both in the geometry as displaced (of a step in which the load does little work, over the work
    of the weight at the same speed); and the work that forces would need across gaps, over that of the load, where the step
    leaves them open, or where nothing would be in balance without these forces: in a jump it is one or far more.
    fallen: stones taken out on the way. message: what is to be said. seconds: time it took. last: what the last step leaves
    to the next. given: load, strength and ties that it was made with, each as a digest; empty where they are not known.
    """

    position: FloatArray
    rotation: FloatArray
    largest: FloatArray
    residual: FloatArray
    violation: FloatArray
    misfit: FloatArray
    dissipation: FloatArray
    fallen: tuple[FallenStones, ...] = ()
    message: str = ""
    seconds: float = 0.0
    last: LastStep = field(default_factory=LastStep)
    given: str = ""

    def __post_init__(self) -> None:
        name = type(self).__name__
        steps = rows_of(f"{name}.position", self.position)
        for key in ("largest", "residual", "violation", "misfit", "dissipation"):
            store(self, **{key: floats(f"{name}.{key}", getattr(self, key), (steps,))})
        check_kind(f"{name}.last", self.last, LastStep)
        store(self, fallen=tuple(listed(f"{name}.fallen", self.fallen, FallenStones)))
        for key in ("message", "given"):
            check_kind(f"{name}.{key}", getattr(self, key), str)
        for key in ("position", "rotation"):
            store(self, **{key: floats(f"{name}.{key}", getattr(self, key), (steps, None, 3))})

    @property
    def proved_steps(self) -> int:
        """How many steps from the first one on are proved: forces balance and keep to friction to 1e-8 of the weight, and the
        motion fits to 1 %."""
        good = (self.residual < _EXACT) & (self.violation < _EXACT) & (self.misfit < FITS)
        return len(good) if good.all() else int(np.argmin(good))

    @property
    def proved(self) -> bool:
        """True when all steps are proved."""
        return self.proved_steps == len(self.misfit)

    @property
    def jumps(self) -> BoolArray:
        """Which steps (ns,) are no equilibria: forces would have to act across open gaps, as where the structure jumps."""
        return self.misfit > CREDIBLE

    def check_of(self, where: str, stones: Assemblage, what: str = "a path") -> None:
        """Raise InputError, that of an argument `where`, unless what is given there is a path of these stones."""
        problem, count = f"{what} of other stones", self.position.shape[1]
        if count != stones.count:
            raise InputError(where, problem, found=f"{count} stones", expected=f"{stones.count} stones")
        if not len(self.position):
            return
        apart = np.linalg.norm(self.position[0] - stones.centroid, axis=1)
        far = int(apart.argmax())
        if apart[far] > _SAME * stones.size:
            found = f"{1e3 * apart[far]:.3g} mm from where stone {stones.block_id[far]} is"
            raise InputError(where, problem, found=found, expected=f"{what} of these stones")

    def first_steps(self, step: int) -> Self:
        """Return the path up to a step, that included."""
        step = whole(f"{type(self).__name__}.until: step", step, least=0, most=len(self.position) - 1)
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        kept: dict[str, Any] = {name: value[: step + 1] for name, value in values.items() if isinstance(value, np.ndarray)}
        fallen = tuple(part for part in self.fallen if part.step < step)
        last = self.last if step == len(self.position) - 1 else LastStep()
        return replace(self, **kept, fallen=fallen, last=last, status="unfinished", message=f"up to step {step}")


class StepArrays(TypedDict):
    """The arrays of a `StonePath`, by their names."""

    position: FloatArray
    rotation: FloatArray
    largest: FloatArray
    residual: FloatArray
    violation: FloatArray
    misfit: FloatArray
    dissipation: FloatArray
    last: LastStep
    given: str


def no_step(count: int) -> StepArrays:
    """Return the arrays of a path of `count` stones that has no step."""
    none, nowhere = np.zeros(0), np.zeros((0, count, 3))
    return StepArrays(
        position=nowhere,
        rotation=nowhere,
        largest=none,
        residual=none,
        violation=none,
        misfit=none,
        dissipation=none,
        last=LastStep(),
        given="",
    )
