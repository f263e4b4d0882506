"""The limit analysis of a shell and a step of its capacity curve in cvxpy, written as close to the formulas as possible.

Its strength is that of running bond derived by hand, or the planes of the paper.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cvxpy
import numpy as np
import scipy.sparse as sp

from churchpipe.homogenised_shell.cell_limit import cohesion_shift
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.loads import load_vectors
from churchpipe.homogenised_shell.point_strength import by_facet
from churchpipe.homogenised_shell.strength import paper_planes
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import Planes
from hand_cell import hand_closing

# Its functions are only partly typed.
cp: Any = cvxpy


@dataclass(frozen=True, slots=True)
class ShellProgram:
    """Maximise tau subject to equilibrium, strength and tau <= cap.

    Variables x (nx,): the stresses themselves, or with the exact cell the corner forces of the points that yield.
    equilibrium (m, 6 nq) stress = dead + tau live,  stress = offset + stress_of x,  still x = 0 (no moment on the stones),
    planes x <= limit,  |(x_k+1, x_k+2)| <= friction x_k for the first 3 nc variables, k = 0, 3 ...  Nothing bounds the stress
    where the shell does not yield.

    Units: forces over the shell's weight `weight`, N; lengths in m; stresses over `unit` (nq, 6), N/m and N.
    """

    equilibrium: sp.csr_matrix[np.float64]
    dead: FloatArray
    live: FloatArray
    stress_of: sp.csr_matrix[np.float64]
    offset: FloatArray
    still: sp.csr_matrix[np.float64]
    planes: sp.csr_matrix[np.float64]
    limit: FloatArray
    friction: FloatArray
    unit: FloatArray
    weight: float
    cap: float = np.inf


def shell_program(elements: ShellElements, load: LoadCase, materials: Sequence[JointStrength], planes: Planes) -> ShellProgram:
    """State the limit analysis of a shell in running bond."""
    loads = load_vectors(elements, load)
    local = _local_strength(elements, materials, planes, loads.unit)
    return ShellProgram(
        equilibrium=loads.equilibrium,
        dead=loads.dead,
        live=loads.live,
        stress_of=local.stress_of,
        offset=local.offset,
        still=local.still,
        planes=local.planes,
        limit=local.limit,
        friction=local.friction,
        unit=loads.unit,
        weight=loads.weight,
    )


def reference_load_factor(program: ShellProgram, solver: str = "CLARABEL", **options: Any) -> float:
    """Return the largest tau of a shell's program by any conic solver that cvxpy knows; NaN unless solved to optimality."""
    tau, x = cp.Variable(), cp.Variable(program.stress_of.shape[1])
    stress = program.offset + program.stress_of @ x
    constraints: list[Any] = [program.equilibrium @ stress == program.dead + tau * program.live]
    constraints += _within_strength(program, x)
    if np.isfinite(program.cap):
        constraints.append(tau <= program.cap)
    problem = cp.Problem(cp.Maximize(tau), constraints)
    return float(tau.value) if _solved(problem, solver, options) else np.nan


def reference_step(
    program: ShellProgram,
    flexibility: FloatArray,
    before: FloatArray,
    displacement: float,
    solver: str = "CLARABEL",
    **options: Any,
) -> tuple[float, FloatArray]:
    """Return load factor and stresses (nq, 6) after a step of a pushover; NaN unless solved to optimality.

    flexibility_qab (nq, 6, 6): C^-1 times the area of each point; before (nq, 6): stresses, N/m and N; displacement: f_L . u
    per total weight that the step adds, m.
    """
    factor, x = cp.Variable(), cp.Variable(program.stress_of.shape[1])
    stress = program.offset + program.stress_of @ x
    # Energies over the weight and the displacement.
    unit = program.unit / np.sqrt(program.weight * displacement)
    root = np.swapaxes(np.linalg.cholesky(unit[:, :, None] * flexibility * unit[:, None, :]), 1, 2)
    nq = len(root)
    block = sp.bsr_matrix((root, np.arange(nq), np.arange(nq + 1)), shape=(6 * nq, 6 * nq))
    constraints: list[Any] = [program.equilibrium @ stress == program.dead + factor * program.live]
    constraints += _within_strength(program, x)
    change = block @ (stress - (before / program.unit).ravel())
    problem = cp.Problem(cp.Minimize(0.5 * cp.sum_squares(change) - factor), constraints)
    if not _solved(problem, solver, options):
        return np.nan, np.full_like(before, np.nan)
    return float(factor.value), np.asarray(stress.value).reshape(-1, 6) * program.unit


def _within_strength(program: ShellProgram, x: Any) -> list[Any]:
    constraints: list[Any] = []
    if program.still.shape[0]:
        constraints.append(program.still @ x == 0)
    if len(program.limit):
        constraints.append(program.planes @ x <= program.limit)
    if len(program.friction):
        force = cp.reshape(x[: 3 * len(program.friction)], (len(program.friction), 3), order="C")
        constraints.append(cp.norm(force[:, 1:], axis=1) <= cp.multiply(program.friction, force[:, 0]))
    return constraints


