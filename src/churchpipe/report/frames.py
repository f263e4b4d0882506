"""The real path of the stones as a series of files for ParaView."""

from pathlib import Path

import numpy as np

from churchpipe.io.atomic import write_text
from churchpipe.io.vtu import write_vtu
from churchpipe.large_displacements.poses import Poses, displaced, rotation_vectors, screw
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.settlement import SettlementPath

# Of a longer path so many steps are kept, the first and the last among them.
_FRAMES = 16


def write_path(series: Path, stones: Assemblage, path: BlockCapacityCurve | SettlementPath) -> None:
    """Write a path as `series`, a .pvd file whose time is the displacement or the movement, and a .vtu file a step beside it.

    The stones are where they are at the step; the velocities of each file lead to the next one. No steps: no series.
    """
    time = path.displacement if isinstance(path, BlockCapacityCurve) else path.movement
    for old in series.parent.glob(f"{series.stem}_*.vtu"):
        old.unlink()
    if not len(time):
        series.unlink(missing_ok=True)
        return
    lines: list[str] = []
    kept = frames(len(time))
    for number, step in enumerate(kept):
        after = kept[min(number + 1, len(kept) - 1)]
        file = series.with_name(f"{series.stem}_{number:02d}.vtu")
        write_vtu(file, placed(stones, path.position[step], path.rotation[step]), _between(path, step, after))
        lines.append(f'    <DataSet timestep="{time[step]:.9g}" part="0" file="{file.name}"/>')
    text = "\n".join(['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>", *lines])
    write_text(series, text + "\n  </Collection>\n</VTKFile>\n")


def frames(steps: int) -> IntArray:
    """Return which of so many steps stand for the path."""
    return np.unique(np.linspace(0, steps - 1, min(steps, _FRAMES)).round().astype(np.int64))


def placed(stones: Assemblage, position: FloatArray, rotation: FloatArray) -> Assemblage:
    """Return the stones where their centroids (nb, 3) m and rotation vectors (nb, 3) rad put them."""
    return displaced(stones, Poses(position, screw(rotation)[0]))


def _between(path: BlockCapacityCurve | SettlementPath, step: int, after: int) -> FloatArray:
    """Return how the stones go on (nb, 6), m and rad, from one step to another."""
    # Rotation vectors do not add up about axes that change, and jump where a stone has turned by half a turn.
    before, then = (screw(path.rotation[one])[0] for one in (step, after))
    turn = rotation_vectors(np.einsum("kij,klj->kil", then, before))
    return np.concatenate([path.position[after] - path.position[step], turn], axis=1)
