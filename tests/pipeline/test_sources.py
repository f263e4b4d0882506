"""Every rule of the pipeline depends on all modules that its stage runs: an edited one must make its results again."""

import ast
import re
from pathlib import Path

import pytest

import churchpipe

PACKAGE = Path(churchpipe.__file__).parent
RULES = Path(__file__).parents[2] / "pipeline"
# Sources of every rule, and modules that decide nothing: what the errors look like, and the package's own front page.
ALWAYS = set(re.findall(r'"([^"]+)"', re.findall(r"places = .*?\((.*?)\*parts", (RULES / "Snakefile").read_text())[0]))
IDLE = {"__init__.py"}
# These turn a stage's settings into arguments; what they import besides has read the case before.
SETTINGS = "config/"


def listed() -> dict[str, set[str]]:
    """Sources by rule, as written."""
    out: dict[str, set[str]] = {}
    for file in sorted((RULES / "rules").glob("*.smk")):
        for stage, names in re.findall(r'sources=sources\((.*?)\),\n.*?STAGE \+ " (\w+) ', file.read_text(), re.DOTALL):
            out[names] = set(re.findall(r'"([^"]+)"', stage))
    return out


def imported(tree: ast.AST) -> set[str]:
    """Modules of this package that a piece of code imports, as paths in the package."""
    out: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("churchpipe"):
            parts = (node.module or "").split(".")[1:]
            for name in [alias.name for alias in node.names]:
                for place in (Path(*parts, f"{name}.py"), Path(*parts).with_suffix(".py") if parts else Path("__init__.py")):
                    if (PACKAGE / place).is_file():
                        out.add(place.as_posix())
                        break
                else:
                    out.add(Path(*parts, "__init__.py").as_posix())
    return out


def reached(first: set[str]) -> set[str]:
    """These modules and all that they import."""
    todo, out = list(first), set[str]()
    while todo:
        place = todo.pop()
        if place not in out:
            out.add(place)
            if place.startswith(SETTINGS):
                continue
            todo += imported(ast.parse((PACKAGE / place).read_text(encoding="utf-8")))
    return out


def stage_bodies() -> dict[str, ast.FunctionDef]:
    tree = ast.parse((PACKAGE / "stages.py").read_text(encoding="utf-8"))
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


def imports_of(stage: str) -> set[str]:
    """Modules that a stage imports, or whose names it takes from the head of the file; those of its helpers, too."""
    tree = ast.parse((PACKAGE / "stages.py").read_text(encoding="utf-8"))
    head = {alias.asname or alias.name: node for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    bodies = stage_bodies()
    todo, done, out = [stage], set[str](), set[str]()
    while todo:
        name = todo.pop()
        if name not in done:
            done.add(name)
            used = {node.id for node in ast.walk(bodies[name]) if isinstance(node, ast.Name)}
            todo += [other for other in used & set(bodies) if other.startswith("_")]
            out |= imported(bodies[name])
            for word in used & set(head):
                names = [alias for alias in head[word].names if (alias.asname or alias.name) == word]
                out |= imported(ast.Module([ast.ImportFrom(head[word].module, names, 0)], []))
    return out


@pytest.mark.parametrize("stage", sorted(listed()))
def test_rule_lists_what_its_stage_imports(stage: str) -> None:
    first = imports_of(stage)
    sources = listed()[stage] | ALWAYS
    forgotten = {
        place
        for place in reached(first)
        if place not in IDLE and not any(place == source or place.startswith(source + "/") for source in sources)
    }
    assert not forgotten


def test_every_stage_has_a_rule() -> None:
    assert set(listed()) == set(stage_bodies()) - {"configure", "versions"} - {
        name for name in stage_bodies() if name.startswith("_")
    }
