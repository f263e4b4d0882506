"""Where in a case file a key stands: errors name it as the person wrote it, with its line."""

import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from churchpipe.config.overrides import apply_overrides, numbered, parse_override, set_key
from churchpipe.config.section import MISSING, WRONG, GatheredError, gathered, shortened
from churchpipe.config.variants import Variant, with_swept
from churchpipe.errors import InputError
from churchpipe.model.quantities import bare, si, unit_of

EMPTY: Mapping[str, Any] = MappingProxyType({})
_NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
# What may be expected of a number: bounds in SI.
_SIGN = r"(?:from|at most|at least|[<>]=?)"
_BOUNDS = re.compile(rf"(?:0, or )?(?:{_SIGN} )?{_NUMBER}(?: to {_NUMBER}| and {_SIGN} {_NUMBER})?(?: m)?")


def located(
    error: InputError,
    path: Path,
    overrides: Sequence[str],
    generator: str = "",
    *,
    swept: Mapping[str, Any] = EMPTY,
    drawn: Mapping[str, Any] = EMPTY,
    variant: Variant | None = None,
) -> InputError:
    """Return an error with the key that the person wrote, and the line of the file, the --set or the [sweep] where it stands.

    Parameters
    ----------
    error: its place is "FILE: KEY", with the key as the schema or the generator has it, or words that name a wall or opening.
    generator: its name, for what it says of its parameters, "NAME.parameter", and of its walls.
    swept: values of the combination at fault, by their dotted keys; drawn: those that [sample] draws. variant: the one at fault,
    None: the building as it is.
    """
    if isinstance(error, GatheredError):
        return gathered(
            str(path),
            [located(problem, path, overrides, swept=swept, drawn=drawn, variant=variant) for problem in error.problems],
        )
    key = error.where.removeprefix(f"{path}: ")
    if key == str(path) and variant:
        return error.at(f"{path}: {_heading(path, overrides, variant)}")
    if generator and f"{key}.".startswith(f"{generator}."):
        key = "source" + key.removeprefix(generator)
    elif key == error.where and not generator:
        return error
    in_words, in_itself = key == error.where, key.startswith("variants.")
    try:
        text = path.read_text(encoding="utf-8-sig")
        table = asked = apply_overrides(tomllib.loads(text), overrides)
        # They may be what is wrong: no tables, or of no name.
        listed = asked["variants"] if variant and isinstance(asked.get("variants"), list) else []
        number = next((n for n, one in enumerate(listed) if variant and one["name"] == variant.name), None)
        distribution = _distributions(asked) if drawn else {}
        in_file = drawn if variant and number is not None and not in_itself else {**drawn, **swept}
        for new_key, new_value in in_file.items():
            set_key(table, new_key, new_value)
        if variant and number is not None and not in_itself:
            table = with_swept(table, swept, number, variant)
    except (OSError, ValueError):
        return error
    parts = _table_of(key, table) if in_words else re.sub(r"\[(\d+)\]", r".\1", key).split(".")
    written, value = _followed(table, parts)
    # A key that is missing is not the one beside it that lacks a unit. One that is there is a table that lacks one of two keys.
    if error.problem == MISSING and written[-1:] != parts[-1:]:
        written, value = _followed(table, parts[:-1])
    # A key may hold dots, as those of [sweep] do.
    missing = parts[sum(key.count(".") + 1 for key in written) :]
    own = _of_variant(asked, variant, number, written)
    stands = own or written
    changed = [numbered(asked, parse_override(change)[0]) for change in overrides]
    # What is wrong with a whole table may come of a change within it.
    within = [f"--set {key}" for key in changed if stands and key.startswith(f"{'.'.join(stands)}.")]
    made = within and len(_followed(tomllib.loads(text), stands)[0]) < len(stands)
    if made or any(_begins(stands, key) for key in changed):
        place = "--set"
    elif name := next((name for name in swept if _begins(written, name)), None):
        at = _followed(tomllib.loads(text), ["sweep", *name.split(".")])[0]
        # A sweep may come of a --set.
        place = f"line {line_of(text, at)}, [sweep]" if at else "[sweep]"
    elif at := next((at for name, at in distribution.items() if name in drawn and _begins(written, name)), None):
        place = f"line {line_of(text, at)}, [sample]"
    else:
        place = " with ".join([f"line {line_of(text, stands)}", *within])
    if swept and not place.endswith("[sweep]"):
        place += f" with [sweep] {', '.join(f'{name} = {value}' for name, value in swept.items())}"
    if variant and not in_itself:
        place += f', variant "{variant.name}"' if own else f" with {_heading(path, overrides, variant)}"
    # What words are about may be made of several keys: the table that they lead to stands before them.
    where = f"{path}: {place}, {'.'.join([*written, *([] if in_words else missing)])}" + (f": {key}" if in_words else "")
    if error.problem != WRONG or missing:
        return error.at(where) if missing or in_words else _as_written(error, written, value).at(where)
    # Lengths were converted on the way to their check.
    return InputError(where, WRONG, found=shortened(value), expected=error.expected, remedy=error.remedy)


