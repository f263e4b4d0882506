"""Ties that travel with their stones: they stretch, yield, hang slack when their ends come nearer again, and break."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.conic.wrenches import Wrenches
from churchpipe.large_displacements.poses import Poses
from churchpipe.loading.ties import anchors_of
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, pointer_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.ties import Tie
from churchpipe.stones.interfaces import frames


@dataclass(frozen=True, slots=True)
class TravellingTies:
    """Bars (nt,) between points of stones, elastic and plastic, or rigid and plastic where they have no stiffness.

    pointer (nt + 1,): the pulls of each; stone, share (np,): a stone and its share of the tension, negative at the start of the
    bar; arm (np, 3) m from its centroid in the axes of the drawing. strength (nt,) N; ultimate (nt,) m, elongation at which it
    breaks; drawn (nt,) m, length as drawn; stiffness (nt,) N/m, infinite for rigid ones; pretension (nt,) N; name (nt,).
    """

    pointer: IntArray
    stone: IntArray
    share: FloatArray
    arm: FloatArray
    strength: FloatArray
    ultimate: FloatArray
    drawn: FloatArray
    stiffness: FloatArray
    pretension: FloatArray
    name: tuple[str, ...]

    @property
    def owner(self) -> IntArray:
        """The tie of each pull (np,)."""
        return np.repeat(np.arange(len(self.name)), np.diff(self.pointer))

    def spans(self, poses: Poses) -> FloatArray:
        """Return the vectors (nt, 3) m from the start of each tie to its end."""
        out = np.zeros((len(self.name), 3))
        np.add.at(out, self.owner, self.share[:, None] * poses.place(self.stone, self.arm))
        return out

    def lengths(self, poses: Poses) -> FloatArray:
        """Return the distance (nt,) m between the ends."""
        return np.linalg.norm(self.spans(poses), axis=1)

    def wrenches(self, poses: Poses, free: IntArray, length: float) -> Wrenches:
        """Return what the tensions, as normal forces of points, do to the free stones (nf,); moments over length, m.

        The rate of such a point is that at which its tie shortens.
        """
        row_of = np.full(len(poses.centroid), -1, dtype=np.int64)
        row_of[free] = np.arange(len(free))
        moving = row_of[self.stone] >= 0
        order = np.lexsort((row_of[self.stone], self.owner))
        order = order[moving[order]]
        stone = self.stone[order]
        span = self.spans(poses)
        return Wrenches(
            len(free),
            pointer_of(np.bincount(self.owner[order], minlength=len(self.name))),
            row_of[stone],
            (poses.place(stone, self.arm[order]) - poses.centroid[stone]) / length,
            self.share[order],
            frames(-span / np.linalg.norm(span, axis=1, keepdims=True)),
            np.arange(len(self.name)),
            np.zeros((len(self.name), 2)),
        )

    @property
    def first_rest(self) -> FloatArray:
        """Length (nt,) m at which each tie has no tension, as drawn."""
        return self.drawn - self.pretension / self.stiffness

    def yielded(self, rest: FloatArray, poses: Poses) -> FloatArray:
        """Return the lengths (nt,) m without tension after a tie has been as long as at these poses; infinite once it broke."""
        length = self.lengths(poses)
        return np.where(length - self.drawn >= self.ultimate, np.inf, np.maximum(rest, length - self.strength / self.stiffness))

    def broken(self, rest: FloatArray, fallen: BoolArray) -> BoolArray:
        """Return which ties (nt,) have broken, or were torn out with a stone that fell; rest as of `yielded`."""
        torn = np.zeros(len(self.name), dtype=bool)
        torn[self.owner[fallen[self.stone]]] = True
        return torn | np.isinf(rest)

    def tension(self, rest: FloatArray, poses: Poses, broken: BoolArray) -> FloatArray:
        """Return the tension (nt,) N of elastic ties at these poses, NaN of rigid ones, which have any up to their strength."""
        elastic = np.isfinite(self.stiffness)
        stretched = np.where(broken, 0.0, np.maximum(self.lengths(poses) - rest, 0.0))
        pull = np.where(elastic, self.stiffness, 0.0) * stretched
        return np.where(elastic, np.minimum(pull, self.strength), np.where(broken, 0.0, np.nan))


def travelling_ties(stones: Assemblage, ties: Sequence[Tie]) -> TravellingTies:
    """Return ties as drawn.

    Raises
    ------
    InputError: as `anchors_of`.
    """
    ends = [anchors_of(stones, tie) for tie in ties]
    stone = [np.concatenate([first.stone, second.stone]) for first, second in ends]
    none, nowhere = np.zeros(0, dtype=np.int64), np.zeros((0, 3))
    every = np.concatenate([none, *stone])
    point = np.concatenate([nowhere, *(part.point for pair in ends for part in pair)])
    pointer = pointer_of([len(part) for part in stone])
    share = np.concatenate([np.zeros(0), *(part for first, second in ends for part in (-first.share, second.share))])
    spans = np.zeros((len(ties), 3))
    np.add.at(spans, np.repeat(np.arange(len(ties)), np.diff(pointer)), share[:, None] * point)
    return TravellingTies(
        pointer=pointer,
        stone=every,
        share=share,
        arm=point - stones.centroid[every],
        strength=np.array([tie.strength for tie in ties]),
        ultimate=np.array([tie.ultimate for tie in ties]),
        drawn=np.linalg.norm(spans, axis=1),
        stiffness=np.array([np.inf if tie.stiffness is None else tie.stiffness for tie in ties]),
        pretension=np.array([tie.pretension for tie in ties]),
        name=tuple(tie.name for tie in ties),
    )
