"""Collapse load factor of a shell by static limit analysis, eqs. (5)-(7): for meshes of a few thousand facets."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import clarabel
import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.element import Membrane, ShellElements, Stations, shell_elements
from churchpipe.homogenised_shell.program import ShellProgram, shell_program
from churchpipe.homogenised_shell.strength import PlaneSet
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.results import ShellLimitState, Status
from churchpipe.model.shell import ShellModel

_TOLERANCE = 1e-6
# With less regularisation quadratic membranes end "almost solved".
_SETTINGS = {"verbose": False, "max_threads": 1, "max_iter": 300, "static_regularization_constant": 1e-7}


@dataclass(frozen=True, slots=True)
class _Answer:
    tau: float
    upper: float
    stress: FloatArray
    motion: FloatArray
    residual: float
    violation: float
    size: float
    iterations: int
    message: str

    @property
    def holds(self) -> bool:
        """True when solved (almost is not enough) and proved by its own arrays."""
        close = abs(self.upper - self.tau) <= _TOLERANCE * max(abs(self.tau), self.size)
        return self.message == "Solved" and close and max(self.residual, self.violation) <= _TOLERANCE


def shell_limit_analysis(
    shell: ShellModel,
    load: LoadCase,
    materials: Sequence[Material],
    *,
    planes: PlaneSet = "paper",
    membrane: Membrane = "LST",
    stations: Stations = "inner",
) -> ShellLimitState:
    """Return the collapse load factor of a shell and its mechanism, dead load first.

    planes: "paper", "paper+torsion" or "cell", see `strength.strength`. membrane, stations: see `element.shell_elements`.

    Raises
    ------
    InputError: values out of range, materials or panels unknown.
    """
    begin = perf_counter()
    elements = shell_elements(shell, membrane, stations)
    program = shell_program(elements, load, materials, planes)
    standing = solve_program(replace(program, dead=np.zeros_like(program.dead), live=program.dead, cap=1.0))
    if not standing.holds:
        return _state(elements, standing, "failed", f"dead load not decided: {standing.message}", begin)
    if standing.tau < 1 - _TOLERANCE:
        message = (
            "the dead load alone brings it down: a continuum without cohesion cannot hold a flat soffit; "
            "openings need lintels that do not yield, or arches"
        )
        return _state(elements, standing, "unstable", message, begin)
    answer = solve_program(program)
    if answer.message == "DualInfeasible":
        return _state(elements, answer, "unbounded", "no lateral load of this kind brings it down", begin)
    return _state(elements, answer, "optimal" if answer.holds else "failed", answer.message, begin)


def solve_program(program: ShellProgram, tolerance: float = 1e-8) -> _Answer:
    """Solve a shell's program with Clarabel."""
    rows, width = program.equilibrium.shape[0], program.stress_of.shape[1]
    cones, stones = len(program.friction), program.still.shape[0]
    coulomb = np.ones((cones, 3))
    coulomb[:, 0] = program.friction
    shear = sp.diags(coulomb.ravel(), shape=(3 * cones, width))
    capped = np.isfinite(program.cap)
    ceiling = [sp.csr_matrix(([1.0], ([0], [width])), shape=(1, width + 1))] if capped else []
    matrix = sp.vstack(
        [
            sp.hstack([program.equilibrium @ program.stress_of, sp.csr_matrix(-program.live[:, None])]),
            *(sp.hstack([part, sp.csr_matrix((part.shape[0], 1))]) for part in (program.still, program.planes)),
            *ceiling,
            sp.hstack([-shear, sp.csr_matrix((3 * cones, 1))]),
        ],
        format="csc",
    )
    constant = program.dead - program.equilibrium @ program.offset
    right = np.concatenate([constant, np.zeros(stones), program.limit, [program.cap] if capped else [], np.zeros(3 * cones)])
    kinds: list[clarabel.Cone] = [clarabel.ZeroConeT(rows + stones)]
    if len(program.limit) + capped:
        kinds.append(clarabel.NonnegativeConeT(len(program.limit) + capped))
    kinds += [clarabel.SecondOrderConeT(3)] * cones
    cost = np.zeros(width + 1)
    cost[-1] = -1.0
    settings = clarabel.DefaultSettings()
    for key, value in (_SETTINGS | dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), tolerance)).items():
        setattr(settings, key, value)
    found = clarabel.DefaultSolver(sp.csc_matrix((width + 1, width + 1)), cost, matrix, right, kinds, settings).solve()
    x, z = np.asarray(found.x), np.asarray(found.z)
    stress = program.offset + program.stress_of @ x[:-1]
    balance = program.equilibrium @ stress - program.dead - x[-1] * program.live
    corner = x[: 3 * cones].reshape(-1, 3)
    excess = [program.planes @ x[:-1] - program.limit, np.hypot(corner[:, 1], corner[:, 2]) - program.friction * corner[:, 0]]
    return _Answer(
        tau=float(x[-1]),
        upper=float(right @ z),
        stress=stress.reshape(-1, 6) * program.unit,
        motion=-z[:rows],
        residual=float(np.abs(np.concatenate([balance, program.still @ x[:-1]])).max(initial=0.0)),
        violation=float(np.concatenate(excess).max(initial=0.0)),
        size=program.cap if capped else 1e-3,
        iterations=int(found.iterations),
        message=str(found.status),
    )


def _state(elements: ShellElements, answer: _Answer, status: Status, message: str, begin: float) -> ShellLimitState:
    motion = np.zeros(elements.unknowns)
    motion[~elements.clamped] = answer.motion
    known = status == "optimal"
    return ShellLimitState(
        load_factor=answer.tau if known else np.inf if status == "unbounded" else np.nan,
        status=status,
        lower_bound=answer.tau if known else np.nan,
        upper_bound=answer.upper if known else np.nan,
        stress=answer.stress,
        velocities=elements.translations(motion),
        edge_rotation=elements.edge_rotation(motion),
        plastic=elements.facet_strain(motion) * elements.shell.yields[:, None],
        equilibrium_residual=answer.residual,
        yield_violation=answer.violation,
        iterations=answer.iterations,
        seconds=perf_counter() - begin,
        message=message,
    )
