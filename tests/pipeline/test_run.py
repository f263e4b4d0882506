"""The pipeline as a user meets it: what is made, what is made again, what survives a kill. Jobs are counted, not timed."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from churchpipe import engine
from processes import group_lives, wait_for

ROOT = Path(__file__).parents[2]
CASE = """
name = "tiny"
[source]
generator = "wall"
length_mm = 800
brick_mm = [400, 250, 200]
courses = 3
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
[[load]]
direction = [-1, 0, 0]
[rigid]
flow = ["associative", "non-associative"]
"""
RESULTS = {"compare": 1, "report": 1, "all": 1}
SHELL = {"shell": 1, "match": 1, "limit": 1}
ALL = {"source": 1, "blocks": 1, "contacts": 1, "rigid": 2, **RESULTS}
CONFIGURE = "import sys; from churchpipe.configuring import configure; configure(sys.argv[1], sys.argv[2], sys.argv[3:])"
# Stands by with the libraries that configuring and the engine take seconds to load. Each line of its input is an order to a fork
# of it: a case or nothing, a run folder, changes of the case, the arguments of Snakemake, and where what they say is written.
FORKS = """
import json, os, sys, traceback
from churchpipe.configuring import configure
from snakemake.cli import main
for line in sys.stdin:
    case, out, changes, arguments, said = json.loads(line)
    if not os.fork():
        code = 1
        os.dup2(os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 1)
        os.dup2(1, 2)
        try:
            if case:
                configure(case, out, changes)
            main(arguments)
        except SystemExit as end:
            code = int(end.code or 0)
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    print(os.waitstatus_to_exitcode(os.wait()[1]), flush=True)
"""


EDITED = pytest.mark.slow("docs/run_folder.md: an edited source runs again what depends on it")


def stages_of(jobs: dict[str, int]) -> dict[str, int]:
    """Jobs that are stages: all but the engine's closing one."""
    return {rule: count for rule, count in jobs.items() if rule != "all"}


@dataclass(frozen=True)
class Copy:
    """A copy of the package whose sources may be edited, with a case and its run folder."""

    root: Path
    name: str = "tiny"
    folder: str = "run"
    forks: "subprocess.Popen[str] | None" = None

    @property
    def case(self) -> Path:
        return self.root / f"{self.name}.toml"

    @property
    def out(self) -> Path:
        return self.root / self.folder

    def module(self, name: str) -> Path:
        return self.root / "src" / "churchpipe" / name

    def start(self, *arguments: object) -> "subprocess.Popen[str]":
        environment = os.environ | {"PYTHONPATH": str(self.root / "src"), "MPLCONFIGDIR": str(self.root / "mpl")}
        module = [] if arguments[0] == "-c" else ["-m"]
        return subprocess.Popen(
            [sys.executable, *module, *map(str, arguments)],
            cwd=self.root,
            env=environment,
            stdin=subprocess.PIPE if arguments[-1] == FORKS else None,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def call(self, *arguments: object) -> tuple[int, str, str]:
        process = self.start(*arguments)
        out, err = process.communicate(timeout=600)
        return process.returncode, out, err

    def run(self, *options: object) -> tuple[int, str, str]:
        return self.call("churchpipe", "run", self.case, "--out", self.out, *options)

    def done(self) -> Counter[str]:
        """Jobs that the last run finished, by stage."""
        return Counter(event.stage for event in self.events() if event.kind == "done")

    def events(self) -> list[engine.Event]:
        """News of the last run."""
        return [event for line in (self.out / "run.log").read_text().splitlines() if (event := engine.heard(line))]

    def stale(self, *changes: str, edited: bool = False) -> dict[str, int]:
        """Jobs that a run would do now, by rule. edited: its sources are others than those that stand by."""
        if edited:
            status, out, err = self.call("-c", CONFIGURE, self.case, self.out, *changes)
            assert status == 0, out + err
        arguments = [part.replace(str(ROOT), str(self.root)) for part in engine.command(self.out, 1)[3:]]
        said = self.root / "said.txt"
        case = "" if edited else str(self.case)
        assert self.forks
        assert self.forks.stdin
        assert self.forks.stdout
        order = [case, str(self.out), changes, [*arguments, "--dry-run", "--quiet", "rules"], str(said)]
        self.forks.stdin.write(json.dumps(order) + "\n")
        self.forks.stdin.flush()
        status = self.forks.stdout.readline()
        assert status == "0\n", said.read_text()
        found = re.findall(r"^(\w+) +(\d+)$", said.read_text(), re.MULTILINE)
        return {rule: int(count) for rule, count in found if rule != "total"}

    def summary(self) -> dict[str, Any]:
        return json.loads((self.out / "summary.json").read_text())


@pytest.fixture(scope="module")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Copy]:
    """A copy in which the case has been run once."""
    copy = Copy(tmp_path_factory.mktemp("pristine"))
    # With what is compiled, but for what another process writes at this moment.
    shutil.copytree(ROOT / "src", copy.root / "src", ignore=shutil.ignore_patterns("*.tmp.*", "*.pyc.*"))
    shutil.copytree(ROOT / "pipeline", copy.root / "pipeline")
    # A machine without graphics: its report has a sentence in place of each picture, and is made faster.
    (copy.root / "src" / "pyvista.py").write_text("raise ImportError('no graphics here')\n")
    copy.case.write_text(CASE)
    code, out, err = copy.run("--jobs", 2)
    assert code == 0, out + err + (copy.out / "run.log").read_text()
    assert copy.done() == stages_of(ALL)
    assert [event.share for event in copy.events() if event.kind == "total"] == [sum(copy.done().values())]
    assert "-x    associative" in out
    assert "rigid     -x_non-associative" in err
    with copy.start("-c", FORKS) as forks:
        yield replace(copy, forks=forks)
        forks.communicate()


