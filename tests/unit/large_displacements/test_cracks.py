"""How wide joints are open on a path, and which of them are there."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista

import churchpipe as cp
from churchpipe.large_displacements.cracks import joint_cracks, path_cracks
from churchpipe.model.stone_path import FallenStones
from churchpipe.report.frames import write_path
from solids import box, on_ground

# A lintel on two posts, one of which stands on a support that sinks.
SOLIDS = [
    box((-1, 1), (-1, 2), (-1, 0)),
    box((2, 4), (-1, 2), (-1, 0)),
    box((0, 0.5), (0, 1), (0, 2)),
    box((2.5, 3), (0, 1), (0, 2)),
    box((0, 3), (0, 1), (2, 2.5)),
]
STONES = cp.Assemblage.from_polyhedra(SOLIDS, 20e3, fixed=[0, 1])
CONTACTS = cp.find_contacts(STONES)


@pytest.fixture(scope="module")
def path() -> cp.SettlementPath:
    return cp.settlement_path(STONES, CONTACTS, [1], (0, 0, -1), friction=0.6, step=0.01, furthest=0.04)


def test_the_lintel_opens_above_the_post_that_stays(path: cp.SettlementPath) -> None:
    assert path.message == "the largest movement asked for, 0.04 m, was reached"
    opening, _ = path_cracks(STONES, CONTACTS, path, -1)
    assert np.array_equal(opening, joint_cracks(STONES, CONTACTS, path.position[-1], path.rotation[-1])[0])
    # It turns about the inner edge of the post that stays, which is 0.5 m wide, and 2 to 2.5 m away from the other.
    turned = opening[(CONTACTS.blocks == [2, 4]).all(axis=1)] / 0.5
    assert turned == pytest.approx(path.movement[-1] / 2.5, rel=0.05)


@pytest.mark.parametrize("step", [1, 2, -1])
def test_joints_of_stones_that_have_fallen_are_no_cracks(path: cp.SettlementPath, step: int) -> None:
    there, _ = path_cracks(STONES, CONTACTS, path, step)
    of_lintel = (CONTACTS.blocks == 4).any(axis=1)
    assert there[of_lintel].max() > 1e-4
    last = len(path.movement) - 1 if step < 0 else step
    # One that falls on the way from this step to the next is still there, one that fell on the way to this step is not.
    for fell, gone in ((last, False), (last - 1, True)):
        fallen = replace(path, fallen=(FallenStones(float(path.movement[fell]), np.array([4]), fell),))
        opening, slip = path_cracks(STONES, CONTACTS, fallen, step)
        assert np.array_equal(opening[~of_lintel], there[~of_lintel])
        assert (opening[of_lintel].max() == slip[of_lintel].max() == 0.0) == gone


@pytest.mark.parametrize("travel", [(0.0, 0.1, 0.2, 0.3), (0.0, -0.1, -0.2, -0.3), (0.0, 0.0, 0.0, 0.0), (0.1, 0.0, 0.1, 0.1)])
def test_stones_have_fallen_whichever_way_a_control_point_goes(tmp_path: Path, travel: tuple[float, ...]) -> None:
    stones = on_ground(box((0, 0.3), (0, 1), (0, 2)), box((0, 0.3), (0, 1), (2, 2.5)))
    contacts = cp.find_contacts(stones)
    curve = cp.block_pushover(stones, contacts, cp.LoadCase((1, 0, 0)), 0.6, step=0.02, steps=4)
    curve = replace(curve, displacement=np.array(travel), fallen=(FallenStones(travel[2], np.array([1, 2]), 2),))
    assert [path_cracks(stones, contacts, curve, step)[0].any() for step in range(4)] == [False, True, True, False]
    assert [len(curve.until(step).fallen) for step in range(4)] == [0, 0, 0, 1]
    write_path(tmp_path / "path.pvd", stones, curve)
    meshes: list[Any] = [pyvista.read(tmp_path / f"path_0{step}.vtu") for step in range(4)]
    assert [int(np.sum(mesh["fallen"])) for mesh in meshes] == [0, 0, 0, 2]
