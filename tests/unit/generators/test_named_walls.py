"""Loads, ties and movements name walls: the reference says, of each generator, what its walls are called."""

import re
from pathlib import Path

import pytest

import churchpipe as cp

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("name", "generator"),
    [("wall", "wall"), ("box", "box"), ("arch", "arch"), ("arch_piers", "arch_piers"), ("s22", "prototype"), ("tower", "tower")],
)
def test_the_reference_names_the_walls(name: str, generator: str) -> None:
    page = (ROOT / "docs" / "reference_case.md").read_text(encoding="utf-8")
    section = page.split(f'## generator = "{generator}"')[1].split("|")[0]
    building = cp.read_case(ROOT / "pipeline" / "cases" / f"{name}.toml").building()
    names = [panel.name for panel in building.panels if panel.name != "partition-3"]
    assert all(re.search(rf"\b{name}\b", section) for name in names)
    if len(names) == 1:
        assert f"called {names[0]}." in section
