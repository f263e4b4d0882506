"""Arched openings in curved walls.

Such an opening is a prism: its sides run straight through the wall, parallel to the wall's normal in the middle of the opening.
"""

from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.planar import Region, polygon, united
from churchpipe.geometry.polygons import corners
from churchpipe.model.arrays import BoolArray, FloatArray, floats, store
from churchpipe.model.building import CylinderChart, Panel

# Greatest half width of an opening with its voussoirs, as a share of the inner radius: the sine of 60 degrees.
WIDEST = np.sqrt(0.75)


@dataclass(frozen=True, slots=True)
class Void:
    """An arched opening of a curved wall, seen along the wall's normal in the middle of the opening.

    In this view x is the distance from the middle plane of the opening and t the height, m. rings: names of the bond regions of
    its voussoirs. middle: s of the middle, m. opening (n, 2), outer (m, 2): outlines x, t, counter-clockwise, of the opening
    alone and together with its voussoirs. filling: the region inside `outer`, in chart coordinates. radii: of the inner and of
    the outer face of the wall, m.
    """

    rings: tuple[str, ...]
    middle: float
    opening: FloatArray
    outer: FloatArray
    filling: Region
    radii: tuple[float, float]

    def __post_init__(self) -> None:
        store(
            self,
            opening=floats("Void.opening", self.opening, (None, 2)),
            outer=floats("Void.outer", self.outer, (None, 2)),
        )

    def faces(self, s: FloatArray, radius: float) -> BoolArray:
        """Return which places s (n,) m are on the same side of the wall's axis as the opening."""
        return np.cos((s - self.middle) / radius) > 0

    def x_at(self, s: float, radius: float) -> tuple[float, float]:
        """Return the least and the greatest x of the radial head joint at s, m, from one face of the wall to the other."""
        across = [float(r * np.sin((s - self.middle) / radius)) for r in self.radii]
        return min(across), max(across)

    def reach(self, radius: float, x: tuple[float, float]) -> tuple[float, float]:
        """Return the least and the greatest s, m, of the masonry between the two given values of x."""
        angle = [np.arcsin(value / r) for value in x for r in self.radii]
        return self.middle + radius * float(min(angle)), self.middle + radius * float(max(angle))


def to_view(chart: CylinderChart, middle: float, points: FloatArray) -> FloatArray:
    """Return the coordinates x, t (n, 2) m of points (n, 2) m of the chart, seen along the normal at s = middle."""
    return np.stack([chart.radius * np.sin((points[:, 0] - middle) / chart.radius), points[:, 1]], axis=1)


def from_view(chart: CylinderChart, middle: float, points: FloatArray) -> FloatArray:
    """Return the chart coordinates (n, 2) m of points x, t (n, 2) m that are seen along the normal at s = middle."""
    return np.stack([middle + chart.radius * np.arcsin(points[:, 0] / chart.radius), points[:, 1]], axis=1)


def voids_of(panel: Panel) -> tuple[Void, ...]:
    """Return the arched openings of a curved wall; none of a plane one.

    The corners of an opening lie on the mid-surface. Between them its edges, and those of its voussoirs, are straight in the
    view along the normal, so that they bound plane joints.

    Raises
    ------
    InputError: an opening that reaches more than 60 degrees of the inner circle to either side.
    """
    chart = panel.chart
    if not isinstance(chart, CylinderChart):
        return ()
    inner = chart.radius - panel.thickness / 2
    found: list[Void] = []
    for opening in panel.openings:
        if opening.kind != "arched":
            continue
        low, high = opening.outline[:, 0].min(), opening.outline[:, 0].max()
        middle = 0.5 * float(low + high)
        outline = to_view(chart, middle, opening.outline)
        outlines = [opening.outline, *(region.outline for region in panel.regions if region.name in opening.rings)]
        whole = united([polygon(to_view(chart, middle, part)) for part in outlines])
        outer = corners(np.array([whole], dtype=np.object_))[0]
        half = float(np.abs(outer[:, 0]).max())
        check_width(f"wall {panel.name}: opening {opening.name}", half, inner)
        found.append(
            Void(
                opening.rings,
                middle,
                outline,
                outer,
                united([polygon(part) for part in outlines]),
                (inner, inner + panel.thickness),
            )
        )
    return tuple(found)


def check_width(where: str, half: float, inner: float) -> None:
    """Raise InputError for an opening that is too wide for its curved wall.

    half: half its width with its voussoirs, m. inner: inner radius of the wall, m.
    """
    if half > WIDEST * inner:
        raise InputError(
            where,
            "too wide for the curve of its wall",
            found=f"{2 * half:.4g} m with its voussoirs",
            expected=f"at most {2 * WIDEST * inner:.4g} m, 120 degrees of the inner circle (radius {inner:g} m)",
            remedy="Make it narrower.",
        )
