"""The processes in which pictures are drawn: all are drawn, by as many as are worth it, and a failure is told."""

import subprocess
from pathlib import Path
from typing import Any

import pytest

from churchpipe.report import figures


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The processes that are started, on a machine of three cores."""
    processes: list[Any] = []
    start = subprocess.Popen

    def follow(*arguments: Any, **options: Any) -> Any:
        processes.append(start(*arguments, **options))
        return processes[-1]

    monkeypatch.setattr(figures.subprocess, "Popen", follow)
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
