"""The case as it was run: a file that runs again from anywhere."""

from collections.abc import Sequence
from pathlib import Path

import tomlkit

from churchpipe.config.overrides import override
from churchpipe.io.atomic import write_if_changed

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
    """Return the text of a case file with its name, the overrides and the absolute path of its drawing in it."""
    document = tomlkit.parse(case.read_text(encoding="utf-8-sig"))
    override(document, overrides)
    for key in ("dxf", "file"):
        if drawing := document["source"].get(key):
            document["source"][key] = (case.parent / drawing).resolve().as_posix()
    # Without a name the file's own name would be taken, which is another one here.
    name = "" if "name" in document else tomlkit.dumps({"name": case.stem})
    return "".join(f"# --set {change}\n" for change in overrides) + name + tomlkit.dumps(document)
