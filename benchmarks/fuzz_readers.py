"""Damage files of every format, thousands of times, and read them: no traceback, no hang, no silently smaller structure.

    .venv/bin/python benchmarks/fuzz_readers.py [FILES_A_WAY] [SEED] [WAY ...] > docs/fuzz_readers.md

A wall of 12 bricks on a plate is written in each format, and for each way of reading (repaired, open joints, whole walls to lay
stones in, a plan, hatches: tests/ways_of_reading.py), and changed at random: bytes changed, cut out, put in, lines swapped and
doubled, numbers changed, the end cut off. Each file is read in a process that is stopped after 20 s. What may come of it: stones,
or an error that names the file (`InputError`). Fewer stones than were written are accepted only with a finding that says so; the
rest is counted as silently smaller, and the file is kept in the folder for temporary files. Another number in the place of a
number is another shape, of which nothing in the file tells.
"""

import multiprocessing
import queue
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from mutations import MUTATIONS, outcome
from ways_of_reading import WAYS

LIMIT = 20.0


def worker(jobs: Any, results: Any) -> None:
    """Read files until there are none."""
    for path, name, count, volume in iter(jobs.get, None):
        begin = time.perf_counter()
        kind, text = outcome(Path(path), count, volume, WAYS[name].options, WAYS[name].windows)
        results.put((path, kind, text, time.perf_counter() - begin))


def run(each: int, seed: int, keep: Path, names: Sequence[str]) -> dict[str, tuple[Counter[str], float]]:
    """Damage and read `each` files a way; files of tracebacks and silent losses are kept in a folder."""
    table: dict[str, tuple[Counter[str], float]] = {}
    for name in names:
        chance = random.Random(f"{name} {seed}")
        counts: Counter[str] = Counter()
        slowest = 0.0
        with tempfile.TemporaryDirectory() as place:
            stones = WAYS[name].stones()
            original = WAYS[name].write(stones, Path(place))
            files = sorted(original.iterdir()) if original.is_dir() else [original]
            count, volume = WAYS[name].size(stones)
            jobs, results, process = start()
            for index in range(each):
                target = chance.choice(files)
                data = target.read_bytes()
                target.write_bytes(chance.choice(MUTATIONS)(data, chance))
                jobs.put((str(original), name, count, volume))
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
    table = run(each, seed, keep, sys.argv[3:] or list(WAYS))
    kinds = ["read", "another shape", "refused", "silently smaller", "traceback", "hang"]
    print("# Damaged files\n")
    print(f"`benchmarks/fuzz_readers.py {each} {seed}`: {sum(sum(c.values()) for c, _ in table.values())} files.\n")
    print("| way | files | " + " | ".join(kinds) + " | slowest, s |")
    print("|---|" + "---|" * (len(kinds) + 2))
    for name, (counts, slowest) in table.items():
        cells = " | ".join(str(counts[kind]) for kind in kinds)
        print(f"| {name} | {sum(counts.values())} | {cells} | {slowest:.2f} |")


if __name__ == "__main__":
    main()
