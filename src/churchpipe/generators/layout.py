"""Straight walls, given by their place in plan and the line of their tops. Towers and churches are made of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Literal

import numpy as np

from churchpipe.errors import InputError
from churchpipe.generators.arched import Hole, holes
from churchpipe.generators.openings import rectangle
from churchpipe.generators.wall_bonds import Bonding
from churchpipe.geometry.planar import Region, area, common, less, polygon, united
from churchpipe.model.building import Panel, Part, PlaneChart

# Lengths closer than this are equal, m.
CLOSE = 1e-9


@dataclass(frozen=True, slots=True)
class WallLayout:
    """One straight wall: along x or y, its centreline at y or x = `at`, thickness, m; top: its upper outline from one end to
    the other, (s, z) in m, s being x or y. runs_through: parity of the courses on which it runs through its junctions. parts:
    macro-elements as (name, start, stop), m. foot: z at which it begins, m."""

    name: str
    along: Literal["x", "y"]
    at: float
    thickness: float
    top: tuple[tuple[float, float], ...]
    runs_through: Literal[0, 1]
    parts: tuple[tuple[str, float, float], ...] = ()
    foot: float = 0.0

    @property
    def span(self) -> tuple[float, float]:
        """Start and stop, s in m."""
        return self.top[0][0], self.top[-1][0]

    @property
    def height(self) -> float:
        """Height of its highest point, m."""
        return max(z for _, z in self.top)


def wall_panels(layouts: Sequence[WallLayout], bonding: Bonding, obstacles: Sequence[WallLayout] = ()) -> list[Panel]:
    """Return the walls as panels. obstacles: further walls that openings must keep clear of.

    Raises
    ------
    InputError: an opening that does not fit into its wall, openings that overlap.
    """
    return [_panel(layout, bonding, [*layouts, *obstacles]) for layout in layouts]


def _panel(layout: WallLayout, bonding: Bonding, layouts: Sequence[WallLayout]) -> Panel:
    start, stop = layout.span
    outline = np.array([(start, layout.foot), (stop, layout.foot), *layout.top[::-1]])
    found = holes(bonding.openings, layout.name)
    for hole in found:
        _check_fit(hole, layout, polygon(outline), layouts)
    for first, second in combinations(found, 2):
        _check_apart(first, second, layout.name)
    origin, axis = ((0.0, layout.at, 0.0), (1.0, 0.0, 0.0)) if layout.along == "x" else ((layout.at, 0.0, 0.0), (0.0, 1.0, 0.0))
    return Panel(
        layout.name,
        PlaneChart(np.array(origin), np.array(axis)),
        outline,
        layout.thickness,
        (bonding.region(layout.name, outline), *(ring for hole in found for ring in hole.rings)),
        material=bonding.material_of(layout.name),
        openings=tuple(hole.opening for hole in found),
        runs_through=layout.runs_through,
        parts=tuple(Part(name, rectangle(low, layout.foot, high, layout.height)) for name, low, high in layout.parts),
    )


def top_at(layout: WallLayout, s: float) -> float:
    """Return z of the top of a wall at s, m: on the higher side of a step; 0 beyond the wall."""
    z = [0.0]
    for (s0, z0), (s1, z1) in pairwise(layout.top):
        if s0 - CLOSE <= s <= s1 + CLOSE:
            z += [z0, z1] if s1 - s0 < CLOSE else [z0 + (z1 - z0) * min(max((s - s0) / (s1 - s0), 0.0), 1.0)]
    return max(z)


def check_clear(leg: WallLayout, end: WallLayout, others: Sequence[WallLayout], where: str) -> None:
    """Raise InputError unless the leg of an apse fits into the wall `end`, clear of the walls that cross it."""
    low, high = leg.at - leg.thickness / 2, leg.at + leg.thickness / 2
    start, stop = end.span
    for other in others:
        near, far = other.at - other.thickness / 2, other.at + other.thickness / 2
        reaches = other.span[1] > end.at
        if reaches and low < far - CLOSE and high > near + CLOSE:
            raise InputError(
                where,
                f"its wall meets the wall {other.name}",
                found=f"x = {low:.4g} to {high:.4g} m",
                expected=f"clear of {near:.4g} to {far:.4g} m",
                remedy="Make its radius or thickness smaller, or move its centre.",
            )
    if low < start - CLOSE or high > stop + CLOSE:
        raise InputError(
            where,
            "does not fit on its wall",
            found=f"x = {low:.4g} to {high:.4g} m",
            expected=f"within {start:.4g} to {stop:.4g} m",
        )


def _check_fit(hole: Hole, layout: WallLayout, outline: Region, layouts: Sequence[WallLayout]) -> None:
    """Raise InputError unless an opening with its voussoirs lies within its wall, clear of the walls that cross it."""
    s0, t0, s1, t1 = hole.outer
    (start, stop), where = layout.span, f"wall {layout.name}: opening {hole.opening.name}"
    if s0 < start - CLOSE or s1 > stop + CLOSE:
        raise InputError(
            where,
            "wider than its wall" if s1 - s0 > stop - start + CLOSE else "reaches beyond an end of its wall",
            found=f"{s0:.4g} to {s1:.4g} m with its {hole.around} ({s1 - s0:.4g} m)",
            expected=f"within {start:.4g} to {stop:.4g} m ({stop - start:.4g} m)",
            remedy=f"Move or narrow it, or make its {'bearing shorter' if hole.around == 'lintel' else 'voussoirs less deep'}.",
        )
    if area(less(_with_rings(hole), [outline])) > CLOSE:
        raise InputError(
            where,
            "reaches beyond the top or the foot of its wall",
            found=f"z = {t0:.4g} to {t1:.4g} m with its {hole.around}",
            expected=f"within {layout.foot:.4g} to {top_at(layout, 0.5 * (s0 + s1)):.4g} m, less where the top slopes",
            remedy="Lower the springing, or make it smaller." if hole.opening.rings else "Lower it, or make it smaller.",
        )
    for other in layouts:
        low, high = other.at - other.thickness / 2, other.at + other.thickness / 2
        crossing = other.along != layout.along and start < high and stop > low
        level = t0 < top_at(other, layout.at) - CLOSE and t1 > other.foot + CLOSE
        if crossing and level and s0 < high - CLOSE and s1 > low + CLOSE:
            raise InputError(
                where,
                f"reaches into the wall {other.name}",
                found=f"{s0:.4g} to {s1:.4g} m with its {hole.around}",
                expected=f"clear of {low:.4g} to {high:.4g} m",
                remedy=f"Move or narrow it, or make its {'voussoirs less deep' if hole.opening.rings else 'bearing shorter'}.",
            )


def _check_apart(first: Hole, second: Hole, wall: str) -> None:
    shared = area(common(_with_rings(first), _with_rings(second)))
    if shared > CLOSE:
        around = " or ".join(sorted({first.around, second.around}))
        raise InputError(
            f"wall {wall}: openings {first.opening.name} and {second.opening.name}",
            f"overlap with their {around if around != 'lintel' else 'lintels'}",
            found=f"{shared:.4g} m2 in common",
            expected="openings beside or above each other",
            remedy="Move one of them, or make it smaller.",
        )


def _with_rings(hole: Hole) -> Region:
    return united([polygon(hole.opening.outline), *(polygon(ring.outline) for ring in hole.rings)])
