"""The stage that reads a drawing: walls without a name get the one that the import announces, and loads are held against them."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from churchpipe import stages
from churchpipe.config.case import read_variants
from churchpipe.config.plan import plan
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.generators import wall
from churchpipe.importing import import_drawing
from churchpipe.io.building_json import read_building
from churchpipe.io.npz import read_npz
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.materials import Material
from churchpipe.recognition.panels import FittedPanels
from churchpipe.stones.blocks import derive_blocks

BRICK = Material("brick", 18e3, 0.6)


@pytest.fixture
def imported(tmp_path: Path) -> Path:
    """Return the case of a drawing whose stones name no wall."""
    stones = derive_blocks(wall(name="w", materials=(BRICK,), length=1.5, brick=(0.25, 0.12, 0.065), courses=6, thickness=0.12))
    write_dxf(replace(stones, panel=np.full(stones.count, "")), tmp_path / "w.dxf", materials=[BRICK])
    done = import_drawing(tmp_path / "w.dxf", tmp_path / "case", loads=["+x"])
    assert "wall-1" in done.shell
    return done.case


def run(case: Path, folder: Path) -> Assemblage:
    """Run the stage on a case."""
    (settings,) = plan(read_variants(case)).geometries.values()
    (folder / "settings.json").write_text(json.dumps(settings))
    stages.drawing(folder / "settings.json", case.parent / "w.dxf", folder / "stones.npz", folder / "stones.vtu")
    return read_npz(folder / "stones.npz", Assemblage)


def test_a_load_may_name_the_wall_that_the_import_announced(imported: Path, tmp_path: Path) -> None:
    imported.write_text(imported.read_text().replace("[[load]]\n", '[[load]]\npanels = ["wall-1"]\n'))
    stones = run(imported, tmp_path)
    assert set(stones.panel[~stones.fixed]) == {"wall-1"}


def test_a_wall_that_is_not_there_is_refused_before_any_solve(imported: Path, tmp_path: Path) -> None:
    imported.write_text(imported.read_text().replace("[[load]]\n", '[[load]]\npanels = ["north"]\n'))
    with pytest.raises(InputError, match="no such panel; found north; expected wall-1"):
        run(imported, tmp_path)


def test_walls_that_are_no_building_leave_the_run_its_stones(
    imported: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_args: object, **_kwargs: object) -> None:
        raise InputError("Building w", "names of panels and parts of vaults are not unique")

    run(imported, tmp_path)
    monkeypatch.setattr(FittedPanels, "building", refused)
    files = [tmp_path / name for name in ("settings.json", "stones.npz", "building.json", "fitted.npz", "fit.json")]
    stages.panels(*files)
    assert json.loads(files[-1].read_text())["message"] == "Building w: names of panels and parts of vaults are not unique."
    assert read_building(files[2]).panels == ()
