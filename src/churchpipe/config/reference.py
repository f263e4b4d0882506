"""The reference page of the case file: every key, made of the tables that check it."""

import re
from collections.abc import Iterator
from typing import Any

from churchpipe.config.json_schema import IN_METRES, case_schema, references
from churchpipe.config.tables import NEEDED
from churchpipe.model.quantities import unit_of

_HEAD = """# The case file

Every key of every table, made by `churchpipe schema --markdown` of what checks a case. Keys end with their unit; a length of
`[source]` may be written in `_m` instead of `_mm`. `churchpipe generate NAME` writes a commented case, `churchpipe check CASE`
examines one, and `--set a.b.c=value` changes a key. `[sweep]` takes lists of values of any key, by its dotted name, and runs
every combination. In such keys an entry of a list has its name or its number, from 0: `line_loads.roof.dead_kN_m`,
`line_loads.0.dead_kN_m`. A case is trusted: the drawing that it names may be any file that you can read.
"""


def reference_page() -> str:
    """Return the page as Markdown."""
    schema = case_schema()
    tables = schema["$defs"]
    sections = list(_section("The whole file", schema, tables))
    todo = [name for value in schema["properties"].values() for name in references(value)]
    seen: set[str] = set()
    while todo:
        name = todo.pop(0)
        if name in seen:
            continue
        seen.add(name)
        generator = tables[name]["properties"].get("generator", {}).get("const")
        title = f'generator = "{generator}"' if generator else _title(name)
        sections += _section(title, tables[name], tables)
        todo += [inner for value in tables[name]["properties"].values() for inner in references(value)]
    return "\n".join([_HEAD, *sections])


def _section(title: str, table: dict[str, Any], tables: dict[str, Any]) -> Iterator[str]:
    text = "" if title == "The whole file" else " ".join(table.get("description", "").split())
    yield f"## {title}\n"
    if text:
        yield f"{text}\n"
    yield "| key | meaning | takes | unit | default |\n|---|---|---|---|---|"
    needed = table.get(NEEDED, table.get("required", []))
    for key, value in table["properties"].items():
        if value.get("title") == IN_METRES:
            continue
        given = value.get("default")
        default = "" if given in (None, []) or isinstance(given, dict) else _value(given)
        if key in needed or value.get(NEEDED):
            default = "needed"
        takes = "a generator's table or a drawing's, below" if key == "source" and not text else _takes(value, tables)
        yield f"| `{key}` | {value.get('description', '')} | {takes} | {unit_of(key).name} | {default} |"
    yield ""


def _takes(value: dict[str, Any], tables: dict[str, Any]) -> str:
    """Return what a key takes in words."""
    if "$ref" in value:
        return f"table {_title(value['$ref'].rpartition('/')[2])}"
    if "const" in value:
        return _value(value["const"])
    if "enum" in value:
        return ", ".join(map(_value, value["enum"]))
    if "anyOf" in value:
        options = [_takes(option, tables) for option in value["anyOf"] if option.get("type") != "null"]
        return "; or ".join(dict.fromkeys(options))
    match value.get("type"):
        case "array":
            return f"list of {_takes(value['items'], tables)}"
        case "object":
            inner = value.get("additionalProperties")
            return f"tables by name, each {_takes(inner, tables)}" if isinstance(inner, dict) else "a table"
        case kind:
            words = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true or false"}
            signs = (("exclusiveMinimum", ">"), ("minimum", ">="), ("exclusiveMaximum", "<"), ("maximum", "<="))
            return " ".join([words[str(kind)], *(f"{sign} {value[key]:g}" for key, sign in signs if key in value)])


def _title(name: str) -> str:
    """Return the name of a table without what its class is called by."""
    return re.sub(r"(Table|Parameters|Settings)$", "", name)


def _value(value: Any) -> str:
    text = (
        str(value).lower()
        if isinstance(value, bool)
        else f'"{value}"'
        if isinstance(value, str)
        else str(value).replace("'", '"')
    )
    return f"`{text}`"
