"""What is told of one stone, one joint or one warning is told in the singular."""

from pathlib import Path

import pytest

from churchpipe.config.case import read_case
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.stones.account import joint_account, joint_lines
from churchpipe.stones.contacts import find_contacts
from churchpipe.terminal import results_table
from churchpipe.wording import counted, four_figures, in_runs, three_figures
from command_line import call
from records import summary
from solids import box, on_ground

CUBE = box((0, 1), (0, 1), (0, 1))


@pytest.mark.parametrize(
    ("number", "words", "said"),
    [
        (1, ("stone",), "1 stone"),
        (0, ("stone",), "0 stones"),
        (2, ("stone",), "2 stones"),
        (1, ("body begins", "bodies begin"), "1 body begins"),
        (3, ("body begins", "bodies begin"), "3 bodies begin"),
    ],
)
def test_a_number_and_what_it_counts(number: int, words: tuple[str, ...], said: str) -> None:
    assert counted(number, *words) == said


@pytest.mark.parametrize(
    ("numbers", "said"),
    [([], ""), ([4], "4"), ([1, 2, 4], "1, 2, 4"), ([*range(1, 14), 20, 22, 23, 24], "1 to 13, 20, 22 to 24")],
)
def test_numbers_that_follow_each_other(numbers: list[int], said: str) -> None:
    assert in_runs(numbers) == said


def test_a_drawing_of_one_stone(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    write_dxf(on_ground(CUBE), tmp_path / "a.dxf")
    code, out, err = call(capsys, "check", tmp_path / "a.dxf")
    assert code == 0
    assert "a.dxf: 1 stone, 1 m3, 1 warning." in out
    assert 'no unit weight for the material "default" of 1 stone. Pass --unit-weight-kN-m3 to churchpipe import' in err
    code, out, _ = call(capsys, "import", tmp_path / "a.dxf", "-o", tmp_path / "a")
    assert code == 0
    assert "1 stone, 1 m3, on 1 fixed one" in out


def test_a_table_of_one_stone() -> None:
    assert str(results_table(summary(weight_kN=18.0)).title) == "w: 1 stone, 1 interface, 18 kN"


def test_a_heavy_building_weighs_no_power_of_ten() -> None:
    assert str(results_table(summary(weight_kN=24563.2)).title) == "w: 1 stone, 1 interface, 24,563 kN"
    assert [four_figures(value) for value in (0.00123456, 18.0, 999.96, 1234.5)] == ["0.001235", "18", "1,000", "1,234"]


def test_one_near_miss() -> None:
    stones = on_ground(CUBE, box((0, 1), (0, 1), (1.05, 2.05)))
    (line,) = joint_lines(*joint_account(stones, find_contacts(stones)))
    assert line.startswith("Near misses: 1 pair of faces nearly meets and is no joint")


def test_errors_end_with_one_mark(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text('[source]\ngenerator = "wall"\nlenth_m = 1\n', encoding="utf-8")
    with pytest.raises(InputError, match="errors:") as error:
        read_case(tmp_path / "a.toml")
    assert str(error.value).endswith('Did you mean "length_m"?')


def test_lengths_are_no_powers_of_ten() -> None:
    found = [three_figures(value) for value in (0.02289, 9.995, 99.96, 153.4, -1234.6)]
    assert found == ["0.0229", "9.99", "100", "153", "-1,235"]
