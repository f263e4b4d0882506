"""Start Snakemake on a run folder, follow it, and leave no lock behind. Snakemake is a child process, never imported here."""

import fcntl
import importlib.util
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, Any

from churchpipe import standby
from churchpipe.compilation import caches_of_user, writable
from churchpipe.errors import Extra, InputError, UsageError
from churchpipe.io.atomic import remove_parts
from churchpipe.resources import pipeline_folder

# News begin so; everything else in a run's output is Snakemake's, for people.
MARK = "@churchpipe "
# Lies in a run folder from the start of a run until it has ended well.
UNFINISHED = "unfinished.txt"
# The profile of one machine.
LOCAL = "local"
# Loads its libraries while the plan of the run is made, and waits for its orders.
_WAITING = "churchpipe.waiting_engine"
# Dates of files are no coarser than this, ns.
_TICK = 10**9
# Dates that differ by this are told apart by the engine, which has them as seconds, ns.
_APART = 10**3
# What the engine says where it cannot note which stages it has finished.
_NO_ROOM = re.compile("No space left on device|Disk quota exceeded|Read-only file system")
# Exit status of a stage that ran out of memory.
_NO_MEMORY = 3
# What the engine says of a job that it has noted as finished.
_NOTED = re.compile(r"Finished jobid: \d+ \(Rule: (\w+)\)")
# What the engine says of the command of a stage that failed: its name, that of its result, and its exit status.
_CRASHED = re.compile(r" stage -- (\w+) (\S+) .*returned non-zero exit status (\d+)")


@dataclass(frozen=True, slots=True)
class Event:
    """News of a run. kind: "start", "progress", "done", "error" of a stage; "total": `share` is the number of stages to do."""

    kind: str
    stage: str = ""
    name: str = ""
    text: str = ""
    share: float = 0.0


def say(event: Event) -> str:
    """Return an event as the line that `run` understands."""
    return MARK + json.dumps([event.kind, event.stage, event.name, event.text, event.share])


def heard(line: str) -> Event | None:
    """Return the news in a line of a run's output; None where there are none.

    Snakemake ends its lines by a write of their own: news of a stage that come in between stand behind Snakemake's words.
    """
    _, mark, news = line.partition(MARK)
    return Event(*json.JSONDecoder().raw_decode(news)[0]) if mark else None


@dataclass(frozen=True, slots=True)
class Engine:
    """An engine that loads its libraries, or has: its process, the line on which its orders come, and the profile of its jobs."""

    process: "subprocess.Popen[str]"
    line: socket.socket
    profile: str


@contextmanager
def started(profile: str = LOCAL) -> Iterator[Engine]:
    """Yield an engine that waits for its orders, see `run`; it does not outlive the block."""
    with Extra("churchpipe run"):
        if importlib.util.find_spec("snakemake") is None:
            raise ModuleNotFoundError(name="snakemake")
    with TemporaryDirectory(prefix="churchpipe-") as scratch, ExitStack() as opened:
        words = [sys.executable, "-m", _WAITING, profile]
        if profile == LOCAL and standby.available():
            words = [sys.executable, "-m", standby.__name__, str(Path(scratch, "standby")), *words]
        environment = dict(os.environ)
        if not writable(caches_of_user()):
            # Snakemake does not start without a place for its caches, and Matplotlib leaves one of its own behind.
            environment = {"MPLCONFIGDIR": scratch, **environment, "XDG_CACHE_HOME": scratch}
        ours, theirs = (opened.enter_context(end) for end in socket.socketpair())
        # A session of its own: an interrupt reaches engine and jobs through here alone, once, from whatever cause.
        process = opened.enter_context(
            subprocess.Popen(
                words,
                env=environment,
                stdin=theirs.fileno(),
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                encoding="utf-8",
                errors="replace",
                start_new_session=True,
            )
        )
        theirs.close()
        try:
            yield Engine(process, ours, profile)
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)


