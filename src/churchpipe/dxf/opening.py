"""From a file on disk to an ezdxf document, without believing a file that lost something on the way."""

import codecs
import gc
import logging
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ezdxf import filemanagement

from churchpipe.dxf.tags import COUNTED, Entity, damage, entities
from churchpipe.findings import Finding

# How bytes that are no text in the encoding of the file are read: many programs write the one of their Windows.
WESTERN = "churchpipe.western"

# Without a handler of its own ezdxf's log would land on the user's screen; what matters in it becomes a finding.
logging.getLogger("ezdxf").addHandler(logging.NullHandler())

BINARY = b"AutoCAD Binary DXF"
_END = re.compile(rb"\n[ \t]*0[ \t]*\r?\n[ \t]*EOF\s*$")
_START = re.compile(rb"^[ \t]*0[ \t]*\r?\n[ \t]*SECTION[ \t]*\r?$", re.MULTILINE)


@contextmanager
def without_collecting() -> Iterator[None]:
    """Make many small objects that all stay: to look for garbage among them again and again takes a third of the time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


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
    drawn = entities(data) if text else []
    findings += filter(None, map(damage, drawn))
    return _load(path, drawn, findings)


def _load(path: Path, drawn: list[Entity], findings: list[Finding]) -> Any | None:
    # A parser of foreign files may fail in any way; whatever it is, the file is at fault and the user gets a finding.
    # ezdxf could recover more, but it turns numbers it does not understand into 0 and says so to nobody.
    foreign: list[str] = []
    codecs.register_error(WESTERN, lambda error: _western(error, foreign))
    try:
        document = filemanagement.readfile(path, errors=WESTERN)
    except Exception as error:
        remedy = "Run AUDIT in the CAD program and export the drawing again."
        return _fail(findings, "E03", f"the file is damaged ({_first_line(error)})", remedy)
    if foreign:
        among = ", ".join(sorted(set(foreign))[:8])
        found = f"{len(foreign)} bytes are no text in {document.encoding}, the encoding of the file; taken as Western European"
        findings.append(Finding("W46", f"{found} they are {among}"))
    there = Counter(entity.kind for entity in drawn if entity.kind.encode() in COUNTED)
    # Of two with one handle the parser keeps one; of what it keeps not all stands somewhere.
    read = Counter(_placed(document)) & Counter(entity.dxftype() for entity in document.entitydb.values() if entity.is_alive)
    lost = [f"{count - read[kind]} of {count} {kind}" for kind, count in there.items() if read[kind] < count]
    remedy = "Run AUDIT in the CAD program and export the drawing again."
    if lost:
        return _fail(findings, "E03", f"entities were lost on reading: {', '.join(lost)}", remedy)
    if document.modelspace().block_record_handle != document.blocks.get("*Model_Space").block_record_handle:
        return _fail(findings, "E03", "the layout of the model shows another block than *Model_Space", remedy)
    return document


def _placed(document: Any) -> Iterator[str]:
    """Yield the kinds of the entities that stand in blocks and layouts."""
    for block in document.blocks:
        yield "BLOCK"
        for entity in block:
            kind: str = entity.dxftype()
            yield kind
            parts: Sequence[Any] = entity.attribs if kind == "INSERT" else entity.vertices if kind == "POLYLINE" else ()
            yield from (part.dxftype() for part in parts)


def _western(error: UnicodeError, foreign: list[str]) -> tuple[str, int]:
    """Return what the bytes of a decoding error are in Windows' Western European, and note it."""
    if not isinstance(error, UnicodeDecodeError):
        raise error
    text = error.object[error.start : error.end].decode("cp1252", errors="replace")
    foreign += text
    return text, error.end


def _fail(findings: list[Finding], code: str, found: str, remedy: str, expected: str = "") -> None:
    findings.append(Finding(code, found, expected, remedy))


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
