"""A part of what a case asks for: some of its loads, or one of its two models."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from churchpipe.config.case import Case
from churchpipe.config.section import nearest
from churchpipe.errors import UsageError

BLOCKS, SHELL = "blocks", "shell"


@dataclass(frozen=True, slots=True)
class Selection:
    """What is picked. loads: names of loads and of supports that move, none: all. model: "blocks", "shell", or "" for both."""

    loads: tuple[str, ...] = ()
    model: str = ""


ALL = Selection()


def selected(cases: Sequence[Case], selection: Selection) -> tuple[Case, ...]:
    """Return the cases with what is picked of their analyses.

    Raises
    ------
    UsageError: a load that no case has, a model that is none or that the case does not ask for.
    """
    known = dict.fromkeys(item.name for case in cases for item in (*case.loads, *case.movements))
    for name in selection.loads:
        if name not in known:
            where = f"--load {name}"
            raise UsageError(where, "no such load", expected=", ".join(known), remedy=nearest(name, known))
    if selection.model not in ("", BLOCKS, SHELL):
        raise UsageError(f"--model {selection.model}", "no such model", expected=f"{BLOCKS} or {SHELL}")
    if selection.model == SHELL and not any(case.shell for case in cases):
        remedy = "Give it a table [shell], or --set shell.element_size_mm=200."
        raise UsageError("--model shell", "the case asks for no shell", remedy=remedy)
    return tuple(_part(case, selection) for case in cases)


def _part(case: Case, selection: Selection) -> Case:
    loads, movements = case.loads, case.movements
    if selection.loads:
        loads = tuple(load for load in loads if load.name in selection.loads)
        movements = tuple(movement for movement in movements if movement.name in selection.loads)
    case = replace(case, loads=loads, movements=movements)
    if selection.model == BLOCKS:
        return replace(case, shell=None)
    if selection.model == SHELL:
        return replace(case, rigid=replace(case.rigid, flow=(), curve=None), movements=())
    return case
