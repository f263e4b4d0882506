"""Exact assemblies, and what surveys and drawings make of them: noise, tilted beds, open joints, rounded coordinates."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from churchpipe.generators.arch import arch
from churchpipe.geometry.manifolds import manifold
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage, Polyhedron
from churchpipe.stones.blocks import derive_blocks
from solids import BOX_FACES, Solid, box, moved

LENGTH, THICKNESS, HEIGHT = 0.5, 0.25, 0.275
# Seeds are fresh: no constant of the product was chosen with them.
FIRST_SEED = 1000


def voussoir_arch() -> Assemblage:
    """The arch of 27 voussoirs, t/R .2, between two skewbacks."""
    return derive_blocks(arch(mean_radius=1.0, thickness=0.2, width=0.5, voussoirs=27))


def turned_wall() -> Assemblage:
    """27 stones in six courses of running bond on a fixed plate, turned by 17 degrees about the vertical."""
    stones = [box((-0.5, 2.75), (-0.5, 0.75), (-0.3, 0.0))]
    for course in range(6):
        marks = [0.0, 0.5, 1.0, 1.5, 2.0, 2.25] if course % 2 else [0.0, 0.75, 1.25, 1.75, 2.25]
        stones += [box(span, (0, THICKNESS), (course * HEIGHT, (course + 1) * HEIGHT)) for span in pairwise(marks)]
    built = Assemblage.from_polyhedra(stones, 18e3, fixed=[0])
    return moved(built, Rotation.from_euler("z", 17, degrees=True).as_matrix(), np.zeros(3))


def corner(*, head_gap: float = 0.0, courses: int = 8) -> Assemblage:
    """Two toothed walls that make an L, on a fixed plate. head_gap: how far the head joints are open, m."""
    stones = [box((-0.5, 2.5), (-0.5, 2.5), (-0.3, 0.0))]
    half = 0.5 * head_gap
    for course in range(courses):
        level = (course * HEIGHT, (course + 1) * HEIGHT)
        # One wall runs through the corner, the other stops at it.
        for axis, marks in ((course % 2, [0.0, 0.5, 1.0, 1.5, 1.75]), (1 - course % 2, [0.25, 0.75, 1.25, 1.75])):
            for start, stop in pairwise(marks):
                along = (start + half * (start > 0), stop - half * (stop < 1.75))
                across = (0.0, THICKNESS)
                stones.append(box(along, across, level) if axis == 0 else box(across, along, level))
    return Assemblage.from_polyhedra(stones, 18e3, fixed=[0])


def two_leaves(joint: float, *, courses: int = 8, length: int = 5) -> list[Solid]:
    """Two leaves of bricks 250 x 102 x 65 mm in running bond, `length` a course, each brick behind one of the other leaf.

    joint: width of the mortar left out all round, m.
    """
    brick = np.array([0.25, 0.102, 0.065])
    places = [(x + 0.5 * (z % 2), y, z) for y in range(2) for z in range(courses) for x in range(length)]
    corner = box((0, brick[0]), (0, brick[1]), (0, brick[2]))[0]
    return [(corner + np.array(place) * (brick + joint), BOX_FACES) for place in places]


def shaken(solids: Sequence[Solid], noise: float, seed: int) -> list[Solid]:
    """The corners of each solid moved on their own by up to `noise`, m, in each direction."""
    rng = np.random.default_rng(seed)
    return [(points + rng.uniform(-noise, noise, points.shape), faces) for points, faces in solids]


def dome(*, sectors: int = 16, courses: int = 18, thickness: float = 0.06) -> Assemblage:
    """A dome of mean radius 1 m on a fixed plate: rings of `sectors` plane stones and a key, all courses of one angle."""
    around = 2 * np.pi * np.arange(sectors) / sectors
    up = 0.5 * np.pi * np.arange(courses) / courses
    radii = (1 - 0.5 * thickness, 1 + 0.5 * thickness)
    stones = [box((-2, 2), (-2, 2), (-0.3, 0))]
    for span in pairwise(up):
        for sides in pairwise([*around, around[0]]):
            stones.append((np.array([_on_sphere(r, u, v) for r in radii for u in sides for v in span]), BOX_FACES))
    key = np.array([_on_sphere(r, u, up[-1]) for r in radii for u in around])
    low = list(range(sectors))
    edges = pairwise([*low, 0])
    stones.append((key, [low[::-1], [n + sectors for n in low], *([a, b, b + sectors, a + sectors] for a, b in edges)]))
    return Assemblage.from_polyhedra(stones, 18e3, fixed=[0])


def _on_sphere(radius: float, longitude: float, latitude: float) -> tuple[float, float, float]:
    level = radius * np.cos(latitude)
    return level * np.cos(longitude), level * np.sin(longitude), radius * np.sin(latitude)


def triangulated(stones: Assemblage) -> Assemblage:
    """The same stones, every face cut into triangles."""

    def cut(points: FloatArray, faces: list[list[int]]) -> Polyhedron:
        mesh = manifold(points, [np.array(face) for face in faces]).to_mesh64()

        return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64).tolist()

    return _changed(stones, cut)


def noisy(stones: Assemblage, noise: float, seed: int) -> Assemblage:
    """The corners of each stone moved on their own by up to `noise`, m, in each direction; triangles, which stay plane."""
    rng = np.random.default_rng(seed)
    return _changed(triangulated(stones), lambda points, faces: (points + rng.uniform(-noise, noise, points.shape), faces))


def rounded(stones: Assemblage, decimals: int) -> Assemblage:
    """Coordinates with so many decimals of a metre; triangles, which stay plane."""
    return _changed(triangulated(stones), lambda points, faces: (np.round(points, decimals), faces))


def tilted(stones: Assemblage, angle: float, seed: int) -> Assemblage:
    """Each free stone turned by up to `angle`, rad, about a random level axis through its centroid: beds and heads lean."""
    rng = np.random.default_rng(seed)
    fixed = iter(stones.fixed.tolist())

    def turn(points: FloatArray, faces: list[list[int]]) -> Polyhedron:
        around = rng.uniform(0, 2 * np.pi)
        vector = rng.uniform(-angle, angle) * np.array([np.cos(around), np.sin(around), 0.0]) * (not next(fixed))
        middle = points.mean(axis=0)
        return (points - middle) @ Rotation.from_rotvec(vector).as_matrix().T + middle, faces

    return _changed(stones, turn)


def changes(stones: Assemblage, seeds: int) -> Iterator[tuple[str, list[Assemblage]]]:
    """What is done to a model, in words, and the models that come of it."""
    series = range(FIRST_SEED, FIRST_SEED + seeds)
    yield "triangles", [triangulated(stones)]
    for share in (1e-6, 1e-5, 1e-4, 1e-3, 3e-3):
        noise = share * median_size(stones)
        yield f"noise {share:g} of the size, {1e3 * noise:.2g} mm", [noisy(stones, noise, seed) for seed in series]
    for degrees in (0.1, 0.3, 0.5):
        yield f"tilted up to {degrees} degrees", [tilted(stones, np.radians(degrees), seed) for seed in series]
    yield "rounded to 3 decimals", [rounded(stones, 3)]


def median_size(stones: Assemblage) -> float:
    """The diagonal of the median free stone, m."""
    low, high = (edge.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0) for edge in (np.minimum, np.maximum))
    return float(np.median(np.linalg.norm(high - low, axis=1)[~stones.fixed]))


def joined_pairs(blocks: Sequence[Sequence[int]]) -> set[tuple[int, int]]:
    """Pairs of stones that meet, in order."""
    return {(min(pair), max(pair)) for pair in blocks}


def _changed(stones: Assemblage, change: Callable[[FloatArray, list[list[int]]], Polyhedron]) -> Assemblage:
    polyhedra: list[Polyhedron] = []
    for i in range(stones.count):
        start, stop = stones.block_point_ptr[i : i + 2]
        faces = [
            (stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - start).tolist()
            for f in range(*stones.block_face_ptr[i : i + 2])
        ]
        polyhedra.append(change(stones.points[start:stop], faces))
    return Assemblage.from_polyhedra(polyhedra, stones.unit_weight, np.flatnonzero(stones.fixed).tolist())


MODELS: dict[str, Callable[[], Assemblage]] = {"arch": voussoir_arch, "wall": turned_wall, "corner": corner, "dome": dome}
