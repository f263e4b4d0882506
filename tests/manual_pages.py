"""The pages of the manual, and the commands that they show."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


def commands(page: Path) -> list[str]:
    """Return the calls of churchpipe in the code of a page, without their comments."""
    text = re.sub(r"\\\n\s*", "", page.read_text(encoding="utf-8"))
    lines = re.findall(r"^(?: {4}|\$ )(churchpipe .*)$", text, flags=re.MULTILINE)
    return [part.strip() for line in lines for part in re.sub(r"\s{2,}[#(].*", "", line).split("&&")]


def commands_in_sentences(page: Path) -> list[str]:
    """Return the calls in the sentences of a page, but for those with a word in capitals where a file would stand."""
    found = re.findall(r"`churchpipe ([a-z-]+)( [^`]*)?`", page.read_text(encoding="utf-8"))
    return [f"churchpipe {name}{rest}" for name, rest in found if rest and not re.search(r"\b[A-Z]{4,}\b", rest)]


def case_of_the_tutorial(steps: int | None = None) -> str:
    """Return the case file that the tutorial writes, after so many of its steps."""
    page = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
    return "\n".join(re.findall(r"^```toml\n(.*?)^```", page, flags=re.DOTALL | re.MULTILINE)[:steps])
