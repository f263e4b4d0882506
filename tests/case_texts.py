"""A small case as text, and as a file."""

from pathlib import Path

# A wall pushed along y; more tables may follow.
WALL = """
[source]
generator = "wall"
length_m = 1.2
brick_mm = [400, 250, 200]
courses = 3
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
[[load]]
direction = [0, 1, 0]
"""


def case_file(folder: Path, text: str, name: str = "case.toml") -> Path:
    """The text as a case file in a folder."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
