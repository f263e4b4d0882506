"""Labels of logarithmic axes: those that matplotlib would set, in plain text."""

import re

import numpy as np
import pytest

from churchpipe.report.plots import new_plot, svg_of
from churchpipe.report.powers import label_powers, power


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "10⁰"), (1e-3, "10⁻³"), (1000.0, "10³"), (2e-6, "2×10⁻⁶"), (0.0, "0"), (-1e12, "−10¹²"), (9.999999999999e-7, "10⁻⁶")],
)
def test_a_number_is_a_multiple_of_a_power_of_ten(value: float, text: str) -> None:
    assert power(value) == text


def labels(low: float, high: float) -> list[str]:
    figure, (axes,) = new_plot(1, (5.0, 3.0))
    axes.semilogy([1, 2], [low, high])
    label_powers(axes.yaxis)
    return [text for text in re.findall(r"<text[^>]*>([^<]*)</text>", svg_of(figure)) if "10" in text]


@pytest.mark.parametrize(("low", "high"), [(1e-7, 1e-1), (2e-3, 3e-3), (1e-1, 2e2)])
def test_an_axis_has_the_labels_of_matplotlib(low: float, high: float) -> None:
    figure, (axes,) = new_plot(1, (5.0, 3.0))
    axes.semilogy([1, 2], [low, high])
    figure.draw_without_rendering()
    expected = [
        sum(
            bool(label.get_text()) and low_end <= label.get_position()[1] <= high_end
            for label in axes.get_yticklabels(minor=minor)
        )
        for minor in (False, True)
        for low_end, high_end in [axes.get_ylim()]
    ]
    found = labels(low, high)
    assert len(found) == sum(expected) > 0
    assert np.unique(found).size == len(found)