def run(
    engine: Engine,
    folder: str | Path,
    jobs: int,
    watch: Callable[[Event], None],
    prepare: Callable[[], object] | None = None,
    until: str = "",
) -> int:
    """Make everything that is missing or stale in a run folder; return Snakemake's exit code.

    engine: of `started`. `prepare` writes the plan, once no other run can be at work on it. until: the last stage to make, all
    where it is empty. All output goes to run.log. An interrupt stops the engine and its jobs; what was finished stays.

    Raises
    ------
    InputError: another run is at work in this folder.
    """
    folder = Path(folder).resolve()
    errors: list[str] = []

    def follow(event: Event) -> None:
        if event.kind == "error":
            errors.append(event.text)
        watch(event)

    with _only_run(folder) as lock, _stopped(engine.process):
        date_back(folder)
        if prepare:
            prepare()
        # Until the run has ended well, what lies here may be of an older case.
        mark = folder / UNFINISHED
        mark.write_text("it was stopped, or is still at work\n", encoding="utf-8")
        remove_parts(folder)
        with _named(folder / "run.log") as log:
            begin = time.time()
            _order(engine, command(folder, jobs, until, engine.profile)[3:], lock)
            code = _follow(engine.process, log, follow, Noted() if engine.profile == LOCAL else _finished)
        if code and engine.profile != LOCAL:
            # What jobs on other machines said did not pass here.
            errors += _errors(folder, begin, watch)
        if not code and until:
            mark.write_text(f"it was asked for no more than the stage {until}\n", encoding="utf-8")
        elif code:
            mark.write_text("\n".join(dict.fromkeys(errors)) or crashes(folder), encoding="utf-8")
        else:
            mark.unlink()
        return code


def unfinished(folder: str | Path) -> str:
    """Return why the last run of a folder did not end well; "" when it did."""
    mark = Path(folder) / UNFINISHED
    return mark.read_text(encoding="utf-8", errors="replace").strip() if mark.is_file() else ""


def command(folder: Path, jobs: int, until: str = "", profile: str = LOCAL) -> list[str]:
    """Return the command line of Snakemake for a run folder. until: the last stage to make. profile: as of `run`."""
    pipeline = pipeline_folder()
    here = ["--resources", f"mem_mb={memory()}"] if profile == LOCAL else ["--jobs", str(jobs)]
    return [
        *(sys.executable, "-m", "snakemake", "--nocolor", "--cores", str(jobs), "--directory", str(folder)),
        *("--snakefile", str(pipeline / "Snakefile"), "--profile", str(profile_folder(profile)), *here),
        *(["--until", until] if until else []),
    ]


def profile_folder(profile: str) -> Path:
    """Return the folder of a profile: one of ours by its name, or a folder of the person's own.

    Raises
    ------
    UsageError: there is no such profile, or what it needs is not installed.
    """
    ours = pipeline_folder() / "profiles"
    known = sorted(folder.name for folder in ours.iterdir())
    folder = ours / profile if profile in known else Path(profile).resolve()
    if not (folder / "config.yaml").is_file():
        expected = f"{', '.join(known)} or a folder with a config.yaml of Snakemake"
        raise UsageError(f"--profile {profile}", "no such profile", expected=expected)
    if profile == "slurm" and importlib.util.find_spec("snakemake_executor_plugin_slurm") is None:
        remedy = "pip install 'churchpipe[slurm]' installs it."
        raise UsageError("--profile slurm", "a package is not installed", found="snakemake-executor-plugin-slurm", remedy=remedy)
    return folder


