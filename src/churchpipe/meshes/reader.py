"""Files of stones in any format: `read_stones` for stones and findings, `read_file` for all that a file tells."""

import importlib
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Final, Literal

import numpy as np

from churchpipe.dxf import schema
from churchpipe.dxf.duplicates import distinct_stones
from churchpipe.dxf.jointing import jointed
from churchpipe.dxf.reader import Drawing, assembled, given_weights, read_drawing, supported, uniquely_named, unit_weights
from churchpipe.dxf.reading import ElevationPlane, JointMode, Mortar, Reading
from churchpipe.dxf.units import length_text, plausible, unit_hint
from churchpipe.errors import InputError
from churchpipe.findings import Finding, Findings, FindingsError
from churchpipe.meshes.solids import AXES, dissolved, parted, to_stones
from churchpipe.meshes.source import Body, Source, Up, refused
from churchpipe.model.arguments import one_of, path_of, positive
from churchpipe.model.assemblage import Assemblage

# Suffix -> module of this package and its function.
READERS: Final = {
    ".obj": ("obj", "read_obj"),
    ".stl": ("stl", "read_stl"),
    ".ply": ("ply", "read_ply"),
    ".glb": ("gltf", "read_gltf"),
    ".gltf": ("gltf", "read_gltf"),
    ".3mf": ("threemf", "read_3mf"),
    ".3dm": ("rhino", "read_3dm"),
    ".json": ("compas", "read_compas"),
    ".3ddat": ("threedec", "read_3dec"),
    ".3dec": ("threedec", "read_3dec"),
}
BODIES = "BODIES.DAT"
FORMATS = "DXF, OBJ, STL, PLY, GLB, 3MF, 3DM, COMPAS JSON, LMGC90 BODIES.DAT, 3DEC"
GROUND = "a body that the file fixes, or one named ground, support or foundation"


def read_stones(
    path: str | os.PathLike[str],
    *,
    units: str | None = None,
    thickness: float | None = None,
    repair: bool = False,
    support: Literal["drawn", "base"] = "drawn",
    unit_weight: float | Mapping[str, float] | None = None,
    up: Up | None = None,
    scale: float = 1.0,
    plane: ElevationPlane = "xz",
    joint: float | None = None,
    joint_mode: JointMode = "grow",
    mortar: Mortar = "counted",
) -> tuple[Assemblage, Findings]:
    """Read the stones of a file in any format; parameters and errors as in `read_file`."""
    read = read_file(
        path,
        units=units,
        thickness=thickness,
        repair=repair,
        support=support,
        unit_weight=unit_weight,
        up=up,
        scale=scale,
        plane=plane,
        joint=joint,
        joint_mode=joint_mode,
        mortar=mortar,
    )
    return read.stones, read.findings


def read_file(
    path: str | os.PathLike[str],
    *,
    units: str | None = None,
    thickness: float | None = None,
    repair: bool = False,
    support: Literal["drawn", "base"] = "drawn",
    unit_weight: float | Mapping[str, float] | None = None,
    up: Up | None = None,
    scale: float = 1.0,
    plane: ElevationPlane = "xz",
    joint: float | None = None,
    joint_mode: JointMode = "grow",
    mortar: Mortar = "counted",
) -> Drawing:
    """Read a file of stones: DXF, OBJ, STL, PLY, GLB, 3MF, Rhino 3DM, COMPAS JSON, LMGC90, 3DEC, or a folder of them.

    Parameters
    ----------
    units: read the file in this unit ("m", "mm", "cm", "in", ...) whatever it says itself.
    thickness: m, of what is drawn as outlines in a plane.
    plane: "xz" takes the x-y of a drawing of outlines for the elevation x-z, "xy" leaves it lying, a plan (DXF alone).
    joint, joint_mode, mortar: joints left open between the stones, as in `churchpipe.dxf.reading.Reading`.
    repair: mend what may change a shape (faces given twice, vertices that nearly meet, corners on edges, holes of one face) and
        drop stones drawn twice; each repair is a warning.
    support: "base" puts a fixed support under the lowest faces when the file has no ground; all its stones stay free.
    unit_weight: N/m3, for all stones or by material name.
    up: the axis of the file that points up; None for what the format says, z where it says nothing.
    scale: sizes in the building over sizes in the file, for models at scale.

    Raises
    ------
    FindingsError: the file has errors; its `findings` list all of them, warnings included.
    InputError: an argument is no unit, no support, no axis or no number.
    """
    path = path_of("read_stones: path", path)
    reading = Reading(units, repair, support, thickness, plane, joint, joint_mode, mortar)
    if up is not None:
        one_of("up", up, *AXES)
    positive("scale", scale)
    if path.suffix.lower() == ".dxf":
        _refuse_for_dxf(up, scale)
        return read_drawing(path, unit_weight=unit_weight, **asdict(reading))
    weights_given = given_weights(unit_weight)
    source = read_source(path)
    findings = source.findings
    if source.flat and thickness is None:
        remedy = "Pass --thickness with the depth of the stones, such as 0.3m."
        findings.append(Finding("E24", "outlines in a plane", "a thickness", remedy))
    bodies = parted(source)
    sizes = [size for item in bodies for size in item.sizes if not item.body.fixed]
    unit = _unit(source, float(np.median(sizes)) * scale if sizes else None, units)
    stones, share = [], np.ones(0)
    if unit is not None:
        depth = (thickness or 1.0) if source.flat else None
        factor = schema.metres(unit) * scale
        findings[:] = [finding.in_metres(factor) for finding in findings]
        stones = to_stones(bodies, factor, up or source.up, depth, repair, findings)
        stones = distinct_stones(stones, repair, findings)
        if all(stone.fixed for stone in stones) and not any(f.severity == "error" for f in findings):
            findings.append(Finding("E17", "no stones but ground" if stones else "no stones", "at least one closed body"))
        if stones and joint is not None:
            stones, share = jointed(stones, joint, joint_mode, mortar, 1.0, findings)
        remedy = "Name the ground so, fix it in the program that made the file"
        stones = supported(stones, support, findings, GROUND, remedy) if stones else stones
        stones = uniquely_named(stones, findings)
    weights, unweighted = unit_weights(stones, (), weights_given, findings)
    weights[: len(share)] *= share
    collected = Findings(path.name, tuple(finding.in_metres(1.0) for finding in findings), source.reader)
    if collected.errors or unit is None:
        raise FindingsError(collected)
    merged = dissolved(stones)
    stones = [replace(stone, points=points, faces=tuple(faces)) for stone, (points, faces) in zip(stones, merged, strict=True)]
    return Drawing(assembled(stones, "m", weights, collected), (), (), collected, unit, unweighted)


