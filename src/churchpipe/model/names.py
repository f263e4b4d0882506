"""Names of models, analyses and strengths: as records hold them, and as people read them."""

from typing import Literal

Model = Literal["rigid-block", "homogenised-shell"]
ShellMethod = Literal["limit", "pushover"]
# Whether sliding dilates.
Flow = Literal["associative", "non-associative"]
# The normal forces from which a search without dilatancy begins.
Start = Literal["centre", "dead-load", "uniform", "associative", "scattered"]
Planes = Literal["paper", "paper+torsion", "cell"]
# Where the friction of a joint acts: at its corners, or so near to the middle that uniform pressure resists torsion as it should.
ContactModel = Literal["corners", "torsion"]
CONTACT_MODEL: ContactModel = "corners"

RIGID_BLOCKS: Model = "rigid-block"
SHELL: Model = "homogenised-shell"
MODELS: dict[str, str] = {RIGID_BLOCKS: "rigid blocks", SHELL: "shell"}
METHODS: dict[str, str] = {"limit": "limit load", "pushover": "capacity curve", "curve": "capacity curve of the stones"}
# What tables call the building without its variants.
AS_IT_IS = "as it is"
# What a load factor rests on; anything else is bad news that the command line reports with its exit code.
GOOD = frozenset({"optimal", "converged", "unbounded"})

# Strength of the shell unless a case or a caller says otherwise: the exact one.
STRENGTH: Planes = "cell"
# Why a strength that is not exact gives load factors that are too large, by its name; up to 53 %: docs/shell_results.md.
OUTER: dict[str, str] = {
    "paper": "the eight planes of the paper are an outer approximation of the strength and bound no twisting: the load factor "
    'may be up to 50 % above that of the exact cell; use planes = "cell"',
    "paper+torsion": "the planes of the paper are an outer approximation of the strength, with a bound of twisting too: the load "
    'factor may be up to 35 % above that of the exact cell; use planes = "cell"',
}
# What a message says of a state in which a few stones that friction alone holds are not held.
LOOSE = "out whatever pushes"
# What a message says of a lower state that does not lead because its gap is larger.
NEARLY = "is lower and nearly as exact"
