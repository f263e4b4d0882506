"""From the description of a building to its mid-surfaces as one conforming mesh of triangles."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np

from churchpipe.bond.count import check_count
from churchpipe.bond.parts import part_names
from churchpipe.bond.patterns import bond_of
from churchpipe.errors import InputError
from churchpipe.geometry.charts import lift
from churchpipe.geometry.clusters import NODE_TOLERANCE, clusters, components
from churchpipe.geometry.planar import area
from churchpipe.model.arguments import check_kind, finite
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building, PlaneChart, Support
from churchpipe.model.materials import by_name
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.shell import ShellModel
from churchpipe.shell_mesh.beams import beams_of, shell_beams, with_bearings, with_vaults_on
from churchpipe.shell_mesh.butt_joints import with_butt_joints
from churchpipe.shell_mesh.element_count import check_elements, check_longest, vault_elements, wall_elements
from churchpipe.shell_mesh.laid_stones import LaidWall, laid_lengths, laid_walls
from churchpipe.shell_mesh.ledges import side_by_side, with_ledges, with_tiers
from churchpipe.shell_mesh.midplanes import MidSurface, mid_surfaces
from churchpipe.shell_mesh.self_weight import weight_factors
from churchpipe.shell_mesh.straight_stones import arc_filled
from churchpipe.shell_mesh.subdivision import Subdivision, subdivide
from churchpipe.shell_mesh.tiers import tier_levels, tiers
from churchpipe.shell_mesh.triangulation import Mesh, signed_areas, triangulated
from churchpipe.shell_mesh.vault_ends import with_end_joints
from churchpipe.shell_mesh.vault_facets import vault_facets

# Share of a mid-surface that its mesh may miss, for rounding only.
AREA_TOLERANCE = 1e-6


def derive_shell(building: Building, element_size: float, sizes: Mapping[str, float] | None = None) -> ShellModel:
    """Return the mid-surfaces of a building as one mesh.

    Walls end at the mid-planes of the walls they meet and share nodes there; openings and the borders of bond regions are mesh
    edges. Each facet takes the bed direction, unit cell and yielding of its bond region; single stones (lintels) do not
    yield. Weights are the stones' (see `self_weight`). Supported are the nodes on the ground and on fixed bodies, which are
    taken as convex.

    Parameters
    ----------
    building
        Panels upright.
    element_size
        Largest edge of an element, m, about.
    sizes
        The same for single panels, by name.

    Raises
    ------
    InputError
        A wall that cannot be meshed, a size out of range or of an unknown panel, a wall that rests on nothing.
    """
    check_kind("derive_shell: building", building, Building, remedy="read_case(...).building() makes one.")
    if not building.panels and not building.vaults:
        raise InputError(f"building {building.name}", "no walls", found=0, expected="at least one panel or vault")
    check_count(building)
    bodies = beams_of(building)
    if bodies and not building.panels:
        found, remedy = ", ".join(bodies[0].panel[bodies[1]].tolist()), "Rigid blocks take them as they are."
        raise InputError(f"building {building.name}", "the shell of a vault alone has no ring beams", found=found, remedy=remedy)
    parts = [_walls(building, bodies, _sizes(building, element_size, {} if sizes is None else sizes))] if building.panels else []
    if building.vaults:
        vaults = _vault_shell(building, element_size)
        shell = side_by_side(parts[0], vaults) if parts else vaults
        vaulted = np.arange(len(shell.triangles)) >= len(shell.triangles) - len(vaults.triangles)
        if bodies:
            shell = with_vaults_on(shell, *bodies, vaulted)
        shell = with_end_joints(*with_ledges(shell, vaulted))
    else:
        (shell,) = parts
    _check_resting(shell)
    return shell


def _walls(building: Building, bodies: tuple[Assemblage, IntArray] | None, sizes: Mapping[str, float]) -> ShellModel:
    """Return the mid-surfaces of the panels of a building, under its rigid bodies; sizes: of the elements of each, m."""
    levels = tier_levels(building.panels)
    walls = laid_walls(building)
    found = [_wall_shell(tier, walls, bodies, sizes) for tier in (tiers(building, levels) if levels else [building])]
    shell = reduce(side_by_side, (tier for tier, _ in found))
    if bodies:
        bearing = np.concatenate([own for _, own in found])
        shell = replace(shell, beams=shell_beams(building, *bodies, shell.points, bearing))
    return with_tiers(shell, levels) if levels else shell


def _wall_shell(
    building: Building,
    walls: Mapping[str, LaidWall],
    bodies: tuple[Assemblage, IntArray] | None,
    sizes: Mapping[str, float],
) -> tuple[ShellModel, IntArray]:
    """Return the mid-surfaces of the panels of a building without its rigid bodies, and which of these each facet is under.

    walls: how each whole panel is laid, by its name.
    """
    panels, names = with_butt_joints(building)
    bearing = np.empty(0, dtype=np.int64)
    if bodies:
        panels, names, bearing = with_bearings(panels, names, *bodies)
    surfaces = mid_surfaces(panels, building.junctions)
    meshes = _meshes(surfaces, subdivide(surfaces, [sizes[panel.name] for panel in panels]))
    counts = [len(mesh.bond) for mesh in meshes]
    points, triangles = _merged(surfaces, meshes)
    facets = [points[part] for part in np.split(triangles, np.cumsum(counts)[:-1])]
    regions = [region for panel in panels for region in panel.regions]
    start = np.cumsum([0] + [len(panel.regions) for panel in panels])
    bond = np.concatenate([mesh.bond + offset for mesh, offset in zip(meshes, start[:-1], strict=True)])
    course = np.array([region.cell.a for region in regions])[bond]
    lengths = [laid_lengths(panel, mesh, walls[panel.name]) for panel, mesh in zip(panels, meshes, strict=True)]
    joints = [walls[panel.name].stations for panel in panels]
    names = np.array(names)[bond]
    _, rank = np.unique(names, return_inverse=True)
    stone_sizes = np.column_stack([course, np.concatenate(lengths)])
    _, first, cell = np.unique(np.column_stack([stone_sizes, rank]), axis=0, return_index=True, return_inverse=True)
    weights = {name: material.unit_weight for name, material in by_name(building.materials).items()}
    material = np.array([region.material or panel.material for panel in panels for region in panel.regions])[bond]
    shell = ShellModel(
        points=points,
        triangles=triangles,
        axes=np.concatenate([_axes(*part) for part in zip(surfaces, meshes, facets, strict=True)]),
        thickness=np.repeat([panel.thickness for panel in panels], counts),
        surface_weight=np.array([weights[name] for name in material.tolist()])
        * np.concatenate([_thickness_carried(*part) for part in zip(surfaces, meshes, facets, joints, strict=True)]),
        cell=cell.ravel(),
        unit_cells=stone_sizes[first],
        bonds=names[first],
        material=material,
        panel=np.concatenate([part_names(p, m.corners.mean(axis=1)) for p, m in zip(panels, meshes, strict=True)]),
        yields=np.array([region.yields and region.pattern != "single" for region in regions])[bond],
        **_standing(building, points),
    )
    return shell, bearing[bond] if bodies else bearing


def _vault_shell(building: Building, element_size: float) -> ShellModel:
    """Return the mid-surfaces of vaults, and of the walls that are laid with them."""
    size = finite("element size", element_size)
    if not size > NODE_TOLERANCE * 10:
        raise InputError("element size", "out of range", found=size, expected="> 0 m")
    curved = [vault for vault in building.vaults if vault.shell != "bodies"]
    check_elements(vault_elements(curved, size), size)
    facets = vault_facets(curved, size)
    label = clusters(facets.corner.reshape(-1, 3))
    points = facets.corner.reshape(-1, 3)[np.unique(label, return_index=True)[1]]
    _, rank = np.unique(facets.bond, return_inverse=True)
    _, first, cell = np.unique(np.column_stack([np.round(facets.cell, 12), rank]), axis=0, return_index=True, return_inverse=True)
    weights = {name: material.unit_weight for name, material in by_name(building.materials).items()}
    sides = facets.corner[:, 1:] - facets.corner[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return ShellModel(
        points=points,
        triangles=label.reshape(-1, 3),
        axes=facets.axes,
        thickness=facets.thickness,
        surface_weight=np.array([weights[name] for name in facets.material.tolist()]) * facets.volume / area,
        cell=cell.ravel(),
        unit_cells=np.round(facets.cell[first], 12),
        bonds=facets.bond[first],
        material=facets.material,
        panel=facets.panel,
        yields=facets.yields,
        **_standing(building, points),
    )


def _sizes(building: Building, element_size: float, sizes: Mapping[str, float]) -> dict[str, float]:
    names = [panel.name for panel in building.panels]
    check_kind("derive_shell: sizes", sizes, Mapping, remedy="Pass the element size of each panel, m, by its name.")
    for name in sizes:
        if name not in names:
            raise InputError(f"element size of {name}", "no such panel", expected=", ".join(names))
    out = [finite(f"element size of {name}", sizes.get(name, element_size)) for name in names]
    for name, size in zip(names, out, strict=True):
        if not size > NODE_TOLERANCE * 10:
            raise InputError(f"element size of {name}", "out of range", found=size, expected="> 0 m")
        check_longest(building.panels, size, f"element size of {name}")
    check_elements(wall_elements(building.panels, out), min(out))
    return dict(zip(names, out, strict=True))


def _meshes(surfaces: Sequence[MidSurface], cuts: Sequence[Subdivision]) -> list[Mesh]:
    meshes = triangulated(cuts, [surface.panel.name for surface in surfaces])
    for mesh, surface in zip(meshes, surfaces, strict=True):
        found, expected = float(signed_areas(mesh.corners).sum()), area(surface.region)
        if abs(found - expected) > AREA_TOLERANCE * expected:
            raise InputError(
                f"wall {surface.panel.name}",
                "its mesh does not cover its mid-surface",
                found=f"{found:.9g} m2",
                expected=f"{expected:.9g} m2",
                remedy="Look for openings or bond regions that touch in a point, or are smaller than a micrometre.",
            )
    return meshes


def _merged(surfaces: Sequence[MidSurface], meshes: Sequence[Mesh]) -> tuple[FloatArray, IntArray]:
    """Return the nodes of all mid-surfaces in space, those of the same place as one, and the triangles."""
    flat = [np.unique(mesh.corners.reshape(-1, 2), axis=0, return_inverse=True) for mesh in meshes]
    places = np.concatenate([lift(s.panel.chart, nodes) for s, (nodes, _) in zip(surfaces, flat, strict=True)])
    offsets = np.cumsum([0] + [len(nodes) for nodes, _ in flat])
    corner = np.concatenate([number.ravel() + offset for (_, number), offset in zip(flat, offsets[:-1], strict=True)])
    label = clusters(places)
    first = np.unique(label, return_index=True)[1]
    return places[first], label[corner].reshape(-1, 3)


def _axes(surface: MidSurface, mesh: Mesh, facets: FloatArray) -> FloatArray:
    """Return the local axes (nt, 3, 3) of facets (nt, 3, 3) m: along the bed, up the courses, normal."""
    middle = mesh.corners.mean(axis=1)
    direction = np.empty_like(middle)
    for number, region in enumerate(surface.panel.regions):
        inside = mesh.bond == number
        direction[inside] = bond_of(region).bed_direction(middle[inside])
    normal: FloatArray = np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    # The level and the rising direction are those of the facet itself: a facet of a curved wall is slightly inclined to its
    # chart.
    level: FloatArray = np.cross(np.array([0.0, 0.0, 1.0]), normal)
    level /= np.linalg.norm(level, axis=1, keepdims=True)
    bed: FloatArray = direction[:, :1] * level + direction[:, 1:] * np.cross(normal, level)
    return np.stack([bed, np.cross(normal, bed), normal], axis=1)


def _thickness_carried(surface: MidSurface, mesh: Mesh, facets: FloatArray, stations: FloatArray) -> FloatArray:
    """Return for each facet the volume of stones it carries over its own area (nt,) m; stations: s of a curved wall's joints."""
    carried = surface.panel.thickness * weight_factors(surface, mesh.corners)
    chart = surface.panel.chart
    if isinstance(chart, PlaneChart):
        return carried
    # A facet is shorter than the arc whose stones it carries.
    cross = np.cross(facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0])
    return carried * arc_filled(chart, mesh, stations) * signed_areas(mesh.corners) / (0.5 * np.linalg.norm(cross, axis=1))


