"""What decides a stage: found through the imports of the sources, in a small package with every kind of them."""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import churchpipe
from churchpipe.closure import PACKAGE, Sources, _imports, code_of, codes_of, imports_in
from churchpipe.stages import STAGES

SOURCES = {
    "stages.py": """
from typing import TYPE_CHECKING
from pack.head import tool as lent
from pack import whole
import pack.plain
if TYPE_CHECKING:
    from pack import hint
LIMIT = 3
def cut(path):
    from pack.deep.lazy import knife
    return helper(knife, LIMIT)
def helper(*_):
    return lent
def glue(path, helper):
    return whole.glue, pack.plain, helper, [cut for cut in path]
""",
    "head.py": "from pack.deep import tool",
    "whole.py": "import numpy",
    "plain.py": "",
    "hint.py": "",
    "deep/__init__.py": "tool = 1",
    "deep/lazy.py": "def knife():\n    if True:\n        from pack.deep.steel import blade\n",
    "deep/steel.py": "",
    "deep/forms/page.html": "<p>",
    "deep/__pycache__/lazy.nbc": "compiled",
    "idle.py": "",
}


@pytest.fixture
def package(tmp_path: Path) -> Path:
    for name, text in SOURCES.items():
        path = tmp_path / "pack" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "pack"


def names(text: str) -> list[str]:
    return [line.split(maxsplit=1)[1] for line in text.splitlines()]


def test_imports_are_followed_those_inside_functions_too(package: Path) -> None:
    assert names(code_of("cut", package)) == [
        "stages.py: cut",
        *("deep/__init__.py", "deep/forms/page.html", "deep/lazy.py", "deep/steel.py", "head.py"),
    ]
    assert names(code_of("glue", package)) == ["stages.py: glue", "plain.py", "whole.py"]


@pytest.mark.parametrize(
    ("name", "old", "new", "changed"),
    [
        ("deep/steel.py", "", "blade = 2", ["cut"]),
        ("deep/forms/page.html", "<p>", "<b>", ["cut"]),
        ("whole.py", "numpy", "scipy", ["glue"]),
        ("stages.py", "LIMIT = 3", "LIMIT = 4", ["cut"]),
        ("stages.py", "return lent", "return lent, 1", ["cut"]),
        ("stages.py", "whole.glue,", "whole,", ["glue"]),
        ("stages.py", "def glue", "@staticmethod\ndef glue", ["glue"]),
        ("stages.py", "LIMIT = 3", "# What cuts.\nLIMIT = 3", []),
        ("hint.py", "", "x = 1", []),
        ("idle.py", "", "x = 1", []),
    ],
)
def test_an_edit_changes_what_depends_on_it_alone(name: str, old: str, new: str, changed: list[str], package: Path) -> None:
    before = {stage: code_of(stage, package) for stage in ("cut", "glue")}
    path = package / name
    path.write_text(path.read_text().replace(old, new, 1))
    assert [stage for stage, text in before.items() if code_of(stage, package) != text] == changed


def test_several_stages_read_each_source_once(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    alone = {stage: code_of(stage, package) for stage in ("cut", "glue")}
    read: list[str] = []
    originals = {name: getattr(Path, name) for name in ("read_text", "read_bytes")}
    for name, original in originals.items():

        def noted(path: Path, *arguments: Any, original: Any = original, name: str = name, **options: Any) -> Any:
            read.append(f"{name} {path}")
            return original(path, *arguments, **options)

        monkeypatch.setattr(Path, name, noted)
    assert codes_of(("cut", "glue", "cut"), package) == alone
    assert len(read) == len(set(read)) > 0


@cache
def modules(stage: str) -> tuple[str, ...]:
    return tuple(name for name in names(code_of(stage)) if name.endswith(".py"))


def test_the_solves_know_neither_cases_nor_generators() -> None:
    for stage in STAGES.keys() - {"source", "sample"}:
        assert not [name for name in modules(stage) if name.startswith("generators/")], stage
        assert "config/case.py" not in modules(stage), stage
    assert "generators/church.py" in modules("source")
    assert "config/settings.py" in modules("pushover")
    assert any(name.startswith("report/static/") for name in names(code_of("report")))


def test_what_reads_the_folder_of_a_run_decides_the_results_alone() -> None:
    assert {stage for stage in STAGES if "run_folder.py" in modules(stage)} == {"compare", "report", "sample"}


def test_every_stage_that_the_rules_name_has_its_code() -> None:
    rules = "".join(path.read_text() for path in (Path(churchpipe.__file__).parents[2] / "pipeline" / "rules").glob("*.smk"))
    assert all(f'code="code/{stage}.txt"' in rules for stage in STAGES)


def test_a_stage_is_loaded_without_the_reader_of_cases_and_without_solvers() -> None:
    # Each stage is a process: what all of them load, a person waits for some ten times.
    heavy = ["pydantic", "tomlkit", "numba", "ezdxf", "clarabel", "churchpipe.config.case", "churchpipe.compare"]
    code = f"import churchpipe.stages, sys; print([m for m in {heavy} if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_the_lines_that_import_say_all_that_the_modules_do() -> None:
    texts = [path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")]
    sources = Sources(PACKAGE)
    found = [(set(imports_in(text, sources)), set(_imports(ast.parse(text), sources))) for text in texts]
    assert all(lines >= tree for lines, tree in found)
    # A program within a text, which another process runs, is all that they find besides.
    assert sum(lines != tree for lines, tree in found) <= 1


def test_lines_that_cannot_be_parsed_alone_are_read_with_their_module(package: Path) -> None:
    tricky = '"""Words\nimport nothing, they say.\n"""\nfrom pack.deep import (\n    tool,  # (here)\n)\nimport pack.plain\n'
    assert {path.name for path in imports_in(tricky, Sources(package))} == {"__init__.py", "plain.py"}
