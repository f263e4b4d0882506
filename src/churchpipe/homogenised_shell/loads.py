"""Dead load and lateral load of a shell: per area of facet, and as wrenches on facets."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.element import ShellElements, surface_load
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase, pushed_share
from churchpipe.model.shell import ShellModel


def dead_pressure(shell: ShellModel) -> FloatArray:
    """Return the self-weight (nt, 3), N/m2."""
    return shell.surface_weight[:, None] * np.array([0.0, 0.0, -1.0])


def live_pressure(shell: ShellModel, load: LoadCase) -> FloatArray:
    """Return the weight pushed sideways at load factor 1 (nt, 3), N/m2.

    Raises
    ------
    InputError: unknown panels, a direction and nothing to push in it.
    """
    height = shell.centroid[:, 2] - shell.points[:, 2].min()
    share = pushed_share(load, shell.panel, shell.weight, height) * shell.surface_weight
    if load.direction.any() and not share.any():
        raise InputError(f"load {load.name}", "nothing to push", expected="panels with weight")
    return share[:, None] * load.direction


def dead_load(elements: ShellElements, load: LoadCase) -> FloatArray:
    """Return the work-conjugate forces (n,), N and Nm, of the self-weight and of the load case's dead wrenches.

    Raises
    ------
    InputError: wrenches that are not those of the facets.
    """
    return surface_load(elements, dead_pressure(elements.shell)) + _facet_load(elements, "LoadCase.dead", load.dead)


def live_load(elements: ShellElements, load: LoadCase) -> FloatArray:
    """Return the same of the lateral load at load factor 1: the weight pushed, and the load case's live wrenches.

    Raises
    ------
    InputError: as `live_pressure`, and as `dead_load`.
    """
    return surface_load(elements, live_pressure(elements.shell, load)) + _facet_load(elements, "LoadCase.live", load.live)


def _facet_load(elements: ShellElements, name: str, wrench: FloatArray | None) -> FloatArray:
    """Return the forces (n,) at nodes of wrenches (nt, 6) N and Nm about the facets' centroids: `nodal_forces`."""
    shell = elements.shell
    out = np.zeros(elements.unknowns)
    if wrench is None:
        return out
    if wrench.shape != (len(shell.triangles), 6):
        remedy = "churchpipe.shell_loaded puts what a building carries on the facets of its shell."
        raise InputError(name, "wrong shape", found=wrench.shape, expected=f"({len(shell.triangles)}, 6)", remedy=remedy)
    nodes = nodal_forces(shell, wrench)
    out[: nodes.size] = nodes.ravel()
    return out


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