@pytest.fixture(scope="module")
def with_shell(pristine: Copy) -> Copy:
    """The same package, and a case with a shell that has been run once."""
    copy = Copy(pristine.root, "shell", "run-shell", pristine.forks)
    copy.case.write_text(CASE.replace(', "non-associative"', "") + "[shell]\nelement_size_mm = 400\n")
    code, out, err = copy.run("--jobs", 2)
    assert code == 0, out + err + (copy.out / "run.log").read_text()
    assert copy.done() == stages_of({**ALL, "rigid": 1, **SHELL})
    assert "shell         limit load" in out
    return copy


@pytest.fixture
def edited(pristine: Copy) -> Iterator[Callable[[str, Callable[[str], str]], None]]:
    """Edit a file of the copy for one test: edited(path, function of its text)."""
    before: dict[Path, tuple[str, os.stat_result]] = {}

    def edit(name: str, change: Callable[[str], str]) -> None:
        path = pristine.root / name
        before[path] = (path.read_text(), path.stat())
        path.write_text(change(path.read_text()))

    yield edit
    for path, (text, stat) in before.items():
        path.write_text(text)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))


def test_everything_is_made(pristine: Copy) -> None:
    made = {str(path.relative_to(pristine.out)) for path in pristine.out.rglob("*") if ".snakemake" not in path.parts}
    wanted = ["report.html", "summary.json", "table.csv", "plan.json", "as-run.toml", "run.log"]
    wanted += [
        f"geometry/base/{name}" for name in ("building.json", "assemblage.npz", "stones.dxf", "stones.vtu", "contacts.npz")
    ]
    wanted += [
        f"rigid/-x_{f}/{n}"
        for f in ("associative", "non-associative")
        for n in ("rigid.npz", "rigid.json", "mechanism.vtu", "joints.vtu")
    ]
    assert made >= set(wanted)
    assert not [name for name in made if ".part" in name]


