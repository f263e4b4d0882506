"""Masonry over openings that is held on one side only: L-shaped openings, and those that reach the end of their wall."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from churchpipe.bond.walls import wall_region
from churchpipe.errors import InputError
from churchpipe.geometry.charts import ALONG, along, base_level, counted_from, footprint_of, lift
from churchpipe.geometry.planar import contains, extent, polygon
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.building import Panel
from churchpipe.recognition.lintels import ABOVE, LEVEL, SEAT, UNDER, bare_heads, slight, undersides
from churchpipe.wording import counted

# Where along what hangs there is looked for what is below it, and over it.
_PLACES = np.linspace(0.02, 0.98, 49)
_UP = np.array([0.0, ABOVE])
FREE = "held on one side only, as over an L-shaped opening or one that reaches the end of the wall"


@dataclass(frozen=True, slots=True)
class Overhang:
    """Masonry of a wall over nothing, m in its chart: from start to stop at the height `level`, with a free end."""

    start: float
    stop: float
    level: float

    def __str__(self) -> str:
        return f"from {self.start:.4g} to {self.stop:.4g} {ALONG}, {self.level:.4g} m high"


def overhangs(panel: Panel, walls: Sequence[Panel] = (), supports: Sequence[FloatArray] = ()) -> list[Overhang]:
    """Return where a wall hangs over nothing at one end or both, without an arch or a lintel there.

    walls: those that may stand below a free end, the wall itself as well; supports: points (n, 3) m of each body that may.
    """
    solid = wall_region(panel)
    base = float(extent(solid)[1])
    over = [polygon(region.outline) for region in panel.regions if region.pattern in ("single", "voussoir")]
    others = [wall for wall in walls if wall is not panel]
    found: list[Overhang] = []
    for chain, rises, falls in undersides(solid):
        if (rises and falls) or chain[:, 1].max() <= base + LEVEL:
            continue
        place = chain[0, 0] + _PLACES * (chain[-1, 0] - chain[0, 0])
        edge = np.column_stack([place, np.interp(place, chain[:, 0], chain[:, 1])])
        covered = np.zeros(len(edge), dtype=bool)
        for region in over:
            covered |= contains(region, edge + _UP)
        if covered.mean() >= UNDER:
            continue
        free = np.array([not rises, not falls])
        if (free & ~_borne(lift(panel.chart, edge[[0, -1]] - _UP), others, supports)).any():
            found.append(Overhang(float(chain[0, 0]), float(chain[-1, 0]), float(chain[:, 1].max())))
    return sorted(found, key=lambda one: (one.start, one.level))


def hanging(panels: Sequence[Panel]) -> Iterator[str]:
    """Yield of each upright wall what is to be said of masonry that hangs over its openings, or nearly does."""
    walls = [panel for panel in panels if _upright(panel)]
    for panel in walls:
        flat = [head for head in bare_heads(panel) if head.flat]
        if flat:
            over = "it" if len(flat) == 1 else "them"
            yield (
                f'"{panel.name}" has {counted(len(flat), "opening")} with a flat head and no lintel: friction of head joints '
                f"holds the stones over {over}, and no shell stands there without cohesion."
            )
        for name, high, long, rests in slight(panel):
            yield (
                f'"{panel.name}": {name}, {1e3 * high:.3g} mm high and {long:.3g} m long, bears {1e3 * rests:.3g} mm at one end; '
                f"usual are {1e3 * SEAT:g} mm and more, as edges spall, and heights and bearings above a fiftieth of the length."
            )
        if found := overhangs(panel, walls):
            places = f"{'; '.join(map(str, found))}, {counted_from(panel.chart)}"
            yield (
                f'"{panel.name}" has masonry that is {FREE}: {places}. Friction of head joints and the '
                "weight of the wall on its other end hold it, and a lintel on it bears on what hangs."
            )


def _borne(points: FloatArray, walls: Sequence[Panel], supports: Sequence[FloatArray]) -> BoolArray:
    """Return of points (n, 3) m whether a wall or a support is there."""
    found = np.zeros(len(points), dtype=bool)
    for body in supports:
        found |= ((points >= body.min(axis=0) - ABOVE) & (points <= body.max(axis=0) + ABOVE)).all(axis=1)
    for wall in walls:
        inside = contains(footprint_of(wall), points[:, :2])
        if inside.any():
            flat = np.column_stack([along(wall.chart, points[:, :2]), points[:, 2] - base_level(wall.chart)])
            found |= inside & contains(wall_region(wall), flat)
    return found


def _upright(panel: Panel) -> bool:
    try:
        wall_region(panel)
    except InputError:
        return False
    return True
