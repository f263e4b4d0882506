"""The first start says that the solvers are compiled; later ones say nothing. Compiled loops are kept wherever it is run."""

import os
import stat
from pathlib import Path

import pytest

from churchpipe.compilation import compiled, keep_compiled


def test_an_empty_folder_of_compiled_loops_means_a_first_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not compiled()
    (tmp_path / "solver").mkdir()
    (tmp_path / "solver" / "loop.py311.nbi").touch()
    assert compiled()


@pytest.fixture
def nowhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package and a home that cannot be written to; returns the folder for what is temporary."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(os, "access", lambda *_: False)
    return tmp_path


def test_loops_are_kept_by_a_user_without_a_home(nowhere: Path) -> None:
    keep_compiled()
    place = Path(os.environ["NUMBA_CACHE_DIR"])
    assert place.parent == nowhere
    assert stat.S_IMODE(place.stat().st_mode) == 0o700
    # The next process finds what this one has kept.
    os.environ["NUMBA_CACHE_DIR"] = ""
    keep_compiled()
    assert Path(os.environ["NUMBA_CACHE_DIR"]) == place
    # A place that the person has named stays.
    os.environ["NUMBA_CACHE_DIR"] = "mine"
    keep_compiled()
    assert os.environ["NUMBA_CACHE_DIR"] == "mine"


@pytest.mark.parametrize("what", ["open to all", "a link", "of another user"])
def test_a_place_that_others_can_write_to_is_not_trusted(nowhere: Path, what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    place = nowhere / f"churchpipe-{os.getuid()}"
    if what == "a link":
        (nowhere / "theirs").mkdir()
        place.symlink_to("theirs")
    else:
        place.mkdir(mode=0o700)
        place.chmod(0o777 if what == "open to all" else 0o700)
    if what == "of another user":
        real = os.getuid()
        place.rename(nowhere / f"churchpipe-{real + 1}")
        monkeypatch.setattr(os, "getuid", lambda: real + 1)
    keep_compiled()
    chosen = Path(os.environ["NUMBA_CACHE_DIR"])
    assert chosen.parent == nowhere
    assert chosen not in (place, nowhere / f"churchpipe-{os.getuid()}")
    assert stat.S_IMODE(chosen.stat().st_mode) == 0o700


def test_another_place_is_found_again(nowhere: Path) -> None:
    (nowhere / f"churchpipe-{os.getuid()}").mkdir()
    (nowhere / f"churchpipe-{os.getuid()}").chmod(0o777)

    def chosen() -> Path:
        os.environ["NUMBA_CACHE_DIR"] = ""
        keep_compiled()
        return Path(os.environ["NUMBA_CACHE_DIR"])

    place = chosen()
    # The next process compiles nothing again, and leaves no place of its own behind.
    assert chosen() == place
    place.chmod(0o777)
    assert chosen() not in (place, nowhere / f"churchpipe-{os.getuid()}")


def test_loops_kept_in_the_home_mean_no_first_start(nowhere: Path) -> None:
    assert not compiled()
    kept = nowhere / "cache" / "numba" / "interior_point_0123"
    kept.mkdir(parents=True)
    (kept / "loop.py311.nbi").touch()
    assert compiled()


def test_a_home_that_can_be_written_to_is_left_to_numba(nowhere: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda folder, _: Path(folder) == nowhere)
    keep_compiled()
    assert os.environ["NUMBA_CACHE_DIR"] == ""