def test_summary_and_table_say_the_same(pristine: Copy) -> None:
    summary = pristine.summary()
    assert list(summary) == [
        *("case", "blocks", "interfaces", "contact_points", "weight_kN", "near_misses", "joints"),
        *("analyses", "guidance", "questions"),
    ]
    # Three courses of .8 m in bricks of .4 m: 2 + 3 + 2 stones, weight by hand.
    assert (summary["case"], summary["blocks"], summary["weight_kN"]) == ("tiny", 7, pytest.approx(0.8 * 0.25 * 0.6 * 18))
    associative, sliding = summary["analyses"]
    assert (associative["model"], associative["load"], associative["friction"]) == ("rigid-block", "-x", 0.6)
    assert associative["status"] == "optimal"
    assert associative["lower_bound"] == pytest.approx(associative["upper_bound"], abs=1e-6)
    # A wall longer than it is high slides whole on the ground, at its friction coefficient, by either flow rule.
    assert associative["load_factor"] == pytest.approx(0.6, rel=1e-6)
    assert sliding["flow"] == "non-associative"
    # Its gap says by how much a state without dilatancy may fall short of that.
    assert 0 <= 0.6 - sliding["load_factor"] <= sliding["gap"] + 1e-9
    assert sliding["gap"] <= 1e-5 * sliding["load_factor"]
    with (pristine.out / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["load_factor"]) for row in rows] == [a["load_factor"] for a in summary["analyses"]]


def test_every_key_of_the_summary_is_documented(pristine: Copy, with_shell: Copy) -> None:
    page = (ROOT / "docs" / "run_folder.md").read_text(encoding="utf-8")
    known = set(re.findall(r"`(\w+)`", page))
    for copy in (pristine, with_shell):
        summary = copy.summary()
        keys = {*summary, *summary["shell"]} if "shell" in summary else {*summary}
        assert keys | {key for record in summary["analyses"] for key in record} <= known


def test_a_second_run_does_nothing(pristine: Copy) -> None:
    # Not even the engine is started: its log is that of the first run.
    before = {path: path.stat().st_mtime_ns for path in (*pristine.out.glob("**/*.npz"), pristine.out / "run.log")}
    code, out, err = pristine.run()
    assert code == 0
    assert "associative" in out
    assert "Nothing has changed" in err
    assert {path: path.stat().st_mtime_ns for path in before} == before
    # A date that differs is the engine's to judge, which finds no work either.
    os.utime(pristine.out / "plan.json")
    code, out, err = pristine.run()
    assert (code, pristine.done()) == (0, {})
    assert "associative" in out
    assert "Nothing has changed" not in err


def test_dates_alone_change_nothing(pristine: Copy) -> None:
    for path in (pristine.case, pristine.module("rigid_blocks/limit.py"), pristine.out / "geometry" / "base" / "contacts.npz"):
        os.utime(path)
    assert pristine.stale() == {}


@pytest.mark.slow
def test_a_new_friction_reruns_the_solves_alone(pristine: Copy) -> None:
    assert pristine.stale("material.default.friction=0.5") == {"rigid": 2, **RESULTS}
    assert pristine.stale("rigid.start=uniform") == {"rigid": 1, **RESULTS}
    assert pristine.stale() == {}


def test_results_of_a_clock_that_was_ahead_are_not_taken_for_newer(pristine: Copy) -> None:
    copy, later = replace(pristine, folder="run-later"), time.time() + 1e8
    shutil.copytree(pristine.out, copy.out)
    for path in copy.out.rglob("*"):
        os.utime(path, (later, later), follow_symlinks=False)
    code, out, err = copy.run("--set", "material.default.friction=0.5", "--dry-run")
    assert code == 0, err
    assert re.search(r"^rigid .* its settings have changed", out, re.MULTILINE)
    assert all(path.stat().st_mtime == pytest.approx(later) for path in copy.out.rglob("*.json"))
    code, out, err = copy.run("--set", "material.default.friction=0.5")
    assert code == 0, err
    assert re.search(r"associative +0\.5 ", out)


@pytest.mark.slow
def test_a_new_length_reruns_everything(pristine: Copy) -> None:
    assert pristine.stale("source.length_mm=1200") == ALL
    assert pristine.stale() == {}


