"""What `check` and `import` say of a file of stones, besides what is wrong with one entity of it."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from ezdxf.filemanagement import new

from command_line import call

OPTIONS = ("--thickness", "0.2m", "--support", "base")


def drawing(path: Path, *outlines: tuple[float, float, float, float], unit: int = 6) -> Path:
    """Outlines of boxes, x and y from and to, and a line that closes nothing."""
    document = new("R2010")
    document.header["$INSUNITS"] = unit
    space: Any = document.modelspace()
    for x, y, right, top in outlines:
        space.add_lwpolyline([(x, y), (right, y), (right, top), (x, top)], close=True)
    space.add_line((5, 0), (6, 0))
    document.saveas(path)
    return path


def test_findings_are_listed_and_drawn_where_stones_are_unsound(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    # What was left out of the file may be why a stone floats.
    path = drawing(tmp_path / "a.dxf", (0, 0, 0.5, 0.3), (0, 0.4, 0.5, 0.7))
    for command in (("check", path, "-o", tmp_path / "found"), ("import", path, "-o", tmp_path / "out")):
        code, _, err = call(capsys, *command, *OPTIONS)
        assert code == 1
        assert f"{path}: stones: 1 without a path to a support" in err
        assert "dxf/W18 a.dxf: left out: 1 lines that close nothing." in err
        assert err.index("without a path") < err.index("W18")
    assert not (tmp_path / "out").exists()
    assert "without a path to a support" in (tmp_path / "found" / "findings.html").read_text()
    assert (tmp_path / "found" / "findings.dxf").exists()


def test_number_and_volume_of_the_stones_are_said(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = drawing(tmp_path / "a.dxf", (0, 0, 0.5, 0.3), (0, 0.3, 0.5, 0.6))
    assert "a.dxf: 2 stones, 0.06 m3, 4 warnings." in call(capsys, "check", path, *OPTIONS)[1]
    assert "2 stones, 0.06 m3, on 1 fixed one: " in call(capsys, "import", path, "-o", tmp_path / "out", *OPTIONS)[1]


REFUSED = [
    (
        ("--joint-mode", "keep"),
        "--joint-mode: no joint to close; found keep; expected joint, the width of the joints, beside it.",
    ),
    (("--mortar", "ignored"), "--mortar: no joint to close; found ignored; expected joint"),
    (("--contact-angle-deg", "90"), "--contact-angle-deg: out of range; found 90.0; expected degrees between 0 and 90"),
    (("--contact-angle-deg", "0"), "--contact-angle-deg: out of range; found 0.0"),
    (
        ("--up", "y"),
        "a.dxf: a drawing is read as it is drawn; found up = y; expected neither up nor scale for a DXF. Leave it out",
    ),
    (("--scale", "10"), "a.dxf: a drawing is read as it is drawn; found scale = 10.0"),
]


@pytest.mark.parametrize(("given", "said"), REFUSED, ids=[" ".join(given) for given, _ in REFUSED])
def test_options_that_would_do_nothing_are_refused(
    given: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    code, _, err = call(capsys, "check", drawing(tmp_path / "a.dxf", (0, 0, 0.5, 0.3)), *OPTIONS, *given)
    assert code in (1, 2)
    assert said in err


GIVEN = ("--unit-weight-kN-m3", "18", "--friction", "0.6", "--load", "+x")


def test_values_out_of_all_reason_are_questioned_by_the_import(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = drawing(tmp_path / "a.dxf", (0, 0, 0.5, 0.3))
    code, _, err = call(capsys, "import", path, "-o", tmp_path / "out", *OPTIONS, *GIVEN[2:], "--unit-weight-kN-m3", "18000")
    assert code == 0
    assert "material.default.unit_weight_kN_m3 is 1.8e+04 kN/m3, usual are" in err
    assert "Is it meant?" not in call(capsys, "import", path, "-o", tmp_path / "usual", *OPTIONS, *GIVEN)[2]


def test_a_run_without_its_drawing_leaves_nothing(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = drawing(tmp_path / "a.dxf", (0, 0, 0.5, 0.3))
    assert call(capsys, "import", path, "-o", tmp_path / "out", *OPTIONS, *GIVEN)[0] == 0
    (tmp_path / "out" / "a.dxf").unlink()
    for command in (("check",), ("run", "--out", tmp_path / "run")):
        code, _, err = call(capsys, command[0], tmp_path / "out" / "case.toml", *command[1:])
        assert code == 1
        assert "case.toml: line 6, source.dxf: no such file; found " in err
    assert not (tmp_path / "run").exists()


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Let the system refuse to write more bytes to a file, as a disk that is full does."""
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, usual[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)


# The drawing has some 16 kB, the page of findings, as the first to be written after it, a megabyte.
@pytest.mark.parametrize(("size", "refused"), [(4_000, "a.dxf"), (100_000, "findings.html")])
@pytest.mark.parametrize("there", [False, True], ids=["new folder", "folder with notes"])
def test_import_that_cannot_be_written_leaves_nothing(
    size: int, refused: str, there: bool, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = drawing(tmp_path / "a.dxf", (0, 0, 0.5, 0.3), (0, 0.3, 0.5, 0.6))
    folder = tmp_path / "deep" / "out"
    if there:
        folder.mkdir(parents=True)
        (folder / "notes.txt").write_text("mine")
    with files_of_at_most(size):
        code, _, err = call(capsys, "import", path, "-o", folder, *OPTIONS)
    assert code == 2
    assert f"{folder / refused}: File too large. Choose another place to write to." in err
    left = [] if not there else [folder / "notes.txt"]
    assert [file for file in (tmp_path / "deep").rglob("*") if file.is_file()] == left
    assert (tmp_path / "deep").exists() == there
    # With room it is made.
    assert call(capsys, "import", path, "-o", folder, *OPTIONS)[0] == 0


def test_case_that_cannot_be_written_leaves_nothing(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Without the page of findings, which is longer, the schema of a case is the longest file.
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    path = drawing(tmp_path / "a.dxf", (0, 0, 0.5, 0.3), (0, 0.3, 0.5, 0.6))
    with files_of_at_most(100_000):
        code, _, err = call(capsys, "import", path, "-o", tmp_path / "out", *OPTIONS)
    assert code == 2
    assert f"{tmp_path / 'out' / 'case.schema.json'}: File too large." in err
    assert [file.name for file in tmp_path.iterdir()] == ["a.dxf"]


def test_what_joins_near_misses_is_an_option_before_there_is_a_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    # Five stones in a row on one below, the last two 5 mm apart, which is no joint between the others.
    row = [(0.5 * n + (0.005 if n == 4 else 0), 0.3, 0.5 * (n + 1), 0.6) for n in range(5)]
    path = drawing(tmp_path / "a.dxf", (0, 0, 2.5, 0.3), *row)
    _, out, _ = call(capsys, "check", path, *OPTIONS)
    assert "--contact-gap 5mm makes joints of them." in out
    assert "[rigid]" not in out
    _, out, _ = call(capsys, "import", path, "-o", tmp_path / "out", *OPTIONS)
    assert "contact_gap_mm = 5 in [rigid] makes joints of them." in out
    assert "Near misses" not in call(capsys, "check", path, *OPTIONS, "--contact-gap", "5mm")[1]
