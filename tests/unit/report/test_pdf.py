"""The printed report, and what is said where the library that prints fails."""

from pathlib import Path
from typing import Any

import pytest
import weasyprint
from weasyprint.formatting_structure.boxes import TextBox

from churchpipe.errors import InputError
from churchpipe.report.pdf import write_pdf
from churchpipe.report.plots import new_panels, svg_of_panels
from churchpipe.report.viewer import static_text
from records import analysis
from report_pages import report


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


@pytest.mark.parametrize("more", [{}, {"variant": "with ties", "swept": {"source.thickness_mm": 500.0}}], ids=["plain", "swept"])
def test_no_column_of_the_load_factors_is_cut_off(more: dict[str, Any], tmp_path: Path) -> None:
    shell = {"model": "homogenised-shell", "method": "limit", "planes": "cell", "elements": 12232, "element_size_mm": 400.0}
    sliding = {"gap": 1.6e-6, "interval": [0.3560, 0.3799], "friction_violation": 3.1e-16, "flow": "non-associative"}
    bounds = {"lower_bound": 0.2968709, "upper_bound": 0.2968709, "iterations": 134, "seconds": 123.4, "cone_violation": 2e-16}
    words = bounds | more | ({"cohesion_kPa": 25.0, "compressive_strength_MPa": 2.5} if more else {})
    report(tmp_path, [], [analysis(name="a", **words, **sliding), analysis(name="b", **words, **shell)])
    pages = weasyprint.HTML(filename=str(tmp_path / "report.html")).render().pages
    texts: list[Any] = [box for page in pages for box in page._page_box.descendants() if isinstance(box, TextBox)]
    assert "Seconds" in [box.text for box in texts]
    # A4 in px of CSS, with margins of 16 mm.
    assert max(box.position_x + box.width for box in texts) < (210 - 16) / 25.4 * 96 + 1


def test_a_failure_of_the_library_that_prints_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def render(_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(weasyprint.HTML, "render", render)
    report, pdf = tmp_path / "report.html", tmp_path / "report.pdf"
    report.write_text("<p>One page.</p>")
    with pytest.raises(InputError, match="the library that prints failed; found AssertionError"):
        write_pdf(report, pdf)
    assert not pdf.exists()
