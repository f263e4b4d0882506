"""The far ends of buttresses and of other walls that stand in what presses on a wall."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.bare import bare_triangles
from churchpipe.geometry.charts import way
from churchpipe.geometry.polygons import behind
from churchpipe.geometry.walls import WallLine, wall_line
from churchpipe.loading.bearing import CLOSE
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.buttress import is_buttress
from churchpipe.model.carried import Pressure
from churchpipe.model.polyhedra import face_normals

# A face bears pressure if it looks against it to this cosine, and lies within this share of the thickness of the wall's face.
AGAINST = 0.9
OUTERMOST = 0.05


def outward_of(wall: WallLine, load: Pressure) -> FloatArray:
    """Return where the face of a wall looks (3,) on which a pressure acts.

    Raises
    ------
    InputError: a direction along the wall.
    """
    return -wall.side(load.called, load.toward) * np.append(wall.normal, 0.0)


def pressed_ends(stones: Assemblage, wall: WallLine, load: Pressure) -> Iterator[tuple[int, FloatArray, FloatArray]]:
    """Yield what a pressure acts on at the far ends of buttresses and of what else a load names: a stone, the normal (3,) and the
    corners (k, 3) m of a part of a face of it.

    Raises
    ------
    InputError: a name of what does not stand before the face of the wall.
    """
    before = _before(stones, wall, outward_of(wall, load))
    names = before.names()
    for name in load.ends or ():
        if name not in names:
            expected = ", ".join(names) or "nothing: no wall stands there"
            problem = f"it does not stand against the face of the wall {wall.name}"
            raise InputError(f"{load.called}: ends", problem, found=name, expected=expected)
    yield from before.ends([name for name in names if _is_pressed(load, name)])


def unpressed_ends(stones: Assemblage, load: Pressure) -> list[str]:
    """Return what to ask about walls that stand in what presses on a wall, and on whose far ends it does not act.

    The far end of a wall that meets another one there is none: it closes a room.

    Raises
    ------
    InputError: as `pressed_ends`, and as `wall_line`.
    """
    if load.ends is not None:
        return []
    wall = wall_line(stones, load.wall, load.called)
    before = _before(stones, wall, outward := outward_of(wall, load))
    left = [name for name in before.names() if not _is_pressed(load, name) and not before.closed(name)]
    left = [name for name in left if any(part[:, 2].min() < load.top - CLOSE for _, _, part in before.ends([name]))]
    if not left:
        return []
    names, quoted = " and of ".join(left), ", ".join(f'"{name}"' for name in left)
    stand, their, end = ("stands", "its", "end") if len(left) == 1 else ("stand", "their", "ends")
    called = load.called[0].upper() + load.called[1:]
    return [
        f"{called} acts on the face of the wall {wall.name} that looks to {way(outward)}, and not on the far {end} of {names}, "
        f"which {stand} in what presses: {their} width bears nothing. Is it meant? ends = [{quoted}] makes it press there, too, "
        "and ends = [] says that it does not."
    ]


def _is_pressed(load: Pressure, name: str) -> bool:
    return is_buttress(name) if load.ends is None else name in load.ends


@dataclass(frozen=True, slots=True)
class _Before:
    """Stones seen along a wall, out of its face and up: frame (3, 3), and how far each stone reaches, low, high (nb, 3) m; where
    the face is, m, with a slack."""

    stones: Assemblage
    wall: WallLine
    frame: FloatArray
    low: FloatArray
    high: FloatArray
    face: float
    slack: float

    def names(self) -> list[str]:
        """Return the names of the walls that stand against the face, between the ends of the wall, and reach out of it."""
        panel = self.stones.panel
        names = np.unique(panel[~self.stones.fixed]).tolist()
        return [name for name in names if name not in ("", self.wall.name) and len(self._reaching(name))]

    def ends(self, names: Collection[str]) -> Iterator[tuple[int, FloatArray, FloatArray]]:
        """Yield what shows of these walls before the face and looks away from it, as `pressed_ends`."""
        axis, outward, _ = self.frame
        owner = np.repeat(np.arange(self.stones.count), np.diff(self.stones.block_face_ptr))
        _, normal, mean = face_normals(self.stones.points, self.stones.face_nodes, self.stones.face_ptr)
        looks = (normal @ outward > AGAINST) & (mean @ outward > self.face + self.slack)
        for name in names:
            own = self._reaching(name)
            for face, triangles in bare_triangles(self.stones, np.flatnonzero(looks & np.isin(owner, own))):
                for part in triangles:
                    inner = behind(behind(part, axis, self._along(1)), -axis, -self._along(0))
                    # A joint that is drawn open is no end: more of the same wall stands before it.
                    if len(inner) and not self._is_hidden(part.mean(axis=0), own):
                        yield int(owner[face]), normal[face], inner

    def closed(self, name: str) -> bool:
        """Return whether another wall stands at the far end of one that reaches out of the face."""
        own = self._reaching(name)
        low, high = self.low[own].min(axis=0), self.high[own].max(axis=0)
        # Where courses are toothed, the wall across has stones within the last thickness of this one.
        low[1] = max(high[1] - (high[0] - low[0]), self.face + self.slack)
        free = ~self.stones.fixed & ~np.isin(self.stones.panel, [name, self.wall.name])
        # What lies on top, as a beam does, closes nothing.
        near = np.array([CLOSE, CLOSE, -CLOSE])
        return bool((free & ((self.low <= high + near) & (self.high >= low - near)).all(axis=1)).any())

    def _along(self, end: int) -> float:
        return float(self.wall.origin @ self.wall.axis) + end * self.wall.length

    def _reaching(self, name: str) -> IntArray:
        """Return the stones of a wall that reach out of the face, none if that wall does not touch it."""
        foot = float(self.low[self.wall.stones, 2].min())
        own = ~self.stones.fixed & (self.stones.panel == name) & (self.high[:, 2] > foot + CLOSE)
        own &= (self.low[:, 2] < self.wall.top - CLOSE) & (self.high[:, 0] > self._along(0) + self.slack)
        own &= self.low[:, 0] < self._along(1) - self.slack
        touches = own & (self.low[:, 1] < self.face + self.slack)
        return np.flatnonzero(own & (self.high[:, 1] > self.face + self.slack)) if touches.any() else np.zeros(0, dtype=np.int64)

    def _is_hidden(self, point: FloatArray, own: IntArray) -> bool:
        along, out, up = self.frame @ point
        near = (self.low[own, 0] < along) & (self.high[own, 0] > along) & (self.low[own, 2] < up) & (self.high[own, 2] > up)
        return bool((near & (self.high[own, 1] > out + self.slack)).any())


def _before(stones: Assemblage, wall: WallLine, outward: FloatArray) -> _Before:
    frame = np.array([np.append(wall.axis, 0.0), outward, [0.0, 0.0, 1.0]])
    local = stones.points @ frame.T
    low, high = (edge.reduceat(local, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    return _Before(stones, wall, frame, low, high, float(high[wall.stones, 1].max()), OUTERMOST * wall.thickness + CLOSE)
