"""Ring beams: rigid stones along the tops of walls, which friction alone holds to the masonry."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.manifolds import manifold
from churchpipe.geometry.planar import hull, pieces, polygon, rings, united
from churchpipe.geometry.prism import prism_of
from churchpipe.geometry.walls import WallLine, points_of, wall_line
from churchpipe.model.arguments import check_kind, listed, positive
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage, Polyhedron, assemble
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.materials import UnitWeight
from churchpipe.model.ring_beam import RING_BEAM, RingBeam

# A wall's top is level to the first, m, as that of drawn stones is. One that sinks by less than the second slopes.
_LEVEL, _SINKS = 1e-3, 1e-2
# Ends of a beam, and what it may be wider than its wall, are known to this, m.
_EXACT = 1e-5
# A beam runs into stones that it overlaps deeper than this, m: drawn ones may overlap a little.
_INTO = 1e-3
# Beams of several walls that meet within this are one, m.
_MEET = 1e-6
CONCRETE = 25e3


@dataclass(frozen=True, slots=True)
class _Stretch:
    """A beam along one wall: span (2,) m along it, its width m."""

    wall: WallLine
    span: tuple[float, float]
    width: float

    @property
    def plan(self) -> FloatArray:
        """Its corners (4, 2) m, counter-clockwise."""
        (s0, s1), half = self.span, self.width / 2
        return np.array([self.wall.at(s0, -half), self.wall.at(s1, -half), self.wall.at(s1, half), self.wall.at(s0, half)])


def with_ring_beams(
    stones: Assemblage,
    walls: Sequence[str],
    *,
    height: float,
    unit_weight: float = CONCRETE,
    width: float | None = None,
    begin: float | None = None,
    end: float | None = None,
    closed: bool = False,
    slab: bool = False,
) -> Assemblage:
    """Return the stones with a rigid beam on the level top of each of some walls, or with one along all of them.

    A beam lies in the middle of its wall and rests on it by friction. Single beams that meet at a corner butt against each other.
    Its weight presses and is pushed as that of any stone.

    Parameters
    ----------
    stones
        With the names of their walls as `panel`.
    walls
        Names of straight walls.
    height
        Of the beams, m.
    unit_weight
        N/m3; that of concrete unless given.
    width
        Of the beams, m; None: the thickness of each wall.
    begin, end
        m along each wall, as in `LineLoad`, where a beam stops short of what stands higher; None: the ends of the wall's top
        course, which may end at a wall across it.
    closed
        One rigid beam along all the walls, which have to meet, at one level.
    slab
        One rigid plate over the walls and what lies between them: a floor or a roof.

    Returns
    -------
    Assemblage
        The stones, and after them the beams, as panels "beam on WALL", or "beam WALLS", of the material of their wall.

    Raises
    ------
    InputError
        A wall that is not there, is not straight or has no level top; a beam wider than its wall, or without height; walls of
        one beam that do not meet, or not at one level; a beam that runs into stones that stand higher; a second one of its name.
    """
    check_kind("with_ring_beams: stones", stones, Assemblage)
    positive("ring beam: unit weight", unit_weight)
    positive("ring beam: height", height)
    doubt_argument("with_ring_beams: unit_weight", unit_weight, UnitWeight, "unit_weight")
    beam = RingBeam(tuple(listed("with_ring_beams: walls", walls, str)), height, width, begin, end, closed, slab)
    return add_beams(stones, [beam], dict.fromkeys(stones.material.tolist(), unit_weight))


def add_beams(stones: Assemblage, beams: Iterable[RingBeam], unit_weight: Mapping[str, float]) -> Assemblage:
    """Return the stones with beams after them; unit_weight: of each material, N/m3. Errors as of `with_ring_beams`."""
    out = stones
    occupied: list[_Stretch] = []
    for beam in beams:
        solids: list[Polyhedron] = []
        own: list[_Stretch] = []
        for name in beam.walls:
            stretch = _stretch(stones, beam, name)
            if not (beam.closed or beam.slab):
                stretch = _shortened(stretch, occupied)
                occupied.append(stretch)
                solids.append(_over(stretch.plan, stretch.wall.top, beam.height))
            own.append(stretch)
        if beam.closed or beam.slab:
            occupied += own
            solids = [_along_all(beam, own)]
        for solid, name, stretch in zip(solids, beam.bodies, own, strict=False):
            material = beam.material or str(stones.material[stretch.wall.stones[0]])
            _check_free(out, beam, stretch, solid)
            if name in out.panel or name in out.block_id:
                remedy = "A beam, or a wall, has this name already: give the beam a name of its own."
                raise InputError(f"ring beam {name.removeprefix(RING_BEAM)}", "not the only one of its name", remedy=remedy)
            out = _joined(out, solid, unit_weight[material], name, material)
    return out


def ring_beams(stones: Assemblage) -> BoolArray:
    """Return True (nb,) for ring beams and slabs: those that were added, and those of a drawing that names them so."""
    return np.char.startswith(stones.panel, RING_BEAM) & ~stones.coursed


def _stretch(stones: Assemblage, beam: RingBeam, name: str) -> _Stretch:
    where = f"ring beam on {name}"
    wall = wall_line(stones, name, where)
    width = wall.thickness if beam.width is None else beam.width
    if not width <= wall.thickness + _EXACT:
        raise InputError(f"{where}: width", "out of range", found=width, expected=f"at most {wall.thickness:.6g} m")
    points = points_of(stones, wall.stones)
    along, depth = points[:, :2] @ wall.axis - float(wall.origin @ wall.axis), wall.top - points[:, 2]
    low, high = float(along[depth < _LEVEL].min()), float(along[depth < _LEVEL].max())
    sinks = (depth >= _LEVEL) & (depth < _SINKS) & ((along < low - _LEVEL) | (along > high + _LEVEL))
    if high - low < _LEVEL or sinks.any():
        lower = f"{1e3 * depth[sinks].max(initial=0.0):.2g} mm lower beside its highest stones"
        found = lower if sinks.any() else "a gable or a single point"
        expected = "a wall that ends in one level course; leave this one out, or run the beam along the others"
        raise InputError(where, f"the top of the wall {name} is not level", found=found, expected=expected)
    span = low if beam.begin is None else beam.begin, high if beam.end is None else beam.end
    if not low - _EXACT <= span[0] < span[1] <= high + _EXACT:
        found, expected = f"from {span[0]:g} m to {span[1]:g} m", f"within {low:.6g} and {high:.6g} m"
        raise InputError(where, "not on the wall's level top", found=found, expected=expected)
    return _Stretch(wall, span, width)


def _shortened(one: _Stretch, occupied: Iterable[_Stretch]) -> _Stretch:
    """Return a beam up to the faces of those that it would run into."""
    begin, end = one.span
    origin = one.wall.at(0.0)
    for other in occupied:
        if abs(float(one.wall.axis @ other.wall.axis)) > 0.5:
            continue
        along, across = (other.plan - origin) @ one.wall.axis, (other.plan - origin) @ one.wall.normal
        low, high = float(along.min()), float(along.max())
        if across.min() >= one.width / 2 or across.max() <= -one.width / 2 or low >= end or high <= begin:
            continue
        begin, end = (high, end) if low <= begin + one.width else (begin, low)
    return _Stretch(one.wall, (begin, end), one.width)


def _along_all(beam: RingBeam, stretches: Sequence[_Stretch]) -> Polyhedron:
    """Return one body over the walls of a beam."""
    where = f"ring beam {beam.name or ' '.join(beam.walls)}"
    tops = [stretch.wall.top for stretch in stretches]
    if max(tops) - min(tops) > _LEVEL:
        found = ", ".join(f"{stretch.wall.name} at {stretch.wall.top:.6g} m" for stretch in stretches)
        raise InputError(where, "its walls do not end at one level", found=found, expected="one height for one rigid beam")
    parts = pieces(united([polygon(stretch.plan) for stretch in stretches], _MEET))
    if beam.slab:
        # Over the walls around a room, or between walls that do not meet.
        parts = pieces(polygon(rings(parts[0])[0]) if len(parts) == 1 else hull(np.concatenate([one.plan for one in stretches])))
    if len(parts) > 1:
        found = f"{len(parts)} parts"
        raise InputError(
            where, "its walls do not meet", found=found, expected="walls that meet at corners", remedy="closed = false"
        )
    points, faces = prism_of(parts[0])
    return points * [1.0, 1.0, beam.height] + [0.0, 0.0, max(tops)], faces


def _check_free(stones: Assemblage, beam: RingBeam, stretch: _Stretch, solid: Polyhedron) -> None:
    """Raise InputError for a beam that runs into stones of walls or gables that stand higher than the top that it lies on."""
    points = np.asarray(solid[0])
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    near = ((low < points.max(axis=0) - _INTO) & (high > points.min(axis=0) + _INTO)).all(axis=1)
    body = manifold(points, solid[1])
    shared = {stone: body ^ manifold(*stones.solid(stone)) for stone in np.flatnonzero(near).tolist()}
    inside = [stone for stone, common in shared.items() if 2 * common.volume() > _INTO * common.surface_area()]
    if not inside:
        return
    wall, single = stretch.wall, not (beam.closed or beam.slab)
    where = f"ring beam on {wall.name}" if single else f"ring beam {beam.name or ' '.join(beam.walls)}"
    names = stones.block_id[inside].tolist()
    found = ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
    remedy = "Let it stop short of them: from_m and to_m of a case, begin and end in Python."
    if single and (free := _free_stretch(stones, stretch, inside)):
        remedy = f"Let it stop short of them: from {free[0]:.6g} to {free[1]:.6g} m along the wall (from_m and to_m), {wall.way}."
    raise InputError(
        where, "it runs into stones that stand higher", found=found, expected="a free top of the wall", remedy=remedy
    )


def _free_stretch(stones: Assemblage, stretch: _Stretch, inside: Sequence[int]) -> tuple[float, float] | None:
    """Return the longest part of a stretch that some stones leave free, m along the wall; None for none."""
    (begin, end), wall = stretch.span, stretch.wall
    taken: list[tuple[float, float]] = []
    for stone in inside:
        along = stones.points[slice(*stones.block_point_ptr[stone : stone + 2]), :2] @ wall.axis - float(wall.origin @ wall.axis)
        taken.append((float(along.min()), float(along.max())))
    free, at = [(0.0, 0.0)], begin
    for low, high in [*sorted(taken), (end, end)]:
        free.append((at, min(low, end)))
        at = max(at, high)
    low, high = max(free, key=lambda part: part[1] - part[0])
    return (low, high) if high - low > stretch.width else None


def _over(plan: FloatArray, level: float, height: float) -> Polyhedron:
    points, faces = prism_of(polygon(plan))
    return points * [1.0, 1.0, height] + [0.0, 0.0, level], faces


def _joined(stones: Assemblage, solid: Polyhedron, unit_weight: float, panel: str, material: str) -> Assemblage:
    beam = Assemblage.from_polyhedra([solid], unit_weight, material=material, panel=panel, block_id=[panel])
    points, faces = len(stones.points), len(stones.face_ptr) - 1
    return assemble(
        points=np.concatenate([stones.points, beam.points]),
        face_nodes=np.concatenate([stones.face_nodes, beam.face_nodes + points]),
        face_ptr=np.concatenate([stones.face_ptr, beam.face_ptr[1:] + len(stones.face_nodes)]),
        block_face_ptr=np.concatenate([stones.block_face_ptr, beam.block_face_ptr[1:] + faces]),
        block_point_ptr=np.concatenate([stones.block_point_ptr, beam.block_point_ptr[1:] + points]),
        **{
            name: np.concatenate([getattr(stones, name), getattr(beam, name)])
            for name in ("unit_weight", "material", "panel", "course", "fixed", "block_id", "butts")
        },
    )
