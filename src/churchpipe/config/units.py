"""Units in key names: converted here, on the way in, and nowhere else."""

import math
from typing import Any

# Suffix -> (multiply, divide): dividing by 1000 rounds correctly, multiplying by 0.001 does not.
UNITS: dict[str, tuple[float, float]] = {
    "_mm": (1.0, 1e3),
    "_m": (1.0, 1.0),
    "_deg": (math.pi, 180.0),
    "_kN_m3": (1e3, 1.0),
    "_kPa": (1e3, 1.0),
    "_GPa": (1e9, 1.0),
    "_m_s2": (1.0, 1.0),
    "_g": (9.80665, 1.0),
}


def bare(key: str) -> str:
    """Return a key without its unit."""
    return key.removesuffix(next((unit for unit in UNITS if key.endswith(unit)), ""))


def in_si(table: dict[str, Any]) -> dict[str, Any]:
    """Return a table with units taken out of its keys and values in SI; nested tables too."""
    out: dict[str, Any] = {}
    for key, value in table.items():
        suffix = next((unit for unit in UNITS if key.endswith(unit)), "")
        out[key.removesuffix(suffix)] = (
            in_si(value) if isinstance(value, dict) else _scaled(value, *UNITS.get(suffix, (1.0, 1.0)))
        )
    return out


def _scaled(value: Any, multiply: float, divide: float) -> Any:
    if isinstance(value, list):
        return tuple(in_si(item) if isinstance(item, dict) else _scaled(item, multiply, divide) for item in value)
    if isinstance(value, bool) or not isinstance(value, int | float) or (multiply, divide) == (1.0, 1.0):
        return value
    return value * multiply / divide
