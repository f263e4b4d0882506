"""The engine that waits for its orders, and the news of the stages in its output."""

import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from churchpipe import engine
from churchpipe.pending import pending
from processes import group_lives, wait_for

NEWS = engine.Event("done", "blocks", "blocks", 'a "text"\nof two lines', 1.5)


# Snakemake writes the end of its own lines apart, so that a stage's news may come between the two.
@pytest.mark.parametrize("before", ["", "Select jobs to execute...", "[Mon Nov 23 21:00:00 2026]"])
def test_news_behind_the_words_of_the_engine_are_heard(before: str) -> None:
    assert engine.heard(before + engine.say(NEWS) + "\n") == NEWS


def test_a_line_of_the_engine_alone_has_no_news() -> None:
    assert engine.heard("Finished jobid: 3 (Rule: blocks)\n") is None


@pytest.mark.parametrize(
    ("status", "told"),
    [
        (137, "signal 9 ended it from outside, as where the machine has no memory left"),
        (3, "it ran out of memory"),
        (1, "it ended with status 1"),
    ],
)
def test_a_stage_that_ended_without_a_word_is_named(tmp_path: Path, status: int, told: str) -> None:
    command = "python -I -S call_standby.py stage -- shell base shell/base/shell.npz 2>&1 | tee log/shell/base.txt"
    engine_says = f"Command 'set -euo pipefail;  {command}' returned non-zero exit status {status}.\n"
    (tmp_path / "run.log").write_text(f"Select jobs to execute...\n{engine_says}{engine_says}", encoding="utf-8")
    (tmp_path / engine.UNFINISHED).write_text(engine.crashes(tmp_path), encoding="utf-8")
    assert engine.unfinished(tmp_path).startswith(f"The stage shell of base crashed: {told}.")
    assert engine.unfinished(tmp_path).count("crashed") == 1
    (tmp_path / "run.log").write_text("WorkflowError\n", encoding="utf-8")
    assert engine.crashes(tmp_path) == f"A stage crashed; see {tmp_path / 'run.log'}"


def test_an_engine_without_room_for_its_notes_says_so(tmp_path: Path) -> None:
    said = "WorkflowError:\nError recording metadata for finished job ([Errno 28] No space left on device).\n"
    (tmp_path / "run.log").write_text(said, encoding="utf-8")
    assert engine.crashes(tmp_path).startswith(f"{tmp_path}: No space left on device. Make room there, or choose another folder")


def test_a_full_disk_is_told_with_the_log_that_found_no_room(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "run.log").symlink_to("/dev/full")
    process = subprocess.Popen(["echo", "said"], stdout=subprocess.PIPE, text=True, start_new_session=True)
    monkeypatch.setattr(engine, "_order", lambda *_: None)
    with process, socket.socket() as line, pytest.raises(OSError, match="No space left") as told:
        engine.run(engine.Engine(process, line, engine.LOCAL), tmp_path, 1, lambda _: None)
    assert told.value.filename == str(tmp_path / "run.log")


def test_an_engine_without_orders_ends_with_what_it_was_started_for() -> None:
    with engine.started() as ready:
        assert ready.process.poll() is None
        # It leads a group of its own, with all that it started.
        assert group_lives(ready.process.pid)
    assert ready.process.poll() is not None
    wait_for(lambda: not group_lives(ready.process.pid), 30.0)


