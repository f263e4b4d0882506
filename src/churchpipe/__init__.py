"""churchpipe: collapse load factors of masonry buildings.

The stable names; each is loaded when it is first used, so that `import churchpipe` costs nothing.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from churchpipe.config import read_case as read_case
    from churchpipe.dxf.reader import read_dxf as read_dxf
    from churchpipe.dxf.writer import write_dxf as write_dxf
    from churchpipe.errors import InputError as InputError
    from churchpipe.geometry.repair import repair_polyhedra as repair_polyhedra
    from churchpipe.homogenised_shell.limit import shell_limit_analysis as shell_limit_analysis
    from churchpipe.homogenised_shell.pushover import pushover as pushover
    from churchpipe.large_displacements.pushover import block_pushover as block_pushover
    from churchpipe.match import match_models as match_models
    from churchpipe.meshes.reader import read_stones as read_stones
    from churchpipe.model.assemblage import Assemblage as Assemblage
    from churchpipe.model.block_curve import BlockCapacityCurve as BlockCapacityCurve
    from churchpipe.model.building import Building as Building
    from churchpipe.model.contacts import Contacts as Contacts
    from churchpipe.model.loads import LoadCase as LoadCase
    from churchpipe.model.materials import Elastic as Elastic
    from churchpipe.model.materials import Material as Material
    from churchpipe.model.results import CapacityCurve as CapacityCurve
    from churchpipe.model.results import LimitState as LimitState
    from churchpipe.model.results import ShellLimitState as ShellLimitState
    from churchpipe.model.shell import ShellModel as ShellModel
    from churchpipe.rigid_blocks.limit import limit_analysis as limit_analysis
    from churchpipe.shell_mesh.shell import derive_shell as derive_shell
    from churchpipe.stones.blocks import derive_blocks as derive_blocks
    from churchpipe.stones.contacts import find_contacts as find_contacts
    from churchpipe.stones.joints import joint_strength as joint_strength
    from churchpipe.stones.soundness import check_soundness as check_soundness

_PLACES = {
    "Assemblage": "model.assemblage",
    "BlockCapacityCurve": "model.block_curve",
    "Building": "model.building",
    "CapacityCurve": "model.results",
    "Contacts": "model.contacts",
    "Elastic": "model.materials",
    "InputError": "errors",
    "LimitState": "model.results",
    "LoadCase": "model.loads",
    "Material": "model.materials",
    "ShellLimitState": "model.results",
    "ShellModel": "model.shell",
    "block_pushover": "large_displacements.pushover",
    "check_soundness": "stones.soundness",
    "derive_blocks": "stones.blocks",
    "derive_shell": "shell_mesh.shell",
    "find_contacts": "stones.contacts",
    "joint_strength": "stones.joints",
    "limit_analysis": "rigid_blocks.limit",
    "match_models": "match",
    "pushover": "homogenised_shell.pushover",
    "read_case": "config",
    "read_dxf": "dxf.reader",
    "read_stones": "meshes.reader",
    "repair_polyhedra": "geometry.repair",
    "shell_limit_analysis": "homogenised_shell.limit",
    "write_dxf": "dxf.writer",
}

__all__ = [
    "Assemblage",
    "BlockCapacityCurve",
    "Building",
    "CapacityCurve",
    "Contacts",
    "Elastic",
    "InputError",
    "LimitState",
    "LoadCase",
    "Material",
    "ShellLimitState",
    "ShellModel",
    "block_pushover",
    "check_soundness",
    "derive_blocks",
    "derive_shell",
    "find_contacts",
    "joint_strength",
    "limit_analysis",
    "match_models",
    "pushover",
    "read_case",
    "read_dxf",
    "read_stones",
    "repair_polyhedra",
    "shell_limit_analysis",
    "write_dxf",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("churchpipe")
    if name not in _PLACES:
        raise AttributeError(f"module 'churchpipe' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"churchpipe.{_PLACES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
