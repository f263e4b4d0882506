"""The [source] table: a generator's parameters, or a drawing.

The keys are the fields of the generators' parameter classes with their unit; a length may be written in _m instead of _mm.
"""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from churchpipe.config.section import TWICE, Section, Table, nearest, section_in, shortened, validated
from churchpipe.config.tables import table_of
from churchpipe.dxf.reading import Reading
from churchpipe.errors import InputError
from churchpipe.generators import GENERATORS

# Lengths that are taken, mm: shorter ones are lost in the tolerances of the geometry.
SHORTEST, LONGEST = 0.01, 1e7


def _path(value: str) -> str:
    """Return the name of a file, if it is one."""
    if not value or not value.isprintable():
        raise ValueError("the path of a file, in printable characters")
    return value


_PATH = Annotated[str, AfterValidator(_path)], Field(description="Its path, relative to the case file or absolute.")
DrawingSource = table_of(Reading, "Drawing", without=("up", "scale"), dxf=_PATH)
FileSource = table_of(Reading, "File", file=_PATH)
GENERATED = {
    name: table_of(generator.parameters, name, generator=(Literal[name], Field(description="What makes the building.")))
    for name, generator in GENERATORS.items()
}


def check_source(table: Table, file: str, problems: list[InputError]) -> Section | None:
    """Return the [source] table checked, or None and what is wrong with it among the problems."""
    given = [key for key in ("generator", "dxf", "file") if key in table]
    if len(given) != 1:
        found = " and ".join(given) or ", ".join(table) or "an empty table"
        expected = 'generator = "...", dxf = "..." or file = "..."'
        problems.append(InputError(f"{file}: source", "no single source", found=found, expected=expected))
        return None
    for key in (key for key in table if key.endswith("_m") and f"{key}m" in table):
        found = f"{key} and {key}m"
        problems.append(InputError(f"{file}: source.{key}", TWICE, found=found, expected="one of them"))
        return None
    if given != ["generator"]:
        kind = DrawingSource if given == ["dxf"] else FileSource
        reading = validated(kind, _in_millimetres(table, kind), "source", file, problems)
        problems += _out_of_scale(reading.model_dump(exclude_none=True), f"{file}: source") if reading else []
        return reading
    name = table["generator"]
    if not isinstance(name, str) or name not in GENERATED:
        problems.append(
            InputError(
                f"{file}: source.generator",
                "unknown generator",
                found=shortened(name),
                expected=", ".join(GENERATED),
                remedy=nearest(str(name), GENERATED),
            )
        )
        return None
    spelled = _in_metres if _written_in_metres(table) else str
    source = validated(GENERATED[name], _in_millimetres(table, GENERATED[name]), "source", file, problems, spelled)
    if source is not None:
        problems += _out_of_scale(source.model_dump(exclude_none=True), f"{file}: source")
    return source


def _out_of_scale(value: Any, place: str) -> list[InputError]:
    """Return what is wrong with lengths that no building has; 0 is no length."""
    if isinstance(value, dict):
        return [problem for key, item in value.items() for problem in _out_of_scale(item, f"{place}.{key}")]
    if isinstance(value, list):
        return [problem for number, item in enumerate(value) for problem in _out_of_scale(item, f"{place}.{number}")]
    is_length = place.rstrip("0123456789.").endswith("_mm") and isinstance(value, int | float)
    if not is_length or value == 0 or SHORTEST <= abs(value) <= LONGEST:
        return []
    expected = f"from {SHORTEST:g} to {LONGEST:g} mm"
    remedy = "Keys in _mm take millimetres, keys in _m metres."
    return [InputError(place, "no length of a building", found=f"{value:g} mm", expected=expected, remedy=remedy)]


def _written_in_metres(value: Any) -> bool:
    """Return whether a table, or one within it, has lengths in metres."""
    if isinstance(value, list):
        return any(map(_written_in_metres, value))
    return isinstance(value, dict) and any(key.endswith("_m") or _written_in_metres(item) for key, item in value.items())


def _in_metres(key: str) -> str:
    return key.removesuffix("mm") + "m" if key.endswith("_mm") else key


def _in_millimetres(table: Table, kind: type[Section]) -> Table:
    """Rename known lengths that are written in metres, those of nested tables too."""
    out: Table = {}
    for key, value in table.items():
        renamed = key.removesuffix("_m") + "_mm"
        if key.endswith("_m") and renamed in kind.model_fields and renamed not in table:
            out[renamed] = _times(value, 1000.0)
            continue
        inner = section_in(kind.model_fields[key].annotation) if key in kind.model_fields else None
        out[key] = _nested(value, inner) if inner else value
    return out


def _nested(value: Any, kind: type[Section]) -> Any:
    if isinstance(value, list):
        return [_nested(item, kind) for item in value]
    return _in_millimetres(value, kind) if isinstance(value, dict) else value


def _times(value: Any, factor: float) -> Any:
    if isinstance(value, list):
        return [_times(item, factor) for item in value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    try:
        return value * factor
    except OverflowError:
        # A whole number of hundreds of digits is refused, with its line, as it was written.
        return value