@pytest.mark.slow
def test_a_sweep_makes_the_stones_once(pristine: Copy) -> None:
    sweep = 'sweep={"material.default.friction"=[0.4,0.5,0.6,0.7]}'
    assert pristine.stale(sweep) == {"rigid": 8, **RESULTS}
    both = 'sweep={"material.default.friction"=[0.4,0.5],"source.courses"=[3,4]}'
    assert pristine.stale(both) == {"source": 2, "blocks": 2, "contacts": 2, "rigid": 8, **RESULTS, "report_1": 1}
    assert pristine.stale() == {}


@pytest.mark.parametrize(
    ("name", "jobs"),
    [
        pytest.param("src/churchpipe/rigid_blocks/limit.py", {"rigid": 2, **RESULTS}, marks=EDITED),
        ("src/churchpipe/stones/contacts.py", {"contacts": 1, "rigid": 2, **RESULTS}),
        pytest.param("src/churchpipe/config/settings.py", ALL, marks=EDITED),
        pytest.param("src/churchpipe/generators/wall.py", ALL, marks=EDITED),
        pytest.param("src/churchpipe/report/html.py", {"report": 1, "all": 1}, marks=EDITED),
        ("src/churchpipe/report/templates/report.html", {"report": 1, "all": 1}),
        # What reads the case decides through the settings, and a comment changes none.
        pytest.param("src/churchpipe/config/case.py", {}, marks=EDITED),
        pytest.param("src/churchpipe/cli/runs.py", {}, marks=EDITED),
    ],
)
def test_an_edited_source_reruns_what_depends_on_it(
    name: str, jobs: dict[str, int], pristine: Copy, edited: Callable[[str, Callable[[str], str]], None]
) -> None:
    edited(name, lambda text: text + ("\n# edited\n" if name.endswith(".py") else "\n"))
    assert pristine.stale(edited=True) == jobs


@pytest.mark.slow
def test_an_edited_reader_of_cases_reruns_what_it_decides(
    pristine: Copy, edited: Callable[[str, Callable[[str], str]], None]
) -> None:
    less = 'values | {"friction": 0.9 * values["friction"]}'
    edited("src/churchpipe/config/case.py", lambda text: text.replace("record(Material, values,", f"record(Material, {less},"))
    assert pristine.stale(edited=True) == {"rigid": 2, **RESULTS}


@EDITED
@pytest.mark.parametrize("stage", ["rigid", "report"])
def test_an_edited_stage_reruns_itself_alone(
    stage: str, pristine: Copy, edited: Callable[[str, Callable[[str], str]], None]
) -> None:
    head = f"\ndef {stage}("
    edited("src/churchpipe/stages.py", lambda text: text.replace(head, f"\n@(lambda work: work){head}"))
    assert pristine.stale(edited=True) == ({"rigid": 2, **RESULTS} if stage == "rigid" else {"report": 1, "all": 1})


def test_a_dry_run_says_what_would_be_done_and_does_nothing(pristine: Copy) -> None:
    def contents() -> dict[str, bytes]:
        return {
            str(path): path.read_bytes() for path in pristine.out.rglob("*") if path.is_file() and ".snakemake" not in str(path)
        }

    before, beside = contents(), sorted(pristine.root.iterdir())
    code, out, _ = pristine.run("--dry-run", "--set", "material.default.friction=0.5")
    assert code == 0
    assert out.count("its settings have changed") == 2
    assert "compare   summary.json" in out
    assert out.endswith("4 stages would be run.\n")
    assert (contents(), sorted(pristine.root.iterdir())) == (before, beside)


@pytest.mark.slow
def test_a_dry_run_knows_where_a_run_would_end_and_when_there_is_nothing_to_do(pristine: Copy) -> None:
    code, out, _ = pristine.run("--dry-run", "--only", "contacts", "--set", "source.courses=4")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == ["source", "blocks", "contacts", "3"]
    assert pristine.run("--dry-run")[1] == "Everything is up to date.\n"


