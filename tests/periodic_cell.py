"""Finite elements of the periodic cell of a bond: stones and mortar as solids, by scikit-fem.

Under a membrane strain E and a curvature chi of the wall the strain is E + z chi in the plane, z through the wall, and that of a
displacement which repeats from period to period and leaves the faces of the wall free. The least energy per area of wall is
half of the stiffness.
"""

from typing import Any

import numpy as np
import scipy.sparse as sp
import skfem

from churchpipe.bond.period import period_of
from churchpipe.model.materials import Elastic


def cell_stiffness(bond: str, a: float, b: float, h: float, elastic: Elastic, divisions: int = 3) -> np.ndarray:
    """Return the stiffness (6, 6) of a wall in a bond, as `stiffness.wall_stiffness`.

    a, b: sizes of a stone without its joints, m. divisions: of a stone between two of its lines of joints.
    """
    t = elastic.joint_thickness
    period = period_of(bond, a + t, b + t, h)
    size = np.array([period.steps[0, 0], 2 * (a + t)])
    lines = [_lines(period.stones[:, k].ravel(), size[k], t, divisions) for k in (0, 1)]
    inner = period.stones[:, 2].ravel()
    inner = inner[np.abs(inner) < h / 2 - t]
    lines.append(_cuts(np.unique(np.concatenate([[-h / 2, h / 2], inner - t / 2, inner + t / 2])), divisions))
    mesh = skfem.MeshHex.init_tensor(*lines)
    basis = skfem.Basis(mesh, skfem.ElementHex2(), intorder=3)
    centre = mesh.p[:, mesh.t].mean(axis=1).T
    stone = np.zeros(len(centre), dtype=bool)
    steps = [i * period.steps[0] + j * period.steps[1] for i in range(-3, 4) for j in range(-3, 4)]
    for box in period.stones:
        low, high = box[:, 0] + t / 2, box[:, 1] - t / 2
        low[2], high[2] = (low[2] if box[2, 0] > -h / 2 else -h), (high[2] if box[2, 1] < h / 2 else h)
        for step in steps:
            place = centre - np.append(step, 0.0)
            stone |= ((place > low) & (place < high)).all(axis=1)
    modulus, poisson = (
        np.where(stone, *pair)[:, None]
        for pair in ((elastic.block_modulus, elastic.joint_modulus), (elastic.block_poisson, elastic.joint_poisson))
    )
    lame, shear = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson)), modulus / (2 * (1 + poisson))
    stiffness = sp.bmat([[_block(basis, i, j, lame, shear) for j in range(3)] for i in range(3)]).tocsc()
    loads, own = _imposed(basis, lame, shear)
    # Nodes that are a period apart move alike; one of them does not move.
    key = np.round(np.column_stack([np.mod(basis.doflocs[:2].T + 1e-9, size), basis.doflocs[2]]) / 1e-7).astype(np.int64)
    _, same = np.unique(key, axis=0, return_inverse=True)
    count = same.max() + 1
    fold = sp.csr_matrix((np.ones(len(same)), (np.arange(len(same)), same.ravel())))
    whole = sp.block_diag([fold] * 3).tocsr()
    free = np.setdiff1d(np.arange(3 * count), count * np.arange(3))
    reduced = (whole.T @ stiffness @ whole).tocsc()[free][:, free]
    right = (whole.T @ loads)[free]
    answer = sp.linalg.splu(reduced.tocsc()).solve(right)
    return (own - right.T @ answer) / size.prod()


def _lines(faces: np.ndarray, size: float, t: float, divisions: int) -> np.ndarray:
    """Return the lines of a mesh over one period, with half a joint to either side of each face of a stone."""
    places = np.unique(np.round(np.mod(np.concatenate([faces, faces + size / 2]) + 1e-9, size), 9))
    near = np.mod(np.concatenate([places - t / 2, places + t / 2]), size)
    return _cuts(np.unique(np.round(np.concatenate([[0.0, size], near]), 9)), divisions)


def _cuts(lines: np.ndarray, divisions: int) -> np.ndarray:
    """Divide every gap between lines that is longer than the shortest."""
    gaps = np.diff(lines)
    counts = np.where(gaps > 3 * gaps.min(), divisions, 1)
    parts = [start + gap * np.arange(count) / count for start, gap, count in zip(lines[:-1], gaps, counts, strict=True)]
    return np.append(np.concatenate(parts), lines[-1])


def _block(basis: skfem.Basis, i: int, j: int, lame: np.ndarray, shear: np.ndarray) -> sp.csr_matrix:
    """Return the stiffness of the displacements i against j."""

    @skfem.BilinearForm
    def form(u: Any, v: Any, _: Any) -> Any:
        energy = lame * u.grad[j] * v.grad[i] + shear * u.grad[i] * v.grad[j]
        return energy + (shear * sum(u.grad[k] * v.grad[k] for k in range(3)) if i == j else 0.0)

    return form.assemble(basis)


def _imposed(basis: skfem.Basis, lame: np.ndarray, shear: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces (dofs, 6) that drive the further displacement under the wall's strains, and the energies without it."""
    z = basis.global_coordinates()[2]
    one = np.ones_like(z)
    # Strain (e11, e22, 2 e12) of each: membrane strains, then curvatures.
    strains = [[size * (k == component) for component in range(3)] for size in (one, z) for k in range(3)]
    stresses = [
        [lame * (e[0] + e[1]) + 2 * shear * e[0], lame * (e[0] + e[1]) + 2 * shear * e[1], shear * e[2], lame * (e[0] + e[1])]
        for e in strains
    ]
    columns = []
    for s11, s22, s12, s33 in stresses:
        of_axis = ((s11, s12, None), (s12, s22, None), (None, None, s33))
        columns.append(np.concatenate([-_force(basis, row) for row in of_axis]))
    own = np.array([[(sum(s[k] * e[k] for k in range(3)) * basis.dx).sum() for e in strains] for s in stresses])
    return np.stack(columns, axis=1), own


def _force(basis: skfem.Basis, stress: tuple[np.ndarray | None, ...]) -> np.ndarray:
    @skfem.LinearForm
    def form(v: Any, _: Any) -> Any:
        return sum(s * v.grad[k] for k, s in enumerate(stress) if s is not None)

    return form.assemble(basis)
