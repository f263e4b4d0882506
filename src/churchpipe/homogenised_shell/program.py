"""Limit analysis of a shell as a cone program in its stresses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.element import ShellElements
from churchpipe.homogenised_shell.loads import dead_load, live_load
from churchpipe.homogenised_shell.point_strength import by_facet
from churchpipe.homogenised_shell.strength import Planes, PlaneSet, strength
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength


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


@dataclass(frozen=True, slots=True)
class LoadVectors:
    """equilibrium (m, 6 nq) stress = dead + load live, for the unknowns that are free; units as in `ShellProgram`."""

    equilibrium: sp.csr_matrix[np.float64]
    dead: FloatArray
    live: FloatArray
    unit: FloatArray
    weight: float


def shell_program(elements: ShellElements, load: LoadCase, materials: Sequence[JointStrength], planes: PlaneSet) -> ShellProgram:
    """State the limit analysis of a shell.

    Raises
    ------
    InputError: as `strength.strength` and `load_vectors`; a material of the shell that is not given.
    """
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


def load_vectors(elements: ShellElements, load: LoadCase) -> LoadVectors:
    """Return equilibrium and loads of the unknowns that are free.

    Raises
    ------
    InputError: as `loads.live_load`; no weight.
    """
    shell = elements.shell
    weight = float(shell.weight.sum())
    if weight == 0:
        raise InputError("shell", "no weight", expected="surface_weight > 0 somewhere")
    h = shell.thickness[elements.facet]
    # Membrane forces in units of weight over height of the shell, moments in the same times the thickness.
    force = weight / float(np.ptp(shell.points, axis=0).max())
    unit = force * np.column_stack([np.ones((len(h), 3)), np.repeat(h[:, None], 3, axis=1)])
    free = ~elements.clamped
    power = sp.diags((np.repeat(elements.weight, 6) * unit.ravel()) / weight)
    return LoadVectors(
        equilibrium=sp.csr_matrix(sp.csr_matrix(elements.strain.T)[free] @ power),
        dead=dead_load(elements, load)[free] / weight,
        live=live_load(elements, load)[free] / weight,
        unit=unit,
        weight=weight,
    )


@dataclass(frozen=True, slots=True)
class _Local:
    stress_of: sp.csr_matrix[np.float64]
    offset: FloatArray
    still: sp.csr_matrix[np.float64]
    planes: sp.csr_matrix[np.float64]
    limit: FloatArray
    friction: FloatArray


def _local_strength(elements: ShellElements, materials: Sequence[JointStrength], planes: PlaneSet, unit: FloatArray) -> _Local:
    shell = elements.shell
    if (shell.bonds != "running").any():
        raise InputError("shell", "this statement knows running bond alone", found=str(shell.bonds[shell.bonds != "running"][0]))
    friction, cohesion, _ = by_facet(shell.material, materials)
    yields = np.flatnonzero(shell.yields[elements.facet])
    facet = elements.facet[yields]
    a, b = shell.unit_cells[shell.cell[facet]].T
    law = strength(planes, a, b, shell.thickness[facet], friction[facet], cohesion[facet])
    nq, ny = len(elements.facet), len(yields)
    empty = np.zeros(0)
    if isinstance(law, Planes):
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
    closing = law.closing.reshape(ny, 36, 9)
    size = np.abs(closing[..., :3] / unit[yields][:, None, :3]).max(axis=(1, 2))[:, None, None]
    elastic = np.setdiff1d(np.arange(nq), yields)
    width = 36 * ny + 6 * len(elastic)
    forces = _blocks(np.swapaxes(closing[..., :6] / unit[yields][:, None] / size, 1, 2), np.arange(ny), ny)
    into = sp.csr_matrix((np.ones(6 * ny), (_six(yields), np.arange(6 * ny))), shape=(6 * nq, 6 * ny))
    rest = sp.csr_matrix(
        (np.ones(6 * len(elastic)), (_six(elastic), np.arange(6 * len(elastic)))), shape=(6 * nq, 6 * len(elastic))
    )
    turn = np.swapaxes(closing[..., 6:], 1, 2)
    turn = turn / np.abs(turn).max(axis=2, keepdims=True)
    offset = np.zeros((nq, 6))
    offset[yields] = law.apex / unit[yields]
    return _Local(
        stress_of=sp.csr_matrix(sp.hstack([into @ forces, rest])),
        offset=offset.ravel(),
        still=sp.csr_matrix(sp.hstack([_blocks(turn, np.arange(ny), ny), sp.csr_matrix((3 * ny, 6 * len(elastic)))])),
        planes=sp.csr_matrix((0, width)),
        limit=empty,
        friction=np.repeat(law.friction, 12),
    )


def _blocks(values: FloatArray, columns: IntArray, count: int) -> sp.csr_matrix[np.float64]:
    """Return a matrix with values (k, rows, cols) as blocks, one a block row, in the given block columns of `count`."""
    k, rows, cols = values.shape
    matrix = sp.bsr_matrix((values, columns, np.arange(k + 1)), shape=(k * rows, count * cols))
    return sp.csr_matrix(matrix)


def _six(points: IntArray) -> IntArray:
    return (6 * points[:, None] + np.arange(6)).ravel()
