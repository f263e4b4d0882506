"""From the description of a building to its stones."""

from collections.abc import Sequence

import numpy as np

from churchpipe.bond.count import check_count
from churchpipe.bond.junction import wall_junctions
from churchpipe.bond.parts import part_names
from churchpipe.bond.tiles import TileSet, beside
from churchpipe.bond.voids import voids_of
from churchpipe.bond.volume import masonry_volume
from churchpipe.bond.walls import lay_wall, wall_region
from churchpipe.errors import InputError
from churchpipe.geometry.planar import centroids
from churchpipe.geometry.polygons import TOLERANCE, snap
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage, assemble
from churchpipe.model.building import Building, CylinderChart, Panel
from churchpipe.model.doubts import doubt
from churchpipe.model.materials import by_name
from churchpipe.model.sizes import size_questions
from churchpipe.stones.pierced import pierced_solids
from churchpipe.stones.prisms import Solids, solids_of, stations_of, thicken
from churchpipe.stones.ring_beams import add_beams
from churchpipe.vaults.stones import stone_parts, vault_stones

# Relative difference allowed between the stones and the walls.
VOLUME_TOLERANCE = 1e-9
GROUND = "ground"


def derive_blocks(building: Building) -> Assemblage:
    """Return the stones of a building: first the fixed bodies (ground plate, supports), then the stones of the walls, panel by
    panel, then those of the vaults, and ring beams. Sizes that no building has are warned of (`DoubtfulValue`).

    Stones are named "panel-course-number", numbered along the course; voussoirs "panel-region-number". The volume of the stones
    is checked against that of the walls and vaults.

    Parameters
    ----------
    building
        The walls, their bonds and supports.

    Raises
    ------
    InputError
        A wall that cannot be laid, or stones whose volume is not that of the walls.
    """
    check_kind("derive_blocks: building", building, Building, remedy="read_case(...).building() makes one.")
    if not building.panels and not building.vaults:
        raise InputError(f"building {building.name}", "no walls", found=0, expected="at least one panel or vault")
    check_count(building)
    solids = [wall_region(panel) for panel in building.panels]
    junctions = wall_junctions(building.panels, solids, building.junctions)
    tiles = [lay_wall(*wall) for wall in zip(building.panels, solids, junctions, strict=True)]
    walls = [_solids(panel, own) for panel, own in zip(building.panels, tiles, strict=True)]
    vaults = [solids_of(vault_stones(vault)) for vault in building.vaults]
    butts = [beside(own, wall.dry) for own, wall in zip(tiles, junctions, strict=True)]
    stones = _assemble(building, tiles, [*_fixed_bodies(building, [*walls, *vaults]), *walls, *vaults], butts)
    stations = [stations_of(panel.chart, wall) for panel, wall in zip(building.panels, tiles, strict=True)]
    expected = sum(vault.volume for vault in building.vaults)
    if building.panels:
        expected += masonry_volume(building.panels, solids, [wall.crossed[:, [0, 2]].ravel() for wall in junctions], stations)
    found = float(stones.volume[~stones.fixed].sum())
    if abs(found - expected) > VOLUME_TOLERANCE * expected:
        raise InputError(
            f"building {building.name}",
            "the stones do not fill the walls exactly",
            found=f"{found:.9g} m3 of stones",
            expected=f"{expected:.9g} m3 of walls and vaults",
            remedy="Look for rings, lintels or walls that overlap, or parts of a wall without a bond.",
        )
    doubt(size_questions(stones))
    return add_beams(stones, building.ring_beams, {material.name: material.unit_weight for material in building.materials})


def _solids(panel: Panel, tiles: TileSet) -> Solids:
    voids = voids_of(panel)
    if voids and isinstance(panel.chart, CylinderChart):
        return pierced_solids(panel, panel.chart, tiles, voids)
    return thicken(panel.chart, panel.thickness, tiles)


def _fixed_bodies(building: Building, walls: Sequence[Solids]) -> list[Solids]:
    bodies = [
        Solids(
            support.points,
            np.array([node for face in support.faces for node in face], dtype=np.int64),
            np.cumsum([0] + [len(face) for face in support.faces]),
            np.array([0, len(support.faces)]),
            np.array([0, len(support.points)]),
        )
        for support in building.supports
    ]
    if building.ground is not None:
        bodies.insert(0, _ground_plate(np.concatenate([wall.points for wall in walls]), building.ground))
    return bodies


