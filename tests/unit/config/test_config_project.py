"""The title block of a case."""

from pathlib import Path

import pytest

from case_texts import case_file
from churchpipe.config.case import read_case
from churchpipe.config.project import Project
from churchpipe.errors import InputError
from churchpipe.resources import sample_case


def test_the_title_block_is_read(tmp_path: Path) -> None:
    table = '[project]\ntitle = "Nave of St John"\nauthor = "A. Rossi"\n'
    assert read_case(case_file(tmp_path, sample_case("wall") + table)).project == Project("Nave of St John", author="A. Rossi")
    assert read_case(case_file(tmp_path, sample_case("wall"))).project == Project()


def test_a_key_that_is_none_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'project.autor: unknown key.*Did you mean "author"'):
        read_case(case_file(tmp_path, sample_case("wall") + '[project]\nautor = "A. Rossi"\n'))
