"""Templates of pages, whatever stands in them escaped, with the macros of tables and plots at hand."""

import re
from functools import cache
from pathlib import Path

import jinja2
from markupsafe import Markup, escape

# Letters of a name that fits beside its heading on a phone.
_LONG = 16
_HEADED = re.compile(r'<section id="([\w-]+)">\s*<h2>(.*?)</h2>', re.DOTALL)


def template(name: str) -> jinja2.Template:
    """Return a template of the folder beside this module."""
    return _environment().get_template(name)


def breakable(text: object) -> Markup:
    """Return a text escaped, in which long names are broken after underscores if anywhere, and no number from its per cent."""
    text = str(text).replace(" %", "\u00a0%")
    words = (escape(word).replace("_", Markup("_<wbr>")) if len(word) > _LONG else escape(word) for word in text.split(" "))
    return Markup(" ").join(words)


def capital(text: str) -> str:
    """Return a sentence with a large first letter, but one that begins with a key of a case as it is: keys are small."""
    first = text.partition(" ")[0]
    return text if "." in first or "_" in first else text[:1].upper() + text[1:]


def headings(page: Markup) -> list[tuple[str, Markup]]:
    """Return the name and the heading of each section of a page, in the order of the page."""
    return [(name, Markup(title)) for name, title in _HEADED.findall(page)]


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"breakable": breakable, "capital": capital, "headings": headings}
    macros = vars(environment.get_template("table.html").module)
    environment.globals.update({name: macros[name] for name in ("table", "long_table", "diagram")})
    return environment
