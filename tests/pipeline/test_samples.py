"""Samples as jobs: more of them add to those there, a kill loses nothing that was finished. Jobs are counted, not timed."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe import engine

SAMPLE = """
[sample]
number = 3
[[sample.parameters]]
key = "source.thickness_mm"
distribution = "normal"
mean = 250
standard_deviation = 20
"""


def start(case: Path, *options: str) -> "subprocess.Popen[str]":
    # A machine without graphics: its report has a sentence in place of each picture, and is made faster.
    blind = case.parent / "no_graphics"
    blind.mkdir(exist_ok=True)
    (blind / "pyvista.py").write_text("raise ImportError('no graphics here')\n")
    environment = os.environ | {"PYTHONPATH": str(blind)}
    command = [sys.executable, "-m", "churchpipe", "run", case, "--out", case.parent / "run", "--jobs", "2", *options]
    return subprocess.Popen(command, cwd=case.parent, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def done(case: Path) -> list[tuple[str, str]]:
    """Stages that the last run finished, and their names."""
    events = map(engine.heard, (case.parent / "run" / "run.log").read_text().splitlines())
    return [(event.stage, event.name) for event in events if event and event.kind == "done"]


def run(case: Path, *options: str) -> Counter[str]:
    log = case.parent / "run" / "run.log"
    before = log.stat().st_mtime_ns if log.exists() else 0
    process = start(case, *options)
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, out + err + log.read_text()
    # A run with nothing to do starts no engine, whose log stays.
    return Counter(stage for stage, _ in done(case)) if log.stat().st_mtime_ns != before else Counter()


def load_factors(case: Path) -> list[float]:
    summary = json.loads((case.parent / "run" / "summary.json").read_text())
    return summary["uncertainty"]["analyses"][0]["load_factors"]


@pytest.mark.slow
def test_more_samples_add_to_those_there(tmp_path: Path) -> None:
    case = case_file(tmp_path, WALL + SAMPLE)
    assert run(case) == {"source": 1, "blocks": 1, "contacts": 1, "rigid": 1, "sample": 3, "compare": 1, "report": 1}
    first = load_factors(case)
    assert run(case) == {}
    assert run(case, "--set", "sample.number=5") == {"sample": 2, "compare": 1, "report": 1}
    assert [name for stage, name in done(case) if stage == "sample"] in (["00004", "00005"], ["00005", "00004"])
    assert load_factors(case)[:3] == first
    assert "Uncertainty" in (case.parent / "run" / "report.html").read_text()


@pytest.mark.slow("doc: samples that were killed go on")
def test_a_kill_in_the_middle_loses_no_sample_that_was_finished(tmp_path: Path) -> None:
    case = case_file(tmp_path, WALL + SAMPLE.replace("number = 3", "number = 8"))
    process = start(case)
    log = case.parent / "run" / "run.log"
    while process.poll() is None and (not log.exists() or sum(stage == "sample" for stage, _ in done(case)) < 4):
        time.sleep(0.1)
    assert process.poll() is None
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    # What the engine knew of; of a record that it had not yet heard of nobody knows whether it is whole.
    finished = len(re.findall(r"Finished jobid: \d+ \(Rule: sample\)", log.read_text()))
    assert 2 <= finished < 8
    assert 0 < run(case)["sample"] <= 8 - finished
    assert len(load_factors(case)) == 8
