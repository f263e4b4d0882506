"""Colours that colour-blind people can tell: protanopia and deuteranopia after Machado, Oliveira and Fernandes (2009)."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from churchpipe.report import colours
from churchpipe.report.plots import new_plot

# Machado et al. (2009), table 1, severity 1.0, on linear RGB.
BLIND = {
    "none": np.eye(3),
    "protan": np.array([[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
    "deutan": np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]),
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour: str, sight: str) -> np.ndarray:
    """CIE L*a*b* of a colour as it is seen."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(BLIND[sight] @ linear, 0, 1) / np.array([0.9505, 1.0, 1.089])
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("sight", BLIND)
def test_walls_are_told_apart(sight: str) -> None:
    # A difference of 2.3 is just noticeable.
    distances = [np.linalg.norm(lab(one, sight) - lab(other, sight)) for one, other in combinations(colours.PANELS, 2)]
    assert min(distances) > 10
    others = (*colours.PANELS, *colours.SPEED_STOPS)
    assert min(np.linalg.norm(lab(colours.PICKED, sight) - lab(other, sight)) for other in others) > 30


@pytest.mark.parametrize("sight", BLIND)
def test_lines_of_a_plot_are_told_apart(sight: str) -> None:
    assert min(np.linalg.norm(lab(one, sight) - lab(other, sight)) for one, other in combinations(colours.LINES, 2)) > 15
    _, (axes,) = new_plot(1, (3.0, 2.0))
    assert [axes.plot([0, 1])[0].get_color() for _ in colours.LINES] == list(colours.LINES)


@pytest.mark.parametrize("sight", BLIND)
@pytest.mark.parametrize("ramp", ["SPEED_STOPS", "PLASTIC_STOPS"])
def test_ramps_darken_from_end_to_end(ramp: str, sight: str) -> None:
    # A difference of 2.3 is just noticeable.
    lightness = [lab(colour, sight)[0] for colour in getattr(colours, ramp)]
    assert (np.diff(lightness) < -2.3).all()