def _solved(problem: Any, solver: str, options: dict[str, Any]) -> bool:
    try:
        problem.solve(solver=solver, **options)
    except cp.SolverError:
        return False
    return problem.status == "optimal"


@dataclass(frozen=True, slots=True)
class _Local:
    stress_of: sp.csr_matrix[np.float64]
    offset: FloatArray
    still: sp.csr_matrix[np.float64]
    planes: sp.csr_matrix[np.float64]
    limit: FloatArray
    friction: FloatArray


def _local_strength(elements: ShellElements, materials: Sequence[JointStrength], planes: Planes, unit: FloatArray) -> _Local:
    shell = elements.shell
    assert (shell.bonds == "running").all()
    friction, cohesion, _ = by_facet(shell.material, materials)
    inner = np.arange(len(elements.facet)) < elements.inner
    yields, joints = np.flatnonzero(shell.yields[elements.facet] & inner), np.flatnonzero(~inner)
    at_foot = elements.facet[joints]
    assert shell.yields[at_foot].all()
    foot_friction, foot_apex = friction[at_foot], (shell.thickness * cohesion / friction)[at_foot] / 2
    facet = elements.facet[yields]
    a, b = shell.unit_cells[shell.cell[facet]].T
    h, friction, cohesion = shell.thickness[facet], friction[facet], cohesion[facet]
    nq, ny = len(elements.facet), len(yields)
    empty = np.zeros(0)
    if planes != "cell":
        law = paper_planes(a, b, h, friction, cohesion, torsion=planes == "paper+torsion")
        normal = law.normal * unit[yields][:, None]
        size = np.abs(normal).max(axis=2)
        identity = sp.csr_matrix(sp.identity(6 * nq))
        return _Local(
            stress_of=identity,
            offset=np.zeros(6 * nq),
            still=sp.csr_matrix((0, 6 * nq)),
            planes=_blocks(normal / size[..., None], yields, nq),
            limit=(law.limit / size).ravel(),
            friction=empty,
        )
    # Corner forces in units that give stresses of order one: their closing rates are about 1 / (a + b).
    closing = np.array([hand_closing(*sizes).reshape(36, 9) for sizes in zip(a, b, h, strict=True)])
    size = np.abs(closing[..., :3] / unit[yields][:, None, :3]).max(axis=(1, 2))[:, None, None]
    elastic = np.setdiff1d(np.arange(elements.inner), yields)
    # The stresses of a joint are minus the forces (normal, along, across) at its two corners.
    width, corners = 36 * ny + 6 * len(joints) + 6 * len(elastic), 6 * len(joints)
    at_corners = sp.csr_matrix((-np.ones(corners), (_six(joints), np.arange(corners))), shape=(6 * nq, corners))
    forces = _blocks(np.swapaxes(closing[..., :6] / unit[yields][:, None] / size, 1, 2), np.arange(ny), ny)
    into = sp.csr_matrix((np.ones(6 * ny), (_six(yields), np.arange(6 * ny))), shape=(6 * nq, 6 * ny))
    rest = sp.csr_matrix(
        (np.ones(6 * len(elastic)), (_six(elastic), np.arange(6 * len(elastic)))), shape=(6 * nq, 6 * len(elastic))
    )
    turn = np.swapaxes(closing[..., 6:], 1, 2)
    turn = turn / np.abs(turn).max(axis=2, keepdims=True)
    offset = np.zeros((nq, 6))
    offset[yields] = cohesion_shift(h, friction, cohesion) / unit[yields]
    offset[joints] = foot_apex[:, None] * np.array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]) / unit[joints]
    return _Local(
        stress_of=sp.csr_matrix(sp.hstack([into @ forces, at_corners, rest])),
        offset=offset.ravel(),
        still=sp.csr_matrix(sp.hstack([_blocks(turn, np.arange(ny), ny), sp.csr_matrix((3 * ny, corners + 6 * len(elastic)))])),
        planes=sp.csr_matrix((0, width)),
        limit=empty,
        friction=np.concatenate([np.repeat(friction, 12), np.repeat(foot_friction, 2)]),
    )


def _blocks(values: FloatArray, columns: IntArray, count: int) -> sp.csr_matrix[np.float64]:
    """Return a matrix with values (k, rows, cols) as blocks, one a block row, in the given block columns of `count`."""
    k, rows, cols = values.shape
    matrix = sp.bsr_matrix((values, columns, np.arange(k + 1)), shape=(k * rows, count * cols))
    return sp.csr_matrix(matrix)


def _six(points: IntArray) -> IntArray:
    return (6 * points[:, None] + np.arange(6)).ravel()