@pytest.mark.slow
def test_a_run_ends_with_the_stage_that_is_asked_for(pristine: Copy, tmp_path: Path) -> None:
    out = tmp_path / "run"
    code, said, err = pristine.call("churchpipe", "run", pristine.case, "--out", out, "--only", "contacts")
    assert code == 0, err
    assert said == f"Made as far as the stage contacts: {out}\n"
    assert (out / "geometry" / "base" / "contacts.npz").is_file()
    assert not (out / "summary.json").exists()
    code, _, err = pristine.call("churchpipe", "show", out)
    assert code == 1
    assert "no more than the stage contacts" in err
    code, _, err = pristine.call("churchpipe", "run", pristine.case, "--out", out, "--only", "shell")
    assert code == 2
    assert "expected source, blocks, contacts, rigid, compare, report" in err


@pytest.mark.slow
def test_what_was_deleted_is_made_again(pristine: Copy) -> None:
    contacts, log = pristine.out / "geometry" / "base" / "contacts.npz", pristine.out / "log" / "contacts" / "base.txt"
    contacts.unlink()
    log.unlink()
    code, out, err = pristine.run()
    assert code == 0, out + err
    assert pristine.done()["contacts"] == 1
    assert contacts.exists()
    assert '"done", "contacts"' in log.read_text()
    assert pristine.stale() == {}


@pytest.mark.slow
def test_what_takes_longest_begins_first(pristine: Copy, tmp_path: Path) -> None:
    elastic = "elastic = { block_E_GPa = 3, block_nu = 0.2, joint_E_GPa = 0.3, joint_nu = 0.3, joint_thickness_mm = 1 }"
    case = CASE.replace("friction = 0.6", f"friction = 0.6\n{elastic}")
    (tmp_path / "both.toml").write_text(f'{case}[shell]\nelement_size_mm = 800\nanalyses = ["limit", "pushover"]\n')
    code, out, err = pristine.call("churchpipe", "run", tmp_path / "both.toml", "--out", tmp_path / "run", "--jobs", 1)
    assert code == 0, out + err
    begun = [event.name for event in Copy(tmp_path).events() if event.kind == "start" and event.name.startswith("-x_")]
    assert set(begun[:2]) == {"-x_non-associative", "-x_pushover"}
    assert begun[2:] == ["-x_limit", "-x_associative"]


def test_a_case_with_a_shell_makes_its_artifacts_once(with_shell: Copy) -> None:
    made = {str(path.relative_to(with_shell.out)) for path in with_shell.out.rglob("*") if ".snakemake" not in path.parts}
    assert made >= {f"shell/base/{name}" for name in ("shell.npz", "shell.msh", "shell.vtu", "match.json")}
    assert made >= {f"limit/-x_limit/{name}" for name in ("limit.npz", "limit.json", "mechanism.vtu")}
    assert not (with_shell.out / engine.UNFINISHED).exists()
    assert with_shell.stale() == {}


def test_a_sweep_of_frictions_reruns_the_solves_of_both_models(with_shell: Copy) -> None:
    assert with_shell.stale('sweep={"material.default.friction"=[0.5,0.6]}') == {"rigid": 2, "limit": 2, **RESULTS}


@pytest.mark.slow
def test_a_sweep_of_meshes_reruns_the_shell_alone(with_shell: Copy) -> None:
    sweep = 'sweep={"shell.element_size_mm"=[400,200]}'
    assert with_shell.stale(sweep) == {"shell": 2, "match": 2, "limit": 2, **RESULTS}
    assert with_shell.stale("shell.planes=paper") == {"limit": 1, **RESULTS}
    assert with_shell.stale() == {}


@pytest.mark.parametrize(
    ("name", "jobs"),
    [
        ("src/churchpipe/homogenised_shell/limit.py", {"limit": 1, **RESULTS}),
        pytest.param("src/churchpipe/match.py", {"match": 1, "limit": 1, **RESULTS}, marks=EDITED),
        pytest.param("src/churchpipe/rigid_blocks/limit.py", {"rigid": 1, **RESULTS}, marks=EDITED),
    ],
)
def test_an_edited_source_of_one_model_leaves_the_other(
    name: str, jobs: dict[str, int], with_shell: Copy, edited: Callable[[str, Callable[[str], str]], None]
) -> None:
    edited(name, lambda text: text + "\n# edited\n")
    assert with_shell.stale(edited=True) == jobs