def _ground_plate(points: FloatArray, level: float) -> Solids:
    """Return a plate below the walls that reaches beyond them by half their size."""
    low, high = points.min(axis=0), points.max(axis=0)
    if low[2] < level - TOLERANCE:
        raise InputError("building", "masonry below the ground", found=f"z = {low[2]:g} m", expected=f"z >= {level:g} m")
    margin = 0.5 * float(np.linalg.norm(high - low))
    x = (low[0] - margin, high[0] + margin)
    y = (low[1] - margin, high[1] + margin)
    corner = np.array([[x[i], y[j]] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
    bottom, top = np.full((4, 1), level - 0.25 * margin), np.full((4, 1), level)
    faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    return Solids(
        np.concatenate([np.hstack([corner, bottom]), np.hstack([corner, top])]),
        np.array(faces, dtype=np.int64).ravel(),
        4 * np.arange(7),
        np.array([0, 6]),
        np.array([0, 8]),
    )


def _assemble(building: Building, tiles: Sequence[TileSet], bodies: Sequence[Solids], butts: Sequence[BoolArray]) -> Assemblage:
    point_offset = np.cumsum([0] + [len(body.points) for body in bodies])
    node_offset = np.cumsum([0] + [len(body.face_nodes) for body in bodies])
    face_offset = np.cumsum([0] + [len(body.face_ptr) - 1 for body in bodies])
    points = np.concatenate([body.points for body in bodies])
    fixed_names = [GROUND] * (building.ground is not None) + [support.name for support in building.supports]
    weights = {name: material.unit_weight for name, material in by_name(building.materials).items()}
    material = np.array(
        [building.materials[0].name] * len(fixed_names)
        + [name for p, t in zip(building.panels, tiles, strict=True) for name in _materials(p, t)]
        + [vault.material for vault in building.vaults for _ in range(vault.stone_count)]
    )
    names = [name for p, t in zip(building.panels, tiles, strict=True) for name in _names(p, t)]
    parts = [stone_parts(vault) for vault in building.vaults]
    names += [name for _, _, own in parts for name in own.tolist()]
    return assemble(
        # Two walls compute the same corner by different sums. This makes coordinates equal that differ by rounding.
        points=np.stack([snap(points[:, axis]) for axis in range(3)], axis=1),
        face_nodes=np.concatenate([body.face_nodes + o for body, o in zip(bodies, point_offset[:-1], strict=True)]),
        face_ptr=_chained([body.face_ptr for body in bodies], node_offset),
        block_face_ptr=_chained([body.block_face_ptr for body in bodies], face_offset),
        block_point_ptr=_chained([body.block_point_ptr for body in bodies], point_offset),
        unit_weight=np.array([weights[name] for name in material]),
        material=material,
        panel=np.concatenate(
            [
                fixed_names,
                *(part_names(p, centroids(t.polygons)) for p, t in zip(building.panels, tiles, strict=True)),
                *(part for part, _, _ in parts),
            ]
        ),
        course=np.concatenate([np.full(len(fixed_names), -1), *(t.course for t in tiles), *(course for _, course, _ in parts)]),
        fixed=np.arange(len(material)) < len(fixed_names),
        block_id=np.array([*fixed_names, *names]),
        butts=np.concatenate(
            [np.zeros(len(fixed_names), dtype=np.bool_), *butts, np.zeros(sum(len(p) for p, _, _ in parts), dtype=np.bool_)]
        ),
    )


def _chained(pointers: Sequence[IntArray], offsets: IntArray) -> IntArray:
    return np.concatenate([[0], *(p[1:] + o for p, o in zip(pointers, offsets[:-1], strict=True))])


def _materials(panel: Panel, tiles: TileSet) -> list[str]:
    of_region = {region.name: region.material or panel.material for region in panel.regions}
    return [of_region[name] for name in tiles.region.tolist()]


def _names(panel: Panel, tiles: TileSet) -> list[str]:
    """Return "panel-course-number", numbered along the course; "panel-region-number" of voussoirs."""
    group = np.where(tiles.voussoir, tiles.region, np.char.mod("%02d", tiles.course))
    start = np.append(True, group[1:] != group[:-1])
    number = np.arange(tiles.count) - np.maximum.accumulate(np.where(start, np.arange(tiles.count), 0))
    return [f"{panel.name}-{g}-{k:03d}" for g, k in zip(group, number, strict=True)]
