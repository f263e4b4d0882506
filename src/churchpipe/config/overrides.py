"""Changes to a case file's table: `--set a.b.c=value` and `[sweep]`."""

import copy
import itertools
import math
import re
import tomllib
from collections.abc import Iterator, Sequence
from typing import Any

from churchpipe.config.section import Table
from churchpipe.errors import InputError, UsageError
from churchpipe.model.arguments import listed
from churchpipe.model.quantities import bare

# Each is analysed at least once, and a stage each.
MOST_COMBINATIONS = 10_000
# Optional tables, which "--set shell=false" leaves out.
SWITCHES = ("shell", "rigid.curve", "check")
# Levels of tables and lists; a case has six.
DEEPEST = 20
# What is swept would change no result, or not that of the variant which it names; and what to do instead.
_NOT_SWEPT = {
    "sweep": "Give the values of its key in [sweep] itself.",
    "variants": "Sweep the key that the variant changes, or give each value a [[variants]] of its own.",
    "sample": "All combinations are analysed at the same samples: leave it out.",
    "project": "The report has one title block: leave it out.",
    "published": "It changes no analysis: leave it out.",
}


def parse_override(text: str) -> tuple[str, Any]:
    """Split "a.b.c=value" into its dotted key and its value, read as TOML (a bare word is a string)."""
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not all(key.split(".")):
        raise UsageError(f"--set {text}", "not an override", expected="key=value, such as --set rigid.solver=clarabel")
    if '"' in key:
        expected = f"the dotted key alone: {key.replace(chr(34), '')}"
        raise UsageError(f"--set {text}", "a key in quotes", expected=expected)
    try:
        read = tomllib.loads(f"value = {value}")["value"]
    except RecursionError:
        read = None
    except ValueError:
        # No TOML, or a number of thousands of digits.
        read = float(value) if re.fullmatch(r"\s*[+-]?(\.\d{1,20}|\d{1,20}\.)\s*", value) else value.strip()
    if read is None or key.count(".") + depth(read) > DEEPEST:
        short = text if len(text) <= 60 else f"{text[:60]} ..."
        raise UsageError(f"--set {short}", "too many levels", expected=f"at most {DEEPEST}")
    return key, read


def depth(value: Any) -> int:
    """Return how many tables and lists are one inside the other."""
    levels, inner = 0, [value]
    while inner := [item for item in inner if isinstance(item, dict | list)]:
        levels += 1
        inner = [part for item in inner for part in (item.values() if isinstance(item, dict) else item)]
    return levels


def set_key(table: Table, key: str, value: Any) -> None:
    """Set a dotted key in place; a number steps into a list (load.0.direction). Tables on the way are made as needed."""
    *path, last = key.split(".")
    place: Any = table
    for depth, part in enumerate(path):
        if isinstance(place, list):
            place = place[_position(place, part, key)]
        elif isinstance(place, dict):
            place = place.setdefault(part, [] if [*path, last][depth + 1].isdecimal() else {})
        if not isinstance(place, dict | list):
            raise InputError(key, f"{'.'.join(path[: depth + 1])} is not a table", found=place)
    if isinstance(place, list):
        place[_position(place, last, key)] = value
    else:
        place[last] = value


def value_at(table: Table, key: str) -> Any:
    """Return what stands at a dotted key; None where there is nothing."""
    place: Any = table
    for part in key.split("."):
        if isinstance(place, list) and part.isdecimal() and int(part) < len(place):
            place = place[int(part)]
        else:
            place = place.get(part) if isinstance(place, dict) else None
    return place


def apply_overrides(table: Table, overrides: Sequence[str]) -> Table:
    """Return the table with overrides set; a key that is set is not swept any more.

    Entries of lists that keys of overrides, [sweep] and [sample] give by their names have their numbers in it.
    """
    table = copy.deepcopy(table)
    override(table, overrides)
    sweep, sample = table.get("sweep"), table.get("sample")
    lists = flatten(sweep) if isinstance(sweep, dict) else {}
    if any(numbered(table, key) != key for key in lists):
        table["sweep"] = {numbered(table, key): values for key, values in lists.items()}
    parameters = sample.get("parameters") if isinstance(sample, dict) else None
    for parameter in parameters if isinstance(parameters, list) else []:
        if isinstance(parameter, dict) and isinstance(keys := parameter.get("key"), str | list):
            several = keys if isinstance(keys, list) else [keys]
            several = [numbered(table, key) if isinstance(key, str) else key for key in several]
            parameter["key"] = several if isinstance(keys, list) else several[0]
    return table


def numbered(table: Table, key: str) -> str:
    """Return a dotted key with the numbers of the entries of lists that it gives by their names."""
    place: Any = table
    parts: list[str] = []
    for part in key.split("."):
        if isinstance(place, list):
            names = [entry.get("name") if isinstance(entry, dict) else None for entry in place]
            part = str(names.index(part)) if part in names else part
            place = place[int(part)] if part.isdecimal() and int(part) < len(place) else None
        else:
            place = place.get(part) if isinstance(place, dict) else None
        parts.append(part)
    return ".".join(parts)


