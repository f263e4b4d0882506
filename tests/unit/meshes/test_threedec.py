"""Commands of 3DEC besides polyhedra: bricks, and what changes blocks that were made before."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from churchpipe.errors import InputError
from churchpipe.meshes.reader import read_stones
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import check_soundness

BRICK = "block create brick"
GROUND = "{} -0.5 2.5 -0.3 0.6 -0.3 0 group 'base'\n"
READ = {"unit_weight": 18e3}


def wall(command: str) -> str:
    """Return a wall of 2 x 1.5 m, 0.3 m thick, in running bond: six courses of bricks of 0.5 m."""
    lines = []
    for course in range(6):
        ends = np.arange(0, 2.01, 0.5) if course % 2 == 0 else np.r_[0, np.arange(0.25, 2, 0.5), 2]
        lines += [f"{command} {a:g},{b:g} 0,0.3 {course / 4:g},{course / 4 + 0.25:g}\n" for a, b in pairwise(ends)]
    return "".join(lines)


@pytest.mark.parametrize(
    ("command", "fix"), [("block create brick", "block fix range group 'base'"), ("poly brick", "fix range group base")]
)
def test_bricks_are_stones(command: str, fix: str, tmp_path: Path) -> None:
    path = tmp_path / "wall.3ddat"
    path.write_text(wall(command) + GROUND.format(command) + fix + "\n")
    stones, findings = read_stones(path, **READ)
    assert "W18" not in findings.codes
    free = ~stones.fixed
    assert (int(free.sum()), int(stones.fixed.sum())) == (27, 1)
    # Every face looks outwards: the volume of each is that of its sides.
    np.testing.assert_allclose(np.unique(stones.volume[free].round(12)), [0.25 * 0.25 * 0.3, 0.5 * 0.25 * 0.3])
    contacts = find_contacts(stones)
    check_soundness(stones, contacts)
    # By hand: 4 or 5 stones of a course have 3 or 4 head joints; 4 base joints; 8 joints in each of 5 beds.
    assert len(contacts.blocks) == 3 * 3 + 3 * 4 + 4 + 5 * 8


def test_a_group_of_many_blocks_is_one_finding_with_their_number(tmp_path: Path) -> None:
    """A group is a set of blocks, so that its blocks are numbered, and nothing is wrong with them."""
    path = tmp_path / "wall.3ddat"
    lines = [line + (" group 'east'" if number % 2 else " group 'west'") for number, line in enumerate(wall(BRICK).splitlines())]
    path.write_text("\n".join([*lines, GROUND.format(BRICK).strip(), "block fix range group 'base'"]) + "\n")
    stones, findings = read_stones(path, **READ)
    assert [finding.found for finding in findings if finding.code in ("W15", "W42")] == [
        'the group "west" has 14 blocks: "west.1" to "west.14"',
        'the group "east" has 13 blocks: "east.1" to "east.13"',
    ]
    assert stones.block_id[[0, 1, 2, 25, 26, 27]].tolist() == ["west.1", "east.1", "west.2", "east.13", "west.14", "base"]
    assert stones.fixed.nonzero()[0].tolist() == [27]


def test_a_brick_of_two_numbers_is_a_cube(tmp_path: Path) -> None:
    path = tmp_path / "cube.3ddat"
    path.write_text("block create brick 0 0.5\n" + GROUND.format("block create brick") + "block fix range group 'base'\n")
    stones, _ = read_stones(path, **READ)
    assert stones.volume[~stones.fixed].tolist() == pytest.approx([0.125])


@pytest.mark.parametrize("sizes", ["0 1 0 1", "0 1 0 1 1 0", "0 1 0 1 0 x"])
def test_sizes_of_no_brick_are_named_with_their_line(sizes: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.3ddat"
    path.write_text(wall("block create brick") + f"block create brick {sizes}\n")
    with pytest.raises(InputError, match=r"E03 .*at line 28: .*six numbers, or two for a cube"):
        read_stones(path, **READ)


@pytest.mark.parametrize(
    "command",
    [
        "block cut joint-set dip 0 spacing 0.25 number 10",
        "jset dip 0 dd 0 spacing 0.25 num 10",
        "delete range region 3",
        "block delete range group 'wall'",
        "block generate from-vrml filename 'wall.wrl'",
        "program call 'more.dat'",
    ],
)
def test_a_command_that_shapes_blocks_is_an_error_since_it_is_not_followed(command: str, tmp_path: Path) -> None:
    path = tmp_path / "cut.3ddat"
    path.write_text(
        wall("block create brick") + GROUND.format("block create brick") + command + "\nblock fix range group 'base'\n"
    )
    with pytest.raises(InputError, match=r"E21 .*a command that shapes blocks, which is not followed, at line 29: "):
        read_stones(path, **READ)
