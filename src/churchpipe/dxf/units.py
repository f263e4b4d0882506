"""The length unit of a drawing: declared, passed, and believed only when stones of that size exist."""

from typing import Any, Literal

import numpy as np

from churchpipe.dxf import schema
from churchpipe.dxf.stones import Stone
from churchpipe.findings import Finding
from churchpipe.geometry.mending import signed_volumes

Drawn = Literal["stone", "wall"]
WHOLE_WALLS = " Where walls are drawn whole, without their stones, pass --bond instead, which lays stones in them."


def find_unit(
    document: Any, stones: list[Stone], flawed: list[float], units: str | None, drawn: Drawn, findings: list[Finding]
) -> str | None:
    """Return the name of the unit to read the drawing in, None when nothing tells; doubts go to `findings`.

    flawed: sizes of bodies that are no stones, which have the unit of the others; units: the name passed by the user, which
    settles every doubt; drawn: what the bodies are.
    """
    code = document.header.get("$INSUNITS", 0)
    declared = declared_unit(document)
    size = median_size(stones, flawed)
    if units is not None:
        factor = schema.metres(units)
        if declared not in (None, units):
            findings.append(Finding("W04", f'$INSUNITS says "{declared}", read as "{units}" as asked'))
        if size is not None and not plausible(size * factor, drawn):
            findings.append(Finding("W05", f"the median {drawn} measures {length_text(size * factor)}, read in {units} as asked"))
        return units
    if declared is None:
        strange = schema.STRANGE_UNITS.get(code)
        said = f" ({strange}), in which no building is drawn" if strange else ", which is no length"
        what = "no units ($INSUNITS is 0)" if code == 0 else f"$INSUNITS = {code}{said}"
        findings.append(Finding("E04", what, "the unit of the drawing", unit_hint(size, drawn)))
        return None
    written = document.header.custom_vars.get(schema.UNITS_PROPERTY)
    if written is not None and written != declared:
        found = f'$INSUNITS says "{declared}", but the drawing was written in "{written}"'
        remedy = f"Pass --units {written}, or --units {declared} if it was scaled since." if written in schema.UNITS else ""
        findings.append(Finding("E05", found, f"one unit{_size_text(size, declared, drawn)}", remedy))
    elif written is None and size is not None and not plausible(size * schema.metres(declared), drawn):
        low, high = schema.PLAUSIBLE_SIZE[drawn]
        found = f'$INSUNITS says "{declared}", so the median {drawn} measures {length_text(size * schema.metres(declared))}'
        findings.append(Finding("E05", found, f"{low:g} to {high:g} m", unit_hint(size, drawn, declared)))
    return declared


def declared_unit(document: Any) -> str | None:
    """Return the unit that a drawing says it is in, None when it names no length."""
    return schema.UNIT_OF_CODE.get(document.header.get("$INSUNITS", 0))


def median_size(stones: list[Stone], flawed: list[float]) -> float | None:
    """Return the median cube root of the volume of free stones, those with flaws included, drawing units; None without any."""
    free = [stone for stone in stones if not stone.fixed]
    by_volume = np.cbrt(signed_volumes([(stone.points, stone.faces) for stone in free])).tolist()
    sizes = [stone.size or size for stone, size in zip(free, by_volume, strict=True)]
    sizes += [size for size in flawed if size > 0]
    return float(np.median(sizes)) if sizes else None


def plausible(size: float, drawn: Drawn = "stone") -> bool:
    """Can a stone, or a whole wall, measure so much, m?"""
    low, high = schema.PLAUSIBLE_SIZE[drawn]
    return low <= size <= high


def unit_hint(size: float | None, drawn: Drawn, declared: str | None = None) -> str:
    """Name the units in which the median stone would be a stone, the median wall a wall."""
    if size is None:
        return "Set the units (UNITS), or pass --units mm, cm or m."
    tries = likely_units(size, drawn, declared)
    known = f"Pass {tries}" if tries else "Pass --units with its unit"
    again = f", or --units {declared} if it is right" if declared else ""
    hint = f"The median {drawn} measures {size:.4g} drawing units. {known}{again}."
    # Walls drawn whole are no stones of a smaller unit: in that one the building would be as small, and its loads as wrong.
    if drawn == "stone" and declared and size * schema.metres(declared) > schema.PLAUSIBLE_SIZE["stone"][1]:
        hint += WHOLE_WALLS if plausible(size * schema.metres(declared), "wall") else ""
    return hint


def likely_units(size: float, drawn: Drawn, declared: str | None) -> str:
    """Return the options for the units, other than the declared one, in which the median stone or wall would be one."""
    likely = [name for name in ("m", "cm", "mm", "in", "ft") if name != declared and plausible(size * schema.metres(name), drawn)]
    return ", ".join(f"--units {name} ({length_text(size * schema.metres(name))})" for name in likely)


def _size_text(size: float | None, unit: str, drawn: Drawn) -> str:
    return "" if size is None else f"; the median {drawn} would measure {length_text(size * schema.metres(unit))}"


def length_text(metres: float) -> str:
    """Return a length in m or mm, whichever reads better."""
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1000:.3g} mm"