def _standing(building: Building, points: FloatArray) -> dict[str, Any]:
    """Return which nodes (nn,) stand on the ground or a fixed body, and the normals (nn, 3) of what they stand on."""
    on, normal = np.zeros(len(points), dtype=np.bool_), np.zeros((len(points), 3))
    for support in building.supports:
        touching, face = _touching(support, points)
        on |= touching
        normal[touching] = face[touching]
    if building.ground is not None:
        lowest = float(points[:, 2].min())
        if lowest < building.ground - NODE_TOLERANCE:
            raise InputError(
                "building", "masonry below the ground", found=f"z = {lowest:g} m", expected=f"z >= {building.ground:g} m"
            )
        level = points[:, 2] < building.ground + NODE_TOLERANCE
        on |= level
        normal[level] = 0.0, 0.0, 1.0
    return {"supported": on, "bed_normal": normal}


def _touching(support: Support, points: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Return which points (n,) lie in a convex body or on it, and the normals (n, 3) of the faces next to them.

    Of the faces that meet at a point it is the one on which most of these points lie.
    """
    nodes = np.array([node for face in support.faces for node in face], dtype=np.int64)
    _, normal, mean = face_normals(support.points, nodes, np.cumsum([0] + [len(face) for face in support.faces]))
    beyond = points @ normal.T - np.einsum("fc,fc->f", normal, mean)
    touching = (beyond < NODE_TOLERANCE).all(axis=1)
    on_face = beyond > beyond.max(axis=1, keepdims=True) - NODE_TOLERANCE
    bearing = on_face[touching].sum(axis=0)
    return touching, normal[np.where(on_face, bearing, -1).argmax(axis=1)]


def _check_resting(shell: ShellModel) -> None:
    edges = np.concatenate([shell.triangles[:, [0, 1]], shell.triangles[:, [1, 2]], shell.ledges[:, :, 0]])
    edges = np.concatenate([edges, np.column_stack([shell.held[:, 0], shell.triangles[shell.held[:, 1], 0]])])
    # Nodes of one beam go together.
    held = np.flatnonzero(shell.on_beam)
    _, first, beam = np.unique(shell.beams.of_node[held], return_index=True, return_inverse=True)
    edges = np.concatenate([edges, np.column_stack([held, held[first[beam]]])])
    part = components(len(shell.points), edges)
    resting = np.bincount(part, shell.supported) > 0
    loose = ~resting[part[shell.triangles[:, 0]]]
    if loose.any():
        raise InputError(
            f"wall {shell.panel[loose][0]}",
            "its mid-surface rests on nothing",
            found=f"walls without a path to the ground: {', '.join(np.unique(shell.panel[loose]))}",
            expected="walls whose footprints overlap where they meet, or that stand on the ground",
            remedy="Extend the outline to the far face of the wall it leans on.",
        )
