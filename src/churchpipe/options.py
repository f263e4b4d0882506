"""Arguments and options of the command line that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

Folder = Annotated[
    Path | None, typer.Option("--out", "-o", help="Folder to write to; default: the name of the file.", show_default=False)
]
StonesFile = Annotated[
    Path, typer.Argument(metavar="FILE", help="A drawing, a mesh, or a folder of them.", exists=True, show_default=False)
]
CaseFile = Annotated[Path, typer.Argument(help="A case file (TOML).", exists=True, dir_okay=False, show_default=False)]
RunFolder = Annotated[Path, typer.Argument(help="Folder of a run.", exists=True, file_okay=False, show_default=False)]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the case: --set material.default.friction=0.5. Repeatable."),
]
Units = Annotated[str | None, typer.Option(help="Read the drawing in this unit (m, mm, in ...), whatever it says.")]
Thickness = Annotated[
    str | None, typer.Option(help="Of stones drawn as outlines, with its unit: 0.12m, 120mm.", show_default=False)
]
Plane = Annotated[str, typer.Option(help='What x-y is in a drawing of outlines: "xz", the elevation, or "xy", a plan.')]
Joint = Annotated[str | None, typer.Option(help="Width of joints that are drawn open, with its unit: 10mm.", show_default=False)]
JointMode = Annotated[str, typer.Option(help='"grow": stones meet in the middle of their joints; "keep": they stay as drawn.')]
ContactGap = Annotated[
    str | None, typer.Option(help="How far two faces of a joint may be apart, with its unit: 2mm.", show_default=False)
]
Mortar = Annotated[str, typer.Option(help='Weight of the mortar: "counted" as if it were stone, or "ignored".')]
Bond = Annotated[
    str | None,
    typer.Option(help='Lay stones in whole walls: "running" or "stack"; "voussoir" where all are rings.', show_default=False),
]
Course = Annotated[
    str | None, typer.Option(help="With --bond: height of a course, width of a voussoir: 0.25m.", show_default=False)
]
StoneLength = Annotated[str | None, typer.Option("--stone", help="With --bond: about the length of a stone.", show_default=False)]
UpAxis = Annotated[str | None, typer.Option("--up", help="Axis of a mesh that points up: z, y, x, -z, -y or -x.")]
Scale = Annotated[float, typer.Option(help="Sizes in the building over sizes in the file, of a mesh at scale.")]
Repair = Annotated[bool, typer.Option("--repair", help="Drop duplicates and recompute wrong attributes; each is listed.")]
Support = Annotated[str, typer.Option(help='"base" puts a support under the lowest faces; "drawn" takes the supports drawn.')]
