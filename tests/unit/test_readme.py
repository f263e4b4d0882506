"""The README's code runs as it stands."""

import re
from pathlib import Path

import pytest

README = Path(__file__).parents[2] / "README.md"
BLOCKS = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), flags=re.DOTALL)


@pytest.mark.parametrize("code", BLOCKS)
def test_python_block(code: str) -> None:
    exec(compile(code, str(README), "exec"), {})


def test_there_is_one() -> None:
    assert BLOCKS
