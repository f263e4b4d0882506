"""Whether a case says all that its analyses need."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from churchpipe.config.carries import LOADS, Carries
from churchpipe.config.section import Table, nearest
from churchpipe.errors import InputError
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.placed_loads import bare_name, called_names
from churchpipe.model.quantities import required


def check_complete(checked: Table, file: str) -> None:
    """Name at once all that an imported drawing did not say: materials, their unit weight and friction, loads.

    Raises
    ------
    InputError: something is missing, or a shell is asked for whose joints have no friction.
    """
    materials: dict[str, Table] = checked.get("material") or {"default": {}}
    needed = [key for key in required(Material) if key != "name"]
    missing = [f"material.{name}.{key}" for name, table in materials.items() for key in needed if key not in table]
    if "pushover" in checked.get("shell", {}).get("analyses", ()):
        bends = _of_walls(checked, materials)
        missing += [f"material.{name}.elastic (for the capacity curve)" for name in bends if "elastic" not in materials[name]]
    if not checked.get("load") and not checked.get("movements"):
        missing.append("load (a table [[load]] with its direction)")
    if missing:
        bare = [name for name, table in materials.items() if needed[0] not in table]
        meant = next((nearest(name, {*materials} - {*bare}) for name in bare if len(bare) < len(materials)), "")
        remedy = "Neither the file nor its drawing says them, and nothing is assumed."
        # Of one material alone: where it stands.
        alone = [f"material.{name}" for name in checked.get("material", {}) if all(f".{name}." in key for key in missing)]
        raise InputError(
            f"{file}: {alone[0]}" if alone else file,
            "missing keys",
            expected=", ".join(missing),
            remedy=f"{remedy} {meant}".strip(),
        )
    if "shell" in checked:
        _check_friction(checked, materials, file)


def unknown_material(where: str, name: str, known: Iterable[str]) -> InputError:
    """Return the error of a material that the case has not; known: those that it has."""
    return InputError(where, "unknown material", found=name, expected=", ".join(known), remedy=nearest(name, known))


def checked_for(loads: Sequence[LoadCase], carries: Carries, file: str) -> Carries:
    """Return what is carried; an InputError for a name that one of the loads multiplies and that nothing carried has."""
    called = [item.called for key in LOADS for item in getattr(carries, key)]
    for number, load in enumerate(loads):
        for name in load.multiplies or ():
            if not {*called} & {*called_names(name)}:
                known = ", ".join(dict.fromkeys(map(bare_name, called))) or "loads that are carried, such as point_loads"
                place, remedy = f"{file}: load.{number}.multiplies", nearest(name, {*map(bare_name, called)})
                raise InputError(place, "no such load", found=name, expected=known, remedy=remedy)
    return carries


def _check_friction(checked: Table, materials: Mapping[str, Table], file: str) -> None:
    """Raise InputError where joints of the shell have no friction: its strength, an apex at cohesion over friction, is none."""
    given = {f"material.{name}.friction": materials[name]["friction"] for name in _of_walls(checked, materials)}
    given |= {f"joints.{n}.friction": group.get("friction") for n, group in enumerate(checked.get("joints", []))}
    for key, value in given.items():
        if value == 0:
            remedy = "Leave out [shell]: the rigid blocks are analysed without friction too. Or give a small friction."
            raise InputError(f"{file}: {key}", "no friction, which the shell needs", found=0, expected="> 0", remedy=remedy)


def _of_walls(checked: Table, materials: Mapping[str, Table]) -> list[str]:
    """Return the materials that the facets of a shell may be of: of a generator the first one and those that its walls and
    buttresses name, not those of rigid ring beams alone; of a drawing all."""
    if "generator" not in checked["source"]:
        return list(materials)
    named: set[Any] = set()
    left: list[Any] = [checked["source"], checked.get("buttresses", [])]
    while left:
        item = left.pop()
        if isinstance(item, str):
            named.add(item)
        elif isinstance(item, Mapping):
            left += item.values()
        elif isinstance(item, Sequence):
            left += item
    return [name for number, name in enumerate(materials) if not number or name in named]
