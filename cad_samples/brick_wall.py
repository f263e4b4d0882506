"""Make the drawing of a brick wall as people draw one: outlines alone, mortar left out, a unit that is wrong, slips of the pen.

`python cad_samples/brick_wall.py wall.dxf` writes 1500 bricks; the tests make smaller ones.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import shapely
from shapely import Polygon

# Bricks and joints, m; the layer they are drawn on.
LENGTH, HEIGHT, JOINT = 0.250, 0.065, 0.010
LAYER = "FACADE"
# Joints of an arch at the intrados and at the extrados, as shares of other joints.
NARROW, WIDE = 0.6, 1.4
# Pieces of bricks smaller than this part of one are laid as one with their neighbour.
SMALL = 0.3


@dataclass(frozen=True)
class Opening:
    """An opening under a segmental arch: bricks before it and in its width, courses below its sill and up to the springing, and
    the radius of the intrados over its width."""

    start: int
    bricks: int
    sill: int
    height: int
    radius: float = 1.15

    @property
    def span(self) -> tuple[float, float]:
        """Left and right jamb."""
        module = LENGTH + JOINT
        return self.start * module - JOINT, (self.start + self.bricks) * module

    @property
    def levels(self) -> tuple[float, float]:
        """Sill and springing."""
        return self.sill * (HEIGHT + JOINT) - (JOINT if self.sill else 1.0), (self.sill + self.height) * (HEIGHT + JOINT)

    @property
    def arch(self) -> "Arch":
        """Its arch."""
        (left, right), (_, springing) = self.span, self.levels
        radius = self.radius * (right - left)
        half = float(np.arcsin(0.5 * (right - left) / radius))
        count = round(2 * half * radius / (HEIGHT + NARROW * JOINT))
        return Arch(np.array([0.5 * (left + right), springing - radius * np.cos(half)]), radius, half, count)


@dataclass(frozen=True)
class Arch:
    """Bricks on end around a centre, cut so that the joints between them are wedges, thin at the intrados."""

    centre: np.ndarray
    radius: float
    half: float
    count: int

    @property
    def axes(self) -> np.ndarray:
        """Directions (count, 2) from the centre through the middle of each voussoir."""
        angle = -self.half + (np.arange(self.count) + 0.5) * 2 * self.half / self.count
        return np.stack([np.sin(angle), np.cos(angle)], axis=1)

    @property
    def halves(self) -> tuple[float, float]:
        """Half the thickness of a voussoir at the intrados and at the extrados."""
        slope = np.tan(self.half / self.count)
        return float(self.radius * slope - 0.5 * NARROW * JOINT), float((self.radius + LENGTH) * slope - 0.5 * WIDE * JOINT)

    def voussoirs(self) -> Iterator[np.ndarray]:
        """Yield the outlines from left to right."""
        thin, thick = self.halves
        for along in self.axes:
            across = np.array([along[1], -along[0]])
            low, high = self.centre + self.radius * along, self.centre + (self.radius + LENGTH) * along
            yield np.array([low - thin * across, low + thin * across, high + thick * across, high - thick * across])

    def cut(self) -> Polygon:
        """Return what bricks leave free above the springing: the ring, a joint above it, and what is below it."""
        a, b = self.skewback()
        reach = 20 * self.radius
        foot, top = a - 0.2 * (b - a), a + reach / np.linalg.norm(b - a) * (b - a)
        region = Polygon(self.centre + np.array([foot, top, top * [-1, 1], foot * [-1, 1]]))
        for along in self.axes:
            across = reach * np.array([along[1], -along[0]])
            over = self.centre + (self.radius + LENGTH + JOINT) * along
            low = over - reach * along
            region = region.intersection(Polygon([over - across, over + across, low + across, low - across]))
        return region

    def skewback(self) -> np.ndarray:
        """Return the face (2, 2) that the last voussoir leans on, from the centre: its side, mirrored at the springing."""
        out = np.array([np.sin(self.half), np.cos(self.half)])
        return (list(self.voussoirs())[-1][[1, 2]] - self.centre) @ (2 * np.outer(out, out) - np.eye(2))


@dataclass
class BrickWall:
    """Outlines (n, 2) of all stones, m; courses: the bricks of each, by index; arches: voussoirs of each, by index."""

    outlines: list[np.ndarray] = field(default_factory=list)
    courses: list[list[int]] = field(default_factory=list)
    arches: list[tuple[Arch, list[int]]] = field(default_factory=list)


def brick_wall(bricks: int, courses: int, openings: list[Opening]) -> BrickWall:
    """Lay a wall in running bond, half bricks at the ends of every other course, and arches over its openings."""
    wall = BrickWall()
    free: list[Polygon] = []
    for opening in openings:
        (left, right), (sill, springing) = opening.span, opening.levels
        cut = opening.arch.cut().intersection(shapely.box(-1e3, springing, 1e3, 1e3))
        free += [shapely.box(left, sill, right, springing), cut]
    holes = shapely.union_all(free) if free else Polygon()
    module = LENGTH + JOINT
    for course in range(courses):
        low = course * (HEIGHT + JOINT)
        ends = module * np.arange(bricks + 1)
        ends = ends if course % 2 == 0 else np.concatenate((ends[:1], ends[:-1] + 0.5 * module, ends[-1:]))
        wall.courses.append([])
        for piece in _laid(list(pairwise(ends.tolist())), low, holes):
            wall.courses[-1].append(len(wall.outlines))
            wall.outlines.append(shapely.get_coordinates(shapely.orient_polygons(piece).exterior)[:-1])
    for opening in openings:
        first = len(wall.outlines)
        wall.outlines += list(opening.arch.voussoirs())
        wall.arches.append((opening.arch, list(range(first, len(wall.outlines)))))
    return wall


def _laid(spans: list[tuple[float, float]], low: float, holes: Polygon) -> list[Polygon]:
    """Return the bricks of a course, cut around holes; small pieces are laid as one with the brick beside them."""
    while True:
        pieces = [_pieces(span, low, holes) for span in spans]
        small = [k for k, parts in enumerate(pieces) if any(part.area < SMALL * LENGTH * HEIGHT for part in parts)]
        # A half brick at the end of a course is meant to be one.
        small = [k for k in small if spans[k][1] - spans[k][0] > 0.75 * (LENGTH + JOINT)]
        if not small:
            return [part for parts in pieces for part in parts]
        k = small[0]
        whole = [n for n in (k - 1, k + 1) if 0 <= n < len(spans) and pieces[n]]
        other = max(whole, key=lambda n: sum(part.area for part in pieces[n]))
        a, b = sorted((k, other))
        spans[a : b + 1] = [(spans[a][0], spans[b][1])]


def _pieces(span: tuple[float, float], low: float, holes: Polygon) -> list[Polygon]:
    left = shapely.box(span[0], low, span[1] - JOINT, low + HEIGHT).difference(holes)
    return [part.simplify(1e-9) for part in shapely.get_parts(left) if part.geom_type == "Polygon" and part.area > 1e-9]


def joints_of(wall: BrickWall, ends: float = 1.0) -> list[tuple[int, int]]:
    """Return the stones on both sides of every joint: along beds, at heads, on arches, at their feet and between voussoirs.

    They are edges a joint apart that overlap when each is drawn on to the middle of the joints at its ends; or as they are
    drawn, with 0 for `ends`.
    """
    margin = ends * JOINT
    found = [pair for _, ring in wall.arches for pair in pairwise(ring)]
    for row in wall.courses:
        ends = [(k, *shapely.bounds(Polygon(wall.outlines[k]))[[0, 2]]) for k in row]
        ends.sort(key=lambda end: end[1])
        found += [(a[0], b[0]) for a, b in pairwise(ends) if abs(b[1] - a[2] - JOINT) < 1e-9]
    for below, above in pairwise(wall.courses):
        lower = [(k, span) for k in below for span in _level(wall.outlines[k], max)]
        upper = [(k, span) for k in above for span in _level(wall.outlines[k], min)]
        found += [(k, n) for k, a in lower for n, b in upper if min(a[1], b[1]) - max(a[0], b[0]) + margin > 1e-9]
    bricks = [k for row in wall.courses for k in row]
    for arch, ring in wall.arches:
        for along, voussoir in zip(arch.axes, ring, strict=True):
            axes = np.stack([[along[1], -along[0]], along])
            reach = arch.halves[1] + 0.5 * margin
            for brick in bricks:
                local = (wall.outlines[brick] - arch.centre) @ axes.T
                for a, b in zip(local, np.roll(local, -1, axis=0), strict=True):
                    level = np.allclose([a[1], b[1]], arch.radius + LENGTH + JOINT, rtol=0, atol=1e-9)
                    if level and min(max(a[0], b[0]), reach) - max(min(a[0], b[0]), -reach) > 1e-9:
                        found.append((voussoir, brick))
        for sign, voussoir in ((-1, ring[0]), (1, ring[-1])):
            found += [(voussoir, brick) for brick in bricks for _ in range(_leans(arch, wall.outlines[brick], sign, margin))]
    return found


def _level(outline: np.ndarray, side) -> list[tuple[float, float]]:
    """Return where the top (max) or bottom (min) of an outline is level, from and to."""
    height = side(outline[:, 1])
    after = np.roll(outline, -1, axis=0)
    flat = (np.abs(outline[:, 1] - height) < 1e-9) & (np.abs(after[:, 1] - height) < 1e-9)
    return [tuple(sorted((a[0], b[0]))) for a, b in zip(outline[flat], after[flat], strict=True)]


def _leans(arch: Arch, brick: np.ndarray, sign: int, margin: float) -> int:
    """Return how many edges of a brick are on the left (-1) or right (1) face that the arch leans on."""
    a, b = arch.skewback() * [sign, 1]
    along = (b - a) / np.linalg.norm(b - a)
    local = brick - arch.centre - a
    on = np.abs(local[:, 0] * along[1] - local[:, 1] * along[0]) < 1e-9
    at = local @ along
    spans = [sorted((at[k], at[(k + 1) % len(at)])) for k in np.flatnonzero(on & np.roll(on, -1))]
    return sum(min(high, LENGTH) - max(low, 0.0) + margin > 1e-9 for low, high in spans)


def write_wall(wall: BrickWall, path: Path, *, unclosed: int, doubled: int) -> None:
    """Write the outlines in metres, flagged inches: some not closed, in turn by ends apart, overrun and a side left out; some
    drawn twice."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 1
    document.layers.add(LAYER)
    space = document.modelspace()
    chosen = np.linspace(0, len(wall.outlines) - 1, unclosed).astype(int).tolist()
    for k, corners in enumerate(wall.outlines):
        drawn = corners
        if k in chosen:
            first, last = corners[1] - corners[0], corners[0] - corners[-1]
            slip = {0: -0.002, 1: 0.003, 2: 0.0}[chosen.index(k) % 3]
            start = corners[0] - slip * first / np.linalg.norm(first)
            end = corners[0] + slip * last / np.linalg.norm(last)
            drawn = np.concatenate([start[None], corners[1:], end[None]]) if slip else corners
        space.add_lwpolyline(drawn.tolist(), close=k not in chosen, dxfattribs={"layer": LAYER})
    for k in np.linspace(1, len(wall.outlines) - 2, doubled).astype(int):
        if k in chosen:
            k += 1
        space.add_lwpolyline(wall.outlines[k].tolist(), close=True, dxfattribs={"layer": LAYER})
    document.saveas(path)


def large_wall() -> BrickWall:
    """Lay 1500 bricks around a door and a window."""
    return brick_wall(41, 40, [Opening(8, 4, 0, 26, 1.38), Opening(26, 4, 8, 18, 1.44)])


if __name__ == "__main__":
    write_wall(large_wall(), Path(sys.argv[1]), unclosed=50, doubled=6)
