"""Every command that the manual shows is executed, in a folder with the files that its page speaks of.

Runs are dry in the tests that are always made. The slow ones run them, with larger stones where those of the page take minutes.
"""

import re
import shlex
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import trimesh
from ezdxf import units

from churchpipe import cli
from manual_pages import PAGES, ROOT, case_of_the_tutorial, commands

Maker = Callable[[Path], object]


def rectangle(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def drawn(path: Path, *outlines: tuple[str, list[tuple[float, float]]]) -> None:
    document = ezdxf.new("R2010")
    document.units = units.M
    for layer, corners in outlines:
        document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    document.saveas(path)


def bricks(path: Path) -> None:
    """Bricks of 250 x 65 mm in six courses, with joints of 10 mm."""
    corners = [(0.26 * column + 0.13 * (course % 2), 0.075 * course) for course in range(6) for column in range(5)]
    drawn(path, *(("WALL", rectangle(x, y, 0.25, 0.065)) for x, y in corners))


def facade(path: Path) -> None:
    gable = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.0, 4.0), (0.0, 3.0)]
    drawn(path, ("FACADE", gable), ("OPENING", rectangle(1.5, 0.0, 1.0, 2.0)))


def two_walls(path: Path) -> None:
    """Two walls that meet at a corner, each a closed body."""
    bodies = [trimesh.creation.box(bounds=bounds) for bounds in (((0, 0, 0), (3, 0.5, 2)), ((0, 0.5, 0), (0.5, 2.5, 2)))]
    trimesh.Scene({"front": bodies[0], "side": bodies[1]}).export(path, include_normals=False)


def ring(path: Path) -> None:
    """Half a ring that stands upright, 2 m wide inside, .3 m high and .4 m deep."""
    angle = np.linspace(0.0, np.pi, 33)
    arc = np.column_stack([np.cos(angle), np.zeros(33), np.sin(angle)])
    depth = np.array([0, 0.4, 0])
    points = np.stack([arc, 1.3 * arc, 1.3 * arc + depth, arc + depth], axis=1).reshape(-1, 3)
    sides = [(4 * k + a, 4 * k + b, 4 * k + 4 + b, 4 * k + 4 + a) for k in range(32) for a, b in ((1, 0), (2, 1), (3, 2), (0, 3))]
    quads = [*sides, (0, 1, 2, 3), (131, 130, 129, 128)]
    trimesh.Trimesh(points, [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]).export(path)


def nave(path: Path) -> None:
    path.write_text(case_of_the_tutorial(), encoding="utf-8")


def profile(path: Path) -> None:
    """The folder that the page on clusters describes."""
    path.mkdir()
    page = (ROOT / "docs" / "cluster.md").read_text(encoding="utf-8")
    block = re.search(r"^```yaml\n# mycluster/config.yaml[^\n]*\n(.*?)^```", page, flags=re.DOTALL | re.MULTILINE)
    assert block
    lines = (ROOT / "pipeline" / "profiles" / "slurm" / "config.yaml").read_text(encoding="utf-8")
    (path / "config.yaml").write_text(lines + block[1], encoding="utf-8")


def copied(name: str) -> Maker:
    return partial(shutil.copyfile, ROOT / name)


# The files that a page speaks of, beside those that its commands make and those of the source.
FILES: dict[str, dict[str, Maker]] = {
    "README.md": {"wall.obj": copied("tests/corpus/sound.obj")},
    "cluster.md": {name: copied(f"pipeline/cases/{name}") for name in ("church.toml", "church_friction.toml")}
    | {"mycluster": profile},
    "drawings.md": {"wall.dxf": bricks, "facade.dxf": facade, "nave.obj": two_walls, "arch.stl": ring},
    "formats.md": {"wall.obj": copied("tests/corpus/sound.obj")},
    "run_folder.md": {"nave.toml": nave},
    "tutorial.md": {"nave.toml": nave},
}
WITH_COMMANDS = [page for page in PAGES if commands(page)]
LONG_PAGES = {"README.md", "run_folder.md", "strengthening.md", "tutorial.md"}
LONG = pytest.mark.slow("README.md, docs/: commands of the pages that check or lay a building with each of them")


def folder_of(page: Path, tmp_path: Path) -> None:
    """Fill a folder with what a reader of a page has."""
    for name in ("pipeline", "cad_samples"):
        (tmp_path / name).symlink_to(ROOT / name)
    for name, make in FILES.get(page.name, {}).items():
        make(tmp_path / name)


def called(command: list[str], monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr("sys.argv", command)
    with pytest.raises(SystemExit) as left:
        cli.main()
    return int(left.value.code or 0)


def typed(page: Path) -> list[str]:
    """Return the commands of a page, with a file where it has a word in capitals."""
    return [line.replace("FILE", "wall.obj") for line in commands(page) if "..." not in line]


@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=LONG if page.name in LONG_PAGES else (), id=page.name) for page in WITH_COMMANDS]
)
def test_commands_of_a_page_can_be_typed(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder_of(page, tmp_path)
    monkeypatch.chdir(tmp_path)
    # Snakemake takes seconds to say which stages it would run (tests/pipeline/test_run.py has it).
    monkeypatch.setattr("churchpipe.pending.pending", lambda *_: [])
    for line in typed(page):
        command = shlex.split(line)
        if command[1] not in ("show", "report"):
            more = {"run": ["--dry-run"], "view": ["--no-open"]}.get(command[1], [])
            assert called([*command, *more], monkeypatch) == 0, line


COARSE = ["--set", "source.course_m=0.55", "--set", "source.stone_length_m=0.8"]
# What makes the runs of a page smaller; None: only dry, since no smaller building says what the page says.
SMALLER: dict[str, list[str] | None] = {
    "chapel": ["--set", "source.course_m=0.5", "--set", "source.stone_length_m=1.0"],
    "mychurch": [*COARSE, "--load", "+x"],
    "church": [*COARSE, "--load", "+x"],
    "church_friction": [*COARSE, "--load", "+x"],
    "church_stone_length": None,
    "church_sliding": None,
    "church_strengthened": None,
}


@pytest.mark.slow("README.md, docs/: the commands of all pages, run to their end")
@pytest.mark.parametrize("page", WITH_COMMANDS, ids=lambda page: page.name)
def test_commands_of_a_page_do_what_they_say(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder_of(page, tmp_path)
    monkeypatch.chdir(tmp_path)
    for line in typed(page):
        command = [word for word in shlex.split(line) if word not in ("--profile", "slurm", "mycluster")]
        more = ["--no-open"] if command[1] == "view" else []
        if command[1] == "run":
            smaller = SMALLER.get(Path(command[2]).stem, [])
            more = ["--dry-run"] if smaller is None else [] if "source.course_m=0.55" in command else smaller
        # 3: the report is written, and says what does not stand.
        assert called([*command, *more], monkeypatch) in ((0, 3) if command[1] == "run" else (0,)), line