def read_source(path: Path) -> Source:
    """Return the bodies of a file, or of all files in a folder, before anything is judged."""
    if path.is_dir():
        return _read_folder(path)
    reader = _reader_of(path)
    if reader is None:
        found = f'a file that ends in "{path.suffix}"' if path.suffix else "a file whose name has no suffix"
        raise refused(path, "import", "E01", found, expected=f"one of {FORMATS}", remedy="Export it in one of these formats.")
    return reader(path)


def files_of(path: Path) -> tuple[Path, ...]:
    """Return all files that reading a file or a folder takes."""
    return (path,) if path.suffix.lower() == ".dxf" else read_source(path).files


def _refuse_for_dxf(up: str | None, scale: float) -> None:
    for name, given in (("up", up not in (None, "z")), ("scale", scale != 1.0)):
        if given:
            raise InputError(name, "drawings are read as they are drawn", expected="no such option for a DXF")


def _reader_of(path: Path) -> Callable[[Path], Source] | None:
    place = READERS.get(path.suffix.lower())
    if place is None and path.suffix.lower() in (".dat", ".txt", "") and path.is_file():
        with path.open("rb") as stream:
            begin = stream.read(20_000)
        if re.search(rb"^\s*\$bdyty|^\s*RBDY[23]\s", begin, re.MULTILINE):
            place = ("lmgc90", "read_lmgc90")
        elif re.search(rb"^\s*(block\s+create\s+)?poly", begin, re.MULTILINE | re.IGNORECASE):
            place = ("threedec", "read_3dec")
    if place is None:
        return None
    return getattr(importlib.import_module(f"churchpipe.meshes.{place[0]}"), place[1])


def _read_folder(path: Path) -> Source:
    """Return the bodies of all files of a folder by the names of their files; of LMGC90's folder, its model."""
    for place in (path / BODIES, path / "DATBOX" / BODIES):
        if place.is_file():
            return read_source(place)
    files = sorted(file for file in path.iterdir() if file.is_file() and _reader_of(file) and file.suffix.lower() != ".dxf")
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
            name = file.stem if single or not body.name else f"{file.stem}/{body.name}"
            bodies.append(replace(body, name=name))
    others = len([file for file in path.iterdir() if not file.name.startswith(".")]) - len(files)
    findings = [finding for source in sources for finding in source.findings]
    findings += [Finding("W18", f"left out: {others} files in other formats")] if others else []
    return Source(bodies, first.reader, first.unit, first.up, tuple(f for s in sources for f in s.files), findings, first.flat)


def _unit(source: Source, size: float | None, units: str | None) -> str | None:
    """Return the name of the unit to read in, None when nothing tells; doubts join the findings.

    size: of the median stone, units of the file.
    """
    findings = source.findings
    if units is not None:
        if source.unit not in (None, units):
            findings.append(Finding("W04", f'the file says "{source.unit}", read as "{units}" as asked'))
        if size is not None and not plausible(size * schema.metres(units)):
            found = f"the median stone measures {length_text(size * schema.metres(units))}, read in {units} as asked"
            findings.append(Finding("W05", found))
        return units
    declared = source.unit or "m"
    if size is None or plausible(size * schema.metres(declared)):
        if source.unit is None and size is not None:
            found = f"the file says no unit: read in m, so that the median stone measures {length_text(size)}"
            findings.append(Finding("W45", found, remedy="Pass --units if that is wrong."))
        return declared
    low, high = schema.PLAUSIBLE_SIZE
    said = f'the file says "{source.unit}"' if source.unit else "the file says no unit; read in m"
    found = f"{said}, so the median stone measures {length_text(size * schema.metres(declared))}"
    findings.append(Finding("E05" if source.unit else "E04", found, f"{low:g} to {high:g} m", unit_hint(size, declared)))
    return None
