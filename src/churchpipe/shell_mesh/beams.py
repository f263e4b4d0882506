"""Rigid bodies on the tops of a shell's walls, ring beams and the slabs below a dome: and the nodes that they hold."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.bond.period import BondName
from churchpipe.errors import InputError
from churchpipe.geometry.charts import base_level
from churchpipe.geometry.clusters import NODE_TOLERANCE
from churchpipe.geometry.locate import stones_at
from churchpipe.geometry.planar import Region, level_section, mapped, polygon, united
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import BondRegion, Building, Panel, PlaneChart
from churchpipe.model.shell import ShellModel
from churchpipe.model.shell_beams import ShellBeams
from churchpipe.shell_mesh.ledges import feet
from churchpipe.stones.blocks import derive_blocks

# A shorter stretch of a wall under a beam bears nothing; half the gap between beams that meet; m.
_SHORT, APART = 0.01, 0.005


def with_bearings(
    panels: Sequence[Panel], bonds: Sequence[BondName], stones: Assemblage, beams: IntArray
) -> tuple[tuple[Panel, ...], list[BondName], IntArray]:
    """Return panels with a region more for each stretch under a beam, one course high, so that it may slide there; the bond of
    each region of each panel in turn, and the beam on it, -1 for none.

    bonds: of the panels as they are. beams (nm,): the stones that are beams.
    """
    plans = [_plan(stones, beam) for beam in beams.tolist()]
    changed: list[Panel] = []
    names: list[BondName] = []
    bearing: list[int] = []
    begin = 0
    for panel in panels:
        main, *others = panel.regions
        own: Sequence[BondName] = bonds[begin : begin + len(panel.regions)]
        begin += len(panel.regions)
        strips = _strips(panel, plans)
        changed.append(replace(panel, regions=(main, *(strip for _, strip in strips), *others)))
        names.extend([own[0], *(own[0] for _ in strips), *own[1:]])
        bearing += [-1, *(beam for beam, _ in strips), *(-1 for _ in others)]
    return tuple(changed), names, np.array(bearing)


def _strips(panel: Panel, plans: Sequence[tuple[Region, float]]) -> list[tuple[int, BondRegion]]:
    """Return the stretches of a panel under beams with these plans and levels, each with the number of its beam."""
    chart, main = panel.chart, panel.regions[0]
    if not isinstance(chart, PlaneChart):
        return []
    axes = np.array([chart.s_axis[:2], [-chart.s_axis[1], chart.s_axis[0]]])
    low, high = panel.outline[:, 0].min(), panel.outline[:, 0].max()
    stretches: list[tuple[int, float, float, float]] = []
    for beam, (plan, level) in enumerate(plans):
        top = level - base_level(chart)
        spans = np.clip(level_section(mapped(plan, axes, -axes @ chart.origin[:2]), 0.0), low, high)
        if top < panel.outline[:, 1].max() + NODE_TOLERANCE:
            stretches += [(beam, top, a, b) for a, b in spans.tolist() if b - a > _SHORT]
    ends = np.array([(top, end) for _, top, *both in stretches for end in both]).reshape(-1, 2)
    found: list[tuple[int, BondRegion]] = []
    for number, (beam, top, a, b) in enumerate(stretches, 1):
        # Two beams that meet keep a little apart, so that each has nodes of its own to its end.
        a, b = (
            end + side * APART * (np.abs(ends - [top, end]).max(axis=1) < _SHORT).sum(initial=-1)
            for end, side in ((a, 1), (b, -1))
        )
        depth = min(main.cell.a, 0.5 * top)
        outline = np.array([[a, top - depth], [b, top - depth], [b, top], [a, top]])
        found.append((beam, replace(main, name=f"under a beam {number}", outline=outline)))
    return found


def _plan(stones: Assemblage, stone: int) -> tuple[Region, float]:
    """Return what the lower face of a beam covers, and its height, m."""
    level = _level(stones, stone)
    faces: list[FloatArray] = []
    for face in range(*stones.block_face_ptr[stone : stone + 2]):
        corners = stones.points[stones.face_nodes[stones.face_ptr[face] : stones.face_ptr[face + 1]]]
        if np.ptp(corners[:, 2]) < NODE_TOLERANCE and abs(corners[0, 2] - level) < NODE_TOLERANCE:
            faces.append(corners[:, :2])
    return united([polygon(face) for face in faces], NODE_TOLERANCE), level


def shell_beams(building: Building, stones: Assemblage, beams: IntArray, points: FloatArray, bearing: IntArray) -> ShellBeams:
    """Return the beams of a mesh with these nodes (nn, 3) m; bearing (nt,): the beam that each facet is under.

    Raises
    ------
    InputError: a beam that no edge of the mesh lies under.
    """
    of_node = _holding(stones, beams, points, [_level(stones, beam) for beam in beams.tolist()])
    for number, name in enumerate(stones.panel[beams].tolist()):
        held = int((of_node == number).sum())
        if held < 2:
            raise InputError(
                f"building {building.name}",
                f"the shell has no nodes under {name}",
                found=f"{held}",
                expected="the mid-plane of a wall under it",
                remedy="A beam narrower than its wall lies in its middle; smaller elements may help.",
            )
    return ShellBeams(
        name=stones.panel[beams],
        material=stones.material[beams],
        centroid=stones.centroid[beams],
        weight=stones.weight[beams],
        of_node=of_node,
        bearing=bearing,
    )


def beams_of(building: Building) -> tuple[Assemblage, IntArray] | None:
    """Return the stones of a building, and which of them (nm,) are rigid bodies of its shell; None where there are none."""
    names = [part for vault in building.vaults if vault.shell == "bodies" for part in vault.parts]
    names += [body for beam in building.ring_beams for body in beam.bodies]
    if not names:
        return None
    stones = derive_blocks(building)
    return stones, np.flatnonzero(np.isin(stones.panel, names))


def with_vaults_on(shell: ShellModel, stones: Assemblage, beams: IntArray, vaulted: BoolArray) -> ShellModel:
    """Return the shell whose beams hold the feet of vaults that stand on them, too. vaulted (nt,): facets of vaults."""
    node = np.unique(feet(shell, vaulted))
    top = [float(_corners(stones, beam)[:, 2].max()) for beam in beams.tolist()]
    of_node = shell.beams.of_node.copy()
    of_node[node] = _holding(stones, beams, shell.points[node], top)
    return replace(shell, beams=replace(shell.beams, of_node=of_node))


def _holding(stones: Assemblage, beams: IntArray, points: FloatArray, level: Sequence[float]) -> IntArray:
    """Return for each point (n, 3) m the first beam (nm,) with a bed there, at its level (nm,) m, or -1."""
    found = np.full(len(points), -1, dtype=np.int64)
    at_level = np.abs(points[:, 2, None] - np.asarray(level)) < NODE_TOLERANCE
    for node in np.flatnonzero(at_level.any(axis=1)).tolist():
        own = np.flatnonzero(np.isin(beams, stones_at(stones, points[node])) & at_level[node])
        found[node] = own[0] if len(own) else -1
    return found


def _level(stones: Assemblage, stone: int) -> float:
    return float(_corners(stones, stone)[:, 2].min())


def _corners(stones: Assemblage, stone: int) -> FloatArray:
    return stones.points[slice(*stones.block_point_ptr[stone : stone + 2])]
