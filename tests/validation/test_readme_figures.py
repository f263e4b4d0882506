"""The figures that README quotes for S22. Those of the church: test_church.py; without dilatancy: test_sliding.py."""

import pytest

import churchpipe as cp
from churchpipe.resources import pipeline_folder
from models import TILTING_LOADS, tilting_test


@pytest.mark.slow("README.md: S22, both models")
def test_both_models_of_s22() -> None:
    stones, contacts = tilting_test("S22")
    assert int((~stones.fixed).sum()) == 869
    blocks = cp.limit_analysis(stones, contacts, TILTING_LOADS["S22"], friction=0.7)
    case = cp.read_case(pipeline_folder() / "cases" / "s22.toml")
    shell = cp.shell_limit_analysis(cp.derive_shell(case.building(), element_size=0.06), case.loads[0], case.materials)
    assert (round(blocks.load_factor, 4), round(shell.load_factor, 4)) == (0.2065, 0.2125)
