"""Files and options as they come: what is refused is named, and nothing is left half done."""

import errno
import io
import os
from contextlib import suppress
from pathlib import Path

import pytest

from case_texts import WALL
from churchpipe import cli, engine
from churchpipe.cli.runs import folder_of
from churchpipe.config.asrun import claim, other_case
from churchpipe.config.case import Drawing, read_case, read_variants
from churchpipe.config.laid_sizes import laying_questions
from churchpipe.config.plan import plan
from churchpipe.configuring import configure
from churchpipe.dxf.reader import read_dxf
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError, UsageError
from churchpipe.findings import FindingsError
from churchpipe.finished import run_name
from churchpipe.importing import import_drawing, parse_length
from churchpipe.io.atomic import write_text
from churchpipe.model.doubts import DoubtfulValue
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.resources import sample_case
from churchpipe.terminal import Reporter
from command_line import call
from corpus_files import CORPUS
from mesh_files import write_dxf_outlines
from solids import box, on_ground

ARCH = sample_case("arch")
STONES = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)), unit_weight=2e4, reach=3)
WEIGHT = "unit_weight_kN_m3 = 20\nfriction = 0.6\n"
STONE = Material("default", 2e4, 0.6)


def written(folder: Path, data: str | bytes, name: str = "case.toml") -> Path:
    path = folder / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


