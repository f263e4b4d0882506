"""The keys that decide which analyses a swept value touches are keys of a case file."""

import pytest

from churchpipe.config.analyses import RigidSettings, ShellSettings
from churchpipe.config.case import Case
from churchpipe.model.materials import Material
from churchpipe.model.quantities import declared
from churchpipe.model.swept import MESH_SIZE, changes_mesh, changes_stones, of_both, of_rigid_blocks, of_shell

TOLERANCES = ("contact_gap", "contact_angle", "overlap")


@pytest.mark.parametrize("field", declared(RigidSettings))
def test_of_the_rigid_blocks_tolerances_of_joints_change_the_stones(field: str) -> None:
    key = f"rigid.{declared(RigidSettings)[field].key}"
    assert changes_stones(key) == (field in TOLERANCES)
    assert of_rigid_blocks(key)


@pytest.mark.parametrize("field", declared(ShellSettings))
def test_of_the_shell_the_size_of_its_elements_changes_the_mesh(field: str) -> None:
    key = f"shell.{declared(ShellSettings)[field].key}"
    assert changes_mesh(key) == (field == "element_size") == (key == MESH_SIZE)
    assert of_shell(key)


@pytest.mark.parametrize("field", [name for name in declared(Material) if name != "name"])
def test_of_a_material_the_unit_weight_changes_the_stones(field: str) -> None:
    key = f"material.tuff.{declared(Material)[field].key}"
    assert changes_stones(key) == (field == "unit_weight")
    assert of_both(key) == (field != "elastic")


def test_parts_of_the_building_change_the_stones() -> None:
    for table in ("source", "ring_beams", "buttresses"):
        assert table in Case.__dataclass_fields__
        assert changes_stones(f"{table}.0.height_m")
