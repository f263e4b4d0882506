"""Collapse load factor of a shell by static limit analysis, eqs. (5)-(7)."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import Literal, get_args

import numpy as np

from churchpipe.homogenised_shell.bounds import Bounds, proved_bounds
from churchpipe.homogenised_shell.condensed import CondensedShell
from churchpipe.homogenised_shell.element import Membrane, ShellElements, Stations, shell_elements
from churchpipe.homogenised_shell.joint_groups import with_bearings
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.homogenised_shell.sliding_off import sliding_off
from churchpipe.homogenised_shell.strength import with_warning
from churchpipe.homogenised_shell.ties import tied_analysis
from churchpipe.model.arguments import check_call, check_kind, listed, one_of
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import STRENGTH
from churchpipe.model.names import Planes as PlaneSet
from churchpipe.model.progress import Progress
from churchpipe.model.results import ShellLimitState, Status
from churchpipe.model.shell import ShellModel
from churchpipe.model.ties import Tie

Solver = Literal["auto", "interior-point", "clarabel"]

# What a shell cannot hold.
TOO_WEAK = (
    "a continuum without cohesion cannot hold a flat soffit, a vault too thin for a line of thrust or without anything that "
    "takes its thrust, a wall that a thrust or a pressure pushes over, nor a load on the very end of a wall; openings need "
    "lintels that do not yield, or arches, and a point load needs the middle of a stone below it"
)
FALLS = f"the dead load alone brings it down: {TOO_WEAK}"

# Its bounds are zero but for rounding, whose sign says nothing.
ON_AN_EDGE = (
    "the dead load stands as on an edge, and no push is carried, however small, as in stack bond without cohesion, where nothing "
    "holds the stones of a course together"
)


def shell_limit_analysis(
    shell: ShellModel,
    load: LoadCase,
    materials: Sequence[JointStrength],
    *,
    planes: PlaneSet = STRENGTH,
    membrane: Membrane = "LST",
    stations: Stations = "inner",
    solver: Solver = "auto",
    ties: Sequence[Tie] = (),
    progress: Progress | None = None,
) -> ShellLimitState:
    """Return the collapse load factor of a shell and its mechanism, dead load first.

    The bounds proved are no farther apart than 1e-6 of the load factor, or than 1e-5 where the message says so.

    Parameters
    ----------
    shell
        The mid-surfaces, from `derive_shell`.
    load
        What the load factor multiplies.
    materials
        Strength of the joints of each masonry, by name.
    planes
        Strength of the unit cell: "cell" is exact; "paper" and "paper+torsion" are outer approximations.
    membrane
        "LST", triangles of linear membrane strain, or "CST", of constant strain, cheaper and too strong.
    stations
        Where the strain of an LST is evaluated: "inner" points, most often the more accurate, or the "corners".
    solver
        "interior-point", condensed to the unknowns of the mesh; "clarabel", all stresses at once, for a few thousand facets;
        "auto", the first, and the second where that fails on a mesh that it can take.
    ties
        Bars that pull facets together, from `place_ties`; the result has their tensions and what their strength adds.
    progress
        Called with what is solved and the share of that which is done.

    Raises
    ------
    InputError
        Arguments of the wrong kind, values out of range, materials or panels unknown.
    """
    check_kind("shell_limit_analysis: shell", shell, ShellModel)
    check_kind("shell_limit_analysis: load", load, LoadCase)
    check_call("shell_limit_analysis: progress", progress)
    shell, materials = with_bearings(shell, listed("shell_limit_analysis: materials", materials, JointStrength))
    one_of("solver", solver, *get_args(Solver))
    begin = perf_counter()
    elements = shell_elements(shell, membrane, stations, on_joints=planes == "cell")
    bars = listed("shell_limit_analysis: ties", ties, Tie)

    def analysed(case: LoadCase, looks: bool = True) -> tuple[ShellLimitState, float]:
        return _solved(CondensedShell(elements, case, materials, planes), solver, looks, progress)

    state = tied_analysis(shell, load, bars, analysed) if bars else analysed(load)[0]
    said = "" if bars else sliding_off(shell, load, materials, state)
    message = "; ".join(filter(None, (said, state.message)))
    return replace(state, seconds=perf_counter() - begin, message=with_warning(message, planes))


def _solved(condensed: CondensedShell, solver: Solver, looks: bool, progress: Progress | None) -> tuple[ShellLimitState, float]:
    """Return the limit state, and the largest share of the dead load where that does not stand, else NaN; looks: first whether
    it does."""
    shell = condensed.elements.shell
    methods = ["interior-point", "clarabel"] if solver == "auto" and len(shell.triangles) <= SOLVER.clarabel_facets else [solver]
    *others, last = methods
    for method in others:
        state, share = _analysed(condensed, method, looks, progress)
        if state.status != "failed":
            return state, share
    return _analysed(condensed, "interior-point" if last == "auto" else last, looks, progress)


def _analysed(condensed: CondensedShell, method: str, looks: bool, progress: Progress | None) -> tuple[ShellLimitState, float]:
    dead, live = condensed.loads.dead, condensed.loads.live
    state, share = None, np.nan
    if looks:
        if method == "clarabel":
            found = condensed.solve_directly(None, dead, cap=1.0)
        else:
            found = condensed.solve(None, dead, cap=1.0, progress=progress and partial(progress, "dead load"))
        standing = proved_bounds(condensed, found, np.zeros_like(dead), dead)
        state = _verdict(condensed.elements, standing)
        share = np.nan if state is None else standing.upper
    if state is None:
        if method == "clarabel":
            found = condensed.solve_directly(dead, live)
        else:
            found = condensed.solve(dead, live, progress=progress and partial(progress, "limit load"))
        state = _decided(condensed.elements, proved_bounds(condensed, found, dead, live))
    return replace(state, solver=method), share


def _verdict(elements: ShellElements, standing: Bounds) -> ShellLimitState | None:
    """Return the state of a shell that does not stand, or None when the dead load is carried."""
    # Where the load reaches its cap nothing has to move. The upper bound may then be one rounding error divided by another.
    stands = standing.lower >= 1 - SOLVER.standing
    if standing.admissible and stands:
        return None
    if standing.outcome == "solved" and not stands and standing.upper < 1 - SOLVER.standing:
        return _state(elements, standing, "unstable", FALLS)
    return _state(elements, standing, "failed", f"dead load not decided: {standing.message}")


def _decided(elements: ShellElements, found: Bounds) -> ShellLimitState:
    agree = found.agree(SOLVER.last_digits, SOLVER.least_load_factor)
    if found.outcome == "unbounded" or (agree and found.lintels > SOLVER.lintel_dissipation * found.upper):
        return _state(elements, found, "unbounded", "no lateral load of this kind brings it down")
    if agree and abs(found.upper) <= SOLVER.duality_gap * SOLVER.least_load_factor:
        return replace(_state(elements, found, "optimal", ON_AN_EDGE), load_factor=0.0)
    message = ""
    if not found.agree(SOLVER.duality_gap, SOLVER.least_load_factor) or found.outcome != "solved":
        message = f"bounds {found.lower:.8g} and {found.upper:.8g}" + (f"; {found.message}" if found.message else "")
    elif found.lintels > SOLVER.duality_gap * found.upper:
        share = found.lintels / found.upper
        tension = f"{SOLVER.lintel_tension:g} x weight / longest side"
        message = f"lintels reach their tension, {tension}; {share:.1e} of the dissipation is theirs"
    return _state(elements, found, "optimal" if agree else "failed", message)


def _state(elements: ShellElements, found: Bounds, status: Status, message: str) -> ShellLimitState:
    motion = np.zeros(elements.unknowns)
    motion[~elements.clamped] = found.motion
    known = status == "optimal"
    return ShellLimitState(
        load_factor=found.lower if known else np.inf if status == "unbounded" else np.nan,
        status=status,
        lower_bound=found.lower if known else np.nan,
        upper_bound=found.upper if known else np.nan,
        stress=found.stress,
        velocities=elements.translations(motion),
        edge_rotation=elements.edge_rotation(motion),
        beam_velocities=elements.beam_motion(motion),
        plastic=elements.facet_strain(motion) * elements.shell.yields[:, None],
        equilibrium_residual=found.residual,
        yield_violation=found.violation,
        iterations=found.iterations,
        message=message,
    )
