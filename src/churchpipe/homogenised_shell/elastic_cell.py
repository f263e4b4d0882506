"""Elastic stiffness of a wall in any bond: finite elements of one period, stones and mortar as solids (scikit-fem).

Under a membrane strain E and a curvature chi of the wall the strain in its plane is E + z chi, z the depth from the mid-surface,
and that of a displacement which repeats from period to period and leaves the faces of the wall free. Of all such displacements
the one with the least energy is that of the wall, and this energy per area is half of the stiffness. The mid-surface stays a
plate: its own shear through the thickness is left out, as the shell leaves it out.
"""

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from churchpipe.bond.period import Period, period_of
from churchpipe.errors import Extra, InputError
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.materials import Elastic

if TYPE_CHECKING:
    import skfem

# Elements are at most so long, over the least of course height, stone length and twice the thickness of a leaf.
_ELEMENT = 1.5
# The stiffness is symmetric but for rounding, which may be at most this share.
_SKEW = 1e-6
# Places nearer than this share of a joint's thickness are one.
_SAME = 1e-3
# So many elements are assembled at a time, for memory.
_CHUNK = 128


@lru_cache(maxsize=256)
def cell_stiffness(bond: str, a: float, b: float, h: float, elastic: Elastic, element: float = _ELEMENT) -> FloatArray:
    """Return the stiffness (6, 6) of a wall, N/m and N m, as `stiffness.wall_stiffness`, for headers or one leaf.

    a, b: height and length of a stone without its joints, m; h: thickness of the wall, m. element: largest side of an element,
    over the least of a, b and twice the thickness of a leaf. With the one given the stiffness is at most 1 % above that of fine
    meshes, in twisting 2 % where leaves are thinner than courses are high.

    Raises
    ------
    InputError: unknown bond; stones and mortar so unlike that rounding hides the stiffness; scikit-fem is not installed.
    """
    with Extra("the stiffness of a shell"):
        import skfem

    t = elastic.joint_thickness
    period = period_of(bond, a + t, b + t, h)
    stones, size = _repeated(period)
    longest = element * min(a, b, 2 * float(np.ptp(period.stones[:, 2], axis=1).min()))
    mesh = skfem.MeshHex.init_tensor(*_lines(stones, size, h, t, longest))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex2()), intorder=4)
    stone = _in_stones(np.asarray(mesh.p[:, mesh.t].mean(axis=1).T), stones, h, t)
    modulus, poisson = (
        np.where(stone, *pair)
        for pair in ((elastic.block_modulus, elastic.joint_modulus), (elastic.block_poisson, elastic.joint_poisson))
    )
    lame, shear = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson)), modulus / (2 * (1 + poisson))

    fold = _fold(basis, size, _SAME * t)
    whole, forces, own = _assembled(basis, lame, shear)
    reduced = sp.csc_matrix(fold.T @ whole @ fold)
    right = np.asarray(fold.T @ forces)
    factor = sp.linalg.splu(reduced, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    found = np.asarray(own - right.T @ factor.solve(right)) / size.prod()
    out = (found + found.T) / 2
    scale = np.sqrt(np.abs(np.diag(out)))
    skew = float((np.abs(found - found.T) / np.outer(scale, scale)).max())
    if not (skew < _SKEW and np.linalg.eigvalsh(out / np.outer(scale, scale)).min() > 0):
        raise InputError(
            "elastic",
            "stones and mortar are so unlike that rounding hides the stiffness of the wall",
            found=f"moduli {elastic.block_modulus:.3g} and {elastic.joint_modulus:.3g} Pa, joints of {t:.3g} m",
            expected="moduli and thicknesses of masonry",
        )
    out.setflags(write=False)
    return out


def _repeated(period: Period) -> tuple[FloatArray, FloatArray]:
    """Return the stones (n, 3, 2) that touch a rectangle which repeats without a shift, corner at zero, and its sides (2,)."""
    first, second = period.steps
    size = np.array([first[0], second[1] * (2 if second[0] else 1)])
    steps = [i * first + j * second for i in range(-2, 3) for j in range(-2, 3)]
    stones = np.concatenate([period.stones + np.append(step, 0.0)[:, None] for step in steps])
    near = (stones[:, :2, 1] >= 0).all(axis=1) & (stones[:, :2, 0] <= size).all(axis=1)
    return stones[near], size


def _lines(stones: FloatArray, size: FloatArray, h: float, t: float, longest: float) -> list[FloatArray]:
    """Return the lines of a mesh along, up and through the wall: at both faces of each joint, and no further apart than asked."""
    out: list[FloatArray] = []
    for axis, (low, high) in enumerate(((0.0, size[0]), (0.0, size[1]), (-h / 2, h / 2))):
        faces = stones[:, axis].ravel()
        if axis == 2:
            faces = faces[np.abs(faces) < h / 2 - t]
        near = np.concatenate([faces - t / 2, faces + t / 2])
        places = np.sort(np.concatenate([[low, high], near[(near > low) & (near < high)]]))
        places = places[np.append(True, np.diff(places) > _SAME * t)]
        parts = [
            np.linspace(start, end, int(np.ceil((end - start) / longest)), endpoint=False) for start, end in pairwise(places)
        ]
        out.append(np.append(np.concatenate(parts), high))
    return out


def _in_stones(place: FloatArray, stones: FloatArray, h: float, t: float) -> BoolArray:
    """Return which places (n, 3) lie in a stone: half a joint within its sides, but not within the faces of the wall."""
    out = np.zeros(len(place), dtype=np.bool_)
    for box in stones:
        joint = np.full((3, 2), t / 2)
        joint[2, np.abs(box[2]) > h / 2 - t] = 0.0
        low, high = (box + joint * [1, -1]).T
        out |= ((place > low) & (place < high)).all(axis=1)
    return out


def _assembled(
    basis: "skfem.Basis", lame: FloatArray, shear: FloatArray
) -> tuple[sp.csr_matrix[np.float64], FloatArray, FloatArray]:
    """Return the stiffness of a mesh, the forces (dofs, 6) of each unit strain of the wall, and the work (6, 6) of each on each.

    lame, shear (elements,). Strains are those along the three axes, then the slidings 12, 13, 23. The loops of scikit-fem over
    pairs of shape functions take ten times as long.
    """
    table = np.asarray(basis.element_dofs).T
    count, shapes = table.shape
    matrix, forces = np.empty((count, shapes, shapes)), np.zeros((basis.N, 6))
    own = np.zeros((6, 6))
    for start in range(0, count, _CHUNK):
        part = slice(start, start + _CHUNK)
        strain = np.stack([_sliding(np.asarray(field[0].grad)[:, :, part]) for field in basis.basis])
        wall = _wall_strains(np.asarray(basis.global_coordinates()[2])[part])
        each = [np.moveaxis(v, (0, 1), (3, 2)).reshape(v.shape[2], -1, v.shape[0]) for v in (strain, wall)]
        law, dx = (lame[part, None], shear[part, None]), np.asarray(basis.dx)[part]
        work = [np.moveaxis(_stress(v, *law) * dx, (0, 1), (3, 2)).reshape(v.shape[2], -1, v.shape[0]) for v in (strain, wall)]
        matrix[part] = np.swapaxes(each[0], 1, 2) @ work[0]
        np.add.at(forces, table[part], np.swapaxes(each[0], 1, 2) @ work[1])
        own += (np.swapaxes(each[1], 1, 2) @ work[1]).sum(axis=0)
    rows, columns = np.repeat(table, shapes, axis=1), np.tile(table, (1, shapes))
    return sp.csr_matrix((matrix.ravel(), (rows.ravel(), columns.ravel())), shape=(basis.N, basis.N)), forces, own


def _sliding(grad: FloatArray) -> FloatArray:
    """Return the strains (6, ...) of gradients of displacement (3, 3, ...)."""
    sums = grad + np.swapaxes(grad, 0, 1)
    return np.stack([*(0.5 * sums[i, i] for i in range(3)), sums[0, 1], sums[0, 2], sums[1, 2]])


def _stress(strain: FloatArray, lame: FloatArray, shear: FloatArray) -> FloatArray:
    """Return the stresses of strains (n, 6, ...)."""
    out = shear * strain
    out[:, :3] *= 2.0
    out[:, :3] += lame * strain[:, :3].sum(axis=1, keepdims=True)
    return out


def _wall_strains(z: FloatArray) -> FloatArray:
    """Return the strains (6, 6, *z.shape) at depths z of each unit strain (E11, E22, 2 E12, chi11, chi22, 2 chi12)."""
    out = np.zeros((6, 6, *z.shape))
    for place, component in enumerate((0, 1, 3)):
        out[place, component], out[3 + place, component] = 1.0, z
    return out


def _fold(basis: "skfem.Basis", size: FloatArray, near: float) -> sp.csr_matrix[np.float64]:
    """Return the matrix that gives nodes a period apart the same displacement, and none to one of them, which may move freely."""
    component = np.zeros(basis.N, dtype=np.int64)
    for table in (basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs, basis.interior_dofs):
        component[table] = np.arange(3)[:, None]
    place = basis.doflocs.copy()
    place[:2] = np.mod(place[:2] + near, size[:, None])
    key = np.column_stack([np.round(place.T / (4 * near)).astype(np.int64), component])
    _, same = np.unique(key, axis=0, return_inverse=True)
    whole = sp.csc_matrix((np.ones(basis.N), (np.arange(basis.N), same.ravel())))
    return sp.csr_matrix(whole[:, 3:])
