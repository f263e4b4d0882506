"""Capacity curves of walls that are drawn as outlines and pushed in their plane: gables, and arcades of two or three arches.

    python benchmarks/plane_walls.py gable-6 gable-4 arcade-2 arcade-3 arcade-60

Gables: width, eaves and ridge, bricks, thickness, m. Arcades: number of arches, their span, the piers, springing, top, bricks,
depth and number of voussoirs, half the angle of a ring, the piers at the ends, thickness. Seconds are processor time.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import ezdxf
import numpy as np
import shapely
from shapely import Polygon

import churchpipe as cp

FRICTION, WEIGHT, STEPS = 0.6, 18e3, 60
# Pieces of bricks smaller than this part of one are laid as one with their neighbour.
SMALL = 0.25


@dataclass(frozen=True)
class Gable:
    """A wall with a gable."""

    width: float
    eaves: float
    ridge: float
    brick: tuple[float, float]
    thickness: float

    def stones(self) -> list[Polygon]:
        """Return the outlines of its stones, m."""
        half = self.width / 2
        outline = Polygon([(0, 0), (self.width, 0), (self.width, self.eaves), (half, self.ridge), (0, self.eaves)])
        laid = bricks(self.width, self.ridge, self.brick)
        return merged([part for brick in laid for part in parts(brick & outline)], self.brick)


@dataclass(frozen=True)
class Arcade:
    """Arches on piers, and the wall over them."""

    arches: int
    span: float
    pier: float
    springing: float
    top: float
    brick: tuple[float, float]
    depth: float
    voussoirs: int
    half: float
    end: float
    thickness: float

    def stones(self) -> list[Polygon]:
        """Return the outlines of its stones, m."""
        radius = self.span / 2 / np.sin(self.half)
        rings: list[Polygon] = []
        voids: list[Polygon] = []
        for arch in range(self.arches):
            left = self.end + arch * (self.span + self.pier)
            centre = np.array([left + self.span / 2, self.springing - radius * np.cos(self.half)])
            angle = np.linspace(-self.half, self.half, self.voussoirs + 1)
            ray = np.stack([np.sin(angle), np.cos(angle)], axis=1)
            low, high = centre + radius * ray, centre + (radius + self.depth) * ray
            rings += [Polygon([low[k], low[k + 1], high[k + 1], high[k]]) for k in range(self.voussoirs)]
            foot = [(left + self.span, self.springing), (left + self.span, -1.0), (left, -1.0), (left, self.springing)]
            voids.append(Polygon([*low, *foot]))
        free = shapely.union_all([*rings, *voids])
        width = 2 * self.end + (self.arches - 1) * self.pier + self.arches * self.span
        left_over = [part for brick in bricks(width, self.top, self.brick) for part in parts(brick - free)]
        return [*merged(left_over, self.brick), *rings]


WALLS = {
    "gable-6": Gable(6.0, 3.0, 5.4, (0.6, 0.3), 0.5),
    "gable-4": Gable(4.2, 2.4, 4.5, (0.42, 0.2), 0.36),
    "arcade-2": Arcade(2, 2.4, 0.9, 2.4, 4.8, (0.6, 0.3), 0.35, 13, np.pi / 2, 0.9, 0.6),
    "arcade-3": Arcade(3, 1.8, 0.7, 2.1, 4.2, (0.5, 0.3), 0.3, 11, np.pi / 2, 0.7, 0.5),
    "arcade-60": Arcade(2, 2.6, 0.8, 2.7, 4.2, (0.8, 0.3), 0.35, 9, np.pi / 3, 1.2, 0.45),
}


def bricks(width: float, height: float, brick: tuple[float, float]) -> list[Polygon]:
    """Return the bricks of a wall in running bond, those of every other course half a brick aside."""
    long, high = brick
    found: list[Polygon] = []
    for course in range(int(np.ceil(height / high - 1e-9))):
        start = -long / 2 * (course % 2) + long * np.arange(width / long + 1)
        found += [
            shapely.box(max(x, 0.0), course * high, min(x + long, width), (course + 1) * high) for x in start if x < width - 1e-9
        ]
    return found


def parts(shape: shapely.Geometry) -> list[Polygon]:
    """Return the polygons of a shape."""
    return [part for part in shapely.get_parts(shape).tolist() if isinstance(part, Polygon) and part.area > 1e-9]


def merged(pieces: list[Polygon], brick: tuple[float, float]) -> list[Polygon]:
    """Return the pieces, each small one as a part of the neighbour with which it shares most."""
    pieces = list(pieces)
    while (small := next((k for k, piece in enumerate(pieces) if piece.area < SMALL * brick[0] * brick[1]), None)) is not None:
        piece = pieces.pop(small)
        most = max(range(len(pieces)), key=lambda k: piece.intersection(pieces[k]).length)
        (pieces[most],) = parts(piece | pieces[most])
    return pieces


def row(name: str) -> str:
    """Return a row of the table."""
    wall, begin = WALLS[name], process_time()
    with TemporaryDirectory() as folder:
        document, path = ezdxf.new(units=6), Path(folder) / "wall.dxf"
        for outline in wall.stones():
            document.modelspace().add_lwpolyline(list(outline.exterior.coords)[:-1], close=True)
        document.saveas(path)
        stones, _ = cp.read_stones(path, unit_weight=WEIGHT, thickness=wall.thickness, support="base")
    contacts, load = cp.find_contacts(stones), cp.LoadCase((1, 0, 0))
    state = cp.limit_analysis(stones, contacts, load, FRICTION)
    sliding = cp.limit_analysis(stones, contacts, load, FRICTION, flow="non-associative")
    curve = cp.block_pushover(stones, contacts, load, FRICTION, state=state, sliding=sliding, steps=STEPS)
    last = curve.proved_steps - 1
    return (
        f"| {name} | {int((~stones.fixed).sum())} | {state.load_factor:.4f} | {sliding.load_factor:.4f} | {last + 1} | "
        f"{1e3 * curve.displacement[last]:.0f} | {curve.load_factor[last]:.4f} | {len(curve.misfit)}, {curve.status}, "
        f"{curve.load_factor[-1]:.4f} at {1e3 * curve.displacement[-1]:.0f} | {process_time() - begin:.0f} |"
    )


def main() -> None:
    """Print a row for each name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", choices=WALLS)
    print("| wall | stones | associative | without dilatancy | proved steps | to, mm | load factor there | ends | s |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for name in parser.parse_args().names:
        print(row(name), flush=True)


if __name__ == "__main__":
    main()
