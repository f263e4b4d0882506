"""A straight wall in plan, read off its stones."""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.charts import way
from churchpipe.model.arrays import FloatArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.polyhedra import face_normals

# A face of a straight wall lies along it or across it, to this sine; share of the faces' area that may do neither.
_SLANT = 0.1
_BENT = 0.05
_UPRIGHT = 0.1
# What a message expects of stones without any.
_NAMED = (
    "stones with names of walls: the groups of an OBJ, the layers of a drawing, the files of a folder with one for each part "
    "(docs/formats.md, names of walls)"
)


@dataclass(frozen=True, slots=True)
class WallLine:
    """A wall's middle line in plan.

    origin (2,) m: its end with the smaller x, of a wall along y with the smaller y; axis, normal (2,) unit vectors; length,
    thickness m, over all; top: z of its highest point, m; stones (n,): its own.
    """

    name: str
    origin: FloatArray
    axis: FloatArray
    normal: FloatArray
    length: float
    thickness: float
    top: float
    stones: IntArray

    def at(self, along: float, aside: float = 0.0) -> FloatArray:
        """Return the point (2,) m at these distances along the wall and from its middle."""
        return self.origin + along * self.axis + aside * self.normal

    @property
    def way(self) -> str:
        """How messages say along which side of the wall, or of a vault, places are measured, and from where."""
        x, y = (self.origin.round(3) + 0.0).tolist()
        return f"along its longer side in plan, {way(self.axis)} from ({x:g}, {y:g})"

    def side(self, where: str, toward: FloatArray) -> float:
        """Return 1 or -1: which side of the wall a direction (3,) names.

        Raises
        ------
        InputError: a direction along the wall.
        """
        across = float(self.normal @ toward[:2])
        if abs(across) < 0.5:
            raise InputError(
                f"{where}: toward",
                f"it runs along the wall {self.name}",
                found=toward.tolist(),
                expected=f"nearer to its normal, {(np.append(self.normal, 0.0).round(4) + 0.0).tolist()} or the opposite",
            )
        return float(np.sign(across))


def wall_line(stones: Assemblage, name: str, where: str) -> WallLine:
    """Return the line of a wall; where: how a message calls what stands on it.

    Raises
    ------
    InputError: no such wall, one that is not straight.
    """
    own = np.flatnonzero((stones.panel == name) & ~stones.fixed)
    if not len(own):
        raise InputError(where, "no such wall", found=name, expected=named_walls(stones.panel[~stones.fixed]))
    axis = _axis(stones, own, name, where)
    if axis[0] < -1e-9 or (abs(axis[0]) <= 1e-9 and axis[1] < 0):
        axis = -axis
    normal = np.array([-axis[1], axis[0]])
    points = points_of(stones, own)
    along, across = points[:, :2] @ axis, points[:, :2] @ normal
    low, high, near, far = along.min(), along.max(), across.min(), across.max()
    return WallLine(
        name=name,
        origin=low * axis + 0.5 * (near + far) * normal,
        axis=axis,
        normal=normal,
        length=float(high - low),
        thickness=float(far - near),
        top=float(points[:, 2].max()),
        stones=own,
    )


def named_walls(panel: NameArray) -> str:
    """Return what a message expects where it finds a name that none of the walls (n,) has."""
    return ", ".join(sorted(set(panel.tolist()) - {""})) or _NAMED


def points_of(stones: Assemblage, chosen: IntArray) -> FloatArray:
    """Return the vertices (n, 3) m of some stones."""
    member = np.zeros(stones.count, dtype=np.bool_)
    member[chosen] = True
    return stones.points[np.repeat(member, np.diff(stones.block_point_ptr))]


def _axis(stones: Assemblage, own: IntArray, name: str, where: str) -> FloatArray:
    """Return the direction (2,) of a wall: that of its upright faces, or square to them, in which it is longer."""
    area, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    face = np.isin(np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr)), own)
    face &= np.abs(normal[:, 2]) < _UPRIGHT
    flat, size = normal[face, :2], np.linalg.norm(area[face], axis=1)
    # Fronts and ends of stones look in one direction once angles are taken four times.
    angle = 0.25 * np.angle(size @ ((flat[:, 0] + 1j * flat[:, 1]) ** 4))
    one = np.array([np.cos(angle), np.sin(angle)])
    across = np.abs(flat @ one)
    slanting = (across > _SLANT) & (across < np.sqrt(1 - _SLANT**2))
    if size[slanting].sum() > _BENT * size.sum():
        raise InputError(
            where,
            f"the wall {name} is not straight",
            expected="a straight wall",
            remedy="On a curved wall loads stand between points: give coordinates in place of the wall.",
        )
    two = np.array([-one[1], one[0]])
    plan = points_of(stones, own)[:, :2]
    longer, other = np.ptp(plan @ one), np.ptp(plan @ two)
    # As long as thick: that nearer to x.
    level = abs(longer - other) < 1e-6 * (longer + other)
    found = one if (abs(one[0]) > abs(two[0]) if level else longer > other) else two
    return np.where(np.abs(found) < 1e-12, 0.0, found)
