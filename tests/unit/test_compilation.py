"""The first start says that the solvers are compiled; later ones say nothing."""

from pathlib import Path

import pytest

from churchpipe.compilation import compiled


def test_an_empty_folder_of_compiled_loops_means_a_first_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not compiled()
    (tmp_path / "solver").mkdir()
    (tmp_path / "solver" / "loop.py311.nbi").touch()
    assert compiled()
