"""From a file on disk to an ezdxf document, without believing a file that lost something on the way."""

import codecs
import gc
import logging
import re
from collections import Counter
from pathlib import Path
from typing import Any

from ezdxf import filemanagement

from churchpipe.findings import Finding

# Without a handler of its own ezdxf's log would land on the user's screen; what matters in it becomes a finding.
logging.getLogger("ezdxf").addHandler(logging.NullHandler())

BINARY = b"AutoCAD Binary DXF"
COUNTED = ("INSERT", "ATTRIB", "ATTDEF", "POINT", "MESH", "POLYLINE", "VERTEX", "3DFACE", "3DSOLID", "BODY", "BLOCK")
_ENTITY = re.compile(rb"^[ \t]*0[ \t]*\r?\n[ \t]*(" + "|".join(COUNTED).encode() + rb")[ \t]*\r?$", re.MULTILINE)
_END = re.compile(rb"\n[ \t]*0[ \t]*\r?\n[ \t]*EOF\s*$")
_START = re.compile(rb"^[ \t]*0[ \t]*\r?\n[ \t]*SECTION[ \t]*\r?$", re.MULTILINE)


def open_document(path: Path, findings: list[Finding]) -> Any | None:
    """Return the ezdxf document of a file, or None with the reason added to `findings`."""
    try:
        data = path.read_bytes()
    except OSError as error:
        return _fail(findings, "E01", f"the file cannot be read ({error.strerror or error})", "Check the path and the rights.")
    if re.match(rb"AC1\d\d\d|AC10\.|AC2\.10|MC0\.0", data):
        return _fail(findings, "E02", "this is a DWG", "Save it as DXF (R2010 or newer) in the CAD program.", "a DXF file")
    if not data.strip(b"\0 \t\r\n"):
        return _fail(findings, "E01", "the file is empty", "Export the drawing again.", "a DXF file")
    if data.startswith((codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        found = "the file begins with a byte order mark, which a text editor put there"
        return _fail(findings, "E03", found, "Export the drawing again, or save it without (UTF-8 without BOM).")
    text = not data.startswith(BINARY)
    if text and not _START.search(data):
        return _fail(findings, "E01", "this is not a DXF file", "Save the drawing as DXF (R2010 or newer).", "0 SECTION")
    if text and not _END.search(data):
        return _fail(findings, "E03", "the file is truncated: its end is missing", "Export it again.", "0 EOF as the last line")
    for handle in _flattened(data) if text else ():
        remedy = "Scale it to its height again, or delete it."
        found = "the insert has the scale 0 along an axis"
        findings.append(Finding("E10", found, "a scale that leaves a body", remedy, "INSERT", handle))
    drawn = Counter(match[1].decode() for match in _ENTITY.finditer(data)) if text else None
    return _load(path, drawn, findings)


def _load(path: Path, drawn: Counter[str] | None, findings: list[Finding]) -> Any | None:
    # A parser of foreign files may fail in any way; whatever it is, the file is at fault and the user gets a finding.
    # ezdxf could recover more, but it turns numbers it does not understand into 0 and says so to nobody.
    # Its many small objects all stay: looking for garbage among them again and again would take a third of the time.
    collecting = gc.isenabled()
    gc.disable()
    try:
        document = filemanagement.readfile(path)
    except Exception as error:
        remedy = "Run AUDIT in the CAD program and export the drawing again."
        return _fail(findings, "E03", f"the file is damaged ({_first_line(error)})", remedy)
    finally:
        if collecting:
            gc.enable()
    if drawn is not None:
        read = Counter(entity.dxftype() for entity in document.entitydb.values() if entity.is_alive)
        lost = [f"{count - read[kind]} of {count} {kind}" for kind, count in drawn.items() if read[kind] < count]
        if lost:
            remedy = "Run AUDIT in the CAD program and export the drawing again."
            return _fail(findings, "E03", f"entities were lost on reading: {', '.join(lost)}", remedy)
    return document


def _flattened(data: bytes) -> list[str]:
    """Return the handles of inserts with a scale of 0, which ezdxf reads as 1."""
    out: list[str] = []
    for match in _ENTITY.finditer(data):
        if match[1] != b"INSERT":
            continue
        tags: dict[bytes, bytes] = {}
        lines = iter(data[match.end() + 1 : match.end() + 4000].splitlines())
        for code, value in zip(lines, lines, strict=False):
            if code.strip() == b"0":
                break
            tags[code.strip()] = value.strip()
        if any(re.fullmatch(rb"[+-]?0*\.?0*([eE].*)?", tags.get(code, b"1")) for code in (b"41", b"42", b"43")):
            out.append(tags.get(b"5", b"").decode(errors="replace"))
    return out


def _fail(findings: list[Finding], code: str, found: str, remedy: str, expected: str = "") -> None:
    findings.append(Finding(code, found, expected, remedy))


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
