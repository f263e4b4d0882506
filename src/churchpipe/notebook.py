"""Pictures and diagrams for notebooks."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from churchpipe.errors import Extra, InputError
from churchpipe.model.arguments import check_kind
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.contacts import Contacts
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState
from churchpipe.model.settlement import SettlementPath
from churchpipe.model.shell import ShellModel

_OBLIQUE = np.array([0.55, -0.75, 0.4]) / np.linalg.norm([0.55, -0.75, 0.4])


def plot(curve: CapacityCurve | BlockCapacityCurve | SettlementPath) -> Any:
    """Return the diagram of a capacity curve or of a support that moves, as a matplotlib figure.

    Parameters
    ----------
    curve
        Of the shell, from `pushover`, or of the stones, from `block_pushover`: load factor against displacement. Of a support,
        from `settlement_path`: reaction against movement.

    Raises
    ------
    InputError
        Not a curve, or one without steps; a package of `churchpipe[all]` is missing.
    """
    check_kind("plot: curve", curve, CapacityCurve, BlockCapacityCurve, SettlementPath)
    with Extra("a diagram"):
        from churchpipe.report.plots import new_plot

        figure, (axes,) = new_plot(1, (6.4, 3.4))
    if isinstance(curve, SettlementPath):
        # The path does not say whether its support moves along or turns.
        place, values, names = curve.movement, curve.reaction, ("movement of the support, m or rad", "reaction, N or Nm")
    else:
        place = 1e3 * (curve.control if isinstance(curve, CapacityCurve) else curve.displacement)
        values, names = curve.load_factor, ("displacement along the load, mm", "load factor")
    if not len(values):
        raise InputError("plot: curve", "a curve without steps", found=curve.status, expected="at least one step")
    axes.plot(place, values, "-o", ms=3, lw=1.4)
    axes.set_xlabel(names[0])
    axes.set_ylabel(names[1])
    if values.min() >= 0:
        axes.set_ylim(bottom=0)
    return figure


def show(model: Assemblage | Contacts | ShellModel, state: LimitState | ShellLimitState | CapacityCurve | None = None) -> Any:
    """Return a picture of a model, of its joints, or of its mechanism, that a notebook shows.

    Parameters
    ----------
    model
        The stones, their joints (coloured by kind), or the shell.
    state
        A result of the same model: stones are displaced and coloured by their speed, a shell by its plastic strain. None: the
        model as it stands.

    Returns
    -------
    PIL.Image.Image
        The picture; its own `show` opens it in a window.

    Raises
    ------
    InputError
        A result of another kind or of another model; a package of `churchpipe[all]` is missing.
    """
    with Extra("a picture"):
        from PIL import Image

        from churchpipe.report.figures import joints_picture, mechanism_picture
        from churchpipe.report.shell_picture import shell_picture
        from churchpipe.report.shell_view import motion_of
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        if isinstance(model, Assemblage):
            velocities = None if state is None else _velocities(state, model)
            mechanism_picture(model, velocities, path)
        elif isinstance(model, Contacts):
            if state is not None:
                raise InputError("show: model", "joints alone have no mechanism", found="Contacts", expected="stones or a shell")
            if not len(model.blocks):
                raise InputError("show: model", "no joints to show", found="none", expected="at least one")
            joints_picture(model, path, _OBLIQUE)
        else:
            check_kind("show: model", model, Assemblage, Contacts, ShellModel)
            motion, plastic = np.zeros((len(model.points), 3)), np.zeros((len(model.triangles), 6))
            if state is not None:
                found = _of_shell(state, model)
                motion, plastic = motion_of(found), np.nan_to_num(found.plastic)
            shell_picture(model, motion, plastic, path, _OBLIQUE)
        with Image.open(path) as picture:
            return picture.convert("RGB")


def _velocities(state: object, stones: Assemblage) -> Any:
    if not isinstance(state, LimitState) or len(state.velocities) != stones.count:
        raise InputError("show: state", "not a result of these stones", found=type(state).__name__, expected="their LimitState")
    return np.nan_to_num(state.velocities)


def _of_shell(state: object, shell: ShellModel) -> Any:
    motion = getattr(state, "velocities" if isinstance(state, ShellLimitState) else "displacement", ())
    if not isinstance(state, ShellLimitState | CapacityCurve) or len(motion) != len(shell.points):
        raise InputError("show: state", "not a result of this shell", found=type(state).__name__, expected="a result of it")
    return state
