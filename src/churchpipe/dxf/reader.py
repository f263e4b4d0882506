"""Drawings to stones: `read_drawing` for all that a drawing tells, `read_dxf` for the stones and the findings."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from churchpipe.dxf import schema
from churchpipe.dxf.carried import records_of
from churchpipe.dxf.duplicates import distinct_stones
from churchpipe.dxf.elevation import stones_of_traces
from churchpipe.dxf.jointing import jointed, unnamed_joints
from churchpipe.dxf.layer_parts import named_by_parts
from churchpipe.dxf.layer_walls import named_by_layers
from churchpipe.dxf.laying import laid_stones
from churchpipe.dxf.merging import with_merged_faces
from churchpipe.dxf.opening import open_document, without_collecting
from churchpipe.dxf.properties import decode_properties
from churchpipe.dxf.reading import Reading
from churchpipe.dxf.slivers import slivers
from churchpipe.dxf.stones import Stone, Survey, summary, survey
from churchpipe.dxf.units import declared_unit, find_unit
from churchpipe.errors import InputError
from churchpipe.findings import REMEDIES, Body, Finding, Findings, FindingsError
from churchpipe.model.arguments import finite, path_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.carried import LineLoad
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material, UnitWeight
from churchpipe.model.tie_bars import TieBar
from churchpipe.recognition.laying import LaidBond
from churchpipe.stones.ground import level_supports
from churchpipe.wording import counted

# Unit weight, N/m3, of stones of which nobody said it: weights are then relative, `Drawing.unweighted` names them.
RELATIVE_WEIGHT = 1.0


@dataclass(frozen=True, slots=True)
class Drawing:
    """What a drawing tells.

    stones: as drawn, in SI, in drawing order; materials, loads: stored in the document, in storage order, empty in drawings
    of other programs; ties, line_loads: drawn on their layers; findings: warnings only; units: name of the unit it was read
    in; unweighted: materials of free stones whose unit weight neither the drawing nor the caller gave:
    `stones.unit_weight` is 1 N/m3 there.
    """

    stones: Assemblage
    materials: tuple[Material, ...]
    loads: tuple[LoadCase, ...]
    findings: Findings
    units: str
    unweighted: tuple[str, ...] = ()
    ties: tuple[TieBar, ...] = ()
    line_loads: tuple[LineLoad, ...] = ()


def read_dxf(
    path: str | os.PathLike[str], *, unit_weight: float | Mapping[str, float] | None = None, **options: Any
) -> tuple[Assemblage, Findings]:
    """Read the stones of a DXF drawing, and what is wrong with it; errors as in `read_stones`.

    Parameters
    ----------
    path
        The drawing.
    unit_weight
        N/m3, for all stones or by material name; overrides what the drawing stores.
    options
        As in `read_stones`, but for up and scale.
    """
    given = list(unit_weight.values()) if isinstance(unit_weight, Mapping) else unit_weight
    if given is not None:
        doubt_argument("read_dxf: unit_weight", given, UnitWeight, "unit_weight")
    for size in ("course", "stone"):
        if options.get(size) is not None:
            doubt_argument(f"read_dxf: {size}", options[size], LaidBond, size)
    drawing = read_drawing(path, unit_weight=unit_weight, **options)
    return drawing.stones, drawing.findings


@without_collecting()
def read_drawing(
    path: str | os.PathLike[str], *, unit_weight: float | Mapping[str, float] | None = None, **options: Any
) -> Drawing:
    """Read a DXF drawing of stones: churchpipe DXF 1, plain solids, or outlines in a plane.

    Outlines are taken for stones when the drawing has no solids, or when their thickness is given.

    Parameters
    ----------
    path
        The file.
    unit_weight
        N/m3, for all stones or by material name; overrides what the drawing stores.
    options
        Fields of `churchpipe.dxf.reading.Reading`: units, repair, support, thickness, plane, joint, joint_mode, mortar,
        bond, course, stone.

    Raises
    ------
    FindingsError
        The drawing has errors; its `findings` list all of them, warnings included.
    InputError
        An argument that cannot be taken.
    """
    reading = Reading(**options)
    weights_given = given_weights(unit_weight)
    path = path_of("read_dxf: path", path)
    findings: list[Finding] = []
    document = open_document(path, findings)
    if document is None:
        raise FindingsError(Findings(path.name, tuple(findings)))
    findings += _check_version(document)
    materials, loads, wrong = decode_properties(list(document.header.custom_vars))
    findings += wrong
    declared = reading.units or declared_unit(document)
    metre = 1.0 / schema.metres(declared) if declared else 1.0
    gathered = survey(document, reading.repair)
    findings += gathered.findings
    stones = distinct_stones(_with_outlines(gathered, reading, metre, findings), reading.repair, findings)
    findings += summary(gathered)
    if all(stone.fixed for stone in stones) and not any(f.severity == "error" for f in findings):
        what = "no stones but ground in model space" if stones else "no stones in model space"
        remedy = "Draw the stones as inserts on CP-BLOCKS, as closed meshes, or as closed outlines."
        findings.append(Finding("E17", what, "at least one solid", remedy))
    unit = find_unit(document, stones, gathered.flawed, reading.units, reading.drawn, findings)
    share = np.ones(0)
    if stones and reading.joint is not None:
        stones, share = jointed(stones, reading.joint * metre, reading.joint_mode, reading.mortar, 1.0 / metre, findings)
    elif stones and gathered.traces and not reading.laid:
        findings += unnamed_joints(stones, 1.0 / metre)
    if reading.laid and unit and not any(f.severity == "error" for f in findings):
        stones = laid_stones(stones, reading.laid, schema.metres(unit), findings)
    stones = named_by_layers(stones)
    stones = supported(stones, reading.support, findings) if stones else stones
    stones = uniquely_named(stones, findings)
    findings += slivers(stones)
    weights, unweighted = unit_weights(stones, materials, weights_given, findings)
    weights[: len(share)] *= share
    ties, line_loads, wrong = records_of(gathered.carried, schema.metres(unit) if unit else 1.0)
    findings += wrong
    findings = [finding.in_metres(schema.metres(unit)) for finding in findings] if unit else findings
    collected = Findings(path.name, tuple(findings))
    if collected.errors or unit is None:
        raise FindingsError(collected, read_bodies(stones, schema.metres(unit) if unit else 1.0))
    assemblage = assembled(stones, unit, weights, collected)
    assemblage = named_by_parts(assemblage, [stone.layer for stone in stones], reading.kept_joint)
    return Drawing(assemblage, materials, loads, collected, unit, unweighted, ties, line_loads)


def _with_outlines(gathered: Survey, reading: Reading, metre: float, findings: list[Finding]) -> list[Stone]:
    """Return the solids and, where outlines are stones, those; lines that are none are counted as left out."""
    if reading.thickness is None and not all(stone.fixed for stone in gathered.stones):
        gathered.left_out.update(f"{trace.place.entity} (no solid)" for trace in gathered.traces)
        gathered.traces.clear()
        return gathered.stones
    thickness = None if reading.thickness is None else reading.thickness * metre
    drawn, left_out = stones_of_traces(
        gathered.traces, thickness=thickness, plane=reading.plane, cut=reading.bond is not None, findings=findings
    )
    gathered.left_out.update(left_out)
    return gathered.stones + drawn


def _check_version(document: Any) -> list[Finding]:
    text = document.header.custom_vars.get(schema.SCHEMA_PROPERTY)
    if text is None or text.strip() == str(schema.VERSION):
        return []
    found = f"the drawing is churchpipe DXF {text!r}"
    return [Finding("E20", found, f"version {schema.VERSION}", "Read it with the version of churchpipe that wrote it.")]


def supported(
    stones: list[Stone],
    support: str,
    findings: list[Finding],
    expected: str = "a stone or a 3DFACE on CP-SUPPORT",
    remedy: str = "Draw the ground on CP-SUPPORT",
) -> list[Stone]:
    """Return the stones with a support: their own, or one put under the lowest faces (`support` "base"); else a finding.

    expected, remedy: what a support is in the file, and what gives it one.
    """
    if any(stone.fixed for stone in stones):
        return stones
    plates, resting = level_supports([(stone.points, stone.faces) for stone in stones])
    named = ", ".join(stones[index].name for index in resting[:8]) + (f" and {len(resting) - 8} more" if resting[8:] else "")
    if not plates:
        found = "no support, and no stone has a level face at the lowest level to put one under"
        findings.append(Finding("E12", found, expected, f"{remedy}."))
        return stones
    place = stones[resting[0]].place
    if support == "base":
        resting_on = counted(len(resting), "stone stands", "stones stand")
        found = f"no support is drawn: one was put under the lowest faces, at z = {{}}; {resting_on} on it ({named})"
        # Turning a plan upright leaves a trace of rounding in a level of zero.
        low = round(float(plates[0][0][:, 2].max()), 9)
        findings.append(place.finding("W12", found, lengths=(low,)))
        return [*stones, *(Stone(*plate, True, place, f"ground-{n + 1}", "default") for n, plate in enumerate(plates))]
    remedy = f"{remedy}, or pass --support base to put a support under the lowest faces."
    findings.append(place.finding("E12", f"no support; the lowest stones are {named}", expected=expected, remedy=remedy))
    return stones


def uniquely_named(stones: list[Stone], findings: list[Finding]) -> list[Stone]:
    """Give stones that share an ID (a copy in the CAD program keeps it) names of their own, with a warning."""
    used = {stone.name for stone in stones}
    seen: set[str] = set()
    out: list[Stone] = []
    for stone in stones:
        name, number = stone.name, 1
        while name in seen or (name != stone.name and name in used):
            number += 1
            name = f"{stone.name}~{number}"
        if name != stone.name:
            findings.append(stone.place.finding("W15", f'the ID "{stone.name}" is taken; "{name}" is used'))
        seen.add(name)
        out.append(replace(stone, name=name) if name != stone.name else stone)
    return out


def given_weights(given: object) -> float | dict[str, float] | None:
    """Return the argument `unit_weight`, its numbers checked."""
    if given is None:
        return None
    if not isinstance(given, Mapping):
        return finite("unit weight", given)
    table = cast("Mapping[Any, object]", given)
    return {str(name): finite(f"unit weight of {name!r}", value) for name, value in table.items()}


def unit_weights(
    stones: Sequence[Stone],
    materials: Sequence[Material],
    given: float | Mapping[str, float] | None,
    findings: list[Finding],
) -> tuple[FloatArray, tuple[str, ...]]:
    """Return the unit weight of each stone (nb,), N/m3, and the materials of free stones that have none."""
    table = {material.name: material.unit_weight for material in materials}
    names = {stone.material for stone in stones}
    if isinstance(given, Mapping):
        table |= given
    elif given is not None:
        table |= dict.fromkeys(names, given)
    for name in {stone.material for stone in stones if not stone.fixed} & table.keys():
        if not 0 < table[name] < np.inf:
            raise InputError(f"unit weight of {name!r}", "out of range", found=table[name], expected="> 0 N/m3")
    unweighted = tuple(dict.fromkeys(s.material for s in stones if not s.fixed and s.material not in table))
    for name in unweighted:
        count = sum(stone.material == name and not stone.fixed for stone in stones)
        found = f'no unit weight for the material "{name}" of {counted(count, "stone")}'
        findings.append(Finding("W19", found, remedy=f"{REMEDIES['W19']} Until then weights are relative."))
    fallback = {True: 0.0, False: RELATIVE_WEIGHT}
    return np.array([table.get(stone.material, fallback[stone.fixed]) for stone in stones]), unweighted


def read_bodies(stones: Sequence[Stone], unit: float) -> tuple[Body, ...]:
    """Return what was read of a file that has errors; unit: of its coordinates, m."""
    return tuple(Body(stone.name, stone.points * unit, stone.faces, stone.fixed) for stone in stones)


def assembled(stones: Sequence[Stone], unit: str, weights: FloatArray, findings: Findings) -> Assemblage:
    """Return stones in a unit as an assemblage, the coplanar faces of each merged; what keeps it from being one joins the
    findings of a `FindingsError`."""
    factor = schema.metres(unit)
    stones = with_merged_faces([replace(stone, points=stone.points * factor) for stone in stones])
    try:
        return Assemblage.from_polyhedra(
            [(stone.points, stone.faces) for stone in stones],
            weights,
            fixed=[index for index, stone in enumerate(stones) if stone.fixed],
            material=[stone.material for stone in stones],
            panel=[stone.panel for stone in stones],
            course=[stone.course for stone in stones],
            butts=[stone.butts for stone in stones],
            block_id=[stone.name for stone in stones],
        )
    except InputError as error:
        raise FindingsError(replace(findings, items=(*findings.items, Finding("E10", str(error).rstrip("."))))) from error