def override(table: Table, overrides: Sequence[str]) -> None:
    """Set overrides in place, as `apply_overrides` does."""
    for given, value in map(parse_override, listed("overrides", overrides, str)):
        key = numbered(table, given)
        if key in SWITCHES and isinstance(value, bool):
            _switch(table, key, value)
            if value:
                continue
        else:
            try:
                set_key(table, key, value)
            except InputError as error:
                raise error.at(f"--set {error.where}") from error
        not_swept(table, key)


def _switch(table: Table, key: str, on: bool) -> None:
    """Leave out an optional table, or see to it that there is one, with its defaults."""
    *path, last = key.split(".")
    place: Any = table
    for part in path:
        place = place.setdefault(part, {})
    if on:
        place.setdefault(last, {})
    else:
        place.pop(last, None)


def not_swept(table: Table, key: str) -> None:
    """Take a key that is set out of the sweep of a table, in whatever unit, with what lies within it and what it lies within."""
    sweep = table.get("sweep")
    if not isinstance(sweep, dict) or key.startswith("sweep."):
        return
    lists = flatten(sweep)
    kept = {swept: values for swept, values in lists.items() if not overlap(numbered(table, swept), key)}
    if not kept:
        del table["sweep"]
    elif len(kept) < len(lists):
        table["sweep"] = kept


def overlap(one: str, other: str) -> bool:
    """Return whether two dotted keys are one, in whatever unit, or one lies within the other."""
    return bare(one) == bare(other) or one.startswith(f"{other}.") or other.startswith(f"{one}.")


def combinations(table: Table) -> Iterator[tuple[Table, Table]]:
    """Yield (table, swept values) for the product of all lists under [sweep]; the file's own table when there is none."""
    base = {key: value for key, value in table.items() if key != "sweep"}
    for swept in swept_values(table):
        changed = copy.deepcopy(base)
        for key, value in swept.items():
            try:
                set_key(changed, key, copy.deepcopy(value))
            except InputError as error:
                raise error.at(f"sweep.{error.where}") from error
        yield changed, swept


def swept_values(table: Table) -> Iterator[Table]:
    """Yield the values by dotted keys, for the product of all lists under [sweep]; nothing swept, once, where there is none.

    Keys may be quoted ("material.default.friction") or written as nested tables.
    """
    sweep = table.get("sweep", {})
    if not isinstance(sweep, dict):
        raise InputError("sweep", "not a table", found=sweep, expected='lists such as "material.default.friction" = [0.5, 0.6]')
    lists = flatten(sweep)
    if "sweep" in table and not lists:
        raise InputError("sweep", "nothing to sweep", found="an empty table", remedy="Give keys their values, or leave it out.")
    for key, values in lists.items():
        if not isinstance(values, list) or not values:
            found = repr(values)
            raise InputError(f"sweep.{key}", "nothing to sweep", found=found, expected="a list of at least one value")
        if remedy := _NOT_SWEPT.get(key.partition(".")[0]):
            raise InputError(f"sweep.{key}", "not to be swept", remedy=remedy)
        if key == "name":
            remedy = "The name is that of the run: leave it out."
            raise InputError("sweep.name", "not to be swept", found=values, remedy=remedy)
    for first, second in itertools.combinations([key for key, _ in _leaves(sweep)], 2):
        if overlap(first, second):
            raise InputError(f"sweep.{second}", "swept twice", found=f"{first} too", expected="one of them")
    # Counted first: values that are far too many would be compared with each other for minutes.
    count = math.prod(map(len, lists.values()))
    if count > MOST_COMBINATIONS:
        raise InputError(
            "sweep",
            "too many combinations",
            found=" x ".join(str(len(values)) for values in lists.values()) + f" = {count:,}",
            expected=f"at most {MOST_COMBINATIONS:,}",
            remedy="Sweep fewer values, or split the case.",
        )
    for key, values in lists.items():
        if twice := [value for number, value in enumerate(values) if value in values[:number]]:
            raise InputError(f"sweep.{key}", "a value given twice", found=twice[0], expected="each value once")
    for values in itertools.product(*lists.values()):
        yield dict(zip(lists, values, strict=True))


def flatten(table: Table) -> Table:
    """Return a nested table as one level of dotted keys; a table that is empty is a value."""
    return dict(_leaves(table))


def _leaves(table: Table, prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, dict) and value:
            yield from _leaves(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def _position(place: list[Any], part: str, key: str) -> int:
    if not part.isdecimal() or int(part) >= len(place):
        names = [entry.get("name") if isinstance(entry, dict) else None for entry in place]
        numbers = "0, the only one" if len(place) == 1 else f"a number from 0 to {len(place) - 1}"
        known = ", ".join(map(str, names)) if all(names) else numbers
        expected = known if place else "an entry, and the list is empty"
        raise InputError(key, "no such entry", found=part, expected=expected)
    return int(part)
