"""What a path was made with, as a text that two paths are compared by."""

from dataclasses import replace

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.large_displacements.path_arguments import check_given
from churchpipe.model.digests import digests

TWO = cp.Anchor(stone=[1, 2], point=[[0, 0, 1], [0, 0, 2]], share=[0.5, 0.5], wall=["nave", "nave"])
ONE = cp.Anchor(stone=[3], point=[[4, 0, 1]], share=[1.0], wall=["apse"])
BAR = cp.Tie("bar", (0, 0, 1.5), (4, 0, 1), strength=1e4, anchors=(TWO, ONE))


def test_ties_that_are_anchored_in_walls_have_a_digest() -> None:
    assert digests(ties=[BAR]) == digests(ties=(replace_anchor(wall=["nave", "nave"]),))
    check_given("here", digests(ties=[BAR]), digests(ties=[BAR]))
    for other in (replace_anchor(wall=["nave", "tower"]), replace_anchor(share=[0.25, 0.75]), replace_anchor(stone=[1, 4])):
        assert digests(ties=[other]) != digests(ties=[BAR])
        with pytest.raises(cp.InputError, match="steps of another analysis; found another ties"):
            check_given("here", digests(ties=[BAR]), digests(ties=[other]))


def test_names_do_not_run_into_each_other() -> None:
    assert digests(walls=np.array(["ab", "c"])) != digests(walls=np.array(["a", "bc"]))
    # The width in which an array keeps its names is not theirs.
    assert digests(walls=np.array(["a", "b"])) == digests(walls=np.array(["a", "b"], dtype="<U9"))


def replace_anchor(**changed: object) -> cp.Tie:
    return cp.Tie("bar", (0, 0, 1.5), (4, 0, 1), strength=1e4, anchors=(replace(TWO, **changed), ONE))
