"""A part of what a case asks for: some loads, one model, a table left out."""

from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.config.asrun import as_run
from churchpipe.config.case import read_case, read_variants
from churchpipe.config.plan import plan
from churchpipe.config.selection import Selection, selected
from churchpipe.errors import UsageError

BOTH = (
    WALL
    + """
[[load]]
direction = [0, 1, 0]
name = "across"
[shell]
element_size_mm = 400
[check]
a_g_m_s2 = 1.5
soil_factor = 1.2
"""
)


@pytest.fixture
def case(tmp_path: Path) -> Path:
    return case_file(tmp_path, BOTH)


def test_one_load_or_one_model_is_picked(case: Path) -> None:
    cases = read_variants(case)
    kinds = plan(selected(cases, Selection(("across",)))).kinds
    assert set(kinds) == {"across_associative", "across_limit"}
    assert set(plan(selected(cases, Selection(model="blocks"))).kinds.values()) == {"rigid"}
    shell = plan(selected(cases, Selection(("across",), "shell")))
    assert shell.kinds == {"across_limit": "limit"}
    assert shell.stages == ("source", "blocks", "contacts", "shell", "match", "limit", "compare", "report")
    assert plan(selected(cases, Selection())).index == plan(cases).index


def test_what_is_not_there_cannot_be_picked(case: Path) -> None:
    with pytest.raises(UsageError, match=r"--load acros: no such load; expected .*across. Did you mean"):
        selected(read_variants(case), Selection(("acros",)))
    with pytest.raises(UsageError, match="no such model; expected blocks or shell"):
        selected(read_variants(case), Selection(model="beams"))
    with pytest.raises(UsageError, match="the case asks for no shell"):
        selected(read_variants(case, ["shell=false"]), Selection(model="shell"))


def test_tables_are_switched_by_set(case: Path, tmp_path: Path) -> None:
    off = read_case(case, ["shell=false", "check=false", "rigid.curve=false"])
    assert (off.shell, off.check, off.rigid.curve) == (None, None, None)
    on = read_case(case, ["shell=true", "rigid.curve=true"])
    assert on.shell == read_case(case).shell
    assert on.rigid.curve is not None
    again = tmp_path / "again.toml"
    again.write_text(as_run(case, ["shell=false"]), encoding="utf-8")
    assert read_case(again).shell is None