@pytest.mark.parametrize(
    "data",
    [b"\xef\xbb\xbf" + ARCH.encode(), ARCH.replace("\n", "\r\n"), ARCH.replace(" = ", "\t=\t")],
    ids=["byte order mark", "CRLF", "tabs"],
)
def test_what_editors_make_of_a_case_is_read(data: str | bytes, tmp_path: Path) -> None:
    assert read_case(written(tmp_path, data)).source == read_case(written(tmp_path, ARCH, "plain.toml")).source


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (ARCH.encode("utf-16"), r"not a text in UTF-8; found invalid start byte, byte 1.*UTF-16.*saved as UTF-8"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", r"not a text in UTF-8"),
        ("a = " + "[" * 5000 + "]" * 5000, r"not a case file; found lists or tables too deep"),
        (ARCH + ".".join(["a"] * 1200) + " = 1", r"not a case file; found lists or tables too deep"),
        ("", r"line 1, source: missing key; expected a table"),
        (ARCH + "\0", r"not TOML"),
    ],
    ids=["UTF-16", "picture", "deep", "deep key", "empty", "null byte"],
)
def test_files_of_another_kind(data: str | bytes, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        read_case(written(tmp_path, data))


def test_a_file_whose_name_cannot_name_its_run(tmp_path: Path) -> None:
    path = written(tmp_path, ARCH.replace('name = "arch"\n', ""), "Stoß [1].toml")
    with pytest.raises(InputError, match=r"Stoß \[1\]\.toml: a file's name that cannot .*; found Stoß \[1\]; .*name = \"nave\""):
        read_case(path)
    assert read_case(written(tmp_path, ARCH, "Stoß [2].toml")).name == "arch"


def test_a_disk_that_is_full_is_said() -> None:
    """It is no defect of the stage, whose trace nobody can use."""

    def work() -> None:
        raise OSError(errno.ENOSPC, "No space left on device", "runs/x/state.npz")

    stream = io.StringIO()
    assert Reporter("rigid", "+x", stream).run(work, takes_progress=False) == 1
    assert (
        f"{Path('runs/x/state.npz').absolute()}: No space left on device. Make room there, or choose another folder"
        in stream.getvalue()
    )

    def broken() -> None:
        raise OSError(errno.ENOENT, "No such file or directory", "runs/x/state.npz")

    with pytest.raises(OSError, match="No such file"):
        Reporter("rigid", "+x", stream).run(broken, takes_progress=False)


def test_a_stage_names_files_of_its_run_as_they_are_found_from_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("shell", "geometry/base"):
        Path(name).mkdir(parents=True)
    Path("settings.json").write_text("{")

    def said(where: str) -> str:
        def work() -> None:
            raise InputError(where, "damaged")

        stream = io.StringIO()
        assert Reporter("rigid", "+x", stream).run(work, takes_progress=False) == 1
        news = engine.heard(stream.getvalue().splitlines()[-1])
        assert news
        return news.text

    for where in ("settings.json", "geometry/base/contacts.npz"):
        assert said(where) == f"{tmp_path / where}: damaged."
    # What else is called as a folder, a file that is named whole, and what is no path.
    for where in ("shell", "/nowhere/a.npz", "material.default.friction", "x" * 5000, "load x/y"):
        assert said(where) == f"{where}: damaged."


def test_a_folder_and_a_pipe_are_no_cases(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    folder = tmp_path / "folder.toml"
    folder.mkdir()
    assert run_name(pipe) == "pipe"  # and does not wait for what comes through it
    for path in (folder, pipe):
        with pytest.raises(InputError, match=r"toml: not a file; found a folder, a pipe or a device; expected a case file\.$"):
            read_case(path)
    with pytest.raises(InputError, match=r"cannot be read; found File name too long"):
        read_case(tmp_path / f"{'x' * 300}.toml")


CHANGES = [
    ("source.generator=[]", r"source\.generator: unknown generator; found \[\]"),
    ("source.generator={}", r"source\.generator: unknown generator; found \{\}"),
    (
        "source.mean_radius_m=1e30",
        r"source\.mean_radius_m: no length of a building; found 1e\+33 mm; expected from 0\.01 to 1e\+07",
    ),
    ("source.thickness_m=1e-300", r"source\.thickness_m: no length of a building"),
    ("source.voussoirs=1000000000000", r"source\.voussoirs: wrong value.*less than or equal to 1000000"),
    ("rigid=1", r"rigid: wrong value; found 1; expected a table\."),
    ("load=1", r"load: wrong value; found 1; expected a list in \[brackets\]"),
    ("name=3", r"name: wrong value; found 3; expected a text in quotes"),
    ("name=../up", r"name: wrong value; found '\.\./up'; expected letters, digits, blanks"),
    (f"name={'n' * 300}", r"name: wrong value; found 'n{99} \.\.\. \(302 characters\); expected a text of at most 100"),
    (f"load.0.name={'n' * 300}", r"load\.0\.name: wrong value"),
    ("load=[]", r"missing keys; expected load"),
    ("sweep.name=['a', 'b']", r"sweep\.name: not to be swept; found \['a', 'b'\]"),
    (
        "material.default.elastic={block_E_GPa=3, block_nu=0.5, joint_E_GPa=1, joint_nu=0.3, joint_thickness_mm=1}",
        r"elastic\.block_nu: wrong value; found 0\.5; expected less than 0\.5",
    ),
]


@pytest.mark.parametrize(("change", "said"), CHANGES, ids=[change[:40] for change, _ in CHANGES])
def test_changes_that_are_refused(change: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        read_case(written(tmp_path, ARCH), [change])


@pytest.mark.parametrize(
    "change",
    [
        ".".join(["a"] * 2000) + "=1",
        ".".join(["a"] * 500) + "=1",
        "rigid.solver=" + "[" * 2000 + "]" * 2000,
        "a=" + "[" * 30 + "]" * 30,
    ],
)
def test_changes_of_too_many_levels(change: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="too many levels; expected at most 20"):
        read_case(written(tmp_path, ARCH), [change])


@pytest.mark.parametrize("name", ['"a\\u0000b.dxf"', '"a\\nb.dxf"', '""'])
def test_a_drawing_has_a_name_that_can_be_printed(name: str, tmp_path: Path) -> None:
    case = written(tmp_path, f"[source]\ndxf = {name}\n")
    with pytest.raises(InputError, match=r"source\.dxf: wrong value.*expected the path of a file, in printable characters"):
        read_case(case)


def test_a_drawing_elsewhere_is_named(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "case").mkdir()
    text = '[source]\ndxf = "../other.dxf"\n' + ARCH[ARCH.index("[material") :]
    code, _, err = call(capsys, "run", written(tmp_path / "case", text), "--out", tmp_path / "run")
    assert code == cli.FINDINGS
    assert f"The drawing lies elsewhere: {tmp_path / 'other.dxf'}" in err
    assert "no such file" in err


def test_an_entry_of_an_empty_list_is_told_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"load\.0\.direction: no such entry; found 0; expected an entry, and the list is empty"):
        read_case(written(tmp_path, ARCH), ["load=[]", "load.0.direction=[1, 0, 0]"])


def test_lengths_in_nested_tables_have_a_scale_too(tmp_path: Path) -> None:
    chapel = written(tmp_path, sample_case("chapel"))
    with pytest.raises(InputError, match=r"source\.openings\.2\.centre_m\.1: no length of a building; found 5\.6e\+09 mm"):
        read_case(chapel, ["source.openings.2.centre_m=[2.4, 5.6e6]"])
    with pytest.raises(InputError, match=r"source\.apse\.thickness_m: no length of a building"):
        read_case(chapel, ["source.apse.thickness_m=1e-9"])


def test_too_many_variants_are_counted_not_made(tmp_path: Path) -> None:
    frictions = ", ".join(str(k / 1000) for k in range(200))
    sweep = f'\n[sweep]\n"material.default.friction" = [{frictions}]\n"source.voussoirs" = {list(range(5, 105))}\n'
    with pytest.raises(InputError, match=r"sweep: too many combinations; found 200 x 100 = 20,000; expected at most 10,000"):
        read_variants(written(tmp_path, ARCH + sweep))


def test_a_folder_has_a_name_that_file_systems_take(tmp_path: Path) -> None:
    flows = [["associative"] * count for count in (30, 31)]
    todo = plan(read_variants(written(tmp_path, f'{ARCH}\n[sweep]\n"rigid.flow" = {flows}\n')))
    assert [len(name) for name in todo.analyses] == [200]
    pushes = [f'[{{direction = [1, 0, 0], name = "{"ü" * 90}{end}"}}]' for end in ("a", "b")]
    todo = plan(read_variants(written(tmp_path, f"sweep.load = [{', '.join(pushes)}]\n{ARCH}")))
    assert len(todo.analyses) == 2 * 2
    assert all(len(name.encode()) <= 202 for name in todo.analyses)


@pytest.mark.parametrize("name", ['q"uote.dxf', "back\\slash.dxf", "ünï cödé →.dxf", "hash#.dxf"])
def test_an_imported_case_can_be_read_whatever_its_drawing_is_called(name: str, tmp_path: Path) -> None:
    write_dxf(STONES, tmp_path / name, materials=[STONE], loads=[LoadCase((1, 0, 0), name='to "the" \\ west')])
    done = import_drawing(tmp_path / name, tmp_path / "out")
    case = read_case(done.case)
    assert isinstance(case.source, Drawing)
    assert case.source.path.name == name
    assert case.loads[0].name == 'to "the" \\ west'


@pytest.mark.parametrize("name", ["new\nline.dxf", "latin-\udce9.dxf"])
def test_a_name_that_no_case_can_hold(name: str, tmp_path: Path) -> None:
    write_dxf(STONES, tmp_path / name, materials=[STONE])
    with pytest.raises(UsageError, match="a case file cannot hold this name"):
        import_drawing(tmp_path / name, tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("mark", [b"\xef\xbb\xbf", b"\xff\xfe"])
def test_a_byte_order_mark_in_a_drawing_is_named(mark: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.dxf"
    write_dxf(STONES, path)
    path.write_bytes(mark + path.read_bytes())
    with pytest.raises(FindingsError, match="byte order mark"):
        read_dxf(path)


def test_export_does_not_overwrite_a_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    case = written(tmp_path, ARCH)
    code, _, err = call(capsys, "export-dxf", case, "--out", case)
    assert code == cli.USAGE
    assert "expected a name that ends in .dxf" in err
    assert case.read_text() == ARCH


@pytest.mark.parametrize("command", ["check", "import"])
@pytest.mark.parametrize(
    ("thickness", "said"),
    [("300m", "the longest side of a stone is 300 m"), ("0.3mm", "the thickness of most stones is 0.0003 m, usual are 0.005")],
)
def test_a_thickness_in_another_unit_is_questioned(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, command: str, thickness: str, said: str
) -> None:
    drawing = CORPUS / "not-closed.dxf"
    options = ("--thickness", thickness)
    code, _, err = call(capsys, command, drawing, *options, "--out", tmp_path / "new")
    assert code == 0
    assert said in err


@pytest.mark.parametrize(("option", "length"), [("course", "0.02mm"), ("stone", "0.02mm"), ("course", "30m")])
def test_stones_in_another_unit_are_questioned_before_any_is_laid(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, option: str, length: str
) -> None:
    wall = write_dxf_outlines(on_ground(box((0, 3), (0, 0.3), (0, 2)), reach=4), tmp_path)
    sizes = {"course": "0.25m", "stone": "0.5m"} | {option: length}
    options = [word for name, size in sizes.items() for word in (f"--{name}", size)]
    found = {"0.02mm": "0.02", "30m": "3e+04"}[length]
    code, _, err = call(capsys, "check", wall, "--bond", "running", *options)
    assert err.startswith(f"--{option} is {found} mm, usual are 5 to 25000 mm: bricks of models")
    assert code == 1
    assert "no stones can be laid in " in err
    with pytest.warns(DoubtfulValue, match=rf"read_dxf: {option} is .* mm"), suppress(InputError):
        read_dxf(wall, bond="running", **{name: parse_length(name, size) for name, size in sizes.items()})
    key = {"course": "course", "stone": "stone_length"}[option]
    case = read_case(written(tmp_path, sample_case("apse")), [f"source.{key}_m={parse_length(option, length)}"])
    [asked] = laying_questions([case, case])
    assert asked.startswith(f"source.{key}_mm is {found} mm, usual are")
    bricks = read_case(written(tmp_path, WALL), ["source.brick_mm=[0.4, 250, 200]"])
    assert [text.partition(",")[0] for text in laying_questions([bricks])] == ["source.brick_mm is 0.4 mm"]


def test_sizes_of_stones_are_questioned_by_the_check_of_a_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    given = {"length_m = 1.2": "length_mm = 1.2", "[400, 250, 200]": "[0.4, 0.25, 0.2]"}
    text = WALL
    for old, new in given.items():
        assert old in text
        text = text.replace(old, new)
    code, _, err = call(capsys, "check", written(tmp_path, text))
    assert code == 0
    assert "the longest side of a stone is 0.0004 m, usual are 0.005 to 25 m" in err


@pytest.mark.parametrize("given", ["length_m = ", "brick_m = [0.25, 0.2, "])
def test_a_number_of_hundreds_of_digits_is_refused(tmp_path: Path, given: str) -> None:
    key = given.split(" ")[0]
    line = next(line for line in WALL.splitlines() if line.startswith(key.removesuffix("_m")))
    text = WALL.replace(line, f"{given}1{'0' * 400}{']' * given.count('[')}")
    with pytest.raises(InputError, match=rf"line \d, source\.{key}\S*: wrong value; found 1000+ \.\.\. \(401 char"):
        read_case(written(tmp_path, text))


@pytest.mark.parametrize("name", ["case.toml", "wall.obj", "page"])
def test_a_page_does_not_overwrite_what_it_shows(capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str) -> None:
    case = written(tmp_path, ARCH)
    written(tmp_path, "v 0 0 0", "wall.obj")
    code, _, err = call(capsys, "view", case, "--no-open", "--out", tmp_path / name)
    assert code == cli.USAGE
    assert "not the name of a page; expected a name that ends in .html" in err
    assert case.read_text() == ARCH
    assert (tmp_path / "wall.obj").read_text() == "v 0 0 0"


def test_export_does_not_overwrite_the_drawing_of_a_case(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    drawing = tmp_path / "stones.dxf"
    write_dxf(STONES, drawing, materials=[STONE])
    drawn = drawing.read_bytes()
    case = written(tmp_path, '[source]\ndxf = "stones.dxf"\n[[load]]\ndirection = [1, 0, 0]\n[material.default]\n' + WEIGHT)
    code, _, err = call(capsys, "export-dxf", case, "--out", tmp_path / "." / "stones.dxf")
    assert code == cli.USAGE
    assert "the file that the case is made of; expected another name" in err
    assert drawing.read_bytes() == drawn


@pytest.mark.parametrize("command", ["check", "import"])
def test_findings_do_not_overwrite_what_they_are_about(capsys: pytest.CaptureFixture[str], tmp_path: Path, command: str) -> None:
    drawing = tmp_path / "findings.dxf"
    write_dxf(STONES, drawing, materials=[STONE])
    drawn = drawing.read_bytes()
    folder = tmp_path if command == "check" else tmp_path / "new"
    code, _, err = call(capsys, command, drawing, "--out", folder)
    assert code == cli.USAGE
    assert f"{folder / 'findings.dxf'}: the findings would be written over it. Rename the file" in err
    assert drawing.read_bytes() == drawn
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("command", [("generate", "arch"), ("run",), ("export-dxf",)])
def test_a_name_that_is_too_long(command: tuple[str, ...], capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    arguments = command if command[0] == "generate" else (*command, written(tmp_path, ARCH))
    code, _, err = call(capsys, *arguments, "--out", tmp_path / f"{'x' * 300}.dxf")
    assert code in (cli.USAGE, cli.FINDINGS)
    assert "File name too long" in err


def test_a_run_among_other_files_is_told(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    case = written(tmp_path, ARCH)
    for folder in (tmp_path, tmp_path / "new"):
        assert folder_of(case, "arch", folder) == folder
    err = capsys.readouterr().err
    assert err.startswith(f"The folder {tmp_path} holds other files, such as case.toml. Those of the run, report.html, code,")
    assert f"are written among them: --out {tmp_path / 'run'} keeps them apart." in err
    assert err.count("holds other files") == 1
    # A run that is there is taken up again.
    claim(tmp_path, case)
    assert folder_of(case, "arch", tmp_path) == tmp_path
    assert capsys.readouterr().err == ""


def test_a_start_that_failed_leaves_a_folder_of_its_case(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Where the disk is full before all settings are written, the next run knows them as its own."""
    case, run = written(tmp_path, ARCH), tmp_path / "run"

    def full(path: Path, text: str) -> None:
        if path.name == "plan.json":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        write_text(path, text)

    monkeypatch.setattr("churchpipe.configuring.write_if_changed", full)
    with pytest.raises(OSError, match="No space left"):
        configure(case, run)
    assert (run / "geometry").is_dir()
    assert folder_of(case, "arch", run) == run
    assert capsys.readouterr().err == ""


def test_two_cases_of_one_name_do_not_share_a_folder(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for folder in ("first", "second"):
        (tmp_path / folder).mkdir()
    first, second = (written(tmp_path / folder, ARCH) for folder in ("first", "second"))
    run = tmp_path / "runs" / "arch"
    assert other_case(run, first) == ""
    claim(run, first)
    assert other_case(run, Path("first") / "case.toml") == ""
    code, _, err = call(capsys, "run", second)
    assert code == cli.USAGE
    assert f"runs/arch: holds the run of another case of this name; found {first}" in err
    assert sorted(path.name for path in run.iterdir()) == ["case-file.txt"]
    # A file that was renamed takes its run along.
    first.rename(tmp_path / "first" / "renamed.toml")
    assert other_case(run, second) == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ('load.0.panels=["arhc"]', 'load.0.panels: no such panel; found arhc; expected arch. Did you mean "arch"?'),
        ("source.voussoirs=1", "source.voussoirs: out of range; found 1; expected a whole number"),
        ("source.half_angle_deg=170", "--set, source.half_angle_deg: out of range"),
    ],
)
def test_a_run_begins_with_a_building_that_can_be_made(
    change: str, said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    code, _, err = call(capsys, "run", written(tmp_path, ARCH), "--out", tmp_path / "out", "--set", change)
    assert code == cli.FINDINGS
    assert said in err
    assert not (tmp_path / "out").exists()


def test_why_a_run_did_not_end_is_read_whatever_it_says(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / engine.UNFINISHED).write_bytes(b"\xff\xfe")
    code, _, err = call(capsys, "show", tmp_path)
    assert code == cli.FINDINGS
    assert "the last run did not go to its end" in err


def test_a_file_that_cannot_be_written_is_named_as_the_person_named_it(tmp_path: Path) -> None:
    (tmp_path / "page.html").mkdir()
    with pytest.raises(OSError, match=r"page\.html") as raised:
        write_text(tmp_path / "page.html", "text")
    assert raised.value.filename == str(tmp_path / "page.html")


def test_a_case_is_not_imported(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, _, err = call(capsys, "import", written(tmp_path, ARCH))
    assert code == 2
    assert "a case, which is not imported; expected a drawing or a mesh. churchpipe run" in err


def test_a_message_does_not_steer_the_terminal(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(ARCH.replace("direction = [1, 0, 0]", 'direction = [1, 0, 0]\n"\\u001b[31m\\u202e" = 1'), encoding="utf-8")
    with pytest.raises(InputError, match=r"load\.0\.\\x1b\[31m\\u202e: unknown key"):
        read_case(case)


@pytest.mark.parametrize("char", ["\\u001b[31m", "\\u202e", "\\u0007"])
def test_names_that_would_steer_the_terminal_are_refused(tmp_path: Path, char: str) -> None:
    case = tmp_path / "case.toml"
    case.write_text(ARCH.replace("direction = [1, 0, 0]", f'direction = [1, 0, 0]\nname = "a{char}b"'), encoding="utf-8")
    with pytest.raises(InputError, match=r"load\.0\.name: a control character; found 'a\\(x|u).*b'; expected a text"):
        read_case(case)
    # Lines and tabs of a note are none.
    case.write_text(ARCH + '\n[project]\ntitle = "one\\ttwo"\n', encoding="utf-8")
    assert read_case(case).project.title == "one\ttwo"


def test_a_long_name_is_told_shortened(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(ARCH.replace('"arch"', f'"{"a" * 5000}"'), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_case(case, ["name=arch"])
    assert "source.generator: unknown generator; found 'aaa" in str(caught.value)
    assert len(str(caught.value)) < 600
