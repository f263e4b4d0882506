"""The model of a case, a drawing or a mesh as a page to look at before any analysis."""

import shlex
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from churchpipe.config.case import Generated, read_variants
from churchpipe.config.plausible import questions
from churchpipe.dxf.reading import Reading
from churchpipe.errors import Extra, InputError
from churchpipe.findings import Findings, FindingsError
from churchpipe.meshes.reader import read_file
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.recognition.panels import fit_panels


def write_view(file: Path, page: Path, reading: Reading, changes: Sequence[str] = ()) -> None:
    """Write a page with the stones of a file in three dimensions, their names, the walls and their openings, and findings.

    reading: of a drawing or a mesh; a case file says itself how its drawing is read. changes: to keys of a case file.

    Raises
    ------
    InputError: the file cannot be taken. Of a drawing with errors the page is written all the same, with what could be read.
    """
    with Extra("a page to look at"):
        from churchpipe.report.findings_page import sound_stones, write_findings_page

    name, asked = shlex.quote(str(file)), []
    after = f"churchpipe run {name} runs the case."
    try:
        if file.suffix.lower() == ".toml":
            cases = read_variants(file, changes)
            asked, source = questions(cases), cases[0].source
            if isinstance(source, Generated):
                from churchpipe.stones.blocks import derive_blocks

                building = cases[0].building()
                write_findings_page(page, Findings(file.name), derive_blocks(building), after, building, asked)
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
    write_findings_page(page, read.findings, read.stones, after, _fitted(read.stones, reading.kept_joint), asked)


def _fitted(stones: Assemblage, joint: float | None) -> Building | None:
    """Return the walls that are recognised in drawn stones, None where there are none; joint: m, of mortar that stays open."""
    try:
        return fit_panels(stones, joint=joint).building()
    except InputError:
        return None