# A lintel that bears on a junction, which only laying finds.
UNLAID = (
    'source={generator="prototype", brick_mm=[80,40,30], main_wall_bricks=8, partitions_x_mm=[0,600], partition_length_mm=320, '
    "courses=21, opening={start_mm=60, width_mm=100, height_courses=14, lintel_bearing_mm=40}}"
)


@pytest.mark.slow
def test_bad_input_found_by_a_stage_is_1_and_says_so(pristine: Copy, tmp_path: Path) -> None:
    run = tmp_path / "run"
    code, out, err = pristine.call("churchpipe", "run", pristine.case, "--out", run, "--set", UNLAID)
    assert code == 1
    assert "lintel-1: an opening, a junction" in err
    assert "Traceback" not in out + err
    assert not (run / "summary.json").exists()
    code, _, err = pristine.call("churchpipe", "show", run)
    assert code == 1
    assert "the last run did not go to its end" in err
    assert "lintel-1: an opening, a junction" in err
    assert (run / "geometry" / "base" / "building.json").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ('load.0.panels=["apse"]', "apse"),
        pytest.param("source.courses=900000", "too many stones", marks=pytest.mark.slow),
    ],
)
def test_bad_input_found_before_is_1_and_leaves_nothing(change: str, said: str, pristine: Copy, tmp_path: Path) -> None:
    code, out, err = pristine.call("churchpipe", "run", pristine.case, "--out", tmp_path / "run", "--set", change)
    assert code == 1
    assert said in err
    assert "Traceback" not in out + err
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
@pytest.mark.parametrize(("damage", "said"), [("{", "not JSON"), ("{}", "not a summary of a run")])
def test_a_damaged_summary_is_made_anew(damage: str, said: str, pristine: Copy, tmp_path: Path) -> None:
    run, sound = tmp_path / "run", pristine.summary()
    shutil.copytree(pristine.out, run)
    (run / "summary.json").write_text(damage)
    code, out, err = pristine.call("churchpipe", "run", pristine.case, "--out", run)
    assert code == 0, out + err
    assert f"{run / 'summary.json'}: {said}. It is made anew." in err
    assert json.loads((run / "summary.json").read_text()) == sound
    # Only what is made of the summary was made with it.
    assert {event.stage for line in (run / "run.log").read_text().splitlines() if (event := engine.heard(line))} >= {"compare"}
    assert "rigid" not in (run / "run.log").read_text().partition("compare")[0].replace("rigid/", "")


@pytest.mark.slow
def test_a_structure_that_falls_is_3_with_its_report(pristine: Copy, tmp_path: Path) -> None:
    (tmp_path / "arch.toml").write_text(
        'name="arch"\n[source]\ngenerator="arch"\nmean_radius_m=1\nthickness_m=0.2\nwidth_m=1\nvoussoirs=7\n'
        "[material.default]\nunit_weight_kN_m3=18\nfriction=0.15\n[[load]]\ndirection=[1,0,0]\n"
    )
    code, out, _ = pristine.call("churchpipe", "run", tmp_path / "arch.toml", "--out", tmp_path / "run")
    assert code == 3
    assert "unstable" in out
    assert (tmp_path / "run" / "report.html").stat().st_size > 10_000
    analysis = json.loads((tmp_path / "run" / "summary.json").read_text())["analyses"][0]
    assert (analysis["status"], analysis["load_factor"]) == ("unstable", None)
    assert pristine.call("churchpipe", "show", tmp_path / "run")[1] == out.replace(out.splitlines(keepends=True)[-1], "")


@pytest.mark.slow("docs/drawings.md: any name of a drawing, to the end of its run")
def test_a_drawing_may_have_braces_in_its_name(pristine: Copy, tmp_path: Path) -> None:
    shutil.copy(pristine.out / "geometry" / "base" / "stones.dxf", tmp_path / "a{b} c.dxf")
    case = CASE[CASE.index("[material") :].replace(', "non-associative"', "")
    (tmp_path / "drawn.toml").write_text(f'name = "drawn"\n[source]\ndxf = "a{{b}} c.dxf"\n{case}')
    code, out, err = pristine.call("churchpipe", "run", tmp_path / "drawn.toml", "--out", tmp_path / "run")
    assert code == 0, out + err
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["analyses"][0]["load_factor"] == pytest.approx(0.6, rel=1e-6)


