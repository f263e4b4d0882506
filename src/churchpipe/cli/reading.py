"""How a file of stones is read: options that several commands share."""

from collections.abc import Callable
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import Annotated, Any

import typer

from churchpipe.cli.app import ask
from churchpipe.errors import InputError, UsageError

Units = Annotated[str | None, typer.Option(help="Read the drawing in this unit (m, mm, in ...), whatever it says.")]
Thickness = Annotated[
    str | None, typer.Option(help="Depth of stones drawn as outlines, with its unit: 0.12m, 120mm.", show_default=False)
]
Plane = Annotated[str, typer.Option(help='What the x-y plane of a drawing of outlines is: "xz", an elevation, or "xy", a plan.')]
Joint = Annotated[str | None, typer.Option(help="Width of joints that are drawn open, with its unit: 10mm.", show_default=False)]
JointMode = Annotated[str, typer.Option(help='"grow": stones meet in the middle of their joints; "keep": they stay as drawn.')]
Mortar = Annotated[str, typer.Option(help='Weight of the mortar: "counted" as if it were stone, or "ignored".')]
Bond = Annotated[
    str | None,
    typer.Option(
        help='Bond of the stones to lay in walls drawn whole: "running", "stack", or "voussoir" where all are rings.',
        show_default=False,
    ),
]
Course = Annotated[
    str | None,
    typer.Option(help="With --bond: height of a course, or width of a voussoir, with its unit: 0.25m.", show_default=False),
]
StoneLength = Annotated[
    str | None, typer.Option("--stone", help="With --bond: length of a stone, about, with its unit: 0.5m.", show_default=False)
]
LintelBearing = Annotated[
    str | None,
    typer.Option(
        help="With --bond: lay a lintel over each flat head without one, which bears so far on each side: 0.25m.",
        show_default=False,
    ),
]
UpAxis = Annotated[str | None, typer.Option("--up", help="Axis of a mesh that points up: z, y, x, -z, -y or -x.")]
Scale = Annotated[float, typer.Option(help="Size of the building over its size in the file, for a mesh drawn to a scale.")]
Repair = Annotated[bool, typer.Option("--repair", help="Drop duplicates and recompute wrong attributes; each is listed.")]
Support = Annotated[str, typer.Option(help='"base" puts a support under the lowest faces; "drawn" takes the supports drawn.')]


def _reading(
    units: Units = None,
    support: Support = "drawn",
    repair: Repair = False,
    thickness: Thickness = None,
    plane: Plane = "xz",
    joint: Joint = None,
    joint_mode: JointMode = "grow",
    mortar: Mortar = "counted",
    up: UpAxis = None,
    scale: Scale = 1.0,
    bond: Bond = None,
    course: Course = None,
    stone: StoneLength = None,
    lintel_bearing: LintelBearing = None,
) -> Any:
    """Return how a drawing is read from the options of the command line."""
    from churchpipe.dxf.reading import Reading
    from churchpipe.importing import parse_length

    given = {"thickness": thickness, "joint": joint, "course": course, "stone": stone, "lintel_bearing": lintel_bearing}
    lengths = {name: parse_length(f"--{name.replace('_', '-')}", text) for name, text in given.items()}
    words: dict[str, Any] = {"support": support, "plane": plane, "joint_mode": joint_mode, "mortar": mortar}
    words |= {"up": up, "scale": scale, "bond": bond}
    try:
        return Reading(units=units, repair=repair, **lengths, **words)
    except InputError as error:
        option = "--" + error.where.replace("_", "-")
        raise UsageError(option, error.problem, found=error.found, expected=error.expected) from None


def refuse_misplaced(context: typer.Context, file: Path, *of_stones: str) -> None:
    """Refuse what was typed and would do nothing: of a case the options of a file of stones, and the other way round.

    of_stones: parameters of the command that are for files of stones alone, beside those of `_reading`.
    """
    of_case, named = file.suffix.lower() == ".toml", {*of_stones, *signature(_reading).parameters}
    for option in context.command.params:
        source = context.get_parameter_source(option.name or "")
        if source is None or source.name != "COMMANDLINE":
            continue
        if of_case and option.name in named:
            remedy = "What a case and its drawing say stands in the case: docs/reference_case.md."
            raise UsageError(option.opts[0], "not for a case", expected="a drawing or a mesh", remedy=remedy)
        if not of_case and option.name == "changes":
            raise UsageError("--set", "for a case alone", found=file, expected="a case file (TOML)")


def with_reading(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that has the options of `_reading` beside its own, and is called with the `Reading` made of them."""
    own, options = signature(command), signature(_reading).parameters

    @wraps(command)
    def run(**given: Any) -> None:
        reading = _reading(**{name: given.pop(name) for name in options})
        if reading.bond is not None:
            from churchpipe.config.laid_sizes import reading_questions

            ask(reading_questions(reading))
        command(**given, reading=reading)

    parameters = [one for one in own.parameters.values() if one.name != "reading"]
    vars(run)["__signature__"] = own.replace(parameters=[*parameters, *options.values()])
    run.__annotations__ = {one.name: one.annotation for one in (*parameters, *options.values())}
    return run
