"""Files of stones in any format: `read_stones` for stones and findings, `read_file` for all that a file tells."""

import hashlib
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from churchpipe.dxf import schema
from churchpipe.dxf.duplicates import distinct_stones
from churchpipe.dxf.jointing import jointed
from churchpipe.dxf.layer_parts import named_by_parts
from churchpipe.dxf.layer_walls import named_by_layers
from churchpipe.dxf.laying import laid_stones
from churchpipe.dxf.reader import (
    Drawing,
    assembled,
    given_weights,
    read_bodies,
    read_drawing,
    supported,
    uniquely_named,
    unit_weights,
)
from churchpipe.dxf.reading import Reading
from churchpipe.dxf.slivers import slivers
from churchpipe.dxf.stones import Stone
from churchpipe.dxf.units import length_text, likely_units, plausible, unit_hint
from churchpipe.errors import InputError, halved
from churchpipe.findings import Finding, Findings, FindingsError
from churchpipe.meshes.coarse import coarse
from churchpipe.meshes.compas import read_compas
from churchpipe.meshes.gltf import read_gltf
from churchpipe.meshes.lmgc90 import read_lmgc90
from churchpipe.meshes.obj import read_obj
from churchpipe.meshes.ply import read_ply
from churchpipe.meshes.rhino import read_3dm
from churchpipe.meshes.solids import parted, to_stones
from churchpipe.meshes.source import MOST_NAMED, Body, Source, refused
from churchpipe.meshes.stl import read_stl
from churchpipe.meshes.threedec import read_3dec
from churchpipe.meshes.threemf import read_3mf
from churchpipe.model.arguments import path_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.materials import UnitWeight
from churchpipe.recognition.laying import LaidBond
from churchpipe.wording import counted

READERS: Final[dict[str, Callable[[Path], Source]]] = {
    ".obj": read_obj,
    ".stl": read_stl,
    ".ply": read_ply,
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".3mf": read_3mf,
    ".3dm": read_3dm,
    ".json": read_compas,
    ".3ddat": read_3dec,
    ".3dec": read_3dec,
}
BODIES, BESIDE = "BODIES.DAT", ("DOF.INI", "DRV_DOF.DAT")
FORMATS = "DXF, OBJ, STL, PLY, GLB, 3MF, 3DM, COMPAS JSON, LMGC90 BODIES.DAT, 3DEC"
GROUND = "a body that the file fixes, or one named ground, support or foundation"
UNNAMED = "save it as a file of its own, such as ground.stl, and read the folder (PLY and binary STL have no names)"


def read_stones(
    path: str | os.PathLike[str], *, unit_weight: float | Mapping[str, float] | None = None, **options: Any
) -> tuple[Assemblage, Findings]:
    """Return the stones of a file, and what is wrong with it.

    Formats: DXF, OBJ, STL, PLY, GLB, 3MF, Rhino 3DM, COMPAS JSON, LMGC90, 3DEC, or a folder of files.

    Parameters
    ----------
    path
        The file, or a folder of files of one stone each.
    unit_weight
        N/m3, for all stones or by material name; overrides what the file stores.
    options
        How to read it, by keywords.
        units: read it in "m", "mm", "in" ... whatever it says itself.
        repair: mend what may change a shape (faces given twice, vertices that nearly meet, corners on edges, holes of one face),
        drop stones given twice; each repair is a warning.
        support: "drawn" or "base", a fixed support under the lowest faces where the file has no ground.
        thickness: of stones drawn as outlines, m. plane: "xz", the drawing is an elevation, or "xy", a plan.
        joint: nominal width, m, of joints drawn open. joint_mode: "grow" lets stones meet in the middle of their joints, "keep"
        leaves them as drawn. `find_contacts` then wants, for "grow", `least_width`, a fifth of the joint, and for "keep",
        `contact_gap`, as wide as the widest joint. mortar: its weight is "counted", as if it were stone, or "ignored".
        up: the axis of the file that points up. scale: sizes in the building over sizes in the file. A DXF has neither.
        bond: the bodies are whole walls and rings to lay stones in, "running", "stack" or "voussoir". course: height of a course,
        width of a voussoir, m. stone: about the length of a stone, m. lintel_bearing: how far lintels that are laid over openings
        bear on either side, m.

    Raises
    ------
    FindingsError
        The file has errors; its `findings` list all of them, warnings included.
    InputError
        An argument that cannot be taken.
    """
    given = list(unit_weight.values()) if isinstance(unit_weight, Mapping) else unit_weight
    if given is not None:
        doubt_argument("read_stones: unit_weight", given, UnitWeight, "unit_weight")
    for size in ("course", "stone"):
        if options.get(size) is not None:
            doubt_argument(f"read_stones: {size}", options[size], LaidBond, size)
    read = read_file(path, unit_weight=unit_weight, **options)
    return read.stones, read.findings


