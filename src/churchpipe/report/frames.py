"""The real path of the stones as a series of files for ParaView."""

from pathlib import Path

import numpy as np

from churchpipe.io.atomic import write_text
from churchpipe.io.vtu import write_vtu
from churchpipe.large_displacements.poses import Poses, displaced, rotation_vectors, screw
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.settlement import SettlementPath

# Of a longer path so many steps are kept, the first and the last among them.
_FRAMES = 16


def write_path(series: Path, stones: Assemblage, path: BlockCapacityCurve | SettlementPath) -> None:
    """Write a path as `series`, a .pvd file, and a .vtu file a step beside it.

    Its time is the displacement or the movement; the number of the step, where these do not grow at every step that is kept. The
    stones are where they are at the step; the velocities of each file lead to the next one. Cell data `fallen`: 1 of stones that
    have fallen by then, which stay where they fell. No steps: no series.
    """
    travel = path.displacement if isinstance(path, BlockCapacityCurve) else path.movement
    for old in series.parent.glob(f"{series.stem}_*.vtu"):
        old.unlink()
    if not len(travel):
        series.unlink(missing_ok=True)
        return
    lines: list[str] = []
    kept = frames(len(travel))
    # Viewers put files in the order of their times, and those of one time on top of each other. A control point may go to and
    # fro, or stand still with the stone that it is of.
    times = [f"{value:.9g}" for value in travel[kept]]
    if (np.diff(np.array(times, dtype=float)) <= 0).any():
        times = [str(step + 1) for step in kept]
    for number, step in enumerate(kept):
        after = kept[min(number + 1, len(kept) - 1)]
        file = series.with_name(f"{series.stem}_{number:02d}.vtu")
        there = placed(stones, path.position[step], path.rotation[step])
        write_vtu(file, there, _between(path, step, after), _fallen(path, step))
        lines.append(f'    <DataSet timestep="{times[number]}" part="0" file="{file.name}"/>')
    text = "\n".join(['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>", *lines])
    write_text(series, text + "\n  </Collection>\n</VTKFile>\n")


def frames(steps: int) -> IntArray:
    """Return which of so many steps stand for the path."""
    return np.unique(np.linspace(0, steps - 1, min(steps, _FRAMES)).round().astype(np.int64))


def placed(stones: Assemblage, position: FloatArray, rotation: FloatArray) -> Assemblage:
    """Return the stones where their centroids (nb, 3) m and rotation vectors (nb, 3) rad put them."""
    return displaced(stones, Poses(position, screw(rotation)[0]))


def _fallen(path: BlockCapacityCurve | SettlementPath, step: int) -> BoolArray:
    """Return which stones (nb,) have fallen by a step."""
    fallen = np.zeros(path.position.shape[1], dtype=bool)
    for part in path.fallen:
        fallen[part.stones] |= part.step < step
    return fallen


def _between(path: BlockCapacityCurve | SettlementPath, step: int, after: int) -> FloatArray:
    """Return how the stones go on (nb, 6), m and rad, from one step to another."""
    # Rotation vectors do not add up about axes that change, and jump where a stone has turned by half a turn.
    before, then = (screw(path.rotation[one])[0] for one in (step, after))
    turn = rotation_vectors(np.einsum("kij,klj->kil", then, before))
    return np.concatenate([path.position[after] - path.position[step], turn], axis=1)
