"""Arguments and options of the command line that several commands share."""

from pathlib import Path
from typing import Annotated, Any

import typer


def out_option(meaning: str) -> Any:
    """Return the option --out of a command, which takes no empty path: a variable of a shell that is not set."""
    return typer.Option("--out", "-o", metavar="<path>", help=meaning, show_default=False, parser=_path)


def _path(text: str | Path) -> Path:
    if not str(text).strip():
        raise typer.BadParameter('no path; expected the name of a file or a folder, "." for the current one.')
    return Path(text)


Folder = Annotated[Path | None, out_option("Folder to write to; default: the name of the file.")]


def _named(path: Path) -> Path:
    """Return a path that has a name: "." has none."""
    return path if path.name else path.resolve()


StonesFile = Annotated[
    Path,
    typer.Argument(
        metavar="FILE", help="A drawing, a mesh, or a folder of them.", exists=True, show_default=False, callback=_named
    ),
]
ModelFile = Annotated[
    Path,
    typer.Argument(
        metavar="FILE",
        help="A case, a drawing, a mesh, or a folder of drawings or meshes.",
        exists=True,
        show_default=False,
        callback=_named,
    ),
]
CaseFile = Annotated[Path, typer.Argument(help="A case file (TOML).", exists=True, dir_okay=False, show_default=False)]
RunFolder = Annotated[Path, typer.Argument(help="Folder of a run.", exists=True, file_okay=False, show_default=False)]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the case: --set material.default.friction=0.5. Repeatable."),
]
ContactGap = Annotated[
    str | None, typer.Option(help="How far two faces of a joint may be apart, with its unit: 2mm.", show_default=False)
]
ContactAngle = Annotated[
    float | None,
    typer.Option(
        "--contact-angle-deg", help="How far two faces of a joint may be from parallel.", min=0, max=90, show_default=False
    ),
]
Overlap = Annotated[
    str | None, typer.Option(help="How deep two stones may lie in each other, with its unit: 2mm.", show_default=False)
]