def read_file(path: str | os.PathLike[str], *, unit_weight: float | Mapping[str, float] | None = None, **options: Any) -> Drawing:
    """Read a file of stones in any format, with what a drawing says beside them; see `read_stones`."""
    path = path_of("read_stones: path", path)
    # "." and ".." are no names that a finding could be told by.
    path = path.resolve() if path.name in ("", "..") else path
    known = [item.name for item in fields(Reading)]
    for name in options:
        if name not in known:
            raise InputError(f"read_stones: {name}", "no such option", expected=", ".join(known))
    reading = Reading(**options)
    if path.suffix.lower() == ".dxf" and not path.is_dir():
        for name, given in (("up", reading.up not in (None, "z")), ("scale", reading.scale != 1.0)):
            if given:
                found, expected = f"{name} = {getattr(reading, name)}", "neither up nor scale for a DXF"
                remedy = "Leave it out, and turn or scale the drawing in the CAD program."
                raise InputError(path.name, "a drawing is read as it is drawn", found=found, expected=expected, remedy=remedy)
        return read_drawing(path, unit_weight=unit_weight, **asdict(reading))
    weights_given = given_weights(unit_weight)
    source = read_source(path)
    findings = source.findings
    if source.flat and reading.thickness is None:
        findings.append(Finding("E24", "outlines in a plane", "a thickness"))
    bodies = parted(source)
    sizes = [size for item in bodies for size in item.sizes if not item.body.fixed]
    findings += coarse(source, float(np.median(sizes))) if sizes else []
    unit = _unit(source, float(np.median(sizes)) * reading.scale if sizes else None, reading)
    stones, share = [], np.ones(0)
    if unit is not None:
        depth = (reading.thickness or 1.0) if source.flat else None
        factor = schema.metres(unit) * reading.scale
        findings[:] = [finding.in_metres(factor) for finding in findings]
        stones = to_stones(bodies, factor, reading.up or source.up, depth, reading.repair, findings)
        stones = stones if reading.laid else _named_by_groups(stones)
        stones = distinct_stones(stones, reading.repair, findings)
        if reading.laid and not any(f.severity == "error" for f in findings):
            stones = laid_stones(stones, reading.laid, 1.0, findings)
        if all(stone.fixed for stone in stones) and not any(f.severity == "error" for f in findings):
            findings.append(Finding("E17", "no stones but ground" if stones else "no stones", "at least one closed body"))
        if stones and reading.joint is not None:
            stones, share = jointed(stones, reading.joint, reading.joint_mode, reading.mortar, 1.0, findings)
        remedy = f"Name the ground so, fix it in the program that made the file, {UNNAMED}"
        stones = supported(stones, reading.support, findings, GROUND, remedy) if stones else stones
        stones = uniquely_named(stones, findings)
        findings += slivers(stones) + (_lying(stones, source.up) if reading.up is None else [])
    weights, unweighted = unit_weights(stones, (), weights_given, findings)
    weights[: len(share)] *= share
    collected = Findings(path.name, tuple(finding.in_metres(1.0) for finding in findings), source.reader)
    if collected.errors or unit is None:
        raise FindingsError(collected, read_bodies(stones, 1.0))
    found = assembled(stones, "m", weights, collected)
    if not reading.laid:
        found = named_by_parts(found, [stone.layer for stone in stones], reading.kept_joint)
    return Drawing(found, (), (), collected, unit, unweighted)


def _lying(stones: Sequence[Stone], up: str) -> list[Finding]:
    """Return the finding of a building that seems to lie on its side: its ground is as high as all of it and as low."""
    ground, free = ([stone.points[:, 2] for stone in stones if stone.fixed == fixed] for fixed in (True, False))
    if not (ground and free):
        return []
    low, high = (edge(np.concatenate(free)) for edge in (np.min, np.max))
    if min(map(np.min, ground)) > low or max(map(np.max, ground)) < high:
        return []
    return [Finding("W45", f"{up} was taken to point up, and the ground reaches from below all stones to above them")]


def _named_by_groups(stones: list[Stone]) -> list[Stone]:
    """Return stones with the names of their groups as those of their walls, unless each stone has a group of its own."""
    groups = [stone.layer for stone in stones if not stone.fixed]
    return named_by_layers(stones) if len(set(groups)) < len(groups) else stones


def read_source(path: Path) -> Source:
    """Return the bodies of a file, or of all files in a folder, before anything is judged."""
    if path.is_dir():
        return _read_folder(path)
    reader = _reader_of(path)
    if reader is None:
        found = f'a file that ends in "{path.suffix}"' if path.suffix else "a file whose name has no suffix"
        raise refused(path, "import", "E01", found, expected=f"one of {FORMATS}", remedy="Export it in one of these formats.")
    source = reader(path)
    for text in {text for body in source.bodies for text in (body.name, body.material, *body.within)}:
        if halved(text):
            found, remedy = (
                f"the name {text!r} has half of a character, which no file can hold",
                "Export it again with another name.",
            )
            raise refused(path, source.reader, "E03", found, expected="names of whole characters", remedy=remedy)
    return source


