"""What a notebook shows of a model or a result: a small table."""

from collections.abc import Mapping
from html import escape


def card(title: str, rows: Mapping[str, object]) -> str:
    """Return a title and its rows as HTML; what comes from drawings and cases is escaped."""
    lines = [f"<tr><th>{escape(name)}</th><td>{escape(_text(value))}</td></tr>" for name, value in rows.items()]
    return f"<table><caption><b>{escape(title)}</b></caption>{''.join(lines)}</table>"


def _text(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value)
