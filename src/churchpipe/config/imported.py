"""The case file of an imported drawing, or of another file of stones."""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import MISSING
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from tomlkit.items import Item, Table

from churchpipe.config.analyses import RigidSettings
from churchpipe.config.shell_table import ShellTable
from churchpipe.dxf.carried import words
from churchpipe.dxf.reader import Drawing
from churchpipe.dxf.reading import Reading
from churchpipe.model.loads import LoadCase, default_name, load_table
from churchpipe.model.materials import Material
from churchpipe.model.quantities import as_written, declared, written

# Above this many the non-associative analysis is left to who asks for it.
MANY_STONES = 3000


def imported_case(
    path: Path,
    drawing: Drawing,
    reading: Reading,
    *,
    unit_weight: float | None,
    friction: float | None,
    loads: Sequence[LoadCase],
    tolerances: Mapping[str, float],
    shell: ShellTable,
) -> tuple[str, list[str]]:
    """Return the text of a case file and the keys that nobody gave, which stand in it as comments.

    Parameters
    ----------
    path: of the file, whose copy lies beside the case. drawing, reading: what was read of it, and how.
    unit_weight: N/m3, of all stones; friction: of all joints; None: as the drawing stores them. loads: those of the case.
    tolerances: of contacts, those that somebody gave, m and rad. shell: its table.
    """
    case = tomlkit.document()
    case.add(tomlkit.comment(f"Imported from {path.name}."))
    # Composed letters, which a file system may have taken apart, are letters of a name.
    case["name"] = re.sub(r"[^\w.+-]+", "-", unicodedata.normalize("NFC", path.stem)).strip("-.+") or "drawing"
    kind = "dxf" if path.suffix.lower() == ".dxf" else "file"
    case["source"] = _table({kind: path.name, **as_written(reading, defaults=False)})
    materials, missing = tomlkit.table(is_super_table=True), list[str]()
    stored = {material.name: material for material in drawing.materials}
    for name in material_names(drawing):
        materials[name], absent = _material_table(stored.get(name), unit_weight, friction)
        missing += [f"material.{tomlkit.key(name).as_string()}.{key}" for key in absent]
    case["material"] = materials
    case.add(tomlkit.nl())
    if loads:
        case["load"] = tomlkit.aot()
        for load in loads:
            case["load"].append(_load_table(load))
    else:
        for line in ("[[load]]", "direction = [1, 0, 0]"):
            case.add(tomlkit.comment(line))
        case.add(tomlkit.nl())
        missing.append("[[load]] with its direction")
    for key, records in (("line_loads", drawing.line_loads), ("ties", drawing.ties)):
        if records:
            case.add(tomlkit.nl())
            case[key] = tomlkit.aot()
            for record in records:
                case[key].append(_table(words(record)))
    case["rigid"] = _rigid_table(drawing.stones.count, tolerances)
    if shell.keys:
        case["shell"] = _table(shell.keys)
        if shell.comment:
            case["shell"]["analyses"].comment(shell.comment)
    return tomlkit.dumps(case), missing


def material_names(drawing: Drawing) -> list[str]:
    """Return the names of the materials of free stones, and then those of others that the drawing stores."""
    used = np.unique(drawing.stones.material[~drawing.stones.fixed]).tolist()
    return list(dict.fromkeys([*used, *(material.name for material in drawing.materials)]))


def _material_table(stored: Material | None, unit_weight: float | None, friction: float | None) -> tuple[Table, list[str]]:
    """Return the table of a material and the keys that nobody gave."""
    given = {"unit_weight": unit_weight, "friction": friction}
    table, missing = tomlkit.table(), list[str]()
    for item in declared(Material).values():
        if item.name == "name":
            continue
        default = None if item.default is MISSING else item.default
        value = given.get(item.name)
        value = getattr(stored, item.name, default) if value is None else value
        if item.table and value is not None:
            table[item.key] = tomlkit.inline_table()
            table[item.key].update({key: _number(part) for key, part in as_written(value).items()})
        elif value is not None:
            table[item.key] = _number(written(item.key, value))
        elif item.default is MISSING:
            table.add(tomlkit.comment(f"{item.key} =    # not in the drawing: fill it in"))
            missing.append(item.key)
    return table, missing


def _load_table(load: LoadCase) -> Table:
    values = load_table(load, defaults=False)
    if load.name == default_name(load.direction, load.multiplies):
        values.pop("name")
    way = {"direction": [_number(value) for value in load.direction]} if load.direction.any() else {}
    return _table(values | way)


def _rigid_table(stones: int, tolerances: Mapping[str, float]) -> Table:
    """Return which flow rules a case asks for: both, unless the second would take most of an hour a load."""
    few = stones <= MANY_STONES
    table = _table({"flow": ["associative", "non-associative"] if few else ["associative"]})
    if not few:
        table["flow"].comment('"non-associative" takes some hundred times longer for so many stones')
    for item in declared(RigidSettings).values():
        if item.name in tolerances:
            table[item.key] = _number(written(item.key, tolerances[item.name]))
    return table


def _table(keys: Mapping[str, Any]) -> Table:
    table = tomlkit.table()
    for key, value in keys.items():
        table[key] = _number(value) if isinstance(value, float) else value
    return table


def _number(value: float) -> Item:
    # One unit in the last place hides that 0.001 has no exact binary form; nothing else is rounded.
    short = f"{value:.15g}"
    return tomlkit.value(short if abs(float(short) - value) <= 2**-52 * abs(value) else repr(float(value)))
