"""findings.html: numbered findings and a picture of the stones, with and without errors."""

import json
import re
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from churchpipe.config.shell_table import ShellTable
from churchpipe.dxf.reader import read_drawing
from churchpipe.dxf.reading import Reading
from churchpipe.findings import FindingsError
from churchpipe.importing import cost_words, import_drawing, record_findings
from damaged_drawings import SAMPLES

BRICKS = [[(0, 0), (250, 0), (250, 65), (0, 65)], [(0, 65), (250, 65), (250, 130), (0, 130)]]


def drawing(path: Path, *, twice: bool) -> Path:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 4
    for outline in BRICKS + BRICKS[1:] * twice:
        document.modelspace().add_lwpolyline(outline, close=True)
    document.saveas(path)
    return path


def viewer_data(page: str) -> dict:
    return json.loads(re.search(r'<script id="viewer-data" type="application/json">(.*?)</script>', page, re.DOTALL)[1])


def test_errors_are_numbered_marked_and_end_in_what_to_do(tmp_path: Path) -> None:
    path = drawing(tmp_path / "a.dxf", twice=True)
    with pytest.raises(FindingsError) as caught:
        read_drawing(path, thickness=0.12, support="base", unit_weight=18e3)
    record_findings(caught.value.findings, tmp_path, "mm", caught.value.bodies, "Mend it.")
    page = (tmp_path / "findings.html").read_text()
    assert '<details class="finding error" open>' in page
    assert "<strong>1. E11</strong>" in page
    assert "Delete one of the two, or pass --repair." in page
    data = viewer_data(page)
    assert data["free"] == 3
    (mark,) = [mark for mark in data["marks"] if mark["label"].startswith("E11")]
    assert data["marks"][-1] == mark, "an error lies above the warnings of its place"
    # Drawn in x-y, stood up: the second brick begins 65 mm above the foot.
    assert np.allclose(mark["place"][2], 0.065, atol=1e-6)


def test_an_import_shows_its_stones_and_says_whether_the_shell_matches(tmp_path: Path) -> None:
    done = import_drawing(SAMPLES / "s5.dxf", tmp_path / "s5", Reading())
    page = (tmp_path / "s5" / "findings.html").read_text()
    assert viewer_data(page)["free"] == done.stones
    assert "churchpipe run" in page
    assert "Nothing to report." in page
    assert "The gate passed" in done.shell
    times = r"Its \d+ elements take some \d+ s a load, the stones some \d+ s, and without dilatancy, as the case asks too"
    assert re.search(rf"{times}, some \d+ s; --set shell=false leaves", done.shell)


def test_what_stones_take_without_dilatancy_follows_from_their_number() -> None:
    limit = ShellTable({"analyses": ["limit"]}, "")
    assert "the stones some 1 s, and without dilatancy, as the case asks too, some 1 s;" in cost_words(114, 14, limit)
    assert "the stones some 2 s, and without dilatancy, as the case asks too, some 200 s." in cost_words(900, 2000, limit)
