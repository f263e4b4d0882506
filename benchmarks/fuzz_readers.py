"""Damage files of every format, thousands of times, and read them: no traceback, no hang, no silently smaller structure.

    .venv/bin/python benchmarks/fuzz_readers.py [FILES_A_FORMAT] [SEED] > docs/fuzz_readers.md

A wall of 12 bricks on a plate is written in each format and changed at random: bytes changed, cut out, put in, lines swapped and
doubled, numbers changed, the end cut off. Each file is read in a process that is stopped after 20 s. What may come of it: stones,
or an error that names the file (`InputError`). Fewer stones than were written are accepted only with a finding that says so; the
rest is counted as silently smaller, and the file is kept in the folder for temporary files. Another number in the place of a
number is another shape, of which nothing in the file tells.
"""

import multiprocessing
import queue
import random
import re
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import churchpipe as cp
from mesh_files import WRITERS, fuzz_wall, write_dxf_drawing

LIMIT = 20.0
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


def outcome(path: Path, count: int, volume: float) -> tuple[str, str]:
    """Read a file; return what came of it, and the text that goes with it."""
    try:
        stones, findings = cp.read_stones(path, units="m", support="base")
    except cp.InputError as error:
        return "refused", str(error)[:300]
    except Exception:  # Whatever comes is what is looked for.
        return "traceback", traceback.format_exc()
    read = float(stones.volume.sum())
    told = set(findings.codes) & SMALLER
    base = "W12" in findings.codes
    if stones.count - base < count and not told:
        return "silently smaller", f"{stones.count - base} of {count} stones; {findings}"
    if read < 0.999 * volume and not told:
        return "another shape", f"{read} of {volume} m3"
    return "read", ""


def worker(jobs: Any, results: Any) -> None:
    """Read files until there are none."""
    for path, count, volume in iter(jobs.get, None):
        begin = time.perf_counter()
        kind, text = outcome(Path(path), count, volume)
        results.put((path, kind, text, time.perf_counter() - begin))


Writers = dict[str, Callable[[Any, Path], Path]]


def run(each: int, seed: int, keep: Path, writers: Writers) -> dict[str, tuple[Counter[str], float]]:
    """Damage and read `each` files a format; files of tracebacks and silent losses are kept in a folder."""
    table: dict[str, tuple[Counter[str], float]] = {}
    for name, write in writers.items():
        chance = random.Random(f"{name} {seed}")
        counts: Counter[str] = Counter()
        slowest = 0.0
        with tempfile.TemporaryDirectory() as place:
            stones = fuzz_wall()
            original = write(stones, Path(place))
            files = sorted(original.iterdir()) if original.is_dir() else [original]
            count, volume = stones.count, float(stones.volume.sum())
            jobs, results, process = start()
            for index in range(each):
                target = chance.choice(files)
                data = target.read_bytes()
                target.write_bytes(chance.choice(MUTATIONS)(data, chance))
                jobs.put((str(original), count, volume))
                try:
                    _, kind, text, seconds = results.get(timeout=LIMIT)
                except queue.Empty:
                    kind, text, seconds = "hang", "", LIMIT
                    process.kill()
                    jobs, results, process = start()
                slowest = max(slowest, seconds)
                counts[kind] += 1
                if kind in ("traceback", "hang", "silently smaller"):
                    keep.mkdir(parents=True, exist_ok=True)
                    (keep / f"{name}-{index}-{target.name}").write_bytes(target.read_bytes())
                    (keep / f"{name}-{index}.txt").write_text(f"{kind}\n{text}")
                target.write_bytes(data)
            jobs.put(None)
            process.join()
        table[name] = counts, slowest
        print(name, dict(counts), f"{slowest:.2f} s", file=sys.stderr, flush=True)
    return table


def start() -> tuple[Any, Any, Any]:
    """Start a process that reads."""
    jobs, results = multiprocessing.Queue(), multiprocessing.Queue()
    process = multiprocessing.Process(target=worker, args=(jobs, results), daemon=True)
    process.start()
    return jobs, results, process


def main() -> None:
    """Run, and print the table."""
    each = int(sys.argv[1]) if len(sys.argv) > 1 else 700
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    keep = Path(tempfile.gettempdir()) / "fuzz_readers"
    table = run(each, seed, keep, {**WRITERS, "dxf": write_dxf_drawing})
    kinds = ["read", "another shape", "refused", "silently smaller", "traceback", "hang"]
    print("# Damaged files\n")
    print(f"`benchmarks/fuzz_readers.py {each} {seed}`: {sum(sum(c.values()) for c, _ in table.values())} files.\n")
    print("| format | files | " + " | ".join(kinds) + " | slowest, s |")
    print("|---|" + "---|" * (len(kinds) + 2))
    for name, (counts, slowest) in table.items():
        cells = " | ".join(str(counts[kind]) for kind in kinds)
        print(f"| {name} | {sum(counts.values())} | {cells} | {slowest:.2f} |")


if __name__ == "__main__":
    main()
