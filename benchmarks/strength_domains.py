"""Sections of the strength of all bonds, from their cells: docs/pictures/strength_domains.png.

python benchmarks/strength_domains.py
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from churchpipe.report.shell_plots import domain_section

# Stones of .5 x .39 m in a wall .5 m thick: that of docs/validation.md. Friction .6.
WALL = (0.39, 0.5, 0.5, 0.6)
BONDS = {"running": "-", "stack": "--", "flemish": "-.", "english": ":", "leaves": (0, (1, 3))}
# Title, stresses of the axes (of N11, N22, N12, M11, M22, M12), and what else acts.
SECTIONS = [
    ("membrane forces, N22 = -1", 0, 2, {1: -1.0}, ("N11", "N12")),
    ("bending, N11 = -.2, N22 = -1", 3, 4, {0: -0.2, 1: -1.0}, ("M11 / h", "M22 / h")),
    ("twisting, N11 = -.2, N22 = -1", 4, 5, {0: -0.2, 1: -1.0}, ("M22 / h", "M12 / h")),
]
RAYS = 48


def main() -> None:
    """Draw the picture."""
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 3.6), layout="constrained")
    for place, (title, first, second, kept, names) in zip(axes, SECTIONS, strict=True):
        for bond, style in BONDS.items():
            corners, _ = domain_section(*WALL, first, second, kept, rays=RAYS, bond=bond)
            place.plot(*np.concatenate([corners, corners[:1]]).T, ls=style, lw=1.5, label=bond)
        place.set(title=title, xlabel=names[0], ylabel=names[1])
        place.axhline(0, color="0.8", lw=0.6, zorder=0)
        place.axvline(0, color="0.8", lw=0.6, zorder=0)
    axes[0].set_xlim(-3, 0.6)
    axes[0].legend(fontsize=8)
    figure.savefig(Path(__file__).parents[1] / "docs" / "pictures" / "strength_domains.png", dpi=140)


if __name__ == "__main__":
    main()
