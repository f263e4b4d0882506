"""Texts of a table in columns as wide as there is room for."""

import re
from collections.abc import Sequence
from textwrap import TextWrapper

from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, RenderResult
from rich.table import Column, Table
from rich.text import Text

# Longer words, such as names made of many parts, may be broken, between their parts where there is room for these.
_LONGEST = 16


class TextTable(Table):
    """A table of texts below a title. Where it is too wide, lines of its cells end between words or after hyphens.

    Where that is not enough, its columns stand closer to each other. Where words would still be broken, its rows become a list.
    """

    def __init__(self, title: str) -> None:
        super().__init__(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the lines of the table, no wider than there is room for."""
        texts = [[*map(_text, (column.header, *column.cells))] for column in self.columns]
        natural = [max(text.cell_len for text in column) for column in texts]
        least = [max(min(len(line), _LONGEST) for text in column for line in _lines(text.plain, 1)) for column in texts]
        # A line on both sides and between columns, and a space in each.
        room = options.max_width - 2 * len(texts) - 1
        if sum(natural) <= room:
            yield from super().__rich_console__(console, options)
            return
        close = len(texts) if sum(least) > room else 0
        if sum(least) > room + close:
            narrow = _listed(texts)
        else:
            narrow = _narrowed(texts, _fitted(least, natural, room + close), self.columns)
            narrow.padding = 0 if close else self.padding
        narrow.title, narrow.title_style, narrow.title_justify = self.title, self.title_style, self.title_justify
        narrow.caption, narrow.caption_justify = self.caption, self.caption_justify
        yield narrow


def _narrowed(texts: Sequence[Sequence[Text]], widths: Sequence[int], columns: Sequence[Column]) -> Table:
    """Return the texts of columns, each with its title, in a table of columns of these widths that stand as others do."""
    table = Table(box=SIMPLE_HEAD)
    broken = [
        [Text("\n".join(_lines(text.plain, width, whole=False)), text.style) for text in column]
        for column, width in zip(texts, widths, strict=True)
    ]
    for column, own in zip(broken, columns, strict=True):
        table.add_column(column[0], justify=own.justify, overflow="fold")
    for row in list(zip(*broken, strict=True))[1:]:
        table.add_row(*row)
    return table


def _listed(texts: Sequence[Sequence[Text]]) -> Table:
    """Return the rows of columns, each with its title, as a list."""
    table = Table.grid("", "", padding=(0, 1, 0, 0))
    for row in list(zip(*texts, strict=True))[1:]:
        told = [Text.assemble(column[0], " ", text) for column, text in zip(texts, row, strict=True) if text.plain]
        table.add_row("-", Text("; ").join(told))
    return table


def _text(cell: object) -> Text:
    return cell if isinstance(cell, Text) else Text(str(cell))


def _lines(text: str, width: int, *, whole: bool = True) -> list[str]:
    """Return a text in lines of so many letters; whole: longer words are not broken, but for long names."""
    return _Wrapper(width, break_long_words=not whole).wrap(text) or [""]


class _Wrapper(TextWrapper):
    """Ends lines also after an underscore of a long name."""

    def _split(self, text: str) -> list[str]:
        words = super()._split(text)
        return [part for word in words for part in (re.split("(?<=_)", word) if len(word) > _LONGEST else [word]) if part]


def _fitted(least: Sequence[int], natural: Sequence[int], room: int) -> list[int]:
    """Return the widths of columns that fill a room, from the least ones on."""
    widths = [max(width, 1) for width in least]
    while sum(widths) < min(room, sum(natural)):
        # The next letter is given to the column whose texts fill most lines.
        lines = [whole / width if width < whole else 0.0 for whole, width in zip(natural, widths, strict=True)]
        widths[lines.index(max(lines))] += 1
    return widths
