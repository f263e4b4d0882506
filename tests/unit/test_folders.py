"""Tests of a module stand in the folder of tests/unit that has the name of its folder in src/churchpipe."""

from pathlib import Path

UNIT = Path(__file__).parent
SOURCE = UNIT.parents[1] / "src" / "churchpipe"


def test_folders_of_tests_are_folders_of_the_source() -> None:
    folders = {file.parent.relative_to(UNIT) for file in UNIT.rglob("test_*.py")}
    assert not [folder for folder in folders if not (SOURCE / folder).is_dir()]


def test_modules_of_a_folder_are_not_tested_beside_it() -> None:
    # The name of a test in the top folder is that of no module deeper down.
    deeper = {file.stem for file in SOURCE.rglob("*.py") if file.parent != SOURCE} - {file.stem for file in SOURCE.glob("*.py")}
    assert not [file.name for file in UNIT.glob("test_*.py") if file.stem.removeprefix("test_") in deeper]


def test_names_of_test_files_are_unique() -> None:
    names = [file.name for file in UNIT.parent.rglob("test_*.py")]
    assert len(set(names)) == len(names)
