"""Dead load and lateral load of a shell, per area of facet."""

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray
from churchpipe.model.loads import LoadCase, pushed_share
from churchpipe.model.shell import ShellModel


def dead_pressure(shell: ShellModel) -> FloatArray:
    """Return the self-weight (nt, 3), N/m2."""
    return shell.surface_weight[:, None] * np.array([0.0, 0.0, -1.0])


def live_pressure(shell: ShellModel, load: LoadCase) -> FloatArray:
    """Return the lateral load at load factor 1 (nt, 3), N/m2.

    Raises
    ------
    InputError: unknown panels, nothing to push, wrenches: they belong to stones, as a load without a direction does.
    """
    if load.dead is not None or load.live is not None:
        raise InputError(f"load {load.name}", "extra wrenches act on stones", expected="no dead or live wrenches for a shell")
    height = shell.points[shell.triangles, 2].mean(axis=1) - shell.points[:, 2].min()
    share = pushed_share(load, shell.panel, shell.weight, height) * shell.surface_weight
    if not share.any():
        raise InputError(f"load {load.name}", "nothing to push", expected="panels with weight")
    return share[:, None] * load.direction
