"""What `help` says of public dataclasses: plain types, and each field with its unit and its meaning."""

import inspect
import pydoc
import re
from dataclasses import fields, is_dataclass

import pytest

import churchpipe as cp

KINDS = [value for name in vars(cp)["__all__"] if inspect.isclass(value := getattr(cp, name)) and is_dataclass(value)]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_help_has_plain_types(kind: type) -> None:
    text = pydoc.plain(pydoc.render_doc(kind))
    lines = [line for line in text.splitlines() if "__annotations__ =" not in line and "__dataclass_fields__ =" not in line]
    assert not [line for line in lines if re.search(r"Annotated\[|Quantity\(", line)]
    for shown in (inspect.signature(kind), inspect.signature(kind.__init__)):
        assert not re.search(r"_SupportsArray|dtype\[", str(shown))
    assert max(map(len, str(inspect.signature(kind)).split(", "))) < 90


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_the_signature_is_that_of_the_class(kind: type) -> None:
    shown = inspect.signature(kind).parameters
    code = kind.__init__.__code__
    assert list(shown) == list(code.co_varnames[1 : 1 + code.co_argcount - 1 + code.co_kwonlyargcount])


def test_fields_have_their_units_and_meanings() -> None:
    text = inspect.getdoc(cp.Buttress) or ""
    assert "wall : str\n    The wall that they stand at." in text
    assert "width : float, m\n    Along the wall." in text
    assert "height : float | None = None, m" in text
    assert text.startswith("Buttresses alike on one side of a wall")
    # In SI, as Python takes them, whatever the unit of the key of a case is.
    assert "unit_weight : float, N/m3" in (inspect.getdoc(cp.Material) or "")
    assert "compressive_strength : float | None = None, Pa" in (inspect.getdoc(cp.Material) or "")


def test_what_is_described_already_is_not_said_twice() -> None:
    text = inspect.getdoc(cp.LineLoad) or ""
    assert text.count("\nParameters\n") == 1
    assert "\nFields\n" not in text


def test_it_is_still_the_same_class() -> None:
    assert cp.Buttress is cp.Buttress
    assert (inspect.getdoc(cp.Buttress) or "").count("\nFields\n") == 1
    assert [field.name for field in fields(cp.Buttress)][:2] == ["wall", "along"]