def _as_written(error: InputError, keys: Sequence[str], value: object) -> InputError:
    """Return an error about a value at keys, and nothing but bounds of it, in the unit of its key instead of SI."""
    key = next((key for key in reversed(keys) if not key.isdecimal()), "")
    unit = unit_of(key)
    number, bounds = re.fullmatch(rf"({_NUMBER})(?: m)?", str(error.found)), _BOUNDS.fullmatch(error.expected)
    if not (unit.name and number and bounds) or isinstance(value, bool) or not isinstance(value, int | float):
        return error
    if not math.isclose(float(number[1]), si(key, value), rel_tol=1e-5):
        return error
    words = error.expected.removesuffix(" m")
    words = re.sub(_NUMBER, lambda found: f"{float(found[0]) * unit.divide / unit.multiply:.6g}", words)
    expected = f"{words} {unit.name}"
    return InputError(error.where, error.problem, found=f"{value:g} {unit.name}", expected=expected, remedy=error.remedy)


def _heading(path: Path, overrides: Sequence[str], variant: Variant) -> str:
    """Return what a variant is called, and the line where it begins, as far as the file tells."""
    try:
        text = path.read_text(encoding="utf-8-sig")
        given = apply_overrides(tomllib.loads(text), overrides).get("variants", [])
        number = next(n for n, one in enumerate(given) if one["name"] == variant.name)
    except (OSError, ValueError, StopIteration):
        return f'variant "{variant.name}"'
    return f'variant "{variant.name}" of line {line_of(text, ["variants", str(number)])}'


def _table_of(words: str, table: Mapping[str, Any]) -> list[str]:
    """Return the keys that lead to the opening, or else the junction or the wall, that words about a building name; to its
    source if to none."""
    source = table.get("source", {})
    for number, opening in enumerate(source.get("openings", [])):
        if re.search(rf"(^|: )openings?\b.*\s{re.escape(str(opening.get('name')))}\b", words):
            return ["source", "openings", str(number)]
    for number, junction in enumerate(source.get("junctions", [])):
        both = re.escape(" and ".join(map(str, junction.get("walls", ()))))
        if re.match(rf"junction of {both}(?![\w-])", words):
            return ["source", "junctions", str(number)]
    for number, wall in enumerate(source.get("walls", [])):
        if "name" in wall and re.match(rf"(walls?|junction of) {re.escape(str(wall['name']))}(?![\w-])", words):
            return ["source", "walls", str(number)]
    return ["source", *(part for part in re.findall(r"\w+", words.partition(": opening")[0]) if part in source)][:2]


def _begins(written: Sequence[str], key: str) -> bool:
    """Whether a path leads to what a dotted key holds; to a whole vector where the key is that of a component."""
    parts = key.split(".")
    if len(written) < len(parts) and parts[-1].isdecimal():
        parts.pop()
    return list(written[: len(parts)]) == parts


def _distributions(table: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return the keys that lead to the distribution of each key that [sample] draws."""
    found: dict[str, list[str]] = {}
    for number, one in enumerate(table.get("sample", {}).get("parameters", [])):
        keys = one["key"] if isinstance(one["key"], list) else [one["key"]]
        found |= {key: ["sample", "parameters", str(number), "key"] for key in keys}
    return found


def _of_variant(table: Any, variant: Variant | None, number: int | None, written: Sequence[str]) -> list[str]:
    """Return the keys in a variant's own table that lead to what it changed or added, as far as they do, or none."""
    if variant is None:
        return []
    head = ["variants", str(number)]
    for word in ("change", "add"):
        found = _followed(table, [*head, word, *written])[0]
        if len(found) > len(head) + 1:
            return found
    return []


def line_of(text: str, keys: Sequence[str]) -> int:
    """Return the line on which a key of a TOML text stands, counted from one; a table's is that of its head.

    The beginning of a text is TOML too, unless it ends inside a value: the first one that knows the key ends with it.
    """
    # As TOML and editors count them: Python's own lines end at rarer signs, too, which a comment may hold.
    lines = text.removesuffix("\n").split("\n")
    without, within = 0, len(lines)
    while True:
        known = next(((stop, table) for stop in _order(without, within) if (table := _read(lines[:stop])) is not None), None)
        if known is None:
            return max(min(without + 1, len(lines)), 1)
        stop, table = known
        if len(_followed(table, keys)[0]) == len(keys):
            within = stop
        else:
            without = stop


def _order(low: int, high: int) -> Iterator[int]:
    """Yield the numbers between two, from the middle on."""
    middle = (low + high) // 2
    yield from (number for number in (*range(middle, low, -1), *range(middle + 1, high)))


def _read(lines: Sequence[str]) -> dict[str, Any] | None:
    try:
        return tomllib.loads("\n".join(lines))
    except ValueError:
        return None


def _followed(table: Any, parts: Sequence[str]) -> tuple[list[str], Any]:
    """Return the keys of a table, as they are written, that a path leads along as far as it exists, and the value there.

    A part of the path may lack the unit of the key or have another one; names may hold dots.
    """
    written: list[str] = []
    rest = list(parts)
    while rest:
        if isinstance(table, list) and rest[0].isdecimal() and int(rest[0]) < len(table):
            written.append(rest[0])
            table, rest = table[int(rest[0])], rest[1:]
            continue
        names = {".".join(rest[:count]): count for count in range(1, len(rest) + 1)} if isinstance(table, dict) else {}
        key = next((key for key in table if key in names), None) if names else None
        if key is None and names:
            key = next((key for key in table if bare(key) == bare(rest[0])), None)
        if key is None:
            break
        written.append(key)
        table, rest = table[key], rest[names.get(key, 1) :]
    return written, table
