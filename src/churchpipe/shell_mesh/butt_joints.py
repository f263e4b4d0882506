"""Butt joints and cracked junctions in the shell: strips in stack bond without cohesion, where one wall ends within another.

Walls of a shell end at the mid-planes of those that they meet. Between that mid-plane and the face of the wall that runs
through, the wall that butts has no stones of its own; this strip stands for the joint. Stack bond without cohesion bears what the
joint does: pressure across it, and along it the friction of that pressure.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import repeat

import numpy as np

from churchpipe.bond.junction import wall_junctions
from churchpipe.bond.period import BondName, bond_name
from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG, counted_from
from churchpipe.geometry.polygons import TOLERANCE
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import BondRegion, Building, Panel


def with_butt_joints(building: Building) -> tuple[tuple[Panel, ...], list[BondName]]:
    """Return the panels of a building with a region more for each stretch of a butt joint, and the bond of each region of each
    panel in turn.

    Raises
    ------
    InputError: a junction that stones bond on every so many courses; a wall that goes on behind the one it butts against.
    """
    for junction in building.junctions:
        if junction.every > 2:
            raise InputError(
                f"junction of {' and '.join(junction.walls)}",
                "the shell has toothed, butt and cracked junctions, and would overrate this one",
                found=f"every {junction.every} courses",
                remedy="Rigid blocks take it as it is.",
            )
    if not any(junction.every == 0 or junction.cracked for junction in building.junctions):
        return building.panels, [bond_name(region) for panel in building.panels for region in panel.regions]
    solids = [wall_region(panel) for panel in building.panels]
    panels: list[Panel] = []
    bonds: list[BondName] = []
    for panel, junctions in zip(building.panels, wall_junctions(building.panels, solids, building.junctions), strict=True):
        strips = _strips(panel, _stacked(junctions.dry))
        panels.append(replace(panel, regions=(*panel.regions, *strips)))
        bonds.extend(bond_name(region) for region in panel.regions)
        bonds.extend(repeat("butt", len(strips)))
    return tuple(panels), bonds


def _strips(panel: Panel, stretches: Sequence[FloatArray]) -> list[BondRegion]:
    ends = panel.outline[:, 0].min(), panel.outline[:, 0].max()
    main = panel.regions[0]
    out: list[BondRegion] = []
    for number, (s0, t0, s1, t1) in enumerate(one.tolist() for one in stretches):
        if s0 > ends[0] + TOLERANCE and s1 < ends[1] - TOLERANCE:
            raise InputError(
                f"wall {panel.name}",
                "the shell has no butt joint of a wall that goes on behind the other one",
                found=f"from {s0:.4g} to {s1:.4g} {ALONG}, {counted_from(panel.chart)}",
                remedy="Rigid blocks take it as it is.",
            )
        outline = np.array([[s0, t0], [s1, t0], [s1, t1], [s0, t1]])
        out.append(BondRegion(f"butt joint {number + 1}", outline, "stack", main.cell, material=main.material))
    return out


def _stacked(rectangles: FloatArray) -> list[FloatArray]:
    """Return rectangles (n, 4), s0, t0, s1, t1, with those that lie on top of each other as one."""
    joined: list[FloatArray] = []
    for one in rectangles[np.lexsort((rectangles[:, 1], rectangles[:, 0]))]:
        if joined and abs(joined[-1][0] - one[0]) < TOLERANCE and abs(joined[-1][3] - one[1]) < TOLERANCE:
            joined[-1] = np.append(joined[-1][:3], one[3])
        else:
            joined.append(one)
    return joined
