"""Capacity curve of a shell: dead load, then lateral load in steps of displacement (Haar and von Karman, eq. 10).

Each step is one convex program for the whole structure. Its unknowns are the stresses t and the load factor lambda. Prescribed
is the step dd of the displacement d = f_L . u / W, with f_L the live load, u the displacements and W the weight. Among all
stresses in equilibrium and within the strength, f(t) <= 0, it finds those nearest in elastic energy to the stresses t_n before
the step, while the load does as much work on dd as possible:

    minimise  1/2 sum A (t - t_n) C^-1 (t - t_n) - lambda dd    s.t.  H t = f_D + lambda f_L,  f(t) <= 0.

A is the area of a point, C the stiffness, H equilibrium, f_D the dead load. The multipliers of equilibrium are the displacements
of the step, those of the strength its plastic strains. The program has a solution for steps of any length, and needs no
cohesion.
"""

from collections.abc import Callable, Sequence
from numbers import Integral
from time import perf_counter

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky, NotDefiniteError
from churchpipe.errors import InputError
from churchpipe.homogenised_shell.condensed import CondensedShell, StressState
from churchpipe.homogenised_shell.element import Membrane, ShellElements, Stations, shell_elements
from churchpipe.homogenised_shell.joint_groups import with_bearings
from churchpipe.homogenised_shell.limit import FALLS, TOO_WEAK
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.homogenised_shell.stiffness import facet_stiffness
from churchpipe.homogenised_shell.strength import with_warning
from churchpipe.homogenised_shell.tie_cuts import tensions_by_cuts
from churchpipe.homogenised_shell.tie_path import TiePath
from churchpipe.model.arguments import check_call, check_kind, describe, listed
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase, way_of
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import STRENGTH
from churchpipe.model.names import Planes as PlaneSet
from churchpipe.model.results import CapacityCurve, CapacityStep, Status
from churchpipe.model.shell import ShellModel
from churchpipe.model.ties import Tie
from churchpipe.wording import counted

Progress = Callable[[CapacityStep], None]
_PULLED = (
    "the dead load and the pretension of the ties bring it down, which a limit analysis leaves out: give the ties less, or none. "
    f"Without any, the dead load alone may bring it down: {TOO_WEAK}"
)


def pushover(
    shell: ShellModel,
    load: LoadCase,
    materials: Sequence[JointStrength],
    *,
    planes: PlaneSet = STRENGTH,
    membrane: Membrane = "LST",
    stations: Stations = "inner",
    control_point: int | npt.ArrayLike | None = None,
    steps: int = 40,
    ties: Sequence[Tie] = (),
    progress: Progress | None = None,
) -> CapacityCurve:
    """Push a shell sideways until its load factor stays constant.

    Parameters
    ----------
    shell, load, materials, planes, membrane, stations
        As in `shell_limit_analysis`; the materials have elastic constants.
    control_point
        Number of a node, or a point (3,) m of the shell whose nearest node is taken; by default the node that moves furthest
        along the load at the end.
    steps
        At most this many, dead load not counted.
    ties
        Bars that pull facets together, from `place_ties`. They are drawn to their pretension with the dead load; then they are
        elastic up to their strength, yield, hang slack and break. The curve has their tensions.
    progress
        Called after every step.

    Returns
    -------
    CapacityCurve
        Status "converged" on a plateau: the last step lengthened the path by at least half, and the load factor rose by less
        than 5e-4 of itself. "not-converged": the steps were used up. "failed": a step was not solved even when shortened.
        "unstable": under dead load alone; displacement is then the falling mechanism, f_D . u = 1 per total weight.

    Raises
    ------
    InputError
        Arguments of the wrong kind, values out of range, materials or panels unknown, no elastic constants, a mesh that is
        not held.
    """
    begin = perf_counter()
    check_kind("pushover: shell", shell, ShellModel)
    check_kind("pushover: load", load, LoadCase)
    check_call("pushover: progress", progress)
    shell, materials = with_bearings(shell, listed("pushover: materials", materials, JointStrength))
    if isinstance(steps, bool) or not isinstance(steps, Integral):
        raise InputError("steps", "not a whole number", found=describe(steps), expected=">= 1")
    if steps < 1:
        raise InputError("steps", "out of range", found=steps, expected=">= 1")
    control = None if control_point is None else _node(shell, control_point)
    stiffness = facet_stiffness(shell, materials)
    elements = shell_elements(shell, membrane, stations, on_joints=planes == "cell")
    condensed = CondensedShell(elements, load, materials, planes)
    path = _Path(condensed, stiffness, listed("pushover: ties", ties, Tie))
    status, message = path.stand(progress)
    if status == "converged":
        status, message = path.push(steps, progress)
    return path.curve(status, with_warning(message, planes), control, load, perf_counter() - begin)


