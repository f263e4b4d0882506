"""Questions about the sizes of stones, asked before any is laid: in another unit they are too many, which takes long to see."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from churchpipe.dxf.reading import Reading
from churchpipe.generators import GENERATORS
from churchpipe.model.doubts import question
from churchpipe.model.quantities import declared, unit_of, written

if TYPE_CHECKING:
    from churchpipe.config.case import Case


def reading_questions(reading: Reading) -> list[str]:
    """Return what to ask about the stones that are laid in a file, by the options of the command line."""
    given = {name: getattr(reading, name) for name in declared(Reading)}
    return list(_asked(Reading, given, {name: f"--{name.replace('_', '-')}" for name in given}))


def laying_questions(cases: Sequence["Case"]) -> list[str]:
    """Return what to ask about the stones that cases have laid, by the keys of [source], each once."""
    return list(dict.fromkeys(text for case in cases for text in _of_source(case.source)))


def _of_source(source: Any) -> Iterator[str]:
    kind = GENERATORS[source.generator].parameters if hasattr(source, "generator") else Reading
    names = {name: f"source.{item.key}" for name, item in declared(kind).items()}
    given = source.parameters if hasattr(source, "generator") else {name: getattr(source.reading, name) for name in names}
    return _asked(kind, given, names)


def _asked(kind: type, given: Mapping[str, Any], names: Mapping[str, str]) -> Iterator[str]:
    """Yield what to ask about given values (SI) of the fields of a dataclass; names: what each is called in the question."""
    for name, item in declared(kind).items():
        usual, value = item.quantity and item.quantity.usual, given.get(name)
        if usual and value is not None:
            for one in value if isinstance(value, tuple) else (value,):
                asked = question(names[name], written(item.key, float(one)), usual, unit_of(item.key))
                yield from [asked] if asked else []
