"""Findings as a drawing to lay over the one they are about: a layer a kind, a circle at each place."""

from pathlib import Path
from typing import Final

import numpy as np
from ezdxf import filemanagement

from churchpipe.dxf import schema
from churchpipe.findings import CODES, Findings

# Radius of a circle as part of the extent of all places, and when there is but one place, m.
RADIUS, ALONE = 0.01, 0.25
COLOURS: Final = {"error": 1, "warning": 40}


def write_findings(findings: Findings, path: Path, units: str) -> None:
    """Write the findings that have a place, as circles in the unit of the drawing they are about."""
    metre = 1.0 / schema.metres(units)
    document = filemanagement.new(schema.DXF_VERSION)
    document.header["$INSUNITS"] = schema.UNITS[units][0]
    space = document.modelspace()
    units_of = {"m": metre}
    placed = [(f, units_of.get(f.unit, 1.0) * np.array(f.position)) for f in findings if f.position]
    extent = float(np.ptp([place for _, place in placed], axis=0).max()) if placed else 0.0
    radius = RADIUS * extent if extent else ALONE * metre
    for finding, place in placed:
        layer = "".join(c for c in f"{finding.code} {CODES[finding.code]}" if c not in '<>/\\":;?*|=`,').strip()
        if layer not in document.layers:
            document.layers.add(layer, color=COLOURS[finding.severity])
        space.add_circle(place.tolist(), radius, dxfattribs={"layer": layer})
        note = space.add_text(f"{finding.code}: {finding.what}".replace("^", " ")[:250], height=0.3 * radius)
        note.dxf.update({"layer": layer, "insert": place.tolist()})
    document.saveas(path)