class _Path:
    """The state of a pushover so far: stresses, displacements and the record of its steps."""

    def __init__(self, condensed: CondensedShell, stiffness: FloatArray, ties: Sequence[Tie]) -> None:
        elements, loads = condensed.elements, condensed.loads
        self._condensed, self._stiffness = condensed, stiffness
        self._elastic = _elastic(elements, stiffness)
        # f_L . u / W, m, at a load factor of one when nothing yields.
        self._softness = loads.weight * float(loads.live @ self._elastic(loads.live))
        self._ties = TiePath(elements, ties, self._softness, loads.weight)
        unit = loads.unit.T
        size = elements.weight / (loads.weight * self._softness)
        flexibility = np.moveaxis(np.linalg.inv(elements.point_stiffness(stiffness)), 0, 2)
        self._compliance = flexibility * unit[:, None] * unit[None, :] * size
        self._stress = np.zeros((6, len(elements.facet)))
        self._state: StressState | None = None
        self._dead_motion = np.zeros(elements.unknowns)
        self._motion = np.zeros(elements.unknowns)
        self._multipliers = np.zeros(condensed.strength.multipliers)
        self._moved: list[FloatArray] = []
        self._steps: list[CapacityStep] = []
        self._tensions: list[FloatArray] = []
        self._lost: list[str] = []

    def stand(self, progress: Progress | None) -> tuple[Status, str]:
        """Apply the dead load."""
        begin = perf_counter()
        dead = self._condensed.loads.dead + self._ties.loads
        state = self._condensed.solve(dead, None, compliance=self._compliance, cap=1.0)
        if state.status == "infeasible":
            fall = state.motion
            self._motion = fall / float(dead @ fall[~self._condensed.elements.clamped])
            return "unstable", _PULLED if self._ties.tension.any() else FALLS
        if not (state.balanced and state.gap <= SOLVER.standing):
            return "failed", f"dead load not decided: {_reason(state)}"
        self._accept(state, 0.0, 0.0, begin, progress)
        self._dead_motion, self._motion = self._motion, np.zeros_like(self._motion)
        self._moved = [np.zeros_like(self._moved[0])]
        return "converged", ""

    def push(self, most: int, progress: Progress | None) -> tuple[Status, str]:
        """Push until the load factor stays constant."""
        length, longest = SOLVER.first_step, np.inf
        travelled = factor = 0.0
        while len(self._steps) <= most:
            begin = perf_counter()
            state, tension = self._step(length)
            if not state.holds:
                if length < SOLVER.shortest * SOLVER.first_step:
                    return "failed", f"step {len(self._steps)}: {_reason(state)}"
                length *= SOLVER.shrink
                longest = length
                continue
            if (share := self._ties.until_broken(state)) < 1 and length * share >= SOLVER.shortest * SOLVER.first_step:
                length *= share
                continue
            broken = self._ties.accept(state, tension)
            rise, before = state.load - factor, travelled
            travelled, factor = travelled + length, state.load
            self._lost += [f"tie {name} broke at a displacement of {1e3 * travelled * self._softness:.3g} mm" for name in broken]
            self._accept(state, travelled * self._softness, factor, begin, progress)
            if before > 0 and travelled >= SOLVER.longer * before and abs(rise) <= SOLVER.plateau * abs(factor):
                return "converged", ""
            wanted = SOLVER.rise * abs(factor) / max(abs(rise), 1e-300)
            length = min(length * float(np.clip(wanted, 1.0, SOLVER.growth)), longest)
        return "not-converged", f"no plateau after {counted(most, 'step')}"

    def _step(self, reward: float) -> tuple[StressState, FloatArray]:
        """Return the state of a step, and the tensions over the weight of the ties that may pull."""
        condensed, before, compliance = self._condensed, self._state, self._compliance
        dead, live = condensed.loads.dead, condensed.loads.live
        ties = self._ties.in_step()
        if not len(ties.most):
            return condensed.solve(dead, live, compliance=compliance, before=before, reward=reward), ties.before
        state = condensed.elastic_step(dead, live, compliance, before, reward, ties)
        if state is not None and state.holds and state.tension is not None:
            return state, state.tension

        def solved(tension: FloatArray) -> tuple[StressState, FloatArray, float]:
            under = dead + tension @ ties.pull
            state = condensed.solve(under, live, compliance=compliance, before=before, reward=reward)
            change = state.stress - self._stress
            energy = 0.5 * float(np.einsum("aq,abq,bq->", change, compliance, change)) - reward * state.load
            return state, state.motion[~condensed.elements.clamped], energy

        return tensions_by_cuts(ties, self._flexibility(ties.pull), solved)

    def _flexibility(self, pull: FloatArray) -> FloatArray:
        """Return the motions (nt, nt) of ties under unit tensions where nothing yields and the load does no work."""
        loads = self._condensed.loads
        scale = loads.weight / self._softness
        under = scale * np.array([self._elastic(row) for row in pull])
        moved = under @ loads.live
        return under @ pull.T - np.outer(moved, moved)

    def curve(self, status: Status, message: str, control: int | None, load: LoadCase, seconds: float) -> CapacityCurve:
        """Return what was found."""
        condensed, elements = self._condensed, self._condensed.elements
        displacement = elements.translations(self._motion)
        way = way_of(load)
        along = displacement @ way
        node = int(along.argmax()) if control is None else control
        area = elements.weight
        rows = condensed.strength.rates(self._multipliers) * condensed.loads.weight * self._softness / area
        mean = elements.facet_mean(rows.T)
        stress = (self._stress * condensed.loads.unit.T).T
        elastic = np.linalg.solve(elements.point_stiffness(self._stiffness), stress[:, :, None])[:, :, 0]
        plastic = elements.of_facets(elements.point_strain(self._dead_motion + self._motion) - elastic)
        return CapacityCurve(
            load_factor=np.array([step.load_factor for step in self._steps]),
            control=np.array([moved[node] @ way for moved in self._moved]),
            control_point=node,
            displacement=displacement,
            edge_rotation=elements.edge_rotation(self._motion),
            plastic=plastic * elements.shell.yields[:, None],
            multipliers=mean * elements.shell.yields[:, None],
            steps=tuple(self._steps),
            tie_forces=np.array(self._tensions).reshape(len(self._steps), len(self._ties)),
            status=status,
            seconds=seconds,
            message="; ".join(filter(None, (*self._lost, message))),
        )

    def _accept(self, state: StressState, displacement: float, factor: float, begin: float, progress: Progress | None) -> None:
        self._stress, self._state = state.stress, state
        self._motion = self._motion + self._softness * state.motion
        self._multipliers = self._multipliers + state.multipliers
        self._tensions.append(self._ties.tension)
        self._moved.append(self._condensed.elements.translations(self._motion))
        step = CapacityStep(
            displacement=displacement,
            load_factor=factor,
            residual=state.residual,
            violation=state.violation,
            gap=state.gap,
            iterations=state.iterations,
            seconds=perf_counter() - begin,
        )
        self._steps.append(step)
        if progress:
            progress(step)


