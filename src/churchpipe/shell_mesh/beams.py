"""Ring beams of a shell: the bodies that lie on the stones, and the nodes that they hold."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from churchpipe.bond.period import BondName
from churchpipe.errors import InputError
from churchpipe.geometry.charts import base_level
from churchpipe.geometry.clusters import NODE_TOLERANCE
from churchpipe.geometry.locate import stones_at
from churchpipe.geometry.planar import Region, common, pieces, polygon, united, vertices
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import BondRegion, Building, Panel, PlaneChart
from churchpipe.model.shell_beams import ShellBeams
from churchpipe.stones.blocks import derive_blocks

# Half the width of the stripe that stands for the line in which the mid-plane of a wall meets its top, m.
_NARROW = 1e-4


def with_bearings(
    panels: Sequence[Panel], bonds: Sequence[BondName], stones: Assemblage, beams: IntArray
) -> tuple[tuple[Panel, ...], list[BondName], IntArray]:
    """Return panels with a region more for each stretch under a beam, one course high, so that it may slide there; the bond of
    each region of each panel in turn, and the beam on it, -1 for none.

    bonds: of the panels as they are. beams (nm,): the stones that are beams.
    """
    plans = [(number, *_plan(stones, beam)) for number, beam in enumerate(beams.tolist())]
    changed: list[Panel] = []
    names: list[BondName] = []
    bearing: list[int] = []
    begin = 0
    for panel in panels:
        main, *others = panel.regions
        own: Sequence[BondName] = bonds[begin : begin + len(panel.regions)]
        begin += len(panel.regions)
        strips = [(beam, strip) for beam, plan, level in plans for strip in _strips(panel, plan, level)]
        changed.append(replace(panel, regions=(main, *(strip for _, strip in strips), *others)))
        names.extend([own[0], *(own[0] for _ in strips), *own[1:]])
        bearing += [-1, *(beam for beam, _ in strips), *(-1 for _ in others)]
    return tuple(changed), names, np.array(bearing)


def _strips(panel: Panel, plan: Region, level: float) -> list[BondRegion]:
    """Return the stretches of a panel under a beam with this plan and lower face."""
    chart, main = panel.chart, panel.regions[0]
    if not isinstance(chart, PlaneChart):
        return []
    top = level - base_level(chart)
    if top > panel.outline[:, 1].max() + NODE_TOLERANCE:
        return []
    ends = chart.origin[:2] + np.array([panel.outline[:, 0].min(), panel.outline[:, 0].max()])[:, None] * chart.s_axis[:2]
    across = _NARROW * np.array([-chart.s_axis[1], chart.s_axis[0]])
    middle = polygon(np.array([ends[0] - across, ends[1] - across, ends[1] + across, ends[0] + across]))
    under = [(vertices(part) - chart.origin[:2]) @ chart.s_axis[:2] for part in pieces(common(plan, middle))]
    spans = [(float(s.min()), float(s.max())) for s in under if len(s) and np.ptp(s) > 10 * _NARROW]
    return [
        replace(main, name=f"under a beam {number}", outline=np.array([[a, top - depth], [b, top - depth], [b, top], [a, top]]))
        for number, (a, b) in enumerate(spans, 1)
        for depth in [min(main.cell.a, 0.5 * top)]
    ]


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
    of_node = np.full(len(points), -1, dtype=np.int64)
    level = np.array([_level(stones, beam) for beam in beams.tolist()])
    near = np.flatnonzero((np.abs(points[:, 2, None] - level) < NODE_TOLERANCE).any(axis=1))
    for node in near.tolist():
        own = np.flatnonzero(np.isin(beams, stones_at(stones, points[node])) & (np.abs(level - points[node, 2]) < NODE_TOLERANCE))
        of_node[node] = own[0] if len(own) else -1
    for number, name in enumerate(stones.panel[beams].tolist()):
        held = int((of_node == number).sum())
        if held < 2:
            raise InputError(
                f"building {building.name}",
                "the shell has no nodes under a ring beam",
                found=f"{held} under {name}",
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


def beams_of(building: Building) -> tuple[Assemblage, IntArray]:
    """Return the stones of a building, and which of them (nm,) are its beams."""
    stones = derive_blocks(building)
    count = sum(len(beam.bodies) for beam in building.ring_beams)
    return stones, np.arange(stones.count - count, stones.count)


def _level(stones: Assemblage, stone: int) -> float:
    return float(stones.points[slice(*stones.block_point_ptr[stone : stone + 2]), 2].min())
