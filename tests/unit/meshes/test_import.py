"""From a file in any format to a case that runs."""

from pathlib import Path

import numpy as np
import pytest

from churchpipe import stages
from churchpipe.config.case import read_case
from churchpipe.configuring import configure
from churchpipe.dxf.reading import Reading
from churchpipe.errors import InputError, UsageError
from churchpipe.findings import FindingsError
from churchpipe.importing import check_drawing, import_drawing
from churchpipe.io.atomic import read_json
from churchpipe.io.npz import read_npz
from churchpipe.meshes.reader import read_stones
from churchpipe.model.assemblage import Assemblage
from mesh_files import WRITERS, fuzz_wall, write_obj


@pytest.mark.parametrize("name", ["obj-triangles", "glb", "lmgc90", "3dec", "folder"])
def test_a_case_of_an_imported_file_reads_its_stones_again(name: str, tmp_path: Path) -> None:
    stones = fuzz_wall()
    path = WRITERS[name](stones, tmp_path)
    done = import_drawing(path, tmp_path / "case", unit_weight=18e3, friction=0.6, loads=["+x"])
    assert (done.stones, done.fixed, done.missing) == (12, 1, ())
    # The case does not need the file it was made of.
    for file in [path, *path.parent.glob("*.INI")] if path.is_file() else path.iterdir():
        file.unlink()
    run = tmp_path / "run"
    index = read_json(configure(done.case, run))
    folder = run / "geometry" / "base"
    stages.drawing(folder / "settings.json", Path(index["drawing"]), folder / "assemblage.npz", folder / "stones.vtu")
    read = read_npz(folder / "assemblage.npz", Assemblage)
    np.testing.assert_allclose(np.sort(read.weight), np.sort(stones.weight), rtol=1e-9)


def test_the_case_keeps_how_the_file_was_read(tmp_path: Path) -> None:
    free = Assemblage.from_polyhedra([(points / 50.0, faces) for points, faces in _bricks()], 1.0)
    path = write_obj(free, tmp_path / "model.obj")
    reading = Reading(scale=50.0, support="base", units="m")
    done = import_drawing(path, tmp_path / "case", reading, unit_weight=18e3, friction=0.6, loads=["+x"])
    source = read_case(done.case).source
    assert source.reading == reading  # type: ignore[union-attr]
    assert check_drawing(path, reading, 18e3)[0].stones.weight.sum() == pytest.approx(fuzz_wall().weight.sum())


def _bricks() -> list:
    from mesh_files import solids

    return [(points, faces) for _, points, faces, fixed in solids(fuzz_wall()) if not fixed]


@pytest.mark.parametrize(("stem", "name"), [("Stützmauer süd", "Stützmauer-süd"), ("Su\u0308d", "Süd"), ("北 (1)", "北-1")])
def test_the_case_has_the_name_of_its_file_in_any_alphabet(stem: str, name: str, tmp_path: Path) -> None:
    # Names that differ in such letters alone would be runs of one name, and one folder.
    path = write_obj(fuzz_wall(), tmp_path / f"{stem}.obj")
    done = import_drawing(path, tmp_path / "case", unit_weight=18e3, friction=0.6, loads=["+x"])
    assert read_case(done.case).name == name


def test_a_folder_that_is_read_from_within_is_called_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "stones"
    folder.mkdir()
    write_obj(fuzz_wall(), folder / "wall.obj")
    monkeypatch.chdir(folder)
    assert read_stones(".")[1].file == read_stones(folder)[1].file == "stones"


def test_what_cannot_be_read_leaves_nothing_behind(tmp_path: Path) -> None:
    path = tmp_path / "wall.obj"
    path.write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(FindingsError):
        import_drawing(path, tmp_path / "case")
    assert not (tmp_path / "case").exists()
    with pytest.raises(InputError, match="neither up nor scale for a DXF"):
        check_drawing(tmp_path / "wall.dxf", Reading(up="y"))


def test_a_case_names_one_source(tmp_path: Path) -> None:
    path = write_obj(fuzz_wall(), tmp_path / "wall.obj")
    done = import_drawing(path, tmp_path / "case", unit_weight=18e3, friction=0.6, loads=["+x"])
    done.case.write_text(done.case.read_text().replace('file = "wall.obj"', 'file = "wall.obj"\ndxf = "wall.dxf"'))
    with pytest.raises(InputError, match="no single source; found dxf and file"):
        read_case(done.case)
    with pytest.raises(UsageError, match="exists already"):
        import_drawing(path, tmp_path / "case")
