"""The code that decides what a stage makes: its own, and all modules of this package that it reaches through their imports.

Read from the sources, so that imports inside functions count, and code that the stage does not use does not. A package's
`__init__` counts where a name is taken from it. A file that is not Python belongs to the modules of its folder.
"""

import ast
import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from symtable import SymbolTable, symtable

PACKAGE = Path(__file__).parent
# Its functions count one by one, all other modules as a whole.
STAGES = "stages.py"
_IMPORT = re.compile(r"^[ \t]*(?:from [\w.]+ import (?:\([^)]*\)|.*)|import .*)$", re.MULTILINE)
_HINTS = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+.*\n|\n)*", re.MULTILINE)


def code_of(stage: str, package: Path = PACKAGE) -> str:
    """Return what a stage's results depend on besides its inputs, as text: a line for each source, with its SHA-256."""
    return codes_of([stage], package)[stage]


def codes_of(stages: Iterable[str], package: Path = PACKAGE) -> dict[str, str]:
    """Return `code_of` of several stages. Each source is read once: a person waits for it."""
    defined: dict[str, list[ast.stmt]] = {}
    for node in ast.parse((package / STAGES).read_text(encoding="utf-8")).body:
        for name in _names(node):
            defined.setdefault(name, []).append(node)
    sources = Sources(package)
    return {stage: sources.lines(stage, *_used(stage, defined, sources)) for stage in stages}


@dataclass
class Sources:
    """The sources of a package, each read when it is first reached."""

    package: Path
    imports: dict[Path, tuple[Path, ...]] = field(default_factory=dict[Path, tuple[Path, ...]])
    # The line of a file.
    digests: dict[Path, str] = field(default_factory=dict[Path, str])
    # Of each folder the files that are not Python.
    data: dict[Path, list[Path]] = field(default_factory=dict[Path, list[Path]])
    places: dict[tuple[str | None, str], list[Path]] = field(default_factory=dict[tuple[str | None, str], list[Path]])

    def lines(self, stage: str, own: str, modules: set[Path]) -> str:
        reached = self.reached(modules)
        data = {path for folder in {path.parent for path in reached} - {self.package} for path in self.data_of(folder)}
        return f"{_digest(own.encode())}  {STAGES}: {stage}\n" + "".join(map(self.line, sorted(reached | data)))

    def reached(self, modules: set[Path]) -> set[Path]:
        """Return these modules and all that they import."""
        todo, out = list(modules), set[Path]()
        while todo:
            path = todo.pop()
            if path not in out:
                out.add(path)
                todo += self.imports_of(path)
        return out

    def imports_of(self, path: Path) -> tuple[Path, ...]:
        if path not in self.imports:
            self.imports[path] = tuple(imports_in(path.read_text(encoding="utf-8"), self))
        return self.imports[path]

    def line(self, path: Path) -> str:
        if path not in self.digests:
            self.digests[path] = f"{_digest(path.read_bytes())}  {path.relative_to(self.package).as_posix()}\n"
        return self.digests[path]

    def data_of(self, folder: Path) -> list[Path]:
        if folder not in self.data:
            self.data[folder] = [path for path in folder.rglob("*") if _is_data(path)]
        return self.data[folder]

    def module(self, module: str | None, name: str) -> list[Path]:
        """Return the file from which a name is imported; none for modules of others."""
        if (module, name) not in self.places:
            self.places[module, name] = _module(module, name, self.package)
        return self.places[module, name]


def _is_data(path: Path) -> bool:
    # Python and Numba keep what they compiled beside the sources.
    return path.suffix != ".py" and "__pycache__" not in path.parts and path.is_file()


def _used(stage: str, defined: Mapping[str, Sequence[ast.stmt]], sources: Sources) -> tuple[str, set[Path]]:
    """Return a function of the stages with what it uses of its module, and the modules that these import.

    defined: the statements of the module of the stages, by the names that they define.
    """
    todo, own, modules = [stage], dict[str, str](), set[Path]()
    while todo:
        name = todo.pop()
        if name in own or name not in defined:
            continue
        own[name] = ""
        for node in defined[name]:
            if isinstance(node, ast.ImportFrom):
                imported = [alias.name for alias in node.names if _bound(alias) == name]
                modules |= {path for other in imported for path in sources.module(node.module, other)}
                continue
            modules |= set(_imports(node, sources))
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


def imports_in(text: str, sources: Sources) -> Iterator[Path]:
    """Yield the modules of a package that the text of one of them imports."""
    # To parse all modules whole takes a second.
    try:
        found = ast.parse(import_lines(text))
    except SyntaxError:
        found = ast.parse(text)
    return _imports(found, sources)


def import_lines(text: str) -> str:
    """Return the statements of a module that import, but for those that only type checkers read; maybe words of a text as well.

    They are lines of their own, as the linter wants them. Where they cannot be parsed, the module must be.
    """
    return "\n".join(found.strip() for found in _IMPORT.findall(_HINTS.sub("", text)))


def _imports(node: ast.AST, sources: Sources) -> Iterator[Path]:
    """Yield the modules of a package that a piece of code imports, but for those that only type checkers read."""
    if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
        return
    if isinstance(node, ast.Import):
        for alias in node.names:
            yield from sources.module(alias.name, "")
    elif isinstance(node, ast.ImportFrom):
        for alias in node.names:
            yield from sources.module(node.module, alias.name)
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.expr):
            yield from _imports(child, sources)


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
