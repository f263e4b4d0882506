"""The picture of docs/drawings.md: small drawings with one fault each, and where their findings are.

PYTHONPATH=tests python benchmarks/drawing_faults.py     # the picture goes to docs/pictures/drawing_faults.png
"""

from pathlib import Path
from textwrap import fill

import ezdxf
import numpy as np
from ezdxf.path import make_path
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from churchpipe.findings import CODES, FindingsError
from churchpipe.meshes.reader import read_file
from corpus_files import CORPUS, FILES

PICTURE = Path("docs/pictures/drawing_faults.png")
# Files of the corpus, and the finding each is there for.
SHOWN = {
    "not-closed.dxf": "W25",
    "crossing.dxf": "E25",
    "doubled.dxf": "E11",
    "joints-open.dxf": "E26",
    "loose-lines.dxf": "W18",
    "curved.dxf": "W27",
    "no-support.dxf": "E12",
    "narrow-pier.dxf": "E28",
    "void.dxf": "W29",
    "outline-inside.dxf": "E29",
}


def main() -> None:
    """Read the drawings, draw them as drawn, and circle what was found."""
    figure = Figure(figsize=(15, 6), layout=ConstrainedLayoutEngine(h_pad=0.12))
    for axes, (name, code) in zip(figure.subplots(2, 5).flat, SHOWN.items(), strict=True):
        corners = []
        for entity in ezdxf.readfile(CORPUS / name).modelspace():
            points = np.array([(point.x, point.y) for point in make_path(entity).flattening(1.0)])
            ground = entity.dxf.layer.upper() == "GROUND"
            axes.plot(*points.T, color="0.6" if ground else "0.1", linewidth=1.0 if ground else 1.6)
            corners.append(points)
        low, high = np.concatenate(corners).min(axis=0), np.concatenate(corners).max(axis=0)
        try:
            findings = read_file(CORPUS / name, **FILES[name][1]).findings
        except FindingsError as error:
            findings = error.findings
        for finding in findings:
            if finding.code == code and finding.position:
                # Places are told in metres, these drawings are in millimetres.
                x, y = 1e3 * np.array(finding.position[:2])
                axes.plot(x, y, "o", markersize=22, markerfacecolor="none", markeredgecolor="crimson", markeredgewidth=2)
        margin = 0.15 * float((high - low).max())
        axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin), aspect="equal")
        axes.set_axis_off()
        axes.set_title(fill(f"{code}: {CODES[code]}", 27), fontsize=13, color="crimson" if code[0] == "E" else "0.1")
    figure.savefig(PICTURE, dpi=100)


if __name__ == "__main__":
    main()
