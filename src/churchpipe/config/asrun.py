"""The case as it was run: a file that runs again from anywhere."""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from churchpipe.config.case import read_table
from churchpipe.config.overrides import apply_overrides
from churchpipe.io.atomic import write_if_changed

_DRAWING = re.compile(r"""(?m)^([^#\n]*?\bdxf\s*=\s*)("[^"\n]*"|'[^'\n]*')""")
_BARE = re.compile(r"[A-Za-z0-9_-]+")


# Lies in a run folder: the case file whose run it is.
ORIGIN = "case-file.txt"


def claim(folder: Path, case: Path) -> None:
    """Note in a run folder the case file whose run it is."""
    write_if_changed(folder / ORIGIN, f"{case.resolve()}\n")


def other_case(folder: Path, case: Path) -> str:
    """Return the case file whose run lies in a folder, if it is another one; "" if not.

    A file that is there no more was moved or renamed: its folder is free.
    """
    origin = folder / ORIGIN
    held = origin.read_text(encoding="utf-8", errors="replace").strip() if origin.is_file() else ""
    return held if held and Path(held).is_file() and not case.samefile(held) else ""


def as_run(case: Path, overrides: Sequence[str]) -> str:
    """Return the text of a case file, the path of its drawing made absolute; with overrides, its keys with what they changed."""
    table = read_table(case)
    text = case.read_text(encoding="utf-8-sig")
    if overrides:
        table = apply_overrides(table, overrides)
        changes = "".join(f"# --set {change}\n" for change in overrides)
        # Without a name the file's own name would be taken, which is another one here.
        text = changes + _toml({"name": case.stem} | table)
    drawing = table.get("source", {}).get("dxf")
    if drawing is None:
        return text
    place = _value((case.parent / drawing).resolve().as_posix())
    return _DRAWING.sub(lambda found: found.group(1) + place, text, count=1)


def _toml(table: dict[str, Any], prefix: str = "") -> str:
    """Return a table as TOML: its values first, then its tables."""
    plain = {key: value for key, value in table.items() if not isinstance(value, dict)}
    lines = [f"{_key(key)} = {_value(value)}\n" for key, value in plain.items()]
    for key, value in table.items():
        if isinstance(value, dict):
            head = f"\n[{prefix}{_key(key)}]\n" if not value or any(not isinstance(item, dict) for item in value.values()) else ""
            lines.append(head + _toml(value, f"{prefix}{_key(key)}."))
    return "".join(lines)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, bool | str):
        # The strings of JSON are strings of TOML.
        return json.dumps(value, ensure_ascii=False)
    return repr(value)


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else json.dumps(key, ensure_ascii=False)
