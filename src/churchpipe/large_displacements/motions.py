"""What is asked of a motion of displaced stones: how long it may last, and which of them fall in it."""

from dataclasses import dataclass

import numpy as np

from churchpipe.geometry.clusters import components
from churchpipe.large_displacements.falling import stones_ahead
from churchpipe.large_displacements.moving_model import MovingModel
from churchpipe.large_displacements.path_state import PathState
from churchpipe.large_displacements.settings import PATH
from churchpipe.large_displacements.state_program import velocities_of
from churchpipe.large_displacements.step import StepAnswer
from churchpipe.large_displacements.travelling import TravellingLoads
from churchpipe.mechanism import reference_speed, stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage


@dataclass(frozen=True, slots=True)
class Motions:
    """The motions of a state, by the multipliers y (m,) of its program; stones: where they are, free: those that may move."""

    model: MovingModel
    state: PathState
    stones: Assemblage
    free: IntArray

    def velocities(self, y: FloatArray) -> FloatArray:
        """Return the velocities (nb, 6) of all stones."""
        return velocities_of(self.model, self.state, self.free, y)

    def mean_speed(self, y: FloatArray) -> float:
        """Return the speed of the weight in the mean, over that at which the load does its work."""
        return float(np.linalg.norm(self.velocities(y)[:, :3], axis=1) @ self.model.stones.weight) / self.model.force

    def longest(self, y: FloatArray) -> float:
        """Return the length of the step, m per unit of work, in which stones go and turn no further than they may.

        In a large model the turn that stands for the mechanism counts: a single stone that spins does not hold up all others.
        """
        velocity = self.velocities(y)
        speed, turn = stone_speed(self.stones, velocity), np.linalg.norm(velocity[:, 3:], axis=1)
        steepest = reference_speed(turn) if self.model.large else float(turn.max(initial=0.0))
        return min(self.model.step / max(reference_speed(speed), 1e-300), self.model.turn / max(steepest, 1e-300))

    def falls(self, y: FloatArray, misfit: float, rests: bool) -> bool:
        """True where a few stones fall; rests: in a motion that does not come to fit better than this.

        Of a fall no more is needed than which stones take part.
        """
        if misfit > PATH.credible * max(1.0, self.mean_speed(y)):
            return False
        return bool(self._ahead(y, rests).any())

    def falling(self, answer: StepAnswer, *, rests: bool = False) -> BoolArray:
        """Return which stones (nb,) fall: those of an infeasible program, or a few of a motion, see `falls`."""
        if answer.outcome == "infeasible":
            speed = stone_speed(self.stones, self.velocities(answer.y))
            # A support that moves goes with what falls in such a motion, but it is driven and cannot be lost.
            return self._brought_down(answer.y, (speed > PATH.falling * float(speed.max(initial=0.0))) & ~self.model.stones.fixed)
        return self._ahead(answer.y, rests) if answer.outcome == "solved" else np.zeros(self.stones.count, dtype=bool)

    def _brought_down(self, y: FloatArray, moving: BoolArray) -> BoolArray:
        """Return which stones (nb,) of a fall their loads bring down.

        Stones that touch none of the others may take part in the motion that a solver finds, lifted from where they stand:
        without them it is a fall as well. The load factor is the last one known.
        """
        model, rotation = self.model, self.state.poses.rotation
        load = model.dead.rows(rotation, self.free, model.force, model.length)
        links = self.state.joints.pair
        if isinstance(model.driven, TravellingLoads):
            load = load + self.state.load_factor * model.driven.rows(rotation, self.free, model.force, model.length)
            pulls = np.stack([model.ties.stone[:-1], model.ties.stone[1:]], axis=1)
            links = np.concatenate([links, pulls[np.diff(model.ties.owner) == 0]])
        part = components(self.stones.count, links[moving[links].all(axis=1)])
        power = np.bincount(
            part[self.free], (load * y[: len(load)]).reshape(-1, 6).sum(axis=1) * moving[self.free], part.max() + 1
        )
        down = moving & (power > PATH.nothing * float(np.maximum(power, 0.0).sum()))[part]
        return down if down.any() else moving

    def _ahead(self, y: FloatArray, rests: bool) -> BoolArray:
        """Return the few light stones (nb,) that leave all others behind; by less very few, in a motion that does not fit.

        Where all others are faster than before as well, the structure jumps: then the fastest ones may come to rest again. In a
        large model, whose stones waver, that does not tell, and where steps have become tiny they do not come to rest.
        """
        speed, before, weight = stone_speed(self.stones, self.velocities(y)), self.state.fastest, self.model.stones.weight
        ahead = stones_ahead(speed, before, weight, self.spared, PATH.faster)
        if rests:
            ahead |= stones_ahead(speed, before, weight, PATH.few * self.spared, self.model.demands.faster)
        may_rest = not self.model.large and self.state.length > PATH.shortest * self.model.step
        jumps = may_rest and float(speed[~ahead].max(initial=0.0)) > PATH.jump * before
        return ahead & (not jumps)

    @property
    def spared(self) -> float:
        """What may still fall out without ending the curve, N."""
        return expendable(self.model, self.state)


def expendable(model: MovingModel, state: PathState) -> float:
    """Return the weight, N, that may still fall out without ending the curve."""
    return PATH.expendable * model.moving - float(model.stones.weight[state.fallen].sum())


def light(model: MovingModel, state: PathState, falling: BoolArray) -> bool:
    """True where stones (nb,) are so light that they may fall without ending the curve."""
    return float(model.stones.weight[falling].sum()) <= expendable(model, state)
