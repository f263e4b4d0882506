"""Which analyses a swept key of a case touches, and its words, by the key alone."""

import re

MESH_SIZE = "shell.element_size_mm"
_STONES = re.compile(
    r"source\.|(ring_beams|buttresses)\.|material\..+\.unit_weight_kN_m3$|rigid\.(contact_gap_mm|contact_angle_deg|overlap_mm)$"
)
_RIGID_BLOCKS = re.compile(r"rigid\.|check\.")
_SHELL = re.compile(r"shell\.|material\..+\.elastic")
_UNIT = re.compile(r"_(mm|mm2|m|kPa|MPa|GPa|kN|kN_m|kN_m2|kN_m3|m_s2|s|g|percent|deg)$")


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


def heading(key: str) -> str:
    """Return a dotted key of the case file as words with its unit: "stone length, m", or "friction of brick" for a material."""
    words, unit = _words_and_unit(key)
    return f"{words}, {unit}" if unit else words


def setting(key: str, value: object) -> str:
    """Return a swept setting as words: "stone length 0.57 m"."""
    words, unit = _words_and_unit(key)
    return " ".join([words, str(value), *([unit] if unit else [])])


def _words_and_unit(key: str) -> tuple[str, str]:
    root, *inner = key.split(".")
    *owner, last = inner or [root]
    # An entry of a list is told by its number: the first of "source.brick_mm.0".
    number = f".{last}" if last.isdecimal() and owner else ""
    last = owner.pop() if number else last
    name, _, unit = _UNIT.sub(r"|\1", last).partition("|")
    # A material, a load or a tie has the same keys as others of its kind.
    if owner and (owner[0].isdecimal() or root == "joints"):
        owner[0] = f"{root}.{owner[0]}"
    of = f" of {'.'.join(owner)}" if owner and owner != ["default"] else ""
    return f"{name.replace('_', ' ')}{number}{of}", unit.replace("_", "/").replace("2", "\u00b2").replace("3", "\u00b3")
