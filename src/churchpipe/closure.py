"""The code that decides what a stage makes: its own, and all modules of this package that it reaches through their imports.

Read from the sources, so that imports inside functions count, and code that the stage does not use does not. A package's
`__init__` counts where a name is taken from it. A file that is not Python belongs to the modules of its folder.
"""

import ast
import hashlib
import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from symtable import SymbolTable, symtable

PACKAGE = Path(__file__).parent
# Its functions count one by one, all other modules as a whole.
STAGES = "stages.py"
_IMPORT = re.compile(r"^[ \t]*(?:from [\w.]+ import (?:\([^)]*\)|.*)|import .*)$", re.MULTILINE)
_HINTS = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+.*\n|\n)*", re.MULTILINE)


def code_of(stage: str, package: Path = PACKAGE) -> str:
    """Return what a stage's results depend on besides its inputs, as text: a line for each source, with its SHA-256."""
    own, modules = _used(stage, package)
    lines = [f"{_digest(own.encode())}  {STAGES}: {stage}\n"]
    reached = _reached(modules, package)
    data = {path for folder in {path.parent for path in reached} - {package} for path in folder.rglob("*") if _is_data(path)}
    lines += [f"{_digest(path.read_bytes())}  {path.relative_to(package).as_posix()}\n" for path in sorted(reached | data)]
    return "".join(lines)


def _is_data(path: Path) -> bool:
    # Python and Numba keep what they compiled beside the sources.
    return path.is_file() and path.suffix != ".py" and "__pycache__" not in path.parts


def _used(stage: str, package: Path) -> tuple[str, set[Path]]:
    """Return a function of the stages with what it uses of its module, and the modules that these import."""
    defined: dict[str, list[ast.stmt]] = {}
    for node in ast.parse((package / STAGES).read_text(encoding="utf-8")).body:
        for name in _names(node):
            defined.setdefault(name, []).append(node)
    todo, own, modules = [stage], dict[str, str](), set[Path]()
    while todo:
        name = todo.pop()
        if name in own or name not in defined:
            continue
        own[name] = ""
        for node in defined[name]:
            if isinstance(node, ast.ImportFrom):
                imported = [alias.name for alias in node.names if _bound(alias) == name]
                modules |= {path for other in imported for path in _module(node.module, other, package)}
                continue
            modules |= set(_imports(node, package))
            if not isinstance(node, ast.Import):
                own[name] += ast.unparse(node)
                todo += _globals(symtable(own[name], STAGES, "exec"))
    return "\n".join(own[name] for name in sorted(own)), modules


def _globals(table: SymbolTable, inside: bool = False) -> Iterator[str]:
    """Yield the names that a piece of code takes from its module, those inside functions too."""
    yield from (symbol.get_name() for symbol in table.get_symbols() if (symbol.is_global() if inside else symbol.is_referenced()))
    for child in table.get_children():
        yield from _globals(child, inside=True)


def _names(node: ast.stmt) -> list[str]:
    """Return the names that a statement of a module defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    if isinstance(node, ast.Import | ast.ImportFrom):
        return [_bound(alias) for alias in node.names]
    return [inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store)]


def _bound(alias: ast.alias) -> str:
    """Return the name that an import binds."""
    return alias.asname or alias.name.partition(".")[0]


def _reached(modules: set[Path], package: Path) -> set[Path]:
    """Return these modules and all that they import."""
    todo, out = list(modules), set[Path]()
    while todo:
        path = todo.pop()
        if path not in out:
            out.add(path)
            todo += _imports_of(path.read_text(encoding="utf-8"), package)
    return out


# Most modules are reached by several stages.
@lru_cache(maxsize=1024)
def _imports_of(text: str, package: Path) -> tuple[Path, ...]:
    # To parse all modules whole takes a second, which a person waits for.
    try:
        found = ast.parse(import_lines(text))
    except SyntaxError:
        found = ast.parse(text)
    return tuple(_imports(found, package))


def import_lines(text: str) -> str:
    """Return the statements of a module that import, but for those that only type checkers read; maybe words of a text as well.

    They are lines of their own, as the linter wants them. Where they cannot be parsed, the module must be.
    """
    return "\n".join(found.strip() for found in _IMPORT.findall(_HINTS.sub("", text)))


def _imports(node: ast.AST, package: Path) -> Iterator[Path]:
    """Yield the modules of this package that a piece of code imports, but for those that only type checkers read."""
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        return
    if isinstance(node, ast.Import):
        for alias in node.names:
            yield from _module(alias.name, "", package)
    elif isinstance(node, ast.ImportFrom):
        for alias in node.names:
            yield from _module(node.module, alias.name, package)
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.expr):
            yield from _imports(child, package)


def _module(module: str | None, name: str, package: Path) -> list[Path]:
    """Return the file from which a name is imported; none for modules of others."""
    first, *parts = (module or "").split(".")
    if first != package.name:
        return []
    place = package.joinpath(*parts)
    candidates = (place / f"{name}.py", place / name / "__init__.py", place.with_suffix(".py"), place / "__init__.py")
    return [next(path for path in candidates if path.is_file())]


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
