"""What a notebook and the terminal show of a model or a result: a small table."""

from abc import abstractmethod
from collections.abc import Mapping
from html import escape

from churchpipe.model.arrays import ReadOnly


class Shown(ReadOnly):
    """What shows itself as a small table in a notebook, and as a line of the same where it is printed."""

    __slots__ = ()

    @abstractmethod
    def _rows(self) -> tuple[str, Mapping[str, object]]:
        """Return the title of the table, and its rows by their names."""

    def _repr_html_(self) -> str:
        return card(*self._rows())

    def __repr__(self) -> str:
        title, rows = self._rows()
        return f"{title}: " + "; ".join(f"{name} {_text(value)}" for name, value in rows.items())


def card(title: str, rows: Mapping[str, object]) -> str:
    """Return a title and its rows as HTML; what comes from drawings and cases is escaped."""
    lines = [f"<tr><th>{escape(name)}</th><td>{escape(_text(value))}</td></tr>" for name, value in rows.items()]
    return f"<table><caption><b>{escape(title)}</b></caption>{''.join(lines)}</table>"


def _text(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value)
