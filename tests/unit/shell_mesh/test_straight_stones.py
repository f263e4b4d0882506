"""Stones of a curved wall are straight from joint to joint, and the shell weighs what they weigh."""

import numpy as np
import pytest

from churchpipe.generators import tower
from churchpipe.model.building import CylinderChart
from churchpipe.model.materials import Material
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.shell_mesh.straight_stones import arc_filled
from churchpipe.shell_mesh.triangulation import Mesh
from churchpipe.stones.blocks import derive_blocks

MATERIAL = Material("default", 16e3, 0.6)


def test_each_facet_carries_its_share_of_every_sector_that_it_crosses():
    # Two sectors of 1 and 2 rad behind triangles: one in the first, one with a quarter of its area in it.
    triangles = np.array([[[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]], [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]])
    mesh = Mesh(triangles, np.zeros(2, dtype=np.int64))
    found = arc_filled(CylinderChart(np.zeros(3), 1.0, sweep=3.0), mesh, np.array([0.0, 1.0, 3.0]))
    assert found.tolist() == pytest.approx([np.sin(1), 0.25 * np.sin(1) + 0.75 * np.sin(2) / 2])


@pytest.mark.parametrize(("depth", "rel"), [(0.1, 1e-3), (0.25, 4e-3)])
def test_a_round_tower_with_a_door_weighs_what_its_stones_weigh(depth, rel):
    # Stones of 36 degrees. Beside a ring .25 m deep two joints are left out, so that the wall is straight for 36 degrees there
    # instead of 18. Opening and voussoirs are prisms, which the shell takes for parts of the curved wall: .3 % remain.
    door = {"name": "door", "wall": "round", "centre": 0.0, "width": 0.6, "shape": "segmental", "voussoirs": 6}
    building = tower(
        plan="round",
        course=0.3,
        stone_length=0.6,
        width=2.4,
        height=1.8,
        thickness=0.5,
        openings=[door | {"depth": depth, "springing": 0.81, "rise": 0.27}],
        materials=(MATERIAL,),
    )
    stones, shell = derive_blocks(building), derive_shell(building, 0.6)
    assert shell.weight.sum() == pytest.approx(stones.weight[~stones.fixed].sum(), rel=rel)
