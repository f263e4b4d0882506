"""docs/dxf.md names every layer, attribute and property of the layout, and no other."""

import re
from pathlib import Path

from churchpipe.dxf import schema

PAGE = Path(__file__).parents[3] / "docs" / "dxf.md"


def first_cells(text: str) -> list[str]:
    return re.findall(r"^\| `([^`]+)` \|", text, re.MULTILINE)


def test_the_page_of_the_layout_is_complete() -> None:
    names = first_cells(PAGE.read_text(encoding="utf-8"))
    layers = [name for name in names if name.startswith("CP-")]
    assert set(layers) == set(schema.LAYERS)
    properties = {name.removesuffix("<name>") for name in names if name.startswith("CP_")}
    assert properties == {schema.SCHEMA_PROPERTY, schema.UNITS_PROPERTY, schema.MATERIAL_PROPERTY, schema.LOAD_PROPERTY}
    attributes = {name for name in names if not name.startswith("CP")}
    assert attributes == {
        schema.VOLUME,
        schema.NFACES,
        schema.ID,
        schema.MATERIAL,
        schema.PANEL_NAME,
        schema.COURSE,
        schema.BUTTS,
    }
    text = PAGE.read_text(encoding="utf-8")
    assert f"version of this layout: {schema.VERSION}" in text
    assert f"`{schema.BLOCK_PREFIX}<number>`" in text
    assert f"`{schema.APPID}`" in text
