"""Mid-surfaces divided into triangles by gmsh. No other module imports gmsh."""

import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from churchpipe.errors import Extra, InputError
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.shell_mesh.subdivision import Subdivision


@dataclass(frozen=True, slots=True)
class Mesh:
    """Facets of one mid-surface: corners (nt, 3, 2) m in chart coordinates, counter-clockwise; bond (nt,) its region of each."""

    corners: FloatArray
    bond: IntArray


def triangulated(cuts: Sequence[Subdivision], names: Sequence[str]) -> list[Mesh]:
    """Return the mesh of each mid-surface, in its chart: walls share nodes because they divide shared edges alike.

    names: of the walls, for messages.

    Raises
    ------
    InputError: gmsh cannot mesh one.
    """
    with _gmsh() as gmsh:
        return [_mesh(gmsh, cut, name) for cut, name in zip(cuts, names, strict=True)]


def signed_areas(corners: FloatArray) -> FloatArray:
    """Return the areas (n,) m2 of triangles with corners (n, 3, 2) m, negative where these run clockwise."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


@contextmanager
def _gmsh() -> Iterator[Any]:
    with Extra("the mesh of a shell"):
        import gmsh

    mine = not gmsh.isInitialized()
    if mine:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        _keep_broken_pipes()
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        yield gmsh
    finally:
        if mine:
            gmsh.finalize()


def _keep_broken_pipes() -> None:
    """Make writing to a closed pipe raise an exception again. Gmsh makes it end the process. Only the main thread can change
    that.
    """
    if not hasattr(signal, "SIGPIPE") or threading.current_thread() is not threading.main_thread():
        return
    handler = signal.getsignal(signal.SIGPIPE)
    if handler is not None:
        signal.signal(signal.SIGPIPE, handler)


def _mesh(gmsh: Any, cut: Subdivision, name: str) -> Mesh:
    gmsh.model.add(name)
    try:
        geo = gmsh.model.geo
        ends = cut.corners[cut.edges]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        pieces = np.maximum(np.ceil(length / cut.size - 1e-6), 1).astype(int)
        size = np.full(len(cut.corners), np.inf)
        np.minimum.at(size, cut.edges, np.broadcast_to((length / pieces)[:, None], cut.edges.shape))
        for number, (s, t) in enumerate(cut.corners):
            geo.addPoint(s, t, 0.0, size[number], number + 1)
        for number, (start, stop) in enumerate(cut.edges):
            geo.addLine(start + 1, stop + 1, number + 1)
            geo.mesh.setTransfiniteCurve(number + 1, int(pieces[number]) + 1)
        lines = {(int(start), int(stop)): number + 1 for number, (start, stop) in enumerate(cut.edges)}
        for face, loops in enumerate(cut.loops):
            rings = [
                geo.addCurveLoop([_signed(lines, *pair) for pair in zip(ring, np.roll(ring, -1), strict=True)]) for ring in loops
            ]
            geo.addPlaneSurface(rings, face + 1)
        geo.synchronize()
        gmsh.model.mesh.generate(2)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        place[tags.astype(np.int64)] = np.arange(len(tags))
        nodes = np.asarray(coordinates).reshape(-1, 3)[:, :2]
        facets = [gmsh.model.mesh.getElementsByType(2, face + 1)[1].astype(np.int64) for face in range(len(cut.loops))]
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"wall {name}", "its mid-surface cannot be meshed", found=error) from error
    finally:
        gmsh.model.remove()
    corners = nodes[place[np.concatenate(facets)]].reshape(-1, 3, 2)
    turned = signed_areas(corners) < 0
    corners[turned] = corners[turned][:, ::-1]
    return Mesh(corners, np.repeat(cut.bond, [len(facet) // 3 for facet in facets]))


def _signed(lines: Mapping[tuple[int, int], int], start: int, stop: int) -> int:
    return lines[start, stop] if start < stop else -lines[stop, start]
