"""The printed report, and what is said where the library that prints fails."""

from pathlib import Path

import pytest
import weasyprint

from churchpipe.errors import InputError
from churchpipe.report.pdf import write_pdf
from churchpipe.report.plots import new_panels, svg_of_panels
from churchpipe.report.viewer import static_text


def test_a_report_is_printed(tmp_path: Path) -> None:
    report, pdf = tmp_path / "report.html", tmp_path / "report.pdf"
    report.write_text("<p>One page.</p>")
    assert write_pdf(report, pdf) == 1
    assert pdf.read_bytes().startswith(b"%PDF")


def test_many_plots_share_a_page_with_their_heading(tmp_path: Path) -> None:
    plots = svg_of_panels(*new_panels(6, (3.1, 2.8)))
    figure = f'<figure class="plot wide">{plots}<figcaption>{"What they show. " * 30}</figcaption></figure>'
    text = f"<style>{static_text('report.css')}</style><h2>Strength</h2>{figure}"
    report = tmp_path / "report.html"
    report.write_text(text, encoding="utf-8")
    assert write_pdf(report, tmp_path / "report.pdf") == 1


def test_a_failure_of_the_library_that_prints_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def render(_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(weasyprint.HTML, "render", render)
    report, pdf = tmp_path / "report.html", tmp_path / "report.pdf"
    report.write_text("<p>One page.</p>")
    with pytest.raises(InputError, match="the library that prints failed; found AssertionError"):
        write_pdf(report, pdf)
    assert not pdf.exists()
