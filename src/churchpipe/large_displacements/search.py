"""Forces and motion of a step, sought in programs until they fit each other."""

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from churchpipe.conic.solve import Solve
from churchpipe.large_displacements.settings import PATH, Demands
from churchpipe.large_displacements.step import (
    Fall,
    StepAnswer,
    StepProgram,
    fallen_alone,
    fitting_forces,
    solve_step,
    without_dilatancy,
)
from churchpipe.model.arrays import FloatArray
from churchpipe.rigid_blocks.settings import SchemeSettings


class Attempt(NamedTuple):
    """An answer and the length of the step that it charges the gaps for, m per unit of work.

    blocked: it may go no further. paired: sought in pairs of programs. falls: a few stones fall in it.
    """

    answer: StepAnswer
    length: float
    blocked: bool = False
    paired: bool = False
    falls: bool = False

    def fits(self, misfit: float) -> bool:
        """True where forces and motion fit each other to a share of the load factor."""
        return self.answer.outcome == "solved" and self.answer.misfit <= misfit

    def will_do(self, misfit: float) -> bool:
        """True where it fits so well, or tells which stones fall, which need not be known as well."""
        return self.falls or self.fits(misfit)


class StepSearch:
    """The programs of one step.

    program: of the step, of any length. gap (nc,) m of its points. longest: what a motion y (m,) may last, m per unit of work.
    fall: whether a motion y (m,) with this misfit is that of a few stones that fall. begin: the length of the last step, and most
    the largest displacement of one. demands: what the programs must reach.
    """

    def __init__(
        self,
        program: StepProgram,
        gap: FloatArray,
        solve: Solve,
        longest: Callable[[FloatArray], float],
        fall: Fall,
        begin: float,
        most: float,
        demands: Demands,
    ) -> None:
        self._program, self._gap, self._solve, self._longest, self._fall = program, gap, solve, longest, fall
        self._begin, self._most, self._demands = begin, most, demands
        # As drawn no gap has to close, and a step of any length has the same program.
        self._of_any_length = not ((gap > 0.0) | (program.softness > 0.0)).any()
        self._least = 0.0 if self._of_any_length else max(PATH.least_charge * begin, PATH.snapping * most)

    def within(self, length: float) -> StepProgram:
        """Return the program of a step of this length."""
        return self._program.within(self._gap, self._program.softness, length)

    def way(self, attempt: Attempt) -> float:
        """Return how far a motion goes, m per unit of work: no further than its program charged the gaps for."""
        way = self._may_go(attempt)
        return way if self._of_any_length else min(attempt.length, way)

    def across(self, attempt: Attempt) -> float:
        """Return the work that forces need across the gaps which a motion leaves open, over that of the load.

        Where all gaps wider than `PATH.drift`, those that close on the way as well, need more than `PATH.credible`, it is the
        work across these: nothing would be in balance without such forces.
        """
        whole = self._work_across(attempt, np.where(self._gap > PATH.drift * self._most, self._gap, 0.0)) / self.way(attempt)
        return whole if whole > PATH.credible else self._left_across(attempt)

    def _left_across(self, attempt: Attempt) -> float:
        """Return as `across` the work that a program has not charged, where the motion goes less far than its length.

        A gap g is charged as g / L for a length L, and a motion of a way w < L would have to close it at the rate g / w.
        """
        return self._work_across(attempt, np.maximum(self._gap, 0.0)) * (1.0 / self.way(attempt) - 1.0 / attempt.length)

    def _work_across(self, attempt: Attempt, gap: FloatArray) -> float:
        n = np.where(self._program.softness > 0.0, 0.0, np.maximum(attempt.answer.forces[:, 0], 0.0))
        return float(n @ gap) / max(abs(attempt.answer.load_factor), self._program.least)

    def _may_go(self, attempt: Attempt) -> float:
        longest = self._longest(attempt.answer.y)
        return min(attempt.length, longest) if attempt.blocked else longest

    def next_length(self, attempt: Attempt) -> float:
        """Return the length that the next step should begin with, m per unit of work."""
        near, length = self._next(attempt)
        return attempt.length if (near and not self._of_any_length) or attempt.falls else length

    def _falls(self, answer: StepAnswer, *, rests: bool = False) -> bool:
        return answer.outcome == "solved" and self._fall(answer.y, answer.misfit, rests)

    def _next(self, attempt: Attempt) -> tuple[bool, float]:
        """Return whether the length of an attempt suits its motion, and the one that does."""
        suited = max(self._may_go(attempt), min(self._least, attempt.length))
        right = self._of_any_length or max(suited / attempt.length, attempt.length / suited) < PATH.right
        return attempt.blocked or right, suited

    def _settled(self, further: float) -> Fall:
        """Return what ends pairs of programs: a fall, or a motion that does not fit and may go further, m per unit of work."""

        def settled(y: FloatArray, misfit: float, rests: bool) -> bool:
            return self._fall(y, misfit, rests) or (misfit > self._demands.enough and self._longest(y) > further)

        return settled

    def closing(self, attempt: Attempt, pairs: int) -> Attempt:
        """Return an attempt whose gaps close within the way that it goes, or the one given where a shorter length leads to none.

        Where the structure jumps there is none: without forces across its gaps it would not be in balance at all. None is sought
        for an attempt that is not credible.
        """
        while attempt.fits(PATH.credible) and not attempt.falls:
            left = self._left_across(attempt)
            if left <= self._demands.across:
                break
            shorter = attempt._replace(length=self.way(attempt), blocked=True)
            shorter = self.by_pairs(shorter, pairs) if attempt.paired else self._again(shorter)
            if not shorter.fits(self._demands.enough) or self._left_across(shorter) > 0.5 * left:
                break
            attempt = shorter
        return attempt

    def _again(self, attempt: Attempt) -> Attempt:
        """Return an attempt of the same length in which points slide as they did in the one given."""
        program = self.within(attempt.length)
        answer = solve_step(program, program.slip(attempt.answer.y), self._solve, self._demands.duality_gap)
        return attempt._replace(answer=answer, falls=self._falls(answer))

    def by_pairs(self, attempt: Attempt, pairs: int, solve: Solve | None = None, astray: float = np.inf) -> Attempt:
        """Return an attempt that fits, sought from the forces of another one in so many pairs of programs at the most.

        solve: of these programs, None: as of all others. astray: a misfit of the first pair with which the search is given up.
        """
        demands = replace(self._demands, astray=astray)
        best: Attempt | None = None
        for left in reversed(range(PATH.lengths)):
            settled = self._settled(self._demands.further * attempt.length if left and not self._of_any_length else np.inf)
            program = self.within(attempt.length)
            answer = without_dilatancy(program, attempt.answer, solve or self._solve, demands, pairs, settled)
            attempt = attempt._replace(answer=answer, paired=True)
            attempt = attempt._replace(falls=self._falls(answer, rests=not attempt.fits(demands.enough)))
            if attempt.answer.outcome != "solved" or attempt.falls or attempt.answer.misfit > astray:
                break
            best = attempt if best is None or attempt.answer.misfit < best.answer.misfit else best
            near, length = self._next(attempt)
            fits = attempt.fits(demands.enough)
            # What points may close by within the step keeps stones apart on every shorter way as well. A motion that may go
            # further goes on in the next step.
            if near or (fits and attempt.length / length < demands.shorter):
                break
            attempt = attempt._replace(length=length)
        return best if best and not attempt.will_do(demands.enough) else attempt

    def fitted(self, last: Attempt, pairs: int, solve: Solve | None) -> Attempt:
        """Return an attempt sought in pairs of programs from forces that fit the last motion; solve: as in `by_pairs`."""
        begun = fitting_forces(self.within(last.length), last.answer, solve or self._solve)
        if not np.isfinite(begun.load_factor):
            return last
        return self.by_pairs(last._replace(answer=begun), pairs, solve, self._demands.astray)

    def under_dead_load(self) -> Attempt:
        """Return the attempt in which stones fall that the dead load alone brings down, or one without motion."""
        return Attempt(fallen_alone(self.within(self._begin), self._solve), self._begin)

    def letting_go(self, attempt: Attempt, pairs: int, solve: Solve | None) -> Attempt | None:
        """Return the fall of stones that hang on joints which open, None where the others hold them.

        A motion that misses its forces opens joints that press. These let go, and those that press instead and open in turn,
        until the others do not carry the dead load any more. solve: as in `by_pairs`.
        """
        released = copy(self)
        for _ in range(PATH.lengths):
            if attempt.answer.outcome != "solved" or attempt.fits(PATH.credible):
                return None
            program, answer = released._program, attempt.answer
            opening = np.maximum(self.within(attempt.length).rates(answer.y)[:, 0], 0.0)
            work = np.maximum(answer.forces[:, 0], 0.0) * opening
            gone = work > PATH.let_go * answer.gap
            bound = np.where(gone, 0.0, program.strength.bound)
            released._program = replace(program, strength=replace(program.strength, bound=bound))
            if (fall := released.under_dead_load()).answer.outcome == "infeasible":
                return fall
            forces = np.where(gone[:, None], 0.0, answer.forces)
            attempt = released.fitted(attempt._replace(answer=replace(answer, forces=forces)), pairs, solve)
        return None

    def giving_way(self, load_factor: float, solve: Solve | None) -> Attempt | None:
        """Return the fall of a few stones with which the structure would stand less than a load factor, None where none fall.

        An associative program tells: with these stones it stands no more, however they slide. solve: as in `by_pairs`. What is
        told need not be exact, and where the program is hard to solve the stones are told by the searches that follow.
        """
        still = np.zeros_like(self._gap)
        answer = solve_step(self.within(self._begin), still, solve or self._solve, SchemeSettings().roughest)
        if answer.outcome != "solved" or answer.load_factor >= load_factor or not self._fall(answer.y, 0.0, True):
            return None
        return Attempt(answer, self._begin, falls=True)

    def onward(self, sliding: FloatArray, last: FloatArray, pairs: int, solve: Solve | None) -> Attempt:
        """Return an attempt sought in pairs of programs near the last motion (m,), from the forces of one associative program.

        sliding (nc,) is what that program charges; solve: as in `by_pairs`.
        """
        begun = self.by_programs(sliding, 1, 0, solve)
        if begun.answer.outcome != "solved" or begun.falls:
            return begun
        begun = begun._replace(answer=replace(begun.answer, outcome="failed", y=last))
        return self.by_pairs(begun, pairs, solve, self._demands.astray)

    def by_programs(self, sliding: FloatArray, programs: int, pairs: int, solve: Solve | None = None) -> Attempt:
        """Return an attempt that fits, sought in so many programs at the most: each charges the sliding of the one before.

        sliding (nc,) is that of the first one. Where the programs go round in circles the search goes on by pairs.
        solve: as in `by_pairs`, of the programs before these.
        """
        attempt = Attempt(StepAnswer("failed", np.zeros((0, 3)), np.nan, np.zeros(0)), self._begin)
        before: Attempt | None = None
        count = 0
        while count < programs:
            answer = solve_step(self.within(attempt.length), sliding, solve or self._solve, self._demands.duality_gap)
            attempt = attempt._replace(answer=answer, falls=self._falls(answer))
            if attempt.answer.outcome == "unbounded" and attempt.length > PATH.shortest * self._most:
                # It comes up against a stone within this step: it may go no further than that.
                attempt = attempt._replace(length=0.25 * attempt.length, blocked=True)
                continue
            if attempt.answer.outcome != "solved" or attempt.falls:
                return attempt
            count += 1
            near, length = self._next(attempt)
            if near and attempt.fits(self._demands.fitting):
                return attempt
            if before and pairs and attempt.answer.misfit > max(self._demands.fitting, 0.5 * before.answer.misfit):
                attempt = attempt if attempt.answer.misfit < before.answer.misfit else before
                break
            if count < programs:
                before, sliding = attempt, self.within(attempt.length).slip(attempt.answer.y)
                attempt = attempt._replace(length=length)
        return self.by_pairs(attempt, pairs) if pairs and not attempt.will_do(self._demands.fitting) else attempt
