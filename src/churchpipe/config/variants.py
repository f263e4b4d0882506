"""The [[variants]] of a case: the building with something changed, added or taken away, beside the building as it is."""

import copy
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

from churchpipe.config.overrides import flatten, not_swept, set_key, swept_values
from churchpipe.config.section import Number, Table, nearest
from churchpipe.config.tables import record
from churchpipe.errors import InputError
from churchpipe.model.names import AS_IT_IS
from churchpipe.model.quantities import bare

# What all variants have in common: one of its own would be passed over; and what to do instead.
_NOT_VARIED = {
    "variants": "Each variant starts from the building as it is; give each a [[variants]] of its own.",
    "name": "The name is that of the run. That of the variant stands in its [[variants]].",
    "sample": "All variants are analysed at the same samples: give the case its [sample].",
    "project": "All variants stand in one report, which has one title block: give the case its [project].",
}


@dataclass(frozen=True, slots=True)
class Variant:
    """A variant of the building, analysed and reported beside the building as it is."""

    name: Annotated[str, "For tables and pictures."]
    change: Annotated[dict[str, Any], "Keys of the case with other values, dotted or as tables."] = field(default_factory=dict)
    add: Annotated[dict[str, Any], "What the case lacks: entries of lists, such as loads, and tables."] = field(
        default_factory=dict
    )
    remove: Annotated[tuple[str, ...], "Dotted keys that are taken away; an entry of a list by its number or name."] = ()
    cost: Annotated[dict[str, Number | str], "Figures for the report, such as EUR = 12000."] = field(default_factory=dict)


def variants_of(tables: Sequence[Mapping[str, Any]]) -> tuple[Variant, ...]:
    """Return the variants of a case, from its checked tables.

    Raises
    ------
    InputError: two of one name, one with the name of the building as it is, or one that changes what all have
    in common.
    """
    found = tuple(record(Variant, table, f"variants.{number}") for number, table in enumerate(tables))
    names = [variant.name for variant in found]
    for number, name in enumerate(names):
        if name in names[:number]:
            raise InputError(f"variants.{number}.name", "two variants of one name", found=name, expected="a name of its own")
        if name.strip().lower() == AS_IT_IS:
            raise InputError(f"variants.{number}.name", "the building without variants", found=name, expected="another name")
    for number, variant in enumerate(found):
        for word, keys in (("change", flatten(variant.change)), ("add", flatten(variant.add)), ("remove", variant.remove)):
            for key in keys:
                if remedy := _NOT_VARIED.get(root := key.split(".")[0]):
                    where, expected = f"variants.{number}.{word}", "keys of the building, its loads and analyses"
                    raise InputError(where, f"a variant of {root}", found=key, expected=expected, remedy=remedy)
    return found


def applied(table: Table, number: int, variant: Variant) -> Table:
    """Return the table of a case with the changes of a variant, which is number so many; what it changes is not swept.

    Raises
    ------
    InputError: a change to, or the removal of, something that is not there; an addition that is.
    """
    out = copy.deepcopy(table)
    file = _file_keys(out)
    for key in variant.remove:
        place, last = _reached(out, key, f"variants.{number}.remove")
        where = f"variants.{number}.remove"
        if isinstance(place, list):
            last = str(_entry(place, last, where))
        _not_swept(out, file, place, last)
        if isinstance(place, list):
            del place[int(last)]
        elif place.pop(last, None) is None:
            raise _absent(where, key, place, last)
    for key, value in flatten(variant.change).items():
        where = f"variants.{number}.change.{key}"
        if value == {}:
            raise InputError(where, "nothing to change", found="an empty table", expected="keys with their values")
        place, last = _reached(out, key, where)
        if isinstance(place, list):
            last = str(_entry(place, last, where))
        _not_swept(out, file, place, last)
        if isinstance(place, list):
            place[int(last)] = value
        else:
            # The same key in another unit is changed, not given twice.
            for other in [known for known in place if bare(known) == bare(last)]:
                del place[other]
            place[last] = value
    for key, value in flatten(variant.add).items():
        _add(out, key, value, f"variants.{number}.add.{key}")
    return out


