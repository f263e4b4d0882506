"""Each parameter of a public function is described in its docstring, which the manual prints."""

import inspect

import pytest
from griffe import Docstring, DocstringSectionKind

import churchpipe as cp

FUNCTIONS = [getattr(cp, name) for name in cp.__all__ if inspect.isfunction(getattr(cp, name))]


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


@pytest.mark.parametrize("name", cp.__all__)
def test_each_name_is_described(name: str) -> None:
    assert isinstance(getattr(cp, name), str) or inspect.getdoc(getattr(cp, name))
