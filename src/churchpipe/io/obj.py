"""Stones as a mesh for other programs: a Wavefront OBJ."""

import re
from collections.abc import Iterable
from os import PathLike

from churchpipe.io.atomic import named_by_caller, write_text
from churchpipe.meshes.source import GROUND
from churchpipe.model.arguments import check_kind, path_of
from churchpipe.model.assemblage import Assemblage


def write_obj(assemblage: Assemblage, path: str | PathLike[str]) -> None:
    """Write stones to a Wavefront OBJ for other programs: an object for each, in m, corners to the last digit.

    Parameters
    ----------
    assemblage
        The stones. Ground is in the group "ground", each free stone in that of its panel. The material is that of `usemtl`.
    path
        The file to write; a folder of it that is missing is made.

    Raises
    ------
    InputError
        Something else than stones, no path, a file that cannot be written.

    Notes
    -----
    `read_stones` reads the stones back. Names have a space in the place of what would end them in an OBJ (# and \\). A free
    stone, a panel or a material whose name, or what follows a slash in it, begins like that of ground has its kind put before it
    and spaces for slashes, as in "stone ground-3".
    """
    check_kind("write_obj: assemblage", assemblage, Assemblage, remedy="derive_blocks(building) makes one.")
    path = path_of("write_obj: path", path)
    fixed = assemblage.fixed
    plain = [_word(name, "" if held else "stone") for name, held in zip(assemblage.block_id, fixed, strict=True)]
    panels = ["ground" if held else _word(name, "panel") for name, held in zip(assemblage.panel, fixed, strict=True)]
    materials = [_word(name, "material") for name in assemblage.material]
    lines, before = ["# Stones in metres, z upwards."], 1
    for stone, name in enumerate(_different(plain)):
        points, faces = assemblage.solid(stone)
        lines += [f"o {name}", f"g {panels[stone]}", f"usemtl {materials[stone]}"]
        lines += ["v " + " ".join(map(repr, point)) for point in points.tolist()]
        lines += ["f " + " ".join(str(node + before) for node in face) for face in faces]
        before += len(points)
    with named_by_caller("write_obj", path):
        write_text(path, "\n".join(lines) + "\n")


def _word(name: str, kind: str) -> str:
    """Return a name as an OBJ can hold it; one that would make ground of what is none, after its kind, if any."""
    word = " ".join(re.split(r"[#\\\s]+", str(name))).strip() or kind or "unnamed"
    # Before a slash stands the name of a file, where there are several.
    if kind and any(map(GROUND.match, (word, word.rpartition("/")[2]))):
        return f"{kind} {word.replace('/', ' ')}"
    return word


def _different(names: Iterable[str]) -> list[str]:
    """Return names of which none is given twice: those that come again have a number."""
    found: dict[str, None] = {}
    for name in names:
        one, count = name, 1
        while one in found:
            count += 1
            one = f"{name} ({count})"
        found[one] = None
    return list(found)
