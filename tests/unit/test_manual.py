"""The manual builds without a warning, asks nothing of the network, and shows commands that exist."""

import ast
import re
import shlex
import textwrap
import tomllib
import warnings
from pathlib import Path
from typing import Any

import pytest
import tomli_w
import typer
import yaml
from markdown import markdown
from markdown.extensions.toc import slugify
from mkdocs.commands.build import build
from mkdocs.config import load_config
from mkdocs.exceptions import Abort
from typer.core import TyperGroup

import churchpipe
from churchpipe.cli import app
from churchpipe.config.case import read_variants
from churchpipe.errors import InputError
from manual_pages import PAGES, ROOT, commands, commands_in_sentences

PICTURES = ROOT / "docs" / "pictures"
# A file that makes or holds figures, a ready case, or a command.
_MADE = re.compile(
    r"(?:tests|benchmarks|pipeline|scripts)/[\w/]+\.\w+|test_\w+\.py|\w+\.toml|^ {4}(?:churchpipe|python) ", re.MULTILINE
)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_table_of_figures_says_what_makes_it(page: Path) -> None:
    """In its section or at the head of the page."""
    text = page.read_text(encoding="utf-8")
    head, *sections = re.split(r"^(?=#{1,3} )", text.partition("\n")[2], flags=re.MULTILINE)
    for section in sections:
        title = section.partition("\n")[0].strip("# ")
        tables = re.findall(r"^\|[-| :]+\|\n((?:\|.*\n)+)", section, flags=re.MULTILINE)
        if any(len(re.findall(r"\.\d\d", table)) > 2 for table in tables):
            assert _MADE.search(section) or _MADE.search(head), f"{title}: what makes its table, or holds it?"
    for name in re.findall(r"\b(?:tests|benchmarks|pipeline|scripts)/[\w/]+\.(?:py|toml|sh|ya?ml)\b", text):
        assert (ROOT / name).is_file(), name


def what_draws(picture: Path) -> str:
    """Return the script that writes a picture and that the manual names, or the page whose Python draws it; "" without one."""
    named = re.compile(rf'["/]{re.escape(picture.stem)}(?:\.png)?"')
    folder = re.compile(rf'["/]{picture.parent.name}["/]|import FOLDER')
    manual = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for script in sorted((ROOT / "benchmarks").glob("*.py")):
        text = script.read_text(encoding="utf-8")
        if named.search(text) and folder.search(text) and f"benchmarks/{script.name}" in manual:
            return script.name
    return next((page.name for page in PAGES if named.search(python_blocks(page))), "")


@pytest.mark.parametrize("picture", sorted(PICTURES.rglob("*.png")), ids=lambda picture: picture.stem)
def test_every_picture_is_made_by_a_script_that_the_manual_names(picture: Path) -> None:
    assert what_draws(picture)


def test_a_picture_that_nothing_draws_is_found() -> None:
    assert not what_draws(PICTURES / "drawn_by_hand.png")
    assert not what_draws(PICTURES / "vaults" / "chapel.png")
    assert what_draws(PICTURES / "gallery" / "chapel.png") == "gallery.py"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_exist(page: Path) -> None:
    group = typer.main.get_command(app)
    assert isinstance(group, TyperGroup)
    for line in [*commands(page), *commands_in_sentences(page)]:
        _, name, *arguments = shlex.split(line, comments=True)
        if name in ("--version", "--help"):
            continue
        command = group.commands[name]
        context = command.context_class(command, info_name=name)
        command.make_parser(context).parse_args(arguments)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_of_the_source_that_a_page_names_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    named = re.findall(r"(?:benchmarks|cad_samples|pipeline|scripts|tests|src)/[\w/.-]+\.(?:py|sh|toml|dxf|yaml)\b", text)
    assert not [name for name in named if not (ROOT / name).exists()]