def _reason(state: StressState) -> str:
    return f"{state.message or state.status}, residual {state.residual:.1e}, gap {state.gap:.1e}"


def _elastic(elements: ShellElements, stiffness: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return what solves for the displacements of the free unknowns when nothing yields."""
    free = ~elements.clamped
    lower = sp.csc_matrix(sp.tril(elements.stiffness_matrix(stiffness)[free][:, free], format="csc"))
    lower.sort_indices()
    factor = Cholesky(lower, 1)
    try:
        factor.factor(lower.data)
    except NotDefiniteError as error:
        raise InputError(
            "shell", "nothing holds it: it moves without strain", expected="supported nodes that fix every part"
        ) from error
    return factor.solve


def _node(shell: ShellModel, control_point: int | npt.ArrayLike) -> int:
    count = len(shell.points)
    try:
        given = np.asarray(control_point)
    except ValueError:
        given = np.empty(0)
    if given.ndim == 0 and given.dtype.kind in "iu":
        if not 0 <= int(given) < count:
            raise InputError("control_point", "no such node", found=int(given), expected=f"0 to {count - 1}")
        return int(given)
    if given.shape != (3,) or given.dtype.kind not in "iuf" or not np.isfinite(given).all():
        raise InputError("control_point", "not a node or a point", found=control_point, expected="a number, or x, y, z in m")
    # The nodes lie in the middle of walls: a point on a face is as near as half a thickness.
    beyond = 0.5 * shell.thickness.max()
    low, high = shell.points.min(axis=0) - beyond, shell.points.max(axis=0) + beyond
    if ((given < low) | (given > high)).any():
        expected = f"a point between {low.round(4).tolist()} and {high.round(4).tolist()} m"
        raise InputError("control_point", "a point outside the shell", found=given.tolist(), expected=expected)
    return int(((shell.points - given) ** 2).sum(axis=1).argmin())