@pytest.mark.slow
def test_a_wall_that_a_drawing_has_not_is_named_with_its_line(pristine: Copy, tmp_path: Path) -> None:
    # Nor do braces in the name of a drawing matter.
    shutil.copy(pristine.out / "geometry" / "base" / "stones.dxf", tmp_path / "a{b} c.dxf")
    text = f'name = "drawn"\n[source]\ndxf = "a{{b}} c.dxf"\n{CASE[CASE.index("[material") :]}'
    case = tmp_path / "drawn.toml"
    case.write_text(f'{text}\n[[line_loads]]\nname = "roof"\nwall = "nave"\ndead_kN_m = 3.0\n')
    code, out, err = pristine.call("churchpipe", "run", case, "--out", tmp_path / "run")
    assert code == 1, out + err
    line = case.read_text().splitlines().index("[[line_loads]]") + 1
    assert f"{case}: line {line}, line_loads.0: line load roof: no such wall; found nave" in err


@pytest.mark.slow
def test_a_kill_in_the_middle_loses_nothing_finished(pristine: Copy, tmp_path: Path) -> None:
    out = tmp_path / "run"
    command = ("churchpipe", "run", pristine.case, "--out", out, "--jobs", 1)

    def started(rule: str) -> bool:
        log = out / "run.log"
        return log.exists() and f'"start", "{rule}"' in log.read_text()

    def signal_engine(number: signal.Signals) -> None:
        os.killpg(int((out / ".snakemake" / "engine.lock").read_text()), number)

    process = pristine.start(*command)
    wait_for(lambda: started("contacts"))
    # While it is at work, held here so that it cannot end before, nobody else may work in the same folder.
    signal_engine(signal.SIGSTOP)
    code, _, err = pristine.call(*command)
    assert code == 1
    assert "another run is at work" in err
    signal_engine(signal.SIGCONT)
    wait_for(lambda: started("rigid"))
    # First the command alone is killed: its engine lives on. Then the engine with all its jobs.
    signal_engine(signal.SIGSTOP)
    process.kill()
    process.communicate()
    (out / "run.log").unlink()
    finished = [out / "geometry" / "base" / name for name in ("building.json", "assemblage.npz", "contacts.npz")]
    before = [path.stat().st_mtime_ns for path in finished]
    (out / "rigid" / ".part-1-left.npz").touch()
    process = pristine.start(*command)
    wait_for(lambda: started("rigid") or process.poll() is not None)
    assert process.poll() is None
    signal_engine(signal.SIGKILL)
    process.kill()
    process.communicate()
    code, text, err = pristine.call(*command)
    assert code == 0, text + err
    assert Copy.done(Copy(tmp_path)).keys() & {"source", "blocks", "contacts"} == set()
    assert [path.stat().st_mtime_ns for path in finished] == before
    assert not list(out.rglob(".part-*"))
    first, second = (
        [analysis["load_factor"] for analysis in json.loads((folder / "summary.json").read_text())["analyses"]]
        for folder in (pristine.out, out)
    )
    assert first == pytest.approx(second, rel=1e-6)


@pytest.mark.slow
def test_an_interrupt_stops_everything(pristine: Copy, tmp_path: Path) -> None:
    out = tmp_path / "run"
    # A shell's background jobs ignore the interrupt, and their children inherit that.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    process = pristine.start("churchpipe", "run", pristine.case, "--out", out, "--jobs", 1)
    signal.signal(signal.SIGINT, before)
    wait_for(lambda: (out / "geometry" / "base" / "contacts.npz").exists())
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert "What was finished stays" in err
    assert "Traceback" not in err
    engine = int((out / ".snakemake" / "engine.lock").read_text())
    # A stage that compiles its loops for the first time takes a moment to die.
    wait_for(lambda: not group_lives(engine), 30.0)
