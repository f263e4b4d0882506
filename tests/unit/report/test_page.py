"""What the templates of all pages have in common."""

import pytest

from churchpipe.report.page import capital


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("the height of the structure is 900 m", "The height of the structure is 900 m"),
        ("check.ag_g is 25 g", "check.ag_g is 25 g"),
        ("stone_length is 5 km", "stone_length is 5 km"),
        ("A vault is meant", "A vault is meant"),
        ("", ""),
    ],
)
def test_a_sentence_begins_with_a_large_letter_but_for_a_key(text: str, shown: str) -> None:
    assert capital(text) == shown
