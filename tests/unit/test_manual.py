"""The manual builds without a warning, asks nothing of the network, and shows commands that exist."""

import re
import shlex
from pathlib import Path

import pytest
import typer
from mkdocs.commands.build import build
from mkdocs.config import load_config

from churchpipe.cli import app

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


def commands(page: Path) -> list[str]:
    """Return the calls of churchpipe in the code of a page, without their comments."""
    lines = re.findall(r"^(?: {4}|\$ )(churchpipe .*)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return [part.strip() for line in lines for part in re.sub(r"\s{2,}[#(].*", "", line).split("&&")]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_exist(page: Path) -> None:
    group = typer.main.get_command(app)
    for line in commands(page):
        _, name, *arguments = shlex.split(line, comments=True)
        if name in ("--version", "--help"):
            continue
        command = group.commands[name]
        context = command.context_class(command, info_name=name)
        command.make_parser(context).parse_args(arguments)


def python_blocks(page: Path) -> str:
    """Return the Python of a page, one block after the other, as a reader follows them."""
    return "\n".join(re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE))


WITH_PYTHON = [page for page in PAGES if python_blocks(page)]


@pytest.mark.parametrize("page", WITH_PYTHON, ids=lambda page: page.name)
def test_python_of_the_pages_runs(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    exec(compile(python_blocks(page), str(page), "exec"), {})


def test_the_readme_and_a_page_have_python() -> None:
    assert {"README.md", "python.md"} <= {page.name for page in WITH_PYTHON}


def test_manual_builds(tmp_path: Path) -> None:
    config = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(tmp_path))
    config.plugins.on_startup(command="build", dirty=False)
    # strict: a warning (a broken link, a page that no other names) is an error.
    build(config)
    pages = [page.read_text(encoding="utf-8") for page in tmp_path.glob("*.html")]
    assert len(pages) > 15
    for page in pages:
        assert not re.search(r"<(?:script|link|img|iframe)[^>]+(?:src|href)=\"?https?:", page)
    api = (tmp_path / "reference_python.html").read_text(encoding="utf-8")
    assert "limit_analysis" in api
    assert "Coefficient, scalar or one an interface" in api
