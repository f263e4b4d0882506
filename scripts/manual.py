"""Pages of the manual that are made from the code when the site is built (a hook of mkdocs)."""

import html
import re
from types import ModuleType
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

import churchpipe as cp

CLASSES = "What analyses take and return"
FUNCTIONS = "Functions"


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the reference of the command line and of the Python API."""
    for name, content in (("reference_cli.md", command_line()), ("reference_python.md", python_api())):
        files.append(File.generated(config, name, content=content))
    return files


def command_line() -> str:
    """Return the reference page of all commands and options."""
    import typer
    from typer.cli import get_docs_for_click

    from churchpipe.cli import app

    command: Any = typer.main.get_command(app)
    command.commands = {name: item for name, item in command.commands.items() if not item.hidden}
    page = get_docs_for_click(obj=command, ctx=typer.Context(command), name="churchpipe", title="Command line")
    return html.unescape(re.sub(r"<span[^>]*>(.*?)</span>", r"`\1`", page))


def python_api() -> str:
    """Return the reference page of the public names; mkdocstrings fills in their docstrings."""
    objects = {name: getattr(cp, name) for name in sorted(vars(cp)["__all__"], key=str.lower)}
    kinds = {FUNCTIONS: [], CLASSES: []}
    for name, item in objects.items():
        # The generators take the keys of a case file, and have their tables there.
        if not isinstance(item, str | ModuleType):
            kinds[CLASSES if isinstance(item, type) else FUNCTIONS].append(f"::: {item.__module__}.{name}")
    parts = ["# Python", "All names are those of `import churchpipe as cp`. Units are SI: metres, newtons, pascals, radians."]
    for title, entries in kinds.items():
        parts += [f"## {title}", *entries]
    return "\n\n".join(parts)