@pytest.mark.parametrize("home", ["there", "nowhere"])
def test_an_engine_has_a_place_for_its_caches(home: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Below a file nobody can make a folder, not even root.
    place = tmp_path if home == "there" else Path("/dev/null/cache")
    monkeypatch.setenv("XDG_CACHE_HOME", str(place))
    with engine.started() as ready:
        environment = Path(f"/proc/{ready.process.pid}/environ")
        # While a process takes on another program it has none for a moment.
        wait_for(lambda: bool(environment.read_bytes()), 30.0)
        words = environment.read_bytes().split(b"\0")
        told = dict(word.decode(errors="replace").split("=", 1) for word in words if b"=" in word)
        assert Path(told["XDG_CACHE_HOME"]).is_dir()
        assert (Path(told["XDG_CACHE_HOME"]) == place) == (home == "there")


def test_results_of_a_clock_that_was_ahead_stay_older_than_what_was_made_after_them(tmp_path: Path) -> None:
    # A run was stopped between the stones and the load factors.
    later, now = time.time() + 1e8, time.time()
    for name, date in (("case", now - 9), ("states", later), ("stones", later + 1), ("contacts", later + 1)):
        (tmp_path / name).write_text(name)
        os.utime(tmp_path / name, (date, date))
    engine.date_back(tmp_path)
    case, states, stones, contacts = ((tmp_path / name).stat().st_mtime for name in ("case", "states", "stones", "contacts"))
    assert case == pytest.approx(now - 9, abs=1e-3)
    assert case < states < stones == contacts < time.time()


def test_an_engine_whose_run_has_died_does_nothing() -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        ours.shutdown(socket.SHUT_WR)
        words = [sys.executable, "-m", "churchpipe.waiting_engine", engine.LOCAL]
        done = subprocess.run(words, stdin=theirs.fileno(), capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_orders_are_arguments_of_snakemake_and_a_lock(tmp_path: Path) -> None:
    ours, theirs = socket.socketpair()
    with (tmp_path / "lock").open("w") as lock, ours, theirs:
        code = """
import json, os, sys
import snakemake.cli
from churchpipe import waiting_engine
def cli(arguments):
    same = [os.path.samefile(f"/proc/self/fd/{number}", sys.argv[1]) for number in range(3, 64)
            if os.path.exists(f"/proc/self/fd/{number}")]
    print(json.dumps([arguments, any(same), sys.stdin.read()]))
snakemake.cli.main = cli
waiting_engine.LATER = ()
waiting_engine.main(["local"])
"""
        words = [sys.executable, "-c", code, lock.name]
        with subprocess.Popen(words, stdin=theirs.fileno(), stdout=subprocess.PIPE, text=True) as process:
            socket.send_fds(ours, [json.dumps(["--cores", "2"]).encode()], [lock.fileno()])
            said, _ = process.communicate(timeout=60)
    assert json.loads(said) == [["--cores", "2"], True, ""]


def test_the_local_profile_loads_no_plugins_of_clusters() -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        ours.shutdown(socket.SHUT_WR)
        code = "import sys; from churchpipe import waiting_engine; waiting_engine.main(['local']); print(*sys.modules)"
        done = subprocess.run([sys.executable, "-c", code], stdin=theirs.fileno(), capture_output=True, text=True, check=True)
    known = done.stdout.split()
    assert {"snakemake.cli", "snakemake.report.html_reporter"} <= set(known)
    assert not [name for name in known if name.startswith("snakemake_executor_plugin_") or name == "pandas"]


@pytest.mark.parametrize(
    ("code", "seen"),
    [("0", 0), ("'no such file'", 1), *(pytest.param(*case, marks=pytest.mark.slow) for case in (("1", 1), ("None", 0)))],
)
def test_an_engine_leaves_with_the_code_of_snakemake_and_all_it_said(code: str, seen: int) -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        ours.sendall(b"[]")
        program = f"""
import atexit, sys
import snakemake.cli
from churchpipe import waiting_engine
def cli(arguments):
    print("said", end="")
    atexit.register(print, "taken down")
    sys.exit({code})
snakemake.cli.main = cli
waiting_engine.LATER = ()
waiting_engine.main(["local"])
"""
        done = subprocess.run([sys.executable, "-c", program], stdin=theirs.fileno(), capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (seen, "said")


def test_a_dry_run_says_in_words_what_a_stopped_run_left(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    said = "[Sat Nov 28 23:12:51 2026]\n"
    said += "rule contacts:\n    output: a, b\n    reason: Forced execution\n    wildcards: geometry=base\n"
    done = subprocess.CompletedProcess([], 0, stdout=said, stderr="")
    monkeypatch.setattr("churchpipe.pending.subprocess.run", lambda *_, **__: done)
    [job] = pending(tmp_path, lambda _: None)
    assert (job.stage, job.name, job.why) == ("contacts", "base", "a run was stopped while it was made")


def test_a_dry_run_leaves_out_what_an_editor_marks_by_a_link_to_nowhere(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "plan.json").touch()
    (tmp_path / ".#plan.json").symlink_to("somebody@somewhere.123")
    monkeypatch.setattr("churchpipe.pending.subprocess.run", lambda *_, **__: subprocess.CompletedProcess([], 0, "", ""))
    seen: list[str] = []
    assert pending(tmp_path, lambda copy: seen.extend(path.name for path in copy.iterdir())) == []
    assert seen == ["plan.json"]


def test_a_dry_run_does_without_a_place_beside_the_results(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    run, beside = tmp_path / "archive" / "run", tmp_path / "scratch"
    run.mkdir(parents=True)
    beside.mkdir()
    (run / "plan.json").touch()
    monkeypatch.setattr("tempfile.tempdir", str(beside))
    monkeypatch.setattr(os, "access", lambda folder, _: Path(folder) != run.parent)
    monkeypatch.setattr("churchpipe.pending.subprocess.run", lambda *_, **__: subprocess.CompletedProcess([], 0, "", ""))
    seen: list[Path] = []
    assert pending(run, lambda copy: seen.extend(copy.iterdir())) == []
    assert [(path.name, path.parents[2]) for path in seen] == [("plan.json", beside)]


def test_a_stage_is_done_when_the_engine_has_noted_it() -> None:
    # A run that is stopped in between makes the stage again: nothing may have said that it was finished.
    first, second = (engine.Event("done", "sample", name, "", 1.5) for name in ("00001", "00002"))
    begun = engine.Event("start", "blocks", "base")
    noted = engine.Noted()
    lines = [first, begun, "1 of 18 steps", second, "Finished jobid: 3 (Rule: blocks)", "Finished jobid: 7 (Rule: sample)"]
    told = [noted(line if isinstance(line, str) else engine.say(line)) for line in lines]
    assert told == [[], [begun], [], [], [], [first]]
    assert noted("Finished jobid: 9 (Rule: sample)" + engine.say(begun)) == [second, begun]
    assert noted("Finished jobid: 9 (Rule: sample)") == []