def files_of(path: Path) -> tuple[Path, ...]:
    """Return all files that reading a file or a folder takes, those of them that are there."""
    if path.is_dir():
        if model := _lmgc90_model(path):
            return files_of(model)
        return tuple(sorted(file for file in path.iterdir() if file.is_file() and _reader_of(file)))
    beside = [path.with_name(name) for name in BESIDE] if path.name == BODIES else []
    return (path, *(file for file in beside if file.is_file()))


def digest_of(path: Path) -> str:
    """Return a digest of the files that a file of stones or a folder of them is read from."""
    digest = hashlib.sha256()
    for file in files_of(path):
        digest.update(os.fsencode(file.name) + b"\0" + file.read_bytes())
    return digest.hexdigest()


def _readable(name: str) -> str:
    """Return the name of a file as a text that can be written: what is no UTF-8 in it, as from an old disk, is a mark."""
    return os.fsencode(name).decode("utf-8", "replace")


def _reader_of(path: Path) -> Callable[[Path], Source] | None:
    reader = READERS.get(path.suffix.lower())
    if reader is None and path.suffix.lower() in (".dat", ".txt", "") and path.is_file():
        with path.open("rb") as stream:
            begin = stream.read(20_000)
        if re.search(rb"^\s*\$bdyty|^\s*RBDY[23]\s", begin, re.MULTILINE):
            return read_lmgc90
        if re.search(rb"^\s*(block\s+create\s+)?poly", begin, re.MULTILINE | re.IGNORECASE):
            return read_3dec
    return reader


def _lmgc90_model(folder: Path) -> Path | None:
    return next((place for place in (folder / BODIES, folder / "DATBOX" / BODIES) if place.is_file()), None)


def _read_folder(path: Path) -> Source:
    """Return the bodies of all files of a folder by the names of their files; of LMGC90's folder, its model."""
    if model := _lmgc90_model(path):
        return read_source(model)
    files = files_of(path)
    if not files:
        raise refused(path, "import", "E01", "a folder without a file that can be read", expected=f"files of {FORMATS}")
    sources = [read_source(file) for file in files]
    first = sources[0]
    if any((other.unit, other.up, other.flat) != (first.unit, first.up, first.flat) for other in sources):
        found = "files in several units or with several axes up"
        raise refused(path, "import", "E05", found, expected="one unit", remedy="Import them one by one, or convert them.")
    bodies: list[Body] = []
    for file, source in zip(files, sources, strict=True):
        single = len(source.bodies) == 1
        for body in source.bodies:
            stem = _readable(file.stem)
            name = stem if single or not body.name else f"{stem}/{body.name}"
            # The stones of one file are a part of the building, unless the file says more.
            within = body.within if single or any(body.within) else (stem,)
            bodies.append(replace(body, name=name, within=within))
    known = {file.name for file in files}
    others = sorted(_readable(file.name) for file in path.iterdir() if not file.name.startswith(".") and file.name not in known)
    findings = [finding for source in sources for finding in source.findings]
    if others:
        named = ", ".join(others[:MOST_NAMED]) + (f" and {len(others) - MOST_NAMED} more" if len(others) > MOST_NAMED else "")
        remedy = "Look whether a stone is among them: convert it to one of the formats, and import a drawing by itself."
        found = f"left out: {counted(len(others), 'file')} in other formats, {named}"
        findings.append(Finding("W18", found, remedy=remedy))
    return Source(bodies, first.reader, first.unit, first.up, findings, first.flat)


def _unit(source: Source, size: float | None, reading: Reading) -> str | None:
    """Return the name of the unit to read in, None when nothing tells; doubts join the findings.

    size: of the median stone or wall, units of the file.
    """
    findings, units, drawn = source.findings, reading.units, reading.drawn
    if units is not None:
        if source.unit not in (None, units):
            findings.append(Finding("W04", f'the file says "{source.unit}", read as "{units}" as asked'))
        if size is not None and not plausible(size * schema.metres(units), drawn):
            found = f"the median {drawn} measures {length_text(size * schema.metres(units))}, read in {units} as asked"
            findings.append(Finding("W05", found))
        return units
    declared = source.unit or "m"
    if size is None or plausible(size * schema.metres(declared), drawn):
        if source.unit is None and size is not None:
            found = f"the file says no unit: read in m, so that the median {drawn} measures {length_text(size)}"
            tries = likely_units(size, drawn, declared)
            findings.append(Finding("W45", found, remedy=f"Pass {tries}, or --up, if that is wrong." if tries else ""))
        return declared
    low, high = schema.PLAUSIBLE_SIZE[drawn]
    said = f'the file says "{source.unit}"' if source.unit else "the file says no unit; read in m"
    found = f"{said}, so the median {drawn} measures {length_text(size * schema.metres(declared))}"
    findings.append(Finding("E05" if source.unit else "E04", found, f"{low:g} to {high:g} m", unit_hint(size, drawn, declared)))
    return None
