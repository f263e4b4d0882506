"""Whose work a report is, of which input, and what the building is made of."""

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from churchpipe.model.assemblage import Assemblage
from churchpipe.wording import four_figures

_TITLES = {"client": "client", "author": "author", "date": "date", "revision": "revision"}


def title_block(project: Mapping[str, str], case_text: str, versions: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return title and text of the entries of a title block.

    A case is known by the first digits of the SHA-256 of its text: two reports with the same digits are of the same input.
    """
    entries = [(title, project[key]) for key, title in _TITLES.items() if project.get(key)]
    if case_text:
        entries.append(("case file", f"SHA-256 {hashlib.sha256(case_text.encode()).hexdigest()[:12]}"))
    if "churchpipe" in versions:
        entries.append(("made with", f"churchpipe {versions['churchpipe']}"))
    return entries


def material_rows(
    stones: Assemblage, materials: Sequence[Mapping[str, Any]], swept: Sequence[Mapping[str, Any]] = ()
) -> list[tuple[str, ...]]:
    """Return a row for each material of the free stones: name, stones, volume, unit weight, weight, friction, cohesion.

    materials: the case's, in SI; what it does not say of a material is "". swept: of each analysis the keys that a sweep changed;
    all values of a friction or a cohesion among them are said.
    """
    said = {str(material["name"]): material for material in materials}
    rows: list[tuple[str, ...]] = []
    for name in np.unique(stones.material[~stones.fixed]).tolist():
        chosen = ~stones.fixed & (stones.material == name)
        volume, weight = stones.volume[chosen].sum(), stones.weight[chosen].sum()
        material = said.get(name, {})
        rows.append(
            (
                name,
                f"{int(chosen.sum()):,}",
                four_figures(float(volume)),
                f"{weight / volume / 1e3:.4g}",
                four_figures(float(weight) / 1e3),
                _values(swept, f"material.{name}.friction", material.get("friction"), 1.0),
                _values(swept, f"material.{name}.cohesion_kPa", material.get("cohesion"), 1e3),
            )
        )
    return rows


def _values(swept: Sequence[Mapping[str, Any]], key: str, value: float | None, unit: float) -> str:
    """Return the values that a sweep gives to a key, or that of the case in the key's unit."""
    several = dict.fromkeys(one[key] for one in swept if key in one)
    return ", ".join(f"{one:g}" for one in several) or ("" if value is None else f"{value / unit:g}")


MATERIAL_HEADINGS = ("Material", "Stones", "Volume, m3", "Unit weight, kN/m3", "Weight, kN", "Friction", "Cohesion, kPa")
