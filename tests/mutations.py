"""Files changed at random, and what reading them comes to."""

import random
import re
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import churchpipe as cp

# Findings that say that something of the file is not among the stones.
SMALLER = {"W11", "W18", "W41", "W42", "W44"}
_NUMBER = re.compile(rb"-?\d+\.?\d*")
Mutation = Callable[[bytes, random.Random], bytes]


def change_bytes(data: bytes, chance: random.Random) -> bytes:
    """Change one to eight bytes."""
    out = bytearray(data)
    for _ in range(chance.randint(1, 8)):
        out[chance.randrange(len(out))] = chance.randrange(256)
    return bytes(out)


def cut_end(data: bytes, chance: random.Random) -> bytes:
    """Keep the beginning."""
    return data[: chance.randrange(1, len(data))]


def cut_out(data: bytes, chance: random.Random) -> bytes:
    """Take out a piece of up to 200 bytes."""
    start = chance.randrange(len(data))
    return data[:start] + data[start + chance.randint(1, 200) :]


def put_in(data: bytes, chance: random.Random) -> bytes:
    """Put in bytes, or a piece of the file itself."""
    at, start = chance.randrange(len(data)), chance.randrange(len(data))
    return data[:at] + chance.choice([chance.randbytes(chance.randint(1, 20)), data[start : start + 100]]) + data[at:]


def change_lines(data: bytes, chance: random.Random) -> bytes:
    """Swap two lines, double one, or leave one out."""
    lines = data.split(b"\n")
    i, j = chance.randrange(len(lines)), chance.randrange(len(lines))
    match chance.randrange(3):
        case 0:
            lines[i], lines[j] = lines[j], lines[i]
        case 1:
            lines.insert(i, lines[j])
        case _:
            del lines[i]
    return b"\n".join(lines)


def change_number(data: bytes, chance: random.Random) -> bytes:
    """Put another number in the place of one to three numbers."""
    found = list(_NUMBER.finditer(data))
    for match in sorted(chance.sample(found, min(len(found), chance.randint(1, 3))), key=lambda m: -m.start()):
        other = chance.choice([b"0", b"-1", b"1e308", b"nan", b"inf", b"99999999", b"1_0", b"0x10", b"1,5", b"", b"1e-30", b"7"])
        data = data[: match.start()] + other + data[match.end() :]
    return data


MUTATIONS: tuple[Mutation, ...] = (change_bytes, cut_end, cut_out, put_in, change_lines, change_number)


# What each solid begins with: a file from which a whole solid was cut out is a sound file of a smaller wall.
_BEGINS = {
    ".obj": rb"^o ",
    ".stl": rb"^solid",
    ".dxf": rb"^(?:INSERT|LWPOLYLINE|MESH|POLYLINE|HATCH)\s*$",
    ".3ddat": rb"^block create poly",
    ".dat": rb"^poly",
    ".DAT": rb"^ RBDY3",
    ".json": rb'"face": ',
}


def announced(path: Path) -> int:
    """Return how many solids a damaged file still begins, counted without reading it."""
    if path.is_dir():
        return sum(announced(file) for file in path.iterdir())
    pattern = _BEGINS.get(path.suffix)
    data = path.read_bytes()
    binary = path.suffix == ".stl" and not data.startswith(b"solid")
    # The bodies of block definitions stand before the entities of a drawing.
    return 10**9 if pattern is None or binary else len(re.findall(pattern, data.rpartition(b"ENTITIES")[2], re.MULTILINE))


def outcome(path: Path, count: int, volume: float, options: dict[str, Any], windows: int = 0) -> tuple[str, str]:
    """Read a file; return what came of it, and the text that goes with it.

    count, volume: of what was written, stones or whole walls, the volume without the ground; windows: outlines that are neither.
    """
    try:
        with warnings.catch_warnings():
            # What overflows on the way would be told on the terminal.
            warnings.simplefilter("error", RuntimeWarning)
            stones, findings = cp.read_stones(path, **({"units": "m", "support": "base"} | options))
    except cp.InputError as error:
        return "refused", str(error)[:300]
    except Exception:  # Whatever comes is what is looked for.
        return "traceback", traceback.format_exc()
    read = float(stones.volume[~stones.fixed].sum())
    told = set(findings.codes) & SMALLER
    base = "W12" in findings.codes
    count = min(count, announced(path) - windows)
    # Of stones laid in whole walls it is the walls that count.
    found = len(np.unique(stones.panel[~stones.fixed])) + stones.fixed.sum() if "bond" in options else stones.count
    if found - base < count and not told:
        return "silently smaller", f"{found - base} of {count} stones; {findings}"
    if read < 0.999 * volume and not told:
        return "another shape", f"{read} of {volume} m3"
    return "read", ""