def variant_combinations(table: Table, number: int, variant: Variant) -> Iterator[tuple[Table, Table]]:
    """Yield (table, swept values) of a variant for all that it leaves to be swept, as `overrides.combinations` does.

    Swept keys are set before the variant is applied, so that the numbers in them are those of the file.

    Raises
    ------
    InputError: as of `applied`.
    """
    for swept in swept_values(applied(table, number, variant)):
        changed = {key: value for key, value in with_swept(table, swept, number, variant).items() if key != "sweep"}
        yield {key: value for key, value in changed.items() if key != "variants"}, swept


def with_swept(table: Table, swept: Mapping[str, Any], number: int, variant: Variant) -> Table:
    """Return the table of a variant, as `applied` does, with swept values of its file, and of its own, set."""
    own = flatten(table.get("sweep", {})).keys()
    changed = copy.deepcopy(table)
    for key in swept.keys() & own:
        set_key(changed, key, swept[key])
    changed = applied(changed, number, variant)
    for key in swept.keys() - own:
        set_key(changed, key, swept[key])
    return changed


def _file_keys(table: Table) -> dict[int, tuple[str, Any]]:
    """Return the dotted key of each table and list of a case by its identity; with each itself, which so stays its own."""
    found: dict[int, tuple[str, Any]] = {}
    inner: list[tuple[str, Any]] = [("", table)]
    while inner:
        key, value = inner.pop()
        if isinstance(value, dict | list):
            found[id(value)] = (key, value)
            parts = value.items() if isinstance(value, dict) else enumerate(value)
            inner += [(f"{key}.{part}" if key else str(part), item) for part, item in parts]
    return found


def _not_swept(table: Table, file: Mapping[int, tuple[str, Any]], place: Table | list[Any], last: str) -> None:
    """Take what a variant changes out of the sweep, by the key that it has in the file whatever was taken away before it."""
    inner = place[int(last)] if isinstance(place, list) else None
    if id(inner) in file:
        not_swept(table, file[id(inner)][0])
    elif id(place) in file:
        key = file[id(place)][0]
        not_swept(table, f"{key}.{last}" if key else last)


def _add(table: Table, key: str, value: Any, where: str) -> None:
    *path, last = key.split(".")
    place: Any = table
    for part in path:
        place = place[_entry(place, part, where)] if isinstance(place, list) else place.setdefault(part, {})
        if not isinstance(place, dict | list):
            raise InputError(where, f"{part} is no table", found=place)
    if isinstance(value, list) and isinstance(place, dict) and isinstance(place.setdefault(last, []), list):
        place[last] += copy.deepcopy(value)
    elif isinstance(place, list) or last in place:
        raise InputError(
            where, "is there already", expected="a new key, or a list of entries", remedy="[variants.change] changes it."
        )
    else:
        place[last] = value


def _reached(table: Table, key: str, where: str) -> tuple[Any, str]:
    """Return the table or list that holds a dotted key, and the last part of the key."""
    *path, last = key.split(".")
    place: Any = table
    for part in path:
        if isinstance(place, list):
            place = place[_entry(place, part, where)]
        elif part in place:
            place = place[part]
        else:
            raise _absent(where, key, place, part)
        if not isinstance(place, dict | list):
            raise InputError(where, f"{part} is no table", found=place)
    return place, last


def _entry(place: list[Any], part: str, where: str) -> int:
    """Return the position of an entry of a list, given by its number or its name."""
    names = [str(entry.get("name", "")) if isinstance(entry, dict) else "" for entry in place]
    if part in names:
        return names.index(part)
    if part.isdecimal() and int(part) < len(place):
        return int(part)
    known = [name or str(number) for number, name in enumerate(names)]
    raise InputError(where, "no such entry", found=part, expected=", ".join(known) or "an entry, and the list is empty")


def _absent(where: str, key: str, place: Table, part: str) -> InputError:
    expected = ", ".join(place) or "an empty table"
    return InputError(where, f"the case has no {key}", found=part, expected=expected, remedy=nearest(part, place))
