"""The plan of a case with its samples: each is the whole case, its variants too, with other values of the sampled keys."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from churchpipe.config import overrides as changes
from churchpipe.config.case import Case, Drawing, cases_of, read_variants
from churchpipe.config.case_file import read_table
from churchpipe.config.distributions import sample_points
from churchpipe.config.plan import Plan, plan
from churchpipe.config.selection import ALL, Selection, selected
from churchpipe.errors import InputError

# Figures of a sampled value: what a run does not depend on is not in its settings.
_DIGITS = 12


def plan_with_samples(
    path: str | Path, overrides: Sequence[str] = (), selection: Selection = ALL
) -> tuple[Plan, dict[str, dict[str, Any]]]:
    """Return the plan of a case file and, by name, what each sample is made of: the files of its own plan and the "index" of it.

    The plan's index has under "sample" the settings, the names, the "points" (lists of values by dotted key), and the files of
    the run that all samples have in common with the building as it is ("shared"). It is None without [sample].

    Raises
    ------
    InputError: as of `read_variants`.
    """
    path = Path(path)
    cases = read_variants(path, overrides)
    todo, sample = plan(selected(cases, selection)), cases[0].sample
    checksum = _checksum(path, cases[0])
    for settings in todo.geometries.values():
        settings |= checksum
    if sample is None:
        return todo, {}
    points = sample_points(sample.parameters, sample.number, seed=sample.seed, method=sample.method)
    values = {
        key: [float(f"{value:.{_DIGITS}g}") for value in column]
        for parameter, column in zip(sample.parameters, points.T, strict=True)
        for key in parameter.key
    }
    table = changes.apply_overrides(read_table(path), overrides)
    table.setdefault("name", path.stem)
    samples: dict[str, dict[str, Any]] = {}
    for number in range(sample.number):
        drawn = {key: column[number] for key, column in values.items()}
        try:
            own = plan(selected(cases_of(table, path, overrides, drawn), selection))
        except InputError as error:
            raise error.at(f"{error.where} (sample {number + 1})") from error
        # Only what is analysed: supports that move are not sampled.
        index = {key: own.index[key] for key in ("case", "geometries", "shells", "analyses")}
        # Where the drawing lies changes no result: its checksum is among the settings.
        index["drawing"] = own.index["drawing"] is not None
        for settings in own.geometries.values():
            settings |= checksum
        samples[f"{number + 1:05d}"] = replace(own, movements={}).files | {"index": index}
    shared = [file for file in _made(todo) if all(_like(table, todo.files, file) for table in samples.values())]
    words = {"settings": todo.index["sample"], "names": list(samples), "points": values, "shared": shared}
    return replace(todo, index=todo.index | {"sample": words}), samples


def _checksum(path: Path, case: Case) -> dict[str, str]:
    """Return what the settings of the stones say of a drawing besides how it is read; nothing of what is generated."""
    if not isinstance(case.source, Drawing):
        return {}
    from churchpipe.meshes.reader import digest_of

    file = case.source.path.resolve()
    if not file.exists():
        raise InputError(f"{path}: source", "no such file", found=file, remedy="Paths are relative to the case file.")
    return {"drawing": digest_of(file)}


# What of the building as it is a sample can use, and the settings that it depends on, in the folder of a geometry or a mesh.
_STONES = ("assemblage.npz", "contacts.npz")
_FITTED = ("building.json", "fitted.npz", "fit.json")
_MESH = ("shell.npz", "match.json")


def _made(todo: Plan) -> list[str]:
    """Return the files of stones, joints and meshes that a run makes."""
    of_shells = {mesh["geometry"] for mesh in todo.index["shells"]} if todo.index["drawing"] else set()
    found = [f"geometry/{name}/{file}" for name in todo.geometries for file in _STONES]
    found += [f"geometry/{name}/{file}" for name in todo.geometries if name in of_shells for file in _FITTED]
    return found + [f"shell/{name}/{file}" for name in todo.shells for file in _MESH]


def _like(sample: Mapping[str, Any], known: Mapping[str, Any], file: str) -> bool:
    """Return whether a sample has the settings, and all that they rest on, that a file of the building as it is was made of."""
    folder = file.rpartition("/")[0]
    places = [f"{folder}/{name}" for name in ("settings", "tolerances", "carried")]
    if folder.startswith("shell/") and f"{folder}/settings" in known:
        geometry = f"geometry/{known[f'{folder}/settings']['geometry']}"
        places += [f"{geometry}/{name}" for name in ("settings", "tolerances")]
    return all(sample.get(place) == known.get(place) for place in places)