def test_each_known_limit_says_its_effect_its_side_and_what_to_do() -> None:
    rows = re.findall(r"^\|(.*)\|$", (ROOT / "docs" / "limits.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    table = [[cell.strip() for cell in row.split(" | ")] for row in rows if not row.startswith("---")]
    assert {len(row) for row in table} == {4}
    assert all(cell for row in table for cell in row)
    sides = {row[2] for row in table if row[0] != "limit"}
    assert all(re.match("unsafe|safe|mostly safe|either|none", side) for side in sides)


def python_blocks(page: Path) -> str:
    """Return the Python of a page, one block after the other, as a reader follows them."""
    return "\n".join(re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE))


WITH_PYTHON = [page for page in PAGES if python_blocks(page)]


# Seven seconds each and more; what they call is in tests of their own.
LONG = pytest.mark.slow("docs/: the Python of its tour and of the pages on vaults, strengthening and variants of a building")
OF_PAGES = [
    pytest.param(
        page, marks=LONG if page.name in ("python.md", "strengthening.md", "vaults.md", "what_if.md") else (), id=page.name
    )
    for page in WITH_PYTHON
]


@pytest.mark.parametrize("page", OF_PAGES)
def test_python_of_the_pages_runs(page: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    names: dict[str, Any] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("error", churchpipe.DoubtfulValue)
        exec(compile(python_blocks(page), str(page), "exec"), names)
    if page.name == "python.md":
        # What the page says that its tower prints.
        assert names["held"].load_factor == pytest.approx(0.2276, abs=5e-5)
        assert names["held"].tie_forces == pytest.approx([27.2e3], rel=2e-3)
        assert names["falls"].d0 == pytest.approx(0.5, abs=5e-3)
        assert names["tilts"].ultimate == pytest.approx(0.46, abs=5e-3)


def indented(text: str) -> list[str]:
    """Return the indented blocks of a page that are not inside a fenced one."""
    rest = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    return [
        textwrap.dedent(block).strip() + "\n" for block in re.findall(r"(?:^ {4}.*\n|^\n(?= {4}))+", rest, flags=re.MULTILINE)
    ]


def tables(text: str) -> list[dict]:
    """Return the parts of case files on a page, in their order; an indented block that is TOML is one."""
    found = re.findall(r"^```toml\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
    found += [block for block in indented(text) if re.match(r"\[\[?[a-z]", block)]
    return [tomllib.loads(block) for block in found]


def joined(one: dict, other: dict) -> dict:
    """Return a case with what another table says."""
    both = one | other
    return both | {key: joined(one[key], other[key]) for key in one.keys() & other.keys() if isinstance(one[key], dict)}


ELASTIC = {"block_E_GPa": 3.18, "block_nu": 0.23, "joint_E_GPa": 0.303, "joint_nu": 0.3, "joint_thickness_mm": 1.0}


def check_tables(text: str, folder: Path) -> int:
    """Take each part of a case file on a page, added to the whole one before it, or to a ready case; return their number."""
    parts, file = tables(text), folder / "case.toml"
    whole: list[dict] = []
    for part in parts:
        if "generator" in part.get("source", {}):
            whole = [{}]
        cases = [joined(case, part) for case in whole or READY]
        for number, case in enumerate(cases):
            file.write_text(tomli_w.dumps(case), encoding="utf-8")
            try:
                read_variants(file)
                break
            except InputError:
                if number == len(cases) - 1:
                    raise
        whole = cases if whole else []
    return len(parts)


def ready_case(name: str) -> dict:
    """Return a ready case with all that parts of it may need besides."""
    case = tomllib.loads((ROOT / "pipeline" / "cases" / f"{name}.toml").read_text(encoding="utf-8"))
    case["material"]["default"]["elastic"] = ELASTIC
    case["material"]["concrete"] = case["material"]["default"] | {"unit_weight_kN_m3": 25.0}
    return case


READY = [ready_case(name) for name in ("s5_uncertain", "chapel")]
WITH_TABLES = [page for page in PAGES if tables(page.read_text(encoding="utf-8"))]


@pytest.mark.parametrize("page", WITH_TABLES, ids=lambda page: page.name)
def test_parts_of_case_files_are_taken(page: Path, tmp_path: Path) -> None:
    assert check_tables(page.read_text(encoding="utf-8"), tmp_path) > 0


def test_a_wrong_key_on_a_page_is_found(tmp_path: Path) -> None:
    assert {"tutorial.md", "second_model.md", "check.md"} <= {page.name for page in WITH_TABLES}
    for block in ("```toml\n[shell]\nelement_size = 100\n```\n", "\n    [shell]\n    element_size = 100\n"):
        with pytest.raises(InputError, match="element_size: unknown key"):
            check_tables(block, tmp_path)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_that_is_only_shown_names_what_exists(page: Path) -> None:
    for block in indented(page.read_text(encoding="utf-8")):
        if re.search(r"^(import|from) |\bcp\.", block, flags=re.MULTILINE) and not block.startswith(("python ", "churchpipe ")):
            ast.parse(block)
            assert set(re.findall(r"\bcp\.(\w+)", block)) <= set(vars(churchpipe)["__all__"])
            exec("\n".join(re.findall(r"^(?:import|from) .*$", block, flags=re.MULTILINE)), {})


@pytest.mark.parametrize("link", ["none.md", "index.md#nowhere", "pictures/none.png"])
def test_a_broken_link_stops_the_build(link: str, tmp_path: Path) -> None:
    config = yaml.load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"), yaml.BaseLoader)
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text(f"# A page\n\n[there]({link})\n", encoding="utf-8")
    kept = {key: config[key] for key in ("site_name", "markdown_extensions", "validation")}
    kept |= {"strict": config["strict"] == "true", "docs_dir": str(tmp_path / "docs"), "site_dir": str(tmp_path / "site")}
    (tmp_path / "mkdocs.yml").write_text(yaml.dump(kept), encoding="utf-8")
    with pytest.raises(Abort):
        build(load_config(str(tmp_path / "mkdocs.yml")))


def broken_links(page: Path) -> list[str]:
    """Return the links and pictures of a page that lead to no file, or to no heading of one."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    broken: list[str] = []
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"https?:|mailto:", link):
            continue
        name, _, anchor = link.partition("#")
        file = page.parent / name if name else page
        headings = (
            re.findall(r"^#+ (.*)$", file.read_text(encoding="utf-8"), flags=re.MULTILINE) if anchor and file.is_file() else []
        )
        if not file.is_file() or (anchor and anchor not in {slugify(heading, "-") for heading in headings}):
            broken.append(link)
    return broken


# The site is built of the pages in docs/ alone.
@pytest.mark.parametrize(
    "page", [page for page in PAGES if page.parent == ROOT] + [ROOT / "CHANGELOG.md"], ids=lambda page: page.name
)
def test_links_of_pages_outside_the_site_lead_somewhere(page: Path) -> None:
    assert broken_links(page) == []


def test_a_link_that_leads_nowhere_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# A page\n\n[a](none.md) [b](page.md#a-page) [c](page.md#none) [d](#none) ![e](none.png) [f](https://a.b)\n")
    assert broken_links(page) == ["none.md", "page.md#none", "#none", "none.png"]


def test_the_readme_and_a_page_have_python() -> None:
    assert {"README.md", "python.md"} <= {page.name for page in WITH_PYTHON}


def misread(page: str) -> list[str]:
    """Return the places of a built page where marks were taken for others than meant, or left as they are.

    An emphasis that begins inside a word was an asterisk of a symbol; a line of a paragraph that begins as an entry of a list, a
    row of a table or a heading does was not indented as Markdown wants it.
    """
    text = re.sub(r"<(pre|code).*?</\1>", "", page.partition("<article")[2].partition("</article>")[0], flags=re.DOTALL)
    found = re.findall(r"\w<em>[^<]{0,40}", text)
    for paragraph in re.findall(r"<(?:p|li|td)>(.*?)</(?:p|li|td)>", text, flags=re.DOTALL):
        found += re.findall(r"^\s*(?:[-*] |\| |#+ ).{0,40}", paragraph, flags=re.MULTILINE)
        found += re.findall(r"\*\*.{0,40}|\]\(.{0,40}", paragraph)
    return found


@pytest.mark.parametrize("text", ["e*, a0* of it", "one\n- two", "- one\n\n  | a | b |\n  |---|---|\n  | c | d |\n- **two**"])
def test_what_markdown_takes_otherwise_is_found(text: str) -> None:
    page = markdown(text, extensions=["tables"])
    assert misread(f"<article>{page}</article>")
    assert not misread(f"<article>{markdown('*one* and **two**', extensions=['tables'])}<pre>* a</pre></article>")


def test_manual_builds(tmp_path: Path) -> None:
    config = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(tmp_path))
    config.plugins.on_startup(command="build", dirty=False)
    # strict: a warning (a broken link, a page that no other names) is an error.
    build(config)
    pages = [page.read_text(encoding="utf-8") for page in tmp_path.glob("*.html")]
    assert len(pages) > 15
    for page in pages:
        assert misread(page) == []
        assert not re.search(r"<(?:script|link|img|iframe)[^>]+(?:src|href)=\"?https?:", page)
    api = (tmp_path / "reference_python.html").read_text(encoding="utf-8")
    assert "limit_analysis" in api
    assert "Coefficient, scalar or one an interface" in api
