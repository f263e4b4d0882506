"""The doctor sees what is missing, survives crashes, and names the line that mends it."""

import sys

import pytest

from churchpipe import doctor
from churchpipe.doctor import Trial, examine


@pytest.mark.slow
def test_this_environment_is_sound() -> None:
    findings = examine()
    assert [(f.name, f.detail) for f in findings if not f.passed] == []
    assert {"clarabel", "cvxpy", "cvxopt.amd", "manifold3d", "shapely", "ezdxf", "meshio", "snakemake", "pyvista"} <= {
        f.name for f in findings
    }


def one(code: str, system: str = "") -> doctor.Finding:
    return examine((Trial("thing", "tests", code, system),))[0]


def test_missing_module_asks_for_all_that_pip_installs() -> None:
    found = one("import thing_that_is_not_there")
    assert not found.passed
    assert found.detail == "ModuleNotFoundError: No module named 'thing_that_is_not_there'"
    assert found.remedy.endswith("install 'churchpipe[all]'")
    assert sys.executable in found.remedy


def test_crash_is_seen_and_survived() -> None:
    found = one("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", system="libegl1")
    assert not found.passed
    assert found.detail == "crashed (SIGSEGV)"
    assert found.remedy == "apt-get install -y libegl1"


@pytest.mark.parametrize(
    ("message", "remedy"),
    [
        ("libGL.so.1: cannot open shared object file: No such file or directory", "apt-get install -y libgl1"),
        ("libXrender.so.1: cannot open shared object file: No such file or directory", "apt-get install -y libxrender1"),
    ],
)
def test_missing_library_asks_for_its_debian_package(message: str, remedy: str) -> None:
    found = one(f"raise ImportError({message!r})")
    assert found.detail == f"ImportError: {message}"
    assert found.remedy == remedy


def test_hanging_child_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "TRIAL_SECONDS", 0.5)
    found = one("import time; time.sleep(60)")
    assert not found.passed
    assert found.detail == "no answer after 0.5 s"
