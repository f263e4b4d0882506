"""The walls of a building and their openings, for a table and for the viewer."""

from typing import Any

import numpy as np

from churchpipe.geometry.charts import lift
from churchpipe.model.arrays import FloatArray
from churchpipe.model.building import Building, CylinderChart, Opening, Panel


def wall_rows(building: Building) -> list[tuple[str, ...]]:
    """Return of each wall, and of each part of a vault, its name, what it is, its size, its material and its openings."""
    rows = [
        (
            panel.name,
            f"wall {1e3 * panel.thickness:.0f} mm" + (", curved" if isinstance(panel.chart, CylinderChart) else ""),
            _size(panel.outline),
            panel.material,
            "; ".join(f"{opening.name} {_size(opening.outline)}" for opening in panel.openings),
        )
        for panel in building.panels
    ]
    parts = [(part, vault.material) for vault in building.vaults for part in vault.parts]
    return rows + [(name, "vault", "", material, "") for name, material in parts]


def opening_outlines(building: Building, origin: FloatArray) -> list[dict[str, Any]]:
    """Return the edges of all openings on both faces of their walls, m from `origin`, for the viewer."""
    return [
        {"points": (points - origin).tolist(), "label": f"{panel.name}: {opening.name}"}
        for panel in building.panels
        for opening in panel.openings
        for points in _edges(panel, opening)
    ]


def _edges(panel: Panel, opening: Opening) -> list[FloatArray]:
    return [lift(panel.chart, opening.outline, side * panel.thickness / 2) for side in (-1.0, 1.0)]


def _size(outline: FloatArray) -> str:
    width, height = np.ptp(outline, axis=0)
    return f"{width:.2f} \u00d7 {height:.2f} m"
