"""What a case names of the whole building, its ground and a point to watch: `check` finds what is not there, with the line."""

from pathlib import Path

import pytest

from case_texts import case_file
from churchpipe.dxf.writer import write_dxf
from churchpipe.generators import wall
from churchpipe.model.materials import Material
from churchpipe.stones.blocks import derive_blocks
from command_line import call

CASE = """
[source]
generator = "wall"
length_m = 1.6
brick_mm = [400, 250, 200]
courses = 5
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
[[load]]
direction = [1, 0, 0]
"""


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ('[[movements]]\nsupport = "nave"\n', "movements.0: support: no wall or stone of this name on the ground; found nave"),
        (
            '[[movements]]\nsupport = "wall"\n[[movements]]\nwithin_mm = [[9000, 0], [9500, 100]]\n',
            "movements.1: support: nothing stands on the ground there; found from [9.0, 0.0] to [9.5, 0.1] m",
        ),
        (
            "[rigid.curve]\ncontrol_mm = [0, 0, 9000]\n",
            "rigid.curve.control_mm: a point outside the free stones; found [0.0, 0.0, 9.0]",
        ),
        (
            "[shell]\nelement_size_mm = 400\ncontrol_point_mm = [0, 0, 9000]\n",
            "shell.control_point_mm: a point outside the free stones; found [0.0, 0.0, 9.0]",
        ),
        (
            "[rigid.curve]\nstep_mm = 20000\n",
            "rigid.curve.step_mm: a step longer than the structure; found 20 m (20000 mm); expected at most 1.9 m",
        ),
        (
            '[[movements]]\nsupport = "wall"\nsteps = 3\nstep_mm = 9e9\n',
            "movements.0.step_mm: a step longer than the structure; found 9e+06 m (9e+09 mm)",
        ),
    ],
)
def test_places_that_are_not_there(capsys: pytest.CaptureFixture[str], tmp_path: Path, lines: str, said: str) -> None:
    path = case_file(tmp_path, f"{CASE}{lines}")
    code, _, err = call(capsys, "check", path)
    assert code == 1
    last = len(path.read_text().splitlines())
    assert f"line {last if '[rigid' in lines or '[shell' in lines or 'step_' in lines else last - 1}, {said}" in err


def test_places_that_are_there(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    lines = '[[movements]]\nsupport = "wall"\n[rigid.curve]\ncontrol_mm = [0, 0, 1000]\n'
    assert call(capsys, "check", case_file(tmp_path, f"{CASE}{lines}"))[0] == 0


@pytest.mark.parametrize(("support", "code"), [("wall", 0), ("nave", 1)])
def test_ground_below_a_drawing_with_a_ring_beam(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, support: str, code: int
) -> None:
    stones = derive_blocks(wall(length=1.6, brick=(0.4, 0.25, 0.2), courses=5, materials=(Material("default", 18e3, 0.6),)))
    write_dxf(stones, tmp_path / "stones.dxf", materials=[Material("default", 18e3, 0.6)])
    drawn = '[source]\ndxf = "stones.dxf"\n' + CASE[CASE.index("[material") :]
    beam = '[[ring_beams]]\nwalls = ["wall"]\nheight_m = 0.2\n'
    path = case_file(tmp_path, f'{drawn}{beam}[[movements]]\nsupport = "{support}"\n')
    ended, _, err = call(capsys, "check", path)
    assert ended == code
    assert ("movements.0: support: no wall or stone of this name on the ground; found nave" in err) == bool(code)


@pytest.mark.parametrize(
    ("movement", "asked"),
    [
        ('support = "wall"', True),
        ("within_mm = [[-10000, -10000], [10000, 10000]]", True),
        ("within_mm = [[0, -100], [800, 500]]", False),
        # A table that is tilted tests a wall.
        ('support = "wall"\ndirection = [1, 0, 0]\nabout_mm = [0, 0, 0]', False),
    ],
)
def test_a_movement_of_the_whole_ground_is_questioned(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, movement: str, asked: bool
) -> None:
    code, _, err = call(capsys, "check", case_file(tmp_path, f'{CASE}[[movements]]\nname = "sinks"\n{movement}\n'))
    assert code == 0
    said = 'The movement "sinks" takes along all ground that the building stands on: it moves as a whole, and nothing cracks.'
    assert (said in err) == asked
