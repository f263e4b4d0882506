"""The tables and the picture of docs/walls.md: what the bond of a facade with its side walls is worth, and its mortar; the shell.

PYTHONPATH=tests python benchmarks/junctions.py     # the picture goes to docs/pictures/facade_junctions.png
"""

from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.figure import Figure
from matplotlib.image import imread

import churchpipe as cp
from churchpipe.report.figures import mechanism_picture
from facades import EAVES, FRICTION, GROUTED, facade, facade_building

PICTURE = Path("docs/pictures/facade_junctions.png")
KINDS = {
    "toothed": {},
    "every 4th course": {"every": 4},
    "every 8th course": {"every": 8},
    "cracked above 2 m": {"every": 2, "cracked": (2.0, EAVES)},
    "butt": {"every": 0},
}
SHOWN = ("toothed", "every 4th course", "butt")
# The shell has these.
MESHED = ("toothed", "cracked above 2 m", "butt")
ELEMENTS = 0.3


def main() -> None:
    """Solve the facades, print the table and draw three of them side by side."""
    figure = Figure(figsize=(12, 3.8), layout="constrained")
    axes = dict(zip(SHOWN, figure.subplots(1, len(SHOWN)), strict=True))
    load = cp.LoadCase((0, -1, 0), panels=("facade",))
    print("| bond of the facade with its side walls | load factor |\n|---|---|")
    with TemporaryDirectory() as scratch:
        for name, junction in KINDS.items():
            stones, contacts = facade(**junction)
            state = cp.limit_analysis(stones, contacts, load, FRICTION)
            print(f"| {name} | {state.load_factor:.3f} |")
            if name in axes:
                file = Path(scratch) / "mechanism.png"
                mechanism_picture(stones, state.velocities, file, load.direction, size=(900, 800))
                axes[name].imshow(imread(file))
                axes[name].set_title(f"{name}: {state.load_factor:.3f}")
                axes[name].axis("off")
        figure.savefig(PICTURE, dpi=110)
    print("\n| bond | stones, mortar of 20 kPa | shell | shell, mortar of 20 kPa |\n|---|---|---|---|")
    for name in MESHED:
        stones, contacts = facade(**KINDS[name])
        mortar = cp.limit_analysis(stones, contacts, load, *cp.joint_strength(stones, contacts, [GROUTED]))
        shell = cp.derive_shell(facade_building(**KINDS[name]), ELEMENTS)
        dry = cp.Material("default", GROUTED.unit_weight, FRICTION)
        found = [cp.shell_limit_analysis(shell, load, [material]).load_factor for material in (dry, GROUTED)]
        print(f"| {name} | {mortar.load_factor:.3f} | {found[0]:.3f} | {found[1]:.3f} |")


if __name__ == "__main__":
    main()
