"""The JSON schema of a case file, for editors that complete and check TOML."""

import json
from pathlib import Path
from typing import Any

from pydantic.json_schema import models_json_schema

from churchpipe.config.schema import CaseTable
from churchpipe.config.sources import GENERATED, DrawingSource, FileSource
from churchpipe.config.tables import NEEDED
from churchpipe.io.atomic import write_text

# Beside a case; its first line names it for editors.
FILE_NAME = "case.schema.json"
REFERENCE = f"#:schema ./{FILE_NAME}\n"
# The title of a length that stands in the schema twice.
IN_METRES = "in metres"


def schema_text() -> str:
    """Return the JSON schema of a case file as text."""
    return json.dumps(case_schema(), indent=1) + "\n"


def write_case(path: Path, text: str) -> None:
    """Write a case file whose first line names the schema, and the schema beside it."""
    write_text(path.with_name(FILE_NAME), schema_text())
    write_text(path, REFERENCE + text)


def case_schema() -> dict[str, Any]:
    """Return the JSON schema of a case file. A length of a source is taken in _mm or in _m."""
    sources = [*GENERATED.values(), DrawingSource, FileSource]
    names, schema = models_json_schema([(kind, "validation") for kind in (CaseTable, *sources)], ref_template="#/$defs/{model}")
    kinds = {kind: reference["$ref"].removeprefix("#/$defs/") for (kind, _), reference in names.items()}
    tables = schema["$defs"]
    case = tables.pop(kinds[CaseTable])
    pending = [kinds[kind] for kind in sources]
    done: set[str] = set()
    while pending:
        name = pending.pop()
        if name not in done:
            done.add(name)
            pending += references(tables[name])
            tables[name] = _in_both_units(tables[name])
    case["properties"]["source"]["anyOf"] = [{"$ref": f"#/$defs/{kinds[kind]}"} for kind in sources]
    case["properties"]["sweep"] = {
        "type": "object",
        "description": "Lists of values of any key, by its dotted name: every combination is run.",
    }
    # Without a name the file's own is taken; what an import leaves open is filled in later.
    case["required"] = ["source"]
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": "churchpipe case", **case, "$defs": tables}


def _in_both_units(table: dict[str, Any]) -> dict[str, Any]:
    """Return a table that takes each length in _mm or in _m. What is needed may stand under [sweep]: `NEEDED` tells people."""
    keys = dict(table["properties"])
    pairs = {key: f"{key.removesuffix('_mm')}_m" for key in keys if key.endswith("_mm")}
    for millimetres, metres in pairs.items():
        keys[metres] = keys[millimetres] | {"title": IN_METRES}
    needed = table.get("required", [])
    required = [key for key in needed if key in ("generator", "dxf", "file")]
    never = [{"not": {"required": list(pair)}} for pair in pairs.items()]
    return table | {"properties": keys, "required": required, NEEDED: needed} | ({"allOf": never} if never else {})


def references(value: Any) -> list[str]:
    """Return the names of the tables that a part of a schema refers to."""
    if isinstance(value, list):
        return [name for item in value for name in references(item)]
    if not isinstance(value, dict):
        return []
    own = [value["$ref"].removeprefix("#/$defs/")] if "$ref" in value else []
    return own + [name for item in value.values() for name in references(item)]
