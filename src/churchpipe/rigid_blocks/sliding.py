"""Non-associative limit analysis: several starts, one headline, and the certificate of each."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from churchpipe.conic.solve import Solve, solver_for
from churchpipe.errors import InputError
from churchpipe.model.arguments import finite, listed
from churchpipe.model.arrays import BoolArray, FloatArray, NameArray
from churchpipe.model.names import Start
from churchpipe.model.progress import Progress
from churchpipe.model.results import Iteration, LimitState, StartRun
from churchpipe.rigid_blocks.central import from_centre, runs_from_centre
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.coulomb import (
    CoulombState,
    admissible,
    bipotential_gap,
    coulomb_state,
    coulomb_step,
    dead_load_start,
    sliding_velocities,
)
from churchpipe.rigid_blocks.equilibrium import Equilibrium
from churchpipe.rigid_blocks.interval import mechanism_ends, towards
from churchpipe.rigid_blocks.iterations import SlidingRun, certified_iteration, paper_iteration
from churchpipe.rigid_blocks.loose import any_load_words, held_fast, loose_stones, loose_words
from churchpipe.rigid_blocks.selection import fits_any_load, led_by, nearly, nearly_words
from churchpipe.rigid_blocks.settings import BIPOTENTIAL_GAP, SEARCH_SPREAD, CentralSettings, SchemeSettings
from churchpipe.rigid_blocks.sliding_state import End, nothing_found, sliding_state
from churchpipe.rigid_blocks.ties import all_forces, with_tensions

Method = Literal["default", "paper"]
_STARTS: dict[Method, tuple[Start, ...]] = {"default": ("centre", "dead-load"), "paper": ("associative",)}
# Nobody waits long for a second opinion: once a state is certified, a search gives up after so many steps without half the gap,
# and near a state that would not lead.
_PATIENCE = 8
# Where the run from the centre cannot begin, or stops short of a state, the search is tried from these.
_OTHERS: tuple[Start, ...] = ("dead-load", "associative")
_LAST: tuple[Start, ...] = ("uniform", "scattered")
# A search leads only where another one, whose forces differ by the first share, is as low. What differs by no more than the
# second share is the same.
_ROUNDING, _SAME = 1e-7, 1e-3
# A run from the centre whose last step moves its load factor by more is led by rounding along the states of its mechanism.
_MOVED = 1e-2
# Factors of the scattered forces, and how often they are drawn at most, until a state is certified.
_SCATTER, _DRAWS = (0.3, 3.0), 3


@dataclass(frozen=True, slots=True)
class SlidingOptions:
    """How sliding without dilatancy is analysed.

    method: "default", a certified state; "paper", the iteration of eq. (3) with n = 0 and n = n_0 before each start. The lowest
    state that was certified leads, or with method "paper" the lowest that settled.
    starts: "centre", one interior-point run that begins at the centre of all cones; the others are the normal forces from which
    a sequence of programs searches: "dead-load" (the least-squares forces of the dead load), "uniform" (their mean at every
    point), "associative" (those of the associative solution), "scattered" (those of the dead load times factors between .3 and
    3, drawn up to three times). None given, the centre and the dead load, with method "paper" the associative forces; where
    neither ends in a state the search is tried from the others. Of several that end in one, `leading` says which is reported;
    a search that leads must end in the same mechanism when it is made again from forces that differ by rounding.
    bipotential_gap: g / alpha at which the analysis stops looking. More than 1e-5 saves time on large models, but only
    1e-5 is called "converged".
    """

    method: Method = "default"
    starts: tuple[Start, ...] = ()
    bipotential_gap: float = BIPOTENTIAL_GAP

    def __post_init__(self) -> None:
        if not isinstance(self.method, str) or self.method not in _STARTS:
            raise InputError("limit_analysis: method", "unknown method", found=repr(self.method), expected='"default" or "paper"')
        for start in listed("limit_analysis: start", self.starts, str):
            if start not in get_args(Start):
                raise InputError(
                    "limit_analysis: start",
                    "unknown start",
                    found=repr(start),
                    expected='"centre", "dead-load", "uniform", "associative" or "scattered", or several',
                )
            if self.method == "paper" and start == "centre":
                raise InputError(
                    "limit_analysis: start",
                    "the paper's iteration starts from forces",
                    found=repr(start),
                    expected='"dead-load", "uniform", "associative" or "scattered", or several',
                )
        if not 0 < finite("limit_analysis: bipotential_gap", self.bipotential_gap) < 1:
            raise InputError(
                "limit_analysis: bipotential_gap", "out of range", found=self.bipotential_gap, expected="between 0 and 1"
            )
        if not self.starts:
            object.__setattr__(self, "starts", _STARTS[self.method])


def sliding_analysis(
    balance: Equilibrium,
    strength: Strength,
    associative: LimitState,
    options: SlidingOptions,
    solve: Solve,
    progress: Progress | None = None,
    names: NameArray | None = None,
) -> LimitState:
    """Return a load factor of sliding without dilatancy, with its gap.

    No such load factor is unique: self-stress at sliding contacts is statically free, so it depends on the start. Every
    distinct value found is in `fixed_points`, and what became of each start in `starts`. names (nf,): of the free stones, for
    what is said of them.
    """
    search = _Search(balance, strength, associative, options, solve, progress)
    starts: list[Start] = list(options.starts)
    if "centre" in starts and not runs_from_centre(*_held(balance, strength, associative)):
        starts = list(dict.fromkeys([*_OTHERS, *(start for start in starts if start != "centre")]))
    if associative.status != "optimal":
        # Forces that balance the lateral load alone are no start.
        others: list[Start] = [start for start in starts if start != "associative"]
        starts = others or ["dead-load"]
    for start in starts:
        search.begin(start)
    if options.starts == _STARTS["default"]:
        for start in (*_OTHERS, *_LAST):
            if start not in starts and not any(end.record.converged for end in search.ends):
                search.begin(start)
        search.hold_loose_stones()
    if not search.ends:
        if associative.status != "optimal":
            return nothing_found(associative)
        # The associative forces are within friction as well: an estimate from above, with the gap that it leaves.
        search.keep("associative", [_associative_run(balance, strength, associative, solve)], "default")
    # Of states that were not certified the nearest is the result. Eq. (3) has no measure of nearness.
    settled = [end for end in search.ends if end.record.converged]
    if not settled:
        settled = [min(search.ends, key=lambda end: end.run.load_factor if options.method == "paper" else end.run.relative_gap)]
    lead, passed_over = _lead(search, settled, names, default=options.starts == _STARTS["default"])
    known = {end.record.start: replace(end.record, interval=search.known_interval(end)) for end in search.ends}
    lead = lead._replace(record=replace(lead.record, interval=known[lead.record.start].interval))
    known[lead.record.start] = lead.record
    of_building = [end.record for end in search.ends if not search.loose(end).any()]
    passed_over += [nearly_words(run) for run in nearly(of_building, lead.record)]
    return sliding_state(balance, strength, associative, lead, list(known.values()), search.found, passed_over, names)


def _lead(search: "_Search", settled: list[End], names: NameArray | None, *, default: bool) -> tuple[End, list[str]]:
    """Return the end that is reported, and why others that are lower are not.

    A search that rounding leads elsewhere does not lead before the run from the centre, however low the state that it found.
    """
    first, intervals = led_by([end.record for end in settled], lambda number: search.interval(settled[number]))
    said: list[str] = []
    for number, (low, high) in intervals.items():
        run = settled[number].record
        if number == first and not fits_any_load(run, (low, high)):
            continue
        loose = search.loose(settled[number])
        told = loose_words(loose, names) if loose.any() else any_load_words(low, high)
        leads = "leads for want of another" if number == first else "does not lead"
        said.append(f"the state at {run.load_factor:.4f} from the start {run.start} {leads}: {told}")
    lead = settled[first]
    if not default:
        return lead, said
    stable = [end for end in settled if end.record.start == "centre" and not fits_any_load(end.record, search.interval(end))]
    if not stable or lead is stable[0]:
        return search.settled(lead), said
    again, words = search.repeated(lead, stable[0])
    return again or search.settled(stable[0]), [*said, *words]


class _Search:
    """What became of each start: found, all runs; ends, the best of each start with its certificate."""

    def __init__(
        self,
        balance: Equilibrium,
        strength: Strength,
        associative: LimitState,
        options: SlidingOptions,
        solve: Solve,
        progress: Progress | None,
    ) -> None:
        self._balance, self._strength, self._associative = balance, strength, associative
        self._options, self._solve, self._progress = options, solve, progress
        self.found: list[SlidingRun] = []
        self.ends: list[End] = []
        self._mechanisms: dict[str, tuple[CoulombState, CoulombState]] = {}

    def begin(self, start: Start) -> None:
        """Run from a start."""
        balance, strength, options, solve = self._balance, self._strength, self._options, self._solve
        if start == "associative" and self._associative.status != "optimal":
            return
        if start == "centre":
            runs = [self._from_centre()]
        else:
            n = self._first_forces(start)
            if options.method == "default":
                runs = [self._searched(n, self._worth_finding())]
                for draw in range(2, _DRAWS + 1 if start == "scattered" else 2):
                    if runs[-1] is not None and runs[-1].converged:
                        break
                    runs.append(self._searched(self._first_forces(start, draw), np.inf))
            else:
                before = np.zeros_like(n), n
                runs = [paper_iteration(balance, strength, n, each, solve, progress=self._progress) for each in before]
        self.keep(start, [run for run in runs if run is not None], options.method)

    def repeated(self, end: End, centre: End) -> tuple[End | None, list[str]]:
        """Return what leads where a search is made again from forces that differ by a ten-millionth, and what is said of it.

        Where both end in mechanisms with the same lowest load factor, that one leads; where both are clearly lower than the run
        from the centre, the higher of the two lowest ones, to which both searches come down. None leads where the second search
        is not clearly lower: rounding has found the first.
        """
        n, start, most = self._first_forces(end.record.start), end.record.start, centre.record.load_factor / (1.0 + SEARCH_SPREAD)
        noise = np.random.default_rng(1).normal(scale=_ROUNDING, size=len(n))
        run = self._searched(n * (1.0 + noise), most)
        elsewhere = (
            f"the state at {end.record.load_factor:.4f} from the start {start} does not lead: a search from forces that differ"
            " by a ten-millionth ends elsewhere"
        )
        if run is None or not run.converged:
            return None, [elsewhere]
        self.found.append(run)
        low, ends = self.interval(end)[0], mechanism_ends(self._balance, self._strength, run)
        other = ends[0].load_factor
        if abs(low - other) <= _SAME * low:
            return self.settled(end), []
        if other > most:
            return None, [elsewhere]
        both = (
            f"searches from forces that differ by a ten-millionth end in mechanisms whose intervals begin at {low:.4f} and"
            f" {other:.4f}: rounding decides between these"
        )
        if other > low:
            self._mechanisms[start] = ends
            end = End(replace(end.record, load_factor=run.load_factor, gap=run.gap, history=run.history), run, run)
        return self.settled(end), [both]

    def _searched(self, n: FloatArray, below: float) -> SlidingRun | None:
        """Return the search from normal forces n (nc,) for a state below a load factor that is known, if any is."""
        settings = SchemeSettings(bipotential_gap=self._options.bipotential_gap)
        if np.isfinite(below):
            settings = replace(settings, patience=_PATIENCE)
        return certified_iteration(self._balance, self._strength, n, self._solve, settings, self._progress, below=below)

    def loose(self, end: End) -> BoolArray:
        """Return the few free stones (nf,) that move in the state of an end, none where the building does."""
        return loose_stones(self._balance, end.run.y if end.state is None else end.state.y)

    def hold_loose_stones(self) -> None:
        """Where a few stones come out whatever pushes, search near a state in which they are held fast for another one."""
        known = [end for end in self.ends if end.record.converged]
        if not known:
            return
        first, intervals = led_by([end.record for end in known], lambda number: self.interval(known[number]))
        stones = np.any([self.loose(known[number]) for number in intervals], axis=0)
        if not fits_any_load(known[first].record, intervals[first]) or not stones.any():
            return
        firm, gap = held_fast(self._balance, self._strength, stones), self._options.bipotential_gap
        if runs_from_centre(self._balance, firm):
            held = from_centre(self._balance, firm, gap, self._solve, self._progress)
        else:
            n, settings = self._first_forces("dead-load"), SchemeSettings(bipotential_gap=gap)
            held = certified_iteration(self._balance, firm, n, self._solve, settings, self._progress)
        near = [] if held is None else [np.maximum(held.x[:, 0], 0.0)]
        if self._associative.status == "optimal":
            near.append(self._first_forces("associative"))
        for n in near:
            run = self._searched(n, np.inf)
            if run is not None and run.converged:
                self.keep("held", [run], "default")
                break

    def interval(self, end: End) -> tuple[float, float]:
        """Return the interval of the mechanism of an end."""
        state, start = end.state, end.record.start
        if state is not None and start not in self._mechanisms:
            self._mechanisms[start] = mechanism_ends(self._balance, self._strength, state)
        return self.known_interval(end)

    def known_interval(self, end: End) -> tuple[float, float]:
        """Return the interval of an end if it was looked for."""
        found = self._mechanisms.get(end.record.start)
        return (np.nan, np.nan) if found is None else (found[0].load_factor, found[1].load_factor)

    def settled(self, end: End) -> End:
        """Return a certified state of the mechanism of an end that does not hang on rounding.

        Which state of its mechanism a search ends at hangs on rounding; which of them is the lowest does not, and that one is
        taken. The end of a run from the centre does not hang on rounding as a rule, and stays as it is, unless it had ties and
        ended in a search. Where its last step has gone far along the states of its mechanism, the one nearest to the step before
        is taken.
        """
        record, run, _ = end
        found = self._mechanisms.get(record.start)
        if found is None or not record.converged:
            return end
        state = found[0]
        if record.start == "centre" and not self._balance.ties:
            before = run.history[-2].load_factor if len(run.history) > 1 else run.load_factor
            if abs(run.load_factor - before) <= _MOVED * abs(run.load_factor):
                return end
            state = towards(run, found[int(before > run.load_factor)], before)
        if state.relative_gap > BIPOTENTIAL_GAP or not admissible(self._balance, self._strength, state):
            return end
        history = (*run.history, Iteration(state.load_factor, 0.0, state.relative_gap))
        chosen = replace(run, x=state.x, load_factor=state.load_factor, gap=state.gap, history=history)
        self.found = [chosen if each is run else each for each in self.found]
        return End(replace(record, load_factor=state.load_factor, gap=state.gap, history=history), chosen, state)

    def _worth_finding(self) -> float:
        """Return the load factor below which a further start of an analysis that names none would lead, infinite if any would."""
        known = [end for end in self.ends if end.record.converged] if self._options.starts == _STARTS["default"] else []
        useful = [end.record.load_factor for end in known if not fits_any_load(end.record, self.interval(end))]
        return min(useful, default=np.inf) / (1.0 + SEARCH_SPREAD)

    def _first_forces(self, start: str, draw: int = 1) -> FloatArray:
        """Return the normal forces (nc,) over the weight from which a search begins; draw: which of the scattered ones."""
        balance = self._balance
        normal = self._associative.forces[:, 0] / balance.force
        forces = np.maximum(normal, 0.0) if start == "associative" else dead_load_start(balance)
        if start == "scattered":
            forces = forces * np.random.default_rng(draw).uniform(*_SCATTER, len(forces))
        if start == "uniform":
            forces = np.full_like(normal, float(forces.mean()))
        return np.concatenate([forces, np.zeros(len(self._strength.friction) - balance.contacts)])

    def _from_centre(self) -> SlidingRun | None:
        """Return the run from the centre; with ties, which it does not know, a search from the end of the run in which they pull
        as they do in the associative state."""
        balance, strength = _held(self._balance, self._strength, self._associative)
        gap = self._options.bipotential_gap
        if balance is self._balance:
            return from_centre(balance, strength, gap, self._solve, self._progress)
        run = from_centre(balance, strength, gap, solver_for(balance.balance), self._progress)
        if run is None or run.relative_gap > CentralSettings().near:
            return None
        n = np.concatenate([np.maximum(run.x[:, 0], 0.0), self._associative.tie_forces / balance.force])
        settings = SchemeSettings(bipotential_gap=gap)
        tied = certified_iteration(self._balance, self._strength, n, self._solve, settings, self._progress)
        if tied is None:
            return None
        spent = {"solves": tied.solves + run.solves, "iterations": tied.iterations + run.iterations}
        return replace(tied, history=(*run.history, *tied.history), **spent)

    def keep(self, start: str, runs: list[SlidingRun], method: Method) -> None:
        """Keep these runs of a start, and the certificate of the best."""
        if not runs:
            return
        run = min(runs, key=lambda run: (not run.converged, run.load_factor))
        state = _certificate(self._balance, self._strength, run, method, self._solve)
        self.found += runs
        gap = np.nan if state is None else state.gap
        record = StartRun(start, run.load_factor, run.converged, gap, (np.nan, np.nan), run.history)
        self.ends.append(End(record, run, state))


def _held(balance: Equilibrium, strength: Strength, associative: LimitState) -> tuple[Equilibrium, Strength]:
    """Return balance and strength with ties that pull as in the associative state, or as they are where there are none."""
    if not balance.ties or balance.pressed is not None or associative.status != "optimal":
        return balance, strength
    return with_tensions(balance, strength, associative.tie_forces / balance.force)


def _associative_run(balance: Equilibrium, strength: Strength, associative: LimitState, solve: Solve) -> SlidingRun:
    """Return the associative forces as a run without a step, with the velocities that fit them best, or their own."""
    x, load_factor = all_forces(balance, associative), associative.load_factor
    state = coulomb_state(balance, strength, x, load_factor, solve)
    y = balance.multipliers(associative.velocities) if state is None else state.y
    gap = bipotential_gap(balance, strength, x, y)
    return SlidingRun(x, load_factor, y, gap, False, (Iteration(load_factor, 0.0, gap / load_factor),))


def _certificate(balance: Equilibrium, strength: Strength, run: SlidingRun, method: Method, solve: Solve) -> CoulombState | None:
    """Return the Coulomb state of a run, or the one nearest to it: eq. (3) overdraws friction."""
    if method == "default":
        return run
    n = np.maximum(run.x[:, 0], 0.0)
    y = sliding_velocities(balance, strength, n, solve)
    return None if y is None else coulomb_step(balance, strength, n, y, solve, nearness=SchemeSettings().weight_b)
