"""The joints for ParaView, read back: forces, openings, slips and names."""

from pathlib import Path
from typing import Any

import numpy as np
import pyvista

import churchpipe as cp
from churchpipe.report.joints_vtu import write_joints
from solids import box, on_ground


def test_joints_carry_forces_openings_and_names(tmp_path: Path) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 3)), unit_weight=2e4)
    contacts = cp.find_contacts(stones)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase((1, 0, 0)), 0.7)
    write_joints(tmp_path / "joints.vtu", stones, contacts, state)
    grid: Any = pyvista.read(tmp_path / "joints.vtu")
    assert grid.n_cells == 2
    # Both stones weigh 60 kN, and overturn as one about their foot, at a load factor of b / h = 1/3.
    base = grid["kind"].tolist().index("base")
    assert {grid["first"][base], grid["second"][base]} == {str(stones.block_id[0]), str(stones.block_id[1])}
    np.testing.assert_allclose(grid["normal_force"][base], 60e3, rtol=1e-6)
    np.testing.assert_allclose(grid["shear_force"][base], 20e3, rtol=1e-5)
    assert grid["opening"][base] > 1e3 * abs(grid["opening"][1 - base])
    np.testing.assert_allclose(grid["area"], 1.0)
    corners = grid.get_cell(base).point_ids
    assert grid.get_cell(base).type == pyvista.CellType.POLYGON
    edges = np.diff(grid.points[[*corners, corners[0]]], axis=0)
    np.testing.assert_allclose(np.linalg.norm(edges, axis=1), 1.0)
    # The forces on the free stone carry the weight and hold against the load.
    sign = 1.0 if grid["second"][base] == str(stones.block_id[1]) else -1.0
    np.testing.assert_allclose(sign * grid.point_data["force"][corners].sum(axis=0), [-20e3, 0, 60e3], rtol=1e-5, atol=1)
