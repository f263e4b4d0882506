"""What a run would do, and why, without doing it."""

import os
import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from churchpipe.compilation import writable
from churchpipe.engine import command, date_back
from churchpipe.errors import InputError

# What lies in a run folder beside the results that the engine looks at.
_LEFT = ("*.log", "*.lock", "figures")
# The engine's reasons, and what they mean.
_REASONS = {
    "Missing output files": "not made yet",
    "Input files updated by another job": "what it works on is made anew",
    "Set of input files has changed since last execution": "it works on other files than before",
    "Forced execution": "a run was stopped while it was made",
    "Params have changed since last execution": "it is called in another way than before",
    "Code has changed since last execution": "it is called in another way than before",
}


@dataclass(frozen=True, slots=True)
class Job:
    """A stage that would be run: its name, what it is for, and why."""

    stage: str
    name: str
    why: str


def pending(folder: Path, prepare: Callable[[Path], object], until: str = "") -> list[Job]:
    """Return the stages that a run would do in a folder, in the order of the work.

    The folder is left as it is: plan and settings are written by `prepare` into a copy of it, whose files are links.

    Raises
    ------
    InputError: the engine cannot tell.
    """
    near = folder.resolve().parent
    # Links need one file system, and cannot be where nothing can be written.
    near = near if folder.is_dir() and writable(near) else None
    with tempfile.TemporaryDirectory(prefix=".dry-run-", dir=near) as scratch:
        copy = Path(scratch) / "run"
        if folder.is_dir():
            left = shutil.ignore_patterns(*_LEFT)
            shutil.copytree(folder, copy, copy_function=_link, ignore=left, ignore_dangling_symlinks=True)
            date_back(copy)
        prepare(copy)
        done = subprocess.run([*command(copy, 1, until), "--dry-run"], capture_output=True, text=True, encoding="utf-8")
    if done.returncode:
        last = (done.stdout + done.stderr).strip().splitlines()[-1:]
        raise InputError(str(folder), "what is to do cannot be told", found="".join(last), remedy="churchpipe run says more.")
    return [job for text in re.split(r"^\[.*\]\n", done.stdout, flags=re.MULTILINE) if (job := _job(text))]


def _link(source: str, target: str) -> None:
    with suppress(OSError):
        # One that is dated back is a file of its own.
        if Path(source).stat().st_mtime_ns <= time.time_ns():
            os.link(source, target)
            return
    shutil.copy2(source, target)


def _job(text: str) -> Job | None:
    rule = re.match(r"(?:local)?rule (\w+):", text)
    if not rule or rule[1] == "all":
        return None
    fields = dict(re.findall(r"^ +(\w+): (.*)$", text, flags=re.MULTILINE))
    name = fields["wildcards"].partition("=")[2] if "wildcards" in fields else fields["output"].partition(",")[0]
    return Job(re.sub(r"_\d+$", "", rule[1]), name, _reason(fields.get("reason", "")))


def _reason(text: str) -> str:
    words: list[str] = []
    for part in text.split("; "):
        what, _, files = part.partition(": ")
        if what == "Updated input files":
            words += [_changed(file) for file in files.split(", ")]
        else:
            words.append(_REASONS.get(what, part))
    return ", ".join(dict.fromkeys(words))


def _changed(file: str) -> str:
    if file.startswith("code/"):
        return "the program has changed"
    if Path(file).name in ("settings.json", "tolerances.json", "carried.json", "plan.json"):
        return "its settings have changed"
    return f"{Path(file).name} has changed"
