"""Walls that meet at a slant: no junction is laid there, and none of their stones face each other across a joint."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from churchpipe.geometry.charts import base_level, footprint_of
from churchpipe.geometry.planar import within
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Panel, PlaneChart
from churchpipe.recognition.insets import is_single
from churchpipe.recognition.squaring import RIGHT

# Two walls meet where they are nearer to each other than this share of the thickness of the thinner one.
NEAR = 0.5


def slanted_meetings(panels: Sequence[Panel]) -> list[tuple[Panel, Panel, float]]:
    """Return the plane walls that stand against one another at a slant, each pair once, and the angle between them, degrees."""
    walls = [panel for panel in panels if isinstance(panel.chart, PlaneChart) and not is_single(panel)]
    found: list[tuple[Panel, Panel, float]] = []
    for one, other in combinations(walls, 2):
        slope = abs(float(_along(one) @ _along(other)))
        level = _levels(one), _levels(other)
        if not RIGHT < slope < 1 - RIGHT or min(top for _, top in level) <= max(foot for foot, _ in level):
            continue
        if within(footprint_of(one), footprint_of(other), NEAR * min(one.thickness, other.thickness)):
            found.append((one, other, float(np.degrees(np.arccos(slope)))))
    return found


def _along(panel: Panel) -> FloatArray:
    assert isinstance(panel.chart, PlaneChart)
    return panel.chart.s_axis[:2]


def _levels(panel: Panel) -> tuple[float, float]:
    base = base_level(panel.chart)
    return base + float(panel.outline[:, 1].min()), base + float(panel.outline[:, 1].max())
