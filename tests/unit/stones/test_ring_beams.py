"""Ring beams on walls whose stones are drawn with little care."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from solids import box

# Between the highest and the lowest of the upper course; coordinates of whole millimetres leave 1 mm.
RAGGED = (0.0, 0.4e-3, 0.9e-3, 0.1e-3, 0.6e-3)


def _wall(lower, name, y):
    """Return a course of five stones on one of two, each of the five lower than .6 m by what is given."""
    solids = [box((0.0, 1.0), (y, y + 0.4), (0.0, 0.3)), box((1.0, 2.5), (y, y + 0.4), (0.0, 0.3))]
    solids += [box((0.5 * k, 0.5 * k + 0.5), (y, y + 0.4), (0.3, 0.6 - by)) for k, by in enumerate(lower)]
    return solids, [name] * len(solids)


def _stones(*walls):
    ground = box((-1.0, 4.0), (-1.0, 4.0), (-0.5, 0.0))
    solids = [solid for wall, _ in walls for solid in wall]
    return cp.Assemblage.from_polyhedra([ground, *solids], 19e3, fixed=[0], panel=["", *(n for _, names in walls for n in names)])


def _beam(stones):
    return stones.solid(stones.count - 1)[0], stones.volume[-1]


@pytest.mark.parametrize("turn", [0, 2])
def test_a_beam_lies_along_the_whole_of_a_ragged_top(turn):
    stones = cp.with_ring_beams(_stones(_wall(np.roll(RAGGED, turn), "wall", 0.0)), ["wall"], height=0.2)
    points, volume = _beam(stones)
    np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], [[0, 0, 0.6], [2.5, 0.4, 0.8]], atol=1e-9)
    assert volume == pytest.approx(2.5 * 0.4 * 0.2)
    contacts = cp.find_contacts(stones)
    assert contacts.area[(contacts.blocks == stones.count - 1).any(axis=1)].sum() == pytest.approx(2.5 * 0.4)
    cp.check_soundness(stones, contacts)


def test_a_slab_lies_on_walls_whose_tops_are_level_to_a_millimetre():
    stones = _stones(_wall(RAGGED, "front", 0.0), _wall(np.array(RAGGED) + 0.08e-3, "back", 2.0))
    _, volume = _beam(cp.with_ring_beams(stones, ["front", "back"], height=0.2, slab=True))
    assert volume == pytest.approx(2.5 * 2.4 * 0.2)


def test_a_top_that_sinks_is_refused():
    stones = _stones(_wall((0.0, 1.2e-3, 2.4e-3, 3.6e-3, 4.8e-3), "wall", 0.0))
    with pytest.raises(InputError, match=r"the top of the wall wall is not level; found 4\.8 mm lower beside its highest stones"):
        cp.with_ring_beams(stones, ["wall"], height=0.2)
