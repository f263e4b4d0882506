"""Dead load and lateral load of a shell: per area of facet, as wrenches on facets, and as vectors of its unknowns."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.element import ShellElements, node_load, surface_load
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase, pushed_share
from churchpipe.model.shell import ShellModel


@dataclass(frozen=True, slots=True)
class LoadVectors:
    """equilibrium (m, 6 nq) stress = dead + load live, for the unknowns that are free.

    Units: forces over the shell's weight `weight`, N; lengths in m; stresses over `unit` (nq, 6), N/m and N.
    """

    equilibrium: sp.csr_matrix[np.float64]
    dead: FloatArray
    live: FloatArray
    unit: FloatArray
    weight: float


def dead_pressure(shell: ShellModel) -> FloatArray:
    """Return the self-weight (nt, 3), N/m2."""
    return shell.surface_weight[:, None] * np.array([0.0, 0.0, -1.0])


def live_pressure(shell: ShellModel, load: LoadCase) -> FloatArray:
    """Return the weight pushed sideways at load factor 1 (nt, 3), N/m2.

    Raises
    ------
    InputError: as `pushed`.
    """
    return (pushed(shell, load)[: len(shell.triangles)] * shell.surface_weight)[:, None] * load.direction


def pushed(shell: ShellModel, load: LoadCase) -> FloatArray:
    """Return the share of the weight of facets and beams (nt + nm,) that a load pushes at load factor 1.

    Raises
    ------
    InputError: unknown panels, a direction and nothing to push in it.
    """
    weight = shell.body_weight
    share = pushed_share(load, shell.body_panel, weight, shell.body_centroid[:, 2] - shell.points[:, 2].min())
    if load.direction.any() and not (share * weight).any():
        raise InputError(f"load {load.name}", "nothing to push", expected="panels with weight")
    return share


def dead_load(elements: ShellElements, load: LoadCase) -> FloatArray:
    """Return the work-conjugate forces (n,), N and Nm, of the self-weight and of the load case's dead wrenches.

    Raises
    ------
    InputError: wrenches that are not those of the facets and beams.
    """
    shell = elements.shell
    own = surface_load(elements, dead_pressure(shell)) + _of_beams(elements, shell.beams.weight, np.array([0.0, 0.0, -1.0]))
    return own + _given(elements, "LoadCase.dead", load.dead, load.dead_nodes)


def live_load(elements: ShellElements, load: LoadCase) -> FloatArray:
    """Return the same of the lateral load at load factor 1: the weight pushed, and the load case's live wrenches.

    Raises
    ------
    InputError: as `live_pressure`, and as `dead_load`; a load that multiplies what it was not given.
    """
    if load.multiplies and (load.live is None or not load.live.any()):
        remedy = "churchpipe.shell_loaded gives it what the building carries."
        raise InputError(
            f"load {load.name}", "nothing is pushed", expected=f"loads named {', '.join(load.multiplies)}", remedy=remedy
        )
    shell = elements.shell
    share = pushed(shell, load)[len(shell.triangles) :]
    own = surface_load(elements, live_pressure(shell, load)) + _of_beams(elements, share * shell.beams.weight, load.direction)
    return own + _given(elements, "LoadCase.live", load.live, load.live_nodes)


def load_vectors(elements: ShellElements, load: LoadCase) -> LoadVectors:
    """Return equilibrium and loads of the unknowns that are free.

    Raises
    ------
    InputError: as `live_load`; no weight.
    """
    shell = elements.shell
    weight = float(shell.body_weight.sum())
    if weight == 0:
        raise InputError("shell", "no weight", expected="surface_weight > 0 somewhere")
    h = shell.thickness[elements.facet]
    # Joints have forces alone, which do work on the motions of their corners.
    h[elements.inner :] = 1.0
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


def _of_beams(elements: ShellElements, force: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the forces (n,) of forces (nm,) N on the beams in one direction (3,)."""
    wrench = np.zeros((len(elements.shell.triangles) + len(force), 6))
    wrench[len(elements.shell.triangles) :, :3] = force[:, None] * direction
    return body_forces(elements, wrench)


def _given(elements: ShellElements, name: str, wrench: FloatArray | None, nodes: FloatArray | None) -> FloatArray:
    """Return the forces (n,) of the wrenches that a load case gives, if any, and of what of them acts on nodes and mid-sides."""
    if wrench is None:
        return np.zeros(elements.unknowns)
    shell = elements.shell
    for found, item, expected in (
        (wrench, name, (len(shell.body_weight), 6)),
        (nodes, f"{name}_nodes", (len(shell.triangles), 9, 3)),
    ):
        if found is not None and found.shape != expected:
            remedy = "churchpipe.shell_loaded puts what a building carries on the facets of its shell."
            raise InputError(item, "wrong shape", found=found.shape, expected=str(expected), remedy=remedy)
    if nodes is None:
        return body_forces(elements, wrench)
    on_corners = nodes[:, :3]
    arm = shell.points[shell.triangles] - shell.centroid[:, None]
    rest = wrench.copy()
    rest[: len(nodes), :3] -= on_corners.sum(axis=1)
    rest[: len(nodes), 3:] -= np.cross(arm, on_corners).sum(axis=1) + nodes[:, 6:].sum(axis=1)
    corners = np.zeros((len(shell.points), 3))
    np.add.at(corners, shell.triangles, on_corners)
    return body_forces(elements, rest) + node_load(elements, corners, nodes[:, 3:6], nodes[:, 6:])


def body_forces(elements: ShellElements, wrench: FloatArray) -> FloatArray:
    """Return the forces (n,) of wrenches (nt + nm, 6) N and Nm on facets and beams, about their centroids."""
    own = np.zeros(elements.motion.shape[0])
    on_facets, on_beams = np.split(wrench, [len(elements.shell.triangles)])
    nodes = nodal_forces(elements.shell, on_facets)
    own[: nodes.size] = nodes.ravel()
    return elements.conjugate(own, on_beams)


def nodal_forces(shell: ShellModel, wrench: FloatArray) -> FloatArray:
    """Return the forces (nn, 3) N at the nodes of wrenches (nt, 6) N and Nm about the facets' centroids.

    Each corner takes a third of the force; the moment M becomes the least forces w x r at the corners r that have it, with
    M = sum r x (w x r).
    """
    arm = shell.points[shell.triangles] - shell.centroid[:, None]
    inertia = (arm**2).sum(axis=(1, 2))[:, None, None] * np.eye(3) - np.einsum("fkc,fkd->fcd", arm, arm)
    turn = np.linalg.solve(inertia, wrench[:, 3:, None])[:, :, 0]
    nodes = np.zeros((len(shell.points), 3))
    np.add.at(nodes, shell.triangles, wrench[:, None, :3] / 3 + np.cross(turn[:, None], arm))
    return nodes
