"""One sample of a case: all its stages in one process, in a folder that does not last."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from churchpipe.io.atomic import PART, write_json
from churchpipe.io.records import Analysis
from churchpipe.run_folder import RunFolder

Stages = Mapping[str, Callable[..., None]]


def run_sample(table: Mapping[str, Any], drawing: Path, shared: Sequence[Path], stages: Stages, place: Path) -> list[Analysis]:
    """Return the records of the analyses of a sample, as those of a run.

    Parameters
    ----------
    table: the settings of its stages by file, and its "index". drawing: that of the case, if its source is one. shared: files of
    the run, relative to its folder, that take the place of the sample's own. stages: by name. place: where its own folder lies
    meanwhile, which is in the run's, so that the next run removes what a killed one has left.
    """
    index = table["index"]
    with tempfile.TemporaryDirectory(prefix=PART, dir=place) as scratch:
        run = RunFolder(Path(scratch), index)
        for file in (run.path / part for part in shared):
            file.parent.mkdir(parents=True, exist_ok=True)
            file.symlink_to(file.relative_to(run.path).absolute())
        for name, settings in table.items():
            if name != "index":
                write_json(run.path / f"{name}.json", settings)
        for name in index["geometries"]:
            _make_geometry(run.path / "geometry" / name, drawing if index["drawing"] else None, stages)
        for mesh in index["shells"]:
            _make_mesh(run.path / "shell" / mesh["name"], run.path / "geometry" / mesh["geometry"], index["drawing"], stages)
        for entry in index["analyses"]:
            _analyse(run, entry, stages)
        meshes = run.meshes()
        return [run.record(entry, meshes) for entry in index["analyses"]]


def _make_geometry(folder: Path, drawing: Path | None, stages: Stages) -> None:
    stones = folder / "assemblage.npz"
    if not stones.exists():
        if drawing:
            stages["drawing"](folder / "settings.json", drawing, stones, folder / "stones.vtu")
        else:
            stages["source"](folder / "settings.json", folder / "building.json")
            stages["blocks"](folder / "building.json", stones)
    if not (folder / "contacts.npz").exists():
        stages["contacts"](folder / "tolerances.json", stones, folder / "contacts.npz")


def _make_mesh(folder: Path, geometry: Path, drawn: bool, stages: Stages) -> None:
    building, stones = geometry / "building.json", geometry / "assemblage.npz"
    if drawn:
        fitted = geometry / "fitted.npz"
        if not fitted.exists():
            stages["panels"](geometry / "settings.json", stones, building, fitted, geometry / "fit.json")
        stones = fitted
    if not (folder / "shell.npz").exists():
        stages["shell"](folder / "settings.json", building, folder / "shell.npz")
    if not (folder / "match.json").exists():
        made = folder / "shell.npz", folder / "carried.json", stones, geometry / "contacts.npz", folder / "match.json"
        stages["match"](*made)


def _analyse(run: RunFolder, entry: Mapping[str, Any], stages: Stages) -> None:
    kind, folder = entry["kind"], run.folder(dict(entry))
    geometry = run.path / "geometry" / entry["geometry"]
    stones, joints = geometry / "assemblage.npz", geometry / "contacts.npz"
    if "shell" in entry:
        mesh = run.path / "shell" / entry["shell"]
        inputs = (mesh / "shell.npz", mesh / "match.json", geometry / "fitted.npz" if run.index["drawing"] else stones)
    else:
        inputs = (stones, joints)
    stages[kind](folder / "settings.json", *inputs, folder / f"{kind}.npz", folder / f"{kind}.json")
    if entry.get("halved"):
        stages["halved"](folder / "settings.json", *inputs, folder / "halved.npz")
