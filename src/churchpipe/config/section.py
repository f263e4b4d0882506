"""Tables of the case file, and what is wrong with one in the user's words."""

import difflib
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from typing import Annotated, Any, TypeVar, cast, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from churchpipe.errors import InputError, steers
from churchpipe.model.quantities import bare

Table = dict[str, Any]
Number = Annotated[float, Field(allow_inf_nan=False)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]


class Section(BaseModel):
    """A table of the case file: unknown keys are errors, numbers are not read out of strings."""

    model_config = ConfigDict(extra="forbid", strict=True)


LETTERS = "letters, digits, blanks and . + - _, beginning with a letter or a digit"
_WANTED = {
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
    "list_type": "a list in [brackets]",
    "string_type": "a text in quotes",
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    # The only pattern is that of names of files.
    "string_pattern_mismatch": LETTERS,
}
WRONG = "wrong value"
MISSING = "missing key"
UNKNOWN = "unknown key"
TWICE = "a length given twice"
Kind = TypeVar("Kind", bound=Section)


def validated(
    kind: type[Kind], table: Table, place: str, file: str, problems: list[InputError], spelled: Callable[[str], str] = str
) -> Kind | None:
    """Return a table checked, or None and what is wrong with it among the problems.

    Parameters
    ----------
    place: the table's own key in the file. spelled: a key as the schema has it -> as this file writes it.
    """
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        for whose, items in groupby(error.errors(), key=_whose):
            first, *others = items
            problem = _translated(first | {"loc": whose} if others else first, kind, place, file, spelled)
            expected = ", or ".join([problem.expected, *map(_wanted, others)])
            problems.append(
                InputError(problem.where, problem.problem, found=problem.found, expected=expected, remedy=problem.remedy)
            )
        return None


def steering(value: Any, place: str) -> Iterator[InputError]:
    """Yield an error for each text or key in a table that would steer the terminal, whose name stands in tables and reports."""
    if isinstance(value, str) and steers(value):
        yield InputError(place, "a control character", found=shortened(value), expected="a text that can be printed")
    elif isinstance(value, list):
        for number, item in enumerate(cast("list[Any]", value)):
            yield from steering(item, f"{place}.{number}")
    elif isinstance(value, dict):
        for key, item in cast("dict[str, Any]", value).items():
            inner = f"{place}.{key}".replace(": .", ": ")
            if steers(key):
                yield InputError(inner, "a control character in a key", expected="a key that can be printed")
            yield from steering(item, inner)


def _whose(item: Any) -> tuple[Any, ...]:
    """Return the place of an error; where a value may be a number or a text, each has one, and theirs is that of the value."""
    place = item["loc"]
    return place[:-1] if place[-1:] in (("float",), ("str",)) and item["type"] != "extra_forbidden" else place


class GatheredError(InputError):
    """Several errors of one file."""

    def __init__(self, file: str, problems: Sequence[InputError]) -> None:
        self.problems = tuple(problems)
        lines = "\n  ".join(str(problem).removeprefix(f"{file}: ") for problem in problems)
        super().__init__(file, f"{len(problems)} errors:\n  {lines}")


def gathered(file: str, problems: Sequence[InputError]) -> InputError:
    """Return one error that says all."""
    return problems[0] if len(problems) == 1 else GatheredError(file, problems)


def nearest(key: str, known: Iterable[str]) -> str:
    """Return the remedy for an unknown word."""
    # Their units make no two words alike. They only tell apart words that differ in nothing else.
    words: dict[str, list[str]] = {}
    for word in known:
        words.setdefault(bare(word).casefold(), []).append(word)
    close = difflib.get_close_matches(bare(key).casefold(), list(words), n=1, cutoff=0.52)
    if not close:
        return ""
    nearest_word = max(words[close[0]], key=lambda word: difflib.SequenceMatcher(None, word, key).ratio())
    return f'Did you mean "{nearest_word}"?'


def _translated(item: Any, kind: type[Section], place: str, file: str, spelled: Callable[[str], str]) -> InputError:
    *path, last = item["loc"]
    where = f"{file}: " + ".".join(map(str, (*([place] if place else []), *path, last)))
    match item["type"]:
        case "extra_forbidden":
            known = [*map(spelled, _section_at(kind, path).model_fields), *(["sweep"] if not place and not path else [])]
            return InputError(where, UNKNOWN, expected=f"one of {', '.join(known)}", remedy=nearest(str(last), known))
        case "missing":
            where = where.removesuffix(str(last)) + spelled(str(last))
            return InputError(where, MISSING, expected=_described(_section_at(kind, path).model_fields[str(last)].annotation))
        case _:
            return InputError(where, WRONG, found=shortened(item["input"]), expected=_wanted(item))


def _wanted(item: Any) -> str:
    """Return what pydantic wants in the words of a case file."""
    kind, message = str(item["type"]), str(item["msg"])
    if kind == "list_type" and isinstance(item["input"], dict):
        return f"a list of tables, each under [[{'.'.join(map(str, item['loc']))}]] with two brackets"
    if kind == "list_type" and item["loc"][-1] in ("direction", "toward"):
        # The command line takes "-y", and buttresses do.
        return f"{_WANTED[kind]}, such as [0, -1, 0]"
    if kind in _WANTED:
        return _WANTED[kind]
    message = message.removeprefix("Value error, ").removeprefix("Input should be ")
    message = message.replace("List should have", "a list of").replace(" after validation", "")
    return message.replace("String should have", "a text of")


def shortened(value: Any) -> str:
    """Return a value as a message shows it."""
    text = repr(value)
    return text if len(text) <= 120 else f"{text[:100]} ... ({len(text)} characters)"


def _section_at(kind: type[Section], path: list[Any]) -> type[Section]:
    """Return the table that a path of keys leads to; names of materials and numbers of loads are stepped over."""
    for part in path:
        field = kind.model_fields.get(str(part))
        if field is not None:
            kind = section_in(field.annotation) or kind
    return kind


def section_in(annotation: Any) -> type[Section] | None:
    """Return the table that a key holds, one or a list of them, or None."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return annotation
    return next((found for part in get_args(annotation) if (found := section_in(part))), None)


def _described(annotation: Any) -> str:
    section = section_in(annotation)
    if section:
        return f"a table with {', '.join(section.model_fields)}"
    words: dict[Any, str] = {float: "a number", int: "a whole number", str: "a text", dict[str, Any]: "a table"}
    return words.get(annotation, "a list" if "list" in str(annotation) else "a value")
