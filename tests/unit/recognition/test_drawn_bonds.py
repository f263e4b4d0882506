"""The bond of drawn walls, as their head joints tell."""

from itertools import pairwise

import numpy as np
import pytest

from churchpipe.model.assemblage import Assemblage
from churchpipe.recognition.panels import fit_panels
from solids import box

THICK = (0.0, 0.4)


def _pattern(solids):
    return fit_panels(Assemblage.from_polyhedra(solids, 18e3)).panels[0].regions[0].pattern


@pytest.mark.parametrize(("stagger", "pattern"), [(0.0, "stack"), (0.3, "running")])
@pytest.mark.parametrize("heights", [(0.4, 0.2, 0.2) * 3, (0.4,) * 4 + (0.1,) * 12], ids=["tall and low", "bricks on a base"])
def test_courses_may_be_of_unlike_height(heights, stagger, pattern):
    solids = []
    for k, height in enumerate(heights):
        ends = np.unique(np.concatenate([[0.0, 3.0], np.arange(stagger * (k % 2), 3.0, 0.6)]))
        low = sum(heights[:k])
        solids += [box((s, stop), THICK, (low, low + height)) for s, stop in pairwise(ends)]
    assert _pattern(solids) == pattern


def test_the_sides_of_piers_are_no_head_joints():
    # Three piers, each of ten stones upon another, and two courses in running bond over the two openings.
    piers = [box((x, x + 0.5), THICK, (0.25 * k, 0.25 * k + 0.25)) for x in (0.0, 1.5, 3.0) for k in range(10)]
    over = [box(along, THICK, (2.5, 2.75)) for along in ((0.0, 1.0), (1.0, 2.5), (2.5, 3.5))]
    top = [box(along, THICK, (2.75, 3.0)) for along in ((0.0, 1.75), (1.75, 3.5))]
    assert _pattern([*piers, *over, *top]) == "running"
