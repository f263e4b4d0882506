"""churchpipe DXF 1: the layers, tags, attributes, properties and units of a drawing of stones."""

import re
from typing import Final

from churchpipe.errors import InputError

VERSION: Final = 1
DXF_VERSION: Final = "R2010"
APPID: Final = "CHURCHPIPE"

BLOCKS: Final = "CP-BLOCKS"
VERTEX: Final = "CP-VERTEX"
CENTROID: Final = "CP-CENTROID"
INTERFACE: Final = "CP-INTERFACE"
SOLID: Final = "CP-SOLID"
SUPPORT: Final = "CP-SUPPORT"
TIES: Final = "CP-TIES"
LOADS: Final = "CP-LOADS"
# Layers that mean ground, whoever drew it.
GROUND: Final = (SUPPORT, "SUPPORT", "SUPPORTS", "GROUND")

# Layer -> AutoCAD colour index.
LAYERS: Final = {BLOCKS: 7, VERTEX: 1, CENTROID: 2, INTERFACE: 4, SOLID: 9, SUPPORT: 3, TIES: 3, LOADS: 6}

BLOCK_PREFIX: Final = "CP_Q"
LINE_PREFIX: Final = "CP_L"

VERTEX_TAG: Final = re.compile(r"V(\d{1,9})")
INTERFACE_TAG: Final = re.compile(r"F(\d{1,9})\.(\d{1,9})")
CENTROID_TAG: Final = "G"

# Attributes of a definition (constant) and of an insert (variable).
VOLUME, NFACES = "VOLUME", "NFACES"
ID, MATERIAL, PANEL_NAME, COURSE, BUTTS = "ID", "MATERIAL", "PANEL", "COURSE", "BUTTS"

# Custom document properties.
SCHEMA_PROPERTY: Final = "CP_SCHEMA"
UNITS_PROPERTY: Final = "CP_UNITS"
MATERIAL_PROPERTY: Final = "CP_MATERIAL_"
LOAD_PROPERTY: Final = "CP_LOAD_"

# Name of a length unit -> ($INSUNITS, metres).
UNITS: Final = {
    "m": (6, 1.0),
    "dm": (14, 0.1),
    "cm": (5, 0.01),
    "mm": (4, 0.001),
    "km": (7, 1000.0),
    "in": (1, 0.0254),
    "ft": (2, 0.3048),
    "yd": (10, 0.9144),
    "mi": (3, 1609.344),
    "mil": (9, 25.4e-6),
    "um": (13, 1e-6),
    "dam": (15, 10.0),
    "hm": (16, 100.0),
    # Of surveys in the United States, where a metre is 39.37 inches.
    "us-ft": (21, 1200 / 3937),
    "us-in": (22, 100 / 3937),
    "us-yd": (23, 3600 / 3937),
    "us-mi": (24, 5280 * 1200 / 3937),
}
UNIT_OF_CODE: Final = {code: name for name, (code, _) in UNITS.items()}
# $INSUNITS of lengths in which nobody draws a building.
STRANGE_UNITS: Final = {
    8: "microinches",
    11: "angstroms",
    12: "nanometres",
    17: "gigametres",
    18: "astronomical units",
    19: "light years",
    20: "parsecs",
}

# Median cube root of the volume of the stones, or of walls drawn whole, m: outside of this a drawing's unit is not believed.
# Bricks drawn in millimetres and taken for inches would measure 3 m.
PLAUSIBLE_SIZE: Final = {"stone": (0.02, 2.5), "wall": (0.2, 50.0)}

# No coordinate of a building is larger, in any unit; larger ones are damage, and overflow.
LARGEST_COORDINATE: Final = 1e12

# Bodies whose corners agree to this part of their size are the same; VOLUME as drawn may be rounded to 1 %.
CORNER_TOLERANCE: Final = 1e-6
VOLUME_TOLERANCE: Final = 1e-2


def is_position_tag(text: str) -> bool:
    """Is a text one of V<i>, F<face>.<corner> and G?"""
    return bool(text == CENTROID_TAG or VERTEX_TAG.fullmatch(text) or INTERFACE_TAG.fullmatch(text))


def metres(unit: str) -> float:
    """Return the length of a unit in m; an unknown name is an `InputError`."""
    if not isinstance(unit, str) or unit not in UNITS:
        raise InputError("units", "unknown unit", found=repr(unit), expected=", ".join(UNITS))
    return UNITS[unit][1]


def check_text(where: str, text: str) -> str:
    """Return a name that a DXF attribute can hold: one line, no blanks around it, no DXF escape in it."""
    if not (text.isprintable() and text == text.strip() and not re.search(r"\\[UuMm]\+|\^", text) and len(text) <= 250):
        raise InputError(
            where,
            "a drawing cannot hold this name",
            found=repr(text),
            expected="one line of at most 250 printable characters, no blanks at its ends, no ^ and no \\U+ in it",
        )
    return text
