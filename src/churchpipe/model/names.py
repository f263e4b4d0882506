"""Names of models, analyses and strengths: as records hold them, and as people read them."""

from typing import Literal

Model = Literal["rigid-block", "homogenised-shell"]
ShellMethod = Literal["limit", "pushover"]
Planes = Literal["paper", "paper+torsion", "cell"]

RIGID_BLOCKS: Model = "rigid-block"
SHELL: Model = "homogenised-shell"
MODELS: dict[str, str] = {RIGID_BLOCKS: "rigid blocks", SHELL: "shell"}
METHODS: dict[str, str] = {"limit": "limit load", "pushover": "capacity curve", "curve": "capacity curve of the stones"}

# Strength of the shell unless a case or a caller says otherwise: the exact one.
STRENGTH: Planes = "cell"
# Why a strength that is not exact gives load factors that are too large, by its name; up to 53 % on the church of docs/shell.md.
OUTER: dict[str, str] = {
    "paper": "the eight planes of the paper are an outer approximation of the strength and bound no twisting: the load factor "
    'may be up to 50 % above that of the exact cell; use planes = "cell"',
    "paper+torsion": "the planes of the paper are an outer approximation of the strength, with a bound of twisting too: the load "
    'factor may be up to 35 % above that of the exact cell; use planes = "cell"',
}


def analysis_name(flow: str | None, method: str | None, planes: str | None) -> str:
    """Return flow rule or method in words, with the strength of a shell where it is not the exact one."""
    words = flow or METHODS.get(str(method), str(method or ""))
    return f"{words}, planes of the paper (too strong)" if planes in OUTER else words
