"""Each parameter of a public function is described in its docstring, which the manual prints; its module has strict types."""

import inspect
import sys
import tomllib
from pathlib import Path

import pytest
from griffe import Docstring, DocstringSectionKind

import churchpipe as cp

NAMES: list[str] = list(vars(cp)["__all__"])
FUNCTIONS = [getattr(cp, name) for name in NAMES if inspect.isfunction(getattr(cp, name))]


@pytest.mark.parametrize("function", [*FUNCTIONS, cp.Assemblage.from_polyhedra, cp.InputError], ids=lambda f: f.__name__)
def test_each_parameter_is_described(function: object) -> None:
    text = Docstring(inspect.getdoc(function) or "", parser="numpy")
    described = {
        name
        for section in text.parsed
        if section.kind in (DocstringSectionKind.parameters, DocstringSectionKind.other_parameters)
        for parameter in section.value
        for name in [parameter.name.lstrip("*")]
        if parameter.description
    }
    parameters = set(inspect.signature(function).parameters)
    assert described == parameters, (described - parameters, parameters - described)


@pytest.mark.parametrize("name", NAMES)
def test_each_name_is_described(name: str) -> None:
    assert isinstance(getattr(cp, name), str) or inspect.getdoc(getattr(cp, name))


def test_modules_of_public_names_have_strict_types() -> None:
    root = Path(__file__).parents[2]
    strict = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["pyright"]["strict"]
    items = [item for name in NAMES if not isinstance(item := getattr(cp, name), str)]
    modules = {item.__name__ if inspect.ismodule(item) else item.__module__ for item in items}
    files = {Path(str(inspect.getsourcefile(sys.modules[module]))).relative_to(root).as_posix() for module in modules}
    assert [file for file in files if not any(file == known or file.startswith(f"{known}/") for known in strict)] == []
    assert (root / "src" / "churchpipe" / "py.typed").is_file()
