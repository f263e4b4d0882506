"""The processes in which pictures are drawn: all are drawn, by as many as are worth it, and a failure is told."""

import faulthandler
import os
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from churchpipe.report import figures


@pytest.fixture(params=["fork", "fresh process"])
def started(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The jobs of the processes that are started, on a machine of three cores, as forks or anew."""
    processes: list[Any] = []
    way = {"fork": "_forked", "fresh process": "_fresh"}[request.param]
    start = getattr(figures, way)

    def follow(jobs: Any, errors: Any) -> Any:
        processes.append(jobs)
        return start(jobs, errors)

    monkeypatch.setattr(figures, way, follow)
    monkeypatch.setattr(figures, "_alone", lambda: request.param == "fork")
    monkeypatch.setattr(figures.os, "cpu_count", lambda: 3)
    return processes


def jobs_of(folder: Path, count: int) -> list[Any]:
    return [(Path.write_text, (folder / f"{number}.png", "drawn")) for number in range(count)]


@pytest.mark.parametrize(("count", "processes"), [(0, 0), (1, 1), (7, 1), (8, 2), (40, 3)])
def test_pictures_are_shared_out(count: int, processes: int, started: list[Any], tmp_path: Path) -> None:
    with figures.mechanism_pictures(jobs_of(tmp_path, count)) as wait:
        assert wait() == ""
    assert len(started) == processes
    assert len(list(tmp_path.iterdir())) == count


def test_one_that_fails_leaves_those_of_the_others(started: list[Any], tmp_path: Path) -> None:
    jobs = jobs_of(tmp_path, 12)
    jobs[1] = (Path.read_text, (tmp_path / "missing",))
    with figures.mechanism_pictures(jobs) as wait:
        assert "FileNotFoundError" in wait()
    assert len(started) == 3
    assert {f"{number}.png" for number in (0, 3, 6, 9, 2, 5, 8, 11)} <= {path.name for path in tmp_path.iterdir()}


def test_a_crash_is_told_by_its_signal(started: list[Any]) -> None:
    # Without the page of calls that pytest would print of a crash.
    with figures.mechanism_pictures([(faulthandler.disable, ()), (os.abort, ())]) as wait:
        assert wait() == "the graphics library crashed, signal 6"
    assert len(started) == 1


def test_one_that_hangs_is_ended(started: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures, "PICTURE_SECONDS", 0.2)
    begin = time.monotonic()
    with figures.mechanism_pictures([(time.sleep, (300,))]) as wait:
        assert wait() == "no picture after 0.2 s"
    assert len(started) == 1
    assert time.monotonic() - begin < 60


def test_a_process_with_other_threads_is_not_forked() -> None:
    end = threading.Event()
    other = threading.Thread(target=end.wait)
    other.start()
    try:
        assert not figures._alone()
    finally:
        end.set()
        other.join()
