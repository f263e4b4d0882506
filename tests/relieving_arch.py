"""A relieving arch in a wall, exactly as drawn: outlines of the stones in x and z, and the stones."""

from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry.polygon import orient

from churchpipe.model.assemblage import Assemblage
from solids import box

LENGTH, HEIGHT, THICKNESS, COURSE = 4.0, 3.0, 0.3, 0.25
CENTRE, RADII = np.array([2.0, 1.25]), (0.95, 1.2)


def voussoirs(count: int = 9, chords: int = 3) -> list[shapely.Polygon]:
    """Return the voussoirs of a relieving arch from 30 to 150 degrees."""
    angle = np.radians(np.linspace(30.0, 150.0, count * chords + 1))
    inner, outer = (CENTRE + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1) for radius in RADII)
    ends = [slice(chords * k, chords * (k + 1) + 1) for k in range(count)]
    return [shapely.Polygon(np.concatenate([outer[own], inner[own][::-1]])) for own in ends]


def arch_in_wall(stone: float) -> list[shapely.Polygon]:
    """Return the stones of a wall in running bond round the arch, and the voussoirs."""
    arch = voussoirs()
    ring = shapely.union_all(arch)
    found = list(arch)
    for course in range(round(HEIGHT / COURSE)):
        ends = np.unique(np.clip(np.arange(-0.5 * stone * (course % 2), LENGTH + stone, stone), 0.0, LENGTH))
        for start, stop in pairwise(ends.tolist()):
            whole = shapely.box(start, course * COURSE, stop, (course + 1) * COURSE)
            found += [part for part in shapely.get_parts(whole.difference(ring)) if part.area > 1e-9]
    return found


def prism(outline: shapely.Polygon):
    corner = np.array(orient(outline).exterior.coords)[:-1]
    count = len(corner)
    points = np.array([(x, y, z) for y in (0.0, THICKNESS) for x, z in corner])
    sides = [[k, k + count, (k + 1) % count + count, (k + 1) % count] for k in range(count)]
    return points, [list(range(count)), list(range(2 * count - 1, count - 1, -1)), *sides]


def stones_of(outlines: list[shapely.Polygon]) -> Assemblage:
    """Return the stones of these outlines on the ground."""
    end = max(outline.bounds[2] for outline in outlines)
    ground = box((-1.0, end + 1.0), (-1.0, 1.0), (-0.3, 0.0))
    return Assemblage.from_polyhedra([ground, *map(prism, outlines)], 18e3, fixed=[0])
