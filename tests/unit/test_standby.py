"""The process that stands by: a fork of it is the command that was asked for, with its own output, folder and end."""

import fcntl
import json
import os
import signal
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from churchpipe import call_standby
from churchpipe.cli.app import USAGE

CLIENT = call_standby.__file__
# Calls the process that stands by, as the jobs of an engine do, and says what came of it.
ASK = f"""
import json, os, sys
sys.path.insert(0, {str(Path(CLIENT).parent)!r})
from call_standby import PLACE, ask
sys.stdout.flush()
codes = [ask(os.environ[PLACE], words) for words in json.loads(sys.argv[1])]
print(json.dumps(codes), file=sys.stderr)
sys.exit(7)
"""


def stand_by(folder: Path, *commands: list[str], ask: str = ASK) -> "subprocess.CompletedProcess[str]":
    """Let a program call commands of a process that stands by in a folder."""
    words = [
        sys.executable,
        "-m",
        "churchpipe.standby",
        str(folder / "door"),
        sys.executable,
        "-I",
        "-c",
        ask,
        json.dumps(commands),
    ]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=120)


@pytest.mark.slow
def test_a_fork_writes_where_its_caller_would_and_ends_as_it_would(tmp_path: Path) -> None:
    done = stand_by(tmp_path, ["--version"], ["no-such-command"])
    assert done.stdout.startswith("churchpipe ")
    assert json.loads(done.stderr.splitlines()[-1]) == [0, USAGE]
    # The end of the whole is that of the command for which it stands by.
    assert done.returncode == 7


@pytest.mark.slow
def test_a_fork_that_a_signal_ends_is_told_as_shells_do(tmp_path: Path) -> None:
    # A building of parameters that are no file waits for nobody: a pipe without writer keeps the stage until it is ended.
    os.mkfifo(tmp_path / "settings.json")
    kill = ASK.replace(
        "codes = [",
        """
import threading, time, signal
def end():
    while True:
        time.sleep(0.1)
        mine = os.getppid()
        forks = open(f"/proc/{mine}/task/{mine}/children").read().split()
        for fork in set(map(int, forks)) - {os.getpid()}:
            os.kill(fork, signal.SIGKILL)
threading.Thread(target=end, daemon=True).start()
codes = [""",
    )
    done = stand_by(tmp_path, ["stage", "source", "base", "settings.json", "building.json"], ask=kill)
    assert json.loads(done.stderr.splitlines()[-1]) == [128 + 9]


def test_a_command_whose_standby_was_killed_is_told_as_killed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # A short path, as sockets want it.
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as door, ThreadPoolExecutor() as pool:
        door.bind("door")
        door.listen()
        code = pool.submit(call_standby.ask, "door", ["stage"])
        line, _ = door.accept()
        order, files, _, _ = socket.recv_fds(line, 2**16, 3)
        while part := line.recv(2**16):
            order += part
        for file in files:
            os.close(file)
        line.close()
        assert json.loads(order)[0] == ["stage"]
        assert code.result(timeout=10) == 128 + signal.SIGKILL


def test_a_command_runs_by_itself_where_nobody_stands_by(tmp_path: Path) -> None:
    environment = os.environ | {call_standby.PLACE: str(tmp_path / "nobody"), "OMP_NUM_THREADS": "1"}
    words = [sys.executable, "-I", "-S", CLIENT, "--version"]
    done = subprocess.run(words, env=environment, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout[:11]) == (0, "churchpipe ")


# An engine that hands on the lock it holds, has a stage started that waits for ever, says its number, and dies with its parent.
DIE = f"""
import fcntl, os, signal, sys, threading, time
sys.path.insert(0, {str(Path(CLIENT).parent)!r})
from call_standby import PLACE, ask, entrust
parent = os.getppid()
with open("lock", "w") as lock:
    fcntl.flock(lock, fcntl.LOCK_EX)
    entrust(os.environ[PLACE], lock.fileno())
os.environ["OMP_NUM_THREADS"] = sys.argv[1]
words = ["stage", "source", "base", "settings.json", "building.json"]
threading.Thread(target=ask, args=(os.environ[PLACE], words), daemon=True).start()
children, command = [], b""
# While a process takes on another program it has no command line for a moment.
while not command or b"standby" in command and sys.argv[1] != "1":
    time.sleep(0.05)
    forks = open(f"/proc/{{parent}}/task/{{parent}}/children").read().split()
    children = [number for number in forks if number != str(os.getpid())]
    command = open(f"/proc/{{children[0]}}/cmdline", "rb").read() if children else b""
print(*children, flush=True)
os.kill(parent, signal.SIGKILL)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("threads", ["1", "2"])
def test_a_stage_that_outlives_its_engine_holds_the_lock_of_the_run(threads: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "settings.json")
    place = str(tmp_path / "door")
    words = [sys.executable, "-m", "churchpipe.standby", place, sys.executable, "-I", "-c", DIE, threads]
    with (
        subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process,
        (tmp_path / "lock").open("w") as lock,
    ):
        assert process.stdout
        stage = int(process.stdout.readline())
        process.wait(timeout=60)
        own = b"-m\0churchpipe\0stage" in Path(f"/proc/{stage}/cmdline").read_bytes()
        with pytest.raises(BlockingIOError):
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.kill(stage, signal.SIGKILL)
        fcntl.flock(lock, fcntl.LOCK_EX)
    # BLAS reads the number of its threads as it is loaded, so a fork has those of the process that stands by.
    assert own == (threads != call_standby.THREADS)


@pytest.mark.slow
def test_what_stands_by_has_the_modules_that_the_stages_need_and_no_threads() -> None:
    code = """
import importlib, os, sys
from churchpipe import standby
os.environ.update(dict.fromkeys(standby._THREADS, standby.THREADS))
for name in (*standby.MODULES, *standby.RESULTS):
    importlib.import_module(name)
standby._call_a_loop()
print(len(os.listdir("/proc/self/task")), *sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    threads, *known = done.stdout.split()
    assert {"numba", "scipy.sparse", "shapely", "ezdxf", "jinja2", "matplotlib.figure", "pyvista.plotting"} <= set(known)
    # A fork of a process with threads would hang or crash.
    assert threads == "1"
    assert not {"gmsh", "snakemake"} & set(known)


def test_blas_is_not_loaded_before_its_threads_are_set() -> None:
    # It reads their number as it is loaded: two threads in each of two forks would wait for each other.
    code = "import sys, churchpipe.standby; print('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "False"
