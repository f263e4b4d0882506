"""Free walls b x h through the product: stones, capacity curve, displacement-based check.

FC 1.35, S 1.2, F0 2.5, TC* .5 s: a_g,SLV of the displacement-based check and of the check with q = 2, m/s2. The first five rows
were computed for this project from the formulas of the circular before the product had them; all rows are computed once more
here, from the rocking block's closed form (Housner 1963).
"""

import math

import pytest

import churchpipe as cp
from churchpipe.code_check import Site
from churchpipe.displacement_check import displacement_check
from churchpipe.model.quantities import GRAVITY
from churchpipe.spectrum import SiteSpectrum
from solids import box, on_ground

WALLS = [
    (0.3, 3.0, 0.918, 1.211),
    (0.5, 4.0, 1.386, 1.5135),
    (0.9, 9.0, 2.173, 1.211),
    (0.9, 12.0, 2.173, 0.908),
    (1.2, 14.0, 2.676, 1.038),
    (0.4, 5.0, 1.158, 0.9686),
    (0.6, 6.0, 1.599, 1.2107),
    (1.5, 20.0, 3.130, 0.9080),
]


def by_hand(breadth: float, height: float) -> float:
    """a_g,SLV of a rocking block on the branches TC..TD and > TD of the spectrum, whichever holds its secant period."""
    reached = 0.4 * breadth / 2
    lever = breadth / 2 - reached
    level = lever / math.sqrt((breadth**2 + height**2) / 4 - lever**2) * GRAVITY / 1.35
    period = 1.68 * math.pi * math.sqrt(reached / level)
    unit = 1.2 * math.sqrt(10 / 13) * 2.5 * 0.5 * (period / (2 * math.pi)) ** 2
    ground = reached * period / unit
    if period > 4 * ground / GRAVITY + 1.6:
        # reached = unit a_g TD / T^2 with TD = 4 a_g/g + 1.6.
        a, b = 4 / GRAVITY, 1.6
        ground = (-b + math.sqrt(b**2 + 4 * a * reached * period**2 / unit)) / (2 * a)
    return ground


TABLE = pytest.mark.slow("docs/displacement_check.md: free walls")


@pytest.mark.parametrize(
    ("breadth", "height", "displacements", "behaviour"),
    [wall if number in (1, 3, 7) else pytest.param(*wall, marks=TABLE) for number, wall in enumerate(WALLS)],
)
def test_free_walls(breadth: float, height: float, displacements: float, behaviour: float) -> None:
    stones = on_ground(box((0, breadth), (0, 1), (0, height)))
    load = cp.LoadCase((1, 0, 0))
    curve = cp.block_pushover(stones, cp.find_contacts(stones), load, 0.7, step=breadth / 20)
    record = displacement_check(curve, stones, load, Site(1.5, 1.2, spectrum=SiteSpectrum(2.5, 0.5)))
    assert record.a_g_slv == pytest.approx(displacements, rel=1e-3)
    assert record.a_g_slv == pytest.approx(by_hand(breadth, height), rel=1e-3)
    assert record.force_based is not None
    assert record.force_based.a_g_slv == pytest.approx(behaviour, rel=1e-3)
