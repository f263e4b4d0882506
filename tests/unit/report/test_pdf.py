"""The printed report, and what is said where the library that prints fails."""

from pathlib import Path

import pytest
import weasyprint

from churchpipe.errors import InputError
from churchpipe.report.pdf import write_pdf


def test_a_report_is_printed(tmp_path: Path) -> None:
    report, pdf = tmp_path / "report.html", tmp_path / "report.pdf"
    report.write_text("<p>One page.</p>")
    assert write_pdf(report, pdf) == 1
    assert pdf.read_bytes().startswith(b"%PDF")


def test_a_failure_of_the_library_that_prints_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def render(_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(weasyprint.HTML, "render", render)
    report, pdf = tmp_path / "report.html", tmp_path / "report.pdf"
    report.write_text("<p>One page.</p>")
    with pytest.raises(InputError, match="the library that prints failed; found AssertionError"):
        write_pdf(report, pdf)
    assert not pdf.exists()
