"""Templates of pages, whatever stands in them escaped, with the macros of tables and plots at hand."""

from functools import cache
from pathlib import Path

import jinja2


def template(name: str) -> jinja2.Template:
    """Return a template of the folder beside this module."""
    return _environment().get_template(name)


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    macros = vars(environment.get_template("table.html").module)
    environment.globals.update({name: macros[name] for name in ("table", "diagram")})
    return environment
