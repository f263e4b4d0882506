"""The model of a case, a drawing or a mesh as a page to look at before any analysis."""

import shlex
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from churchpipe.config.carries import placed
from churchpipe.config.case import Case, Generated, read_variants
from churchpipe.config.plausible import questions
from churchpipe.config.soil_questions import end_questions
from churchpipe.dxf.reading import Reading
from churchpipe.errors import Extra, InputError
from churchpipe.findings import Findings, FindingsError
from churchpipe.meshes.reader import read_file
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.model.placed_loads import Applied
from churchpipe.recognition.panels import fit_panels, wall_names
from churchpipe.stones.ring_beams import add_beams


def write_view(file: Path, page: Path, reading: Reading, changes: Sequence[str] = ()) -> None:
    """Write a page with the stones of a file in three dimensions, their names, the walls and their openings, and findings.

    Of a case, also with what the building carries and its ties.

    reading: of a drawing or a mesh; a case file says itself how its drawing is read. changes: to keys of a case file.

    Raises
    ------
    InputError: the file cannot be taken. Of a drawing with errors the page is written all the same, with what could be read.
    """
    with Extra("a page to look at"):
        from churchpipe.report.findings_page import sound_stones, write_findings_page

    name, asked, cases = shlex.quote(str(file)), [], []
    after = f"churchpipe run {name} runs the case."
    try:
        if file.suffix.lower() == ".toml":
            cases = read_variants(file, changes)
            asked, source = questions(cases), cases[0].source
            if isinstance(source, Generated):
                from churchpipe.config.laid_stones import laid_stones

                building = cases[0].building()
                stones = laid_stones(cases[0], building)
                applied = _applied(cases, stones)
                asked += end_questions(cases[0].carries, stones)
                write_findings_page(page, Findings(file.name), stones, after, building, asked, applied)
                return
            weights = {material.name: material.unit_weight for material in cases[0].materials}
            reading = source.reading
            read = read_file(source.path, unit_weight=weights, **asdict(reading))
        else:
            after = f"churchpipe import {name}, with the same options, makes a case of it."
            read = read_file(file, **asdict(reading))
    except FindingsError as error:
        write_findings_page(page, error.findings, sound_stones(error.bodies), "Mend what the errors say.")
        raise
    fitted, stones, applied = _fitted(read.stones, reading.kept_joint), read.stones, []
    if cases and (cases[0].carries or cases[0].ring_beams):
        stones = replace(stones, panel=wall_names(stones, reading.kept_joint))
        cases[0].check_applied(stones)
        stones = add_beams(stones, cases[0].ring_beams, weights)
        applied = _applied(cases, stones)
        asked += end_questions(cases[0].carries, stones)
    write_findings_page(page, read.findings, stones, after, fitted, asked, applied)


def _applied(cases: Sequence[Case], stones: Assemblage) -> list[Applied]:
    """Return what the stones of the first case carry in it, and in each variant of the same stones."""
    of_stones = (cases[0].source, cases[0].buttresses, cases[0].ring_beams)
    alike = [case for case in cases if (case.source, case.buttresses, case.ring_beams) == of_stones]
    known: list[dict[str, Any]] = []
    found: list[Applied] = []
    for case in alike:
        if case.carries and (settings := case.carries.settings()) not in known:
            known.append(settings)
            try:
                found.append(placed(case.carries, stones))
            except InputError as error:
                raise case.located(error.at(f"{case.path}: {error.where}")) from error
    return found


def _fitted(stones: Assemblage, joint: float | None) -> Building | None:
    """Return the walls that are recognised in drawn stones, None where there are none; joint: m, of mortar that stays open."""
    try:
        return fit_panels(stones, joint=joint).building()
    except InputError:
        return None