def memory() -> int:
    """Return the memory of this machine, MB: jobs that would not fit into it side by side follow each other."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20


def _order(engine: Engine, arguments: Sequence[str], lock: IO[str]) -> None:
    """Let the engine begin, which inherits the lock of its folder."""
    lock.seek(0)
    lock.truncate()
    lock.write(str(engine.process.pid))
    lock.flush()
    # An engine that has died says why, where it is followed.
    with suppress(BrokenPipeError):
        socket.send_fds(engine.line, [json.dumps(arguments).encode()], [lock.fileno()])


@contextmanager
def _stopped(process: "subprocess.Popen[str]") -> Iterator[None]:
    """Stop an engine with its jobs if it still runs at the end, before its folder is free for others."""
    try:
        yield
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


@contextmanager
def _named(path: Path) -> Iterator[IO[str]]:
    """Yield a file to write, whose name stands in what the system says of a write that fails."""
    try:
        with path.open("w", encoding="utf-8") as file:
            yield file
    except OSError as error:
        error.filename = error.filename or str(path)
        raise


class Noted:
    """News of a run on this machine by the lines of its output. A stage is done when the engine has noted it, some 30 ms after
    the stage itself says so: a run that is stopped before makes it again."""

    def __init__(self) -> None:
        self._done: list[Event] = []

    def __call__(self, line: str) -> list[Event]:
        """Return the news in a line, and what was held back until it."""
        found, event = _NOTED.search(line), heard(line)
        told = [done for done in self._done if found and done.stage == found[1]][:1]
        for done in told:
            self._done.remove(done)
        if event and event.kind == "done":
            self._done.append(event)
        elif event:
            told.append(event)
        return told


def _follow(
    process: "subprocess.Popen[str]", log: IO[str], watch: Callable[[Event], None], news: Callable[[str], Sequence[Event]]
) -> int:
    """Keep what the engine says; return its exit code."""
    for line in process.stdout or ():
        log.write(line)
        log.flush()
        for event in news(line):
            watch(event)
    return process.wait()


def _finished(line: str) -> list[Event]:
    """Return what the engine says of a job on another machine, whose own news do not pass here."""
    if found := _NOTED.search(line):
        return [Event("done", found[1])]
    event = heard(line)
    return [event] if event else []


def _errors(folder: Path, begin: float, watch: Callable[[Event], None]) -> list[str]:
    """Return what stages that failed since a time have said in their own logs, and pass it on."""
    logs = [log for log in sorted((folder / "log").rglob("*.txt")) if log.stat().st_mtime >= begin]
    said = (heard(line) for log in logs for line in log.read_text(encoding="utf-8", errors="replace").splitlines())
    found = [event for event in said if event and event.kind == "error"]
    for event in found:
        watch(event)
    return [event.text for event in found]


def crashes(folder: Path) -> str:
    """Return which stages ended without a word, and how, from what the engine says of their commands."""
    log = (folder / "run.log").read_text(encoding="utf-8", errors="replace")
    told: list[str] = []
    for stage, name, code in _CRASHED.findall(log):
        ended = "it ran out of memory" if int(code) == _NO_MEMORY else f"it ended with status {code}"
        if int(code) > 128:
            ended = f"signal {int(code) - 128} ended it from outside, as where the machine has no memory left"
        where = folder / "log" / stage / f"{name}.txt"
        told.append(f"The stage {stage} of {name} crashed: {ended}. Run it again, what is finished stays; see {where}")
    if not told and (full := _NO_ROOM.search(log)):
        return f"{folder}: {full[0]}. Make room there, or choose another folder with --out; what is finished stays."
    return "\n".join(dict.fromkeys(told)) or f"A stage crashed; see {folder / 'run.log'}"


def date_back(folder: Path) -> None:
    """Date what a clock that was ahead has dated after now: else what changes from now on would be older than its results.

    What was older than another stays so: a run may have been stopped where results were older than what they are made of.
    """
    now, ahead = time.time_ns(), dict[Path, int]()
    for path in folder.rglob("*"):
        with suppress(FileNotFoundError):
            if (date := path.lstat().st_mtime_ns) > now:
                ahead[path] = date
    order = {date: rank for rank, date in enumerate(sorted(set(ahead.values())))}
    for path, date in ahead.items():
        place = now - _TICK + min(order[date] * _APART, _TICK)
        # A file of somebody else keeps its date.
        with suppress(FileNotFoundError, PermissionError):
            os.utime(path, ns=(place, place), follow_symlinks=False)


@contextmanager
def _only_run(folder: Path) -> Iterator[IO[str]]:
    """Hold the folder for one run; yield the lock that the engine inherits.

    The system drops both locks when their holders die, so neither can be stale. The second one tells whether an engine
    outlived the run that started it (killed with -9): it is stopped before its work is taken over.
    """
    state = folder / ".snakemake"
    state.mkdir(parents=True, exist_ok=True)
    with (state / "run.lock").open("a") as ours, (state / "engine.lock").open("a+") as theirs:
        if not _lock(ours):
            raise InputError(str(folder), "another run is at work in this folder", remedy="Wait for it, or choose another --out.")
        if not _lock(theirs):
            _stop_leftover(theirs)
        yield theirs


def _stop_leftover(lock: IO[str]) -> None:
    lock.seek(0)
    if pid := lock.read().strip():
        os.killpg(int(pid), signal.SIGKILL)
    fcntl.flock(lock, fcntl.LOCK_EX)


def _lock(file: IO[Any]) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
