"""The attributes of stones: texts that people and other programs edit, so each is checked."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from churchpipe.dxf import schema
from churchpipe.findings import Finding, Place

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")


@dataclass(frozen=True, slots=True)
class Labels:
    """What the attributes of one stone say, and what is wrong with them."""

    name: str
    material: str
    panel: str
    course: int
    butts: bool
    findings: tuple[Finding, ...]


def read_labels(
    texts: Mapping[str, str],
    constants: Mapping[str, str],
    defaults: Mapping[str, str],
    place: Place,
    *,
    volume: float,
    required: bool,
    repair: bool,
) -> Labels:
    """Read the attributes of an insert.

    texts: tag -> text on the insert; constants, defaults: those of the definition; volume: of the placed body, drawing units
    cubed; required: report a missing ID or MATERIAL (W13); repair: recompute what cannot be understood (W07) in place of E07.
    """
    findings: list[Finding] = []
    material = texts.get(schema.MATERIAL, constants.get(schema.MATERIAL))
    instead = defaults.get(schema.MATERIAL) or "default"
    name = texts.get(schema.ID) or constants.get(schema.ID)
    if required and not name:
        findings.append(place.finding("W13", f"no attribute ID; its handle {place.handle} is used"))
    if required and material is None:
        findings.append(place.finding("W13", f'no attribute MATERIAL; "{instead}" is used'))
    if schema.VOLUME in texts and schema.VOLUME not in constants:
        findings += check_volume(texts[schema.VOLUME], volume, place, repair)
    course, wrong = _course(texts.get(schema.COURSE, constants.get(schema.COURSE, "")), place, repair)
    panel = texts.get(schema.PANEL_NAME, constants.get(schema.PANEL_NAME, ""))
    butts, doubtful = _butts(texts.get(schema.BUTTS, constants.get(schema.BUTTS, "")), place, repair)
    material = instead if material is None else material
    return Labels(name or place.handle, material, panel, course, butts, (*findings, *wrong, *doubtful))


def check_volume(text: str, volume: float, place: Place, repair: bool) -> list[Finding]:
    """Compare the text of VOLUME with the volume of the faces; both in drawing units cubed."""
    found = f'attribute VOLUME = "{text}"'
    if not NUMBER.fullmatch(text):
        if repair:
            return [place.finding("W07", f"{found}: recomputed from the faces: {volume:.6g}")]
        remedy = "Correct it, or pass --repair to recompute the volume from the faces."
        return [place.finding("E07", found, expected="a number with a decimal point", remedy=remedy)]
    if abs(float(text) - volume) > schema.VOLUME_TOLERANCE * volume:
        return [place.finding("W14", found, expected=f"{volume:.6g} from the faces, which is used")]
    return []


def _butts(text: str, place: Place, repair: bool) -> tuple[bool, list[Finding]]:
    if text in ("", "0", "1"):
        return text == "1", []
    found = f'attribute BUTTS = "{text}"'
    if repair:
        return True, [place.finding("W07", f"{found}: taken as 1, without mortar")]
    remedy = "Correct it, or pass --repair to take it as 1."
    return True, [place.finding("E07", found, expected="1, without mortar to the walls beside it, or 0", remedy=remedy)]


def _course(text: str, place: Place, repair: bool) -> tuple[int, list[Finding]]:
    if text == "":
        return -1, []
    if text.isascii() and text.isdigit() and len(text) < 10:
        return int(text), []
    found = f'attribute COURSE = "{text}"'
    if repair:
        return -1, [place.finding("W07", f"{found}: left out")]
    remedy = "Correct it, or pass --repair to leave it out."
    return -1, [place.finding("E07", found, expected="a whole number, 0 at the bottom", remedy=remedy)]
