"""Which analyses a swept key of a case touches, by the key alone."""

import re

MESH_SIZE = "shell.element_size_mm"
_STONES = re.compile(
    r"source\.|(ring_beams|buttresses)\.|material\..+\.unit_weight_kN_m3$|rigid\.(contact_gap_mm|contact_angle_deg|overlap_mm)$"
)
_RIGID_BLOCKS = re.compile(r"rigid\.|check\.")
_SHELL = re.compile(r"shell\.|material\..+\.elastic")


def changes_stones(key: str) -> bool:
    """Whether a key changes the stones or their joints, and with them everything."""
    return bool(_STONES.match(key))


def changes_mesh(key: str) -> bool:
    """Whether a key changes the mesh of the shell, through the stones or by itself."""
    return changes_stones(key) or key == MESH_SIZE


def of_rigid_blocks(key: str) -> bool:
    """Whether a key belongs to the analyses of the rigid blocks alone."""
    return bool(_RIGID_BLOCKS.match(key))


def of_shell(key: str) -> bool:
    """Whether a key belongs to the analyses of the shell alone."""
    return bool(_SHELL.match(key))


def friction_of_material(key: str) -> bool:
    """Whether a key is the friction of a material, which every analysis says by itself; that of single joints it does not."""
    return key.startswith("material.") and key.endswith(".friction")


def of_both(key: str) -> bool:
    """Whether a key asks both models another question: analyses that differ in it are no pair."""
    return not (of_rigid_blocks(key) or of_shell(key))
