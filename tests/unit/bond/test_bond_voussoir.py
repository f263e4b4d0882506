"""Voussoirs and lintels."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from churchpipe.bond.field import Field
from churchpipe.bond.single import SingleStone
from churchpipe.bond.voussoir import VoussoirRing, ring_outline
from churchpipe.errors import InputError
from churchpipe.geometry.planar import area, less, polygon
from churchpipe.model.building import UnitCell

CELL = UnitCell(a=0.3, b=0.45)


@settings(deadline=None)
@given(
    radius=st.floats(0.2, 5.0),
    depth=st.floats(0.05, 1.0),
    start=st.floats(-1.0, 1.5),
    opening=st.floats(0.3, math.pi),
    pieces=st.integers(1, 40),
)
def test_voussoirs_are_chords_of_the_ring(radius, depth, start, opening, pieces):
    outline = ring_outline((1.0, 2.0), radius, radius + depth, start, start + opening, pieces)
    tiles = VoussoirRing(CELL, outline, (1.0, 2.0), pieces).tiles(Field("ring", polygon(outline), (-9.0, 9.0)))
    step = opening / pieces
    area = 0.5 * math.sin(step) * ((radius + depth) ** 2 - radius**2)
    np.testing.assert_allclose(tiles.area, area, rtol=1e-9)
    assert (tiles.course == -1).all()
    # Neighbours share their corners to the last digit.
    corners = {tuple(c) for c in tiles.corner.tolist()}
    assert len(corners) == 2 * (pieces + 1)


def test_the_shell_reads_radial_beds_from_a_ring():
    outline = ring_outline((1.0, 2.0), 1.0, 1.5, 0.0, math.pi, 9)
    ring = VoussoirRing(CELL, outline, (1.0, 2.0), 9)
    np.testing.assert_allclose(ring.bed_direction(np.array([[2.2, 2.0], [1.0, 3.3]])), [[1, 0], [0, 1]], atol=1e-15)
    assert ring.cell is CELL


def test_a_ring_that_is_cut_names_the_room_it_needs():
    outline = ring_outline((1.0, 2.0), 1.0, 1.5, 0.0, math.pi, 9)
    wall = polygon(np.array([[0, 0], [4, 0], [4, 5], [0, 5]], dtype=float))
    with pytest.raises(InputError, match="expected room for a ring 3 m wide"):
        VoussoirRing(CELL, outline, (1.0, 2.0), 9).tiles(Field("ring", wall, (0.0, 4.0)))


def test_an_outline_with_other_corners_is_cut_by_radial_joints():
    outline = ring_outline((1.0, 2.0), 1.0, 1.5, 0.0, math.pi, 9)
    tiles = VoussoirRing(CELL, outline, (1.0, 2.0), 8).tiles(Field("ring", polygon(outline), (-9.0, 9.0)))
    assert tiles.count == 8
    assert tiles.area.sum() == pytest.approx(area(polygon(outline)), rel=1e-12)
    turn = np.arctan2(*(tiles.corner - [1.0, 2.0]).T[::-1])
    joints = np.pi * np.arange(9) / 8
    assert (np.abs(turn[:, None] - joints).min(axis=0) < 1e-12).all()


def test_a_lintel_is_one_stone_of_the_course_it_starts_in():
    outline = np.array([[0.08, 0.45], [0.32, 0.45], [0.32, 0.48], [0.08, 0.48]])
    tiles = SingleStone(UnitCell(0.03, 0.08), outline).tiles(Field("lintel", polygon(outline), (0.0, 0.84)))
    assert tiles.count == 1
    assert tiles.course.tolist() == [15]
    assert tiles.area[0] == pytest.approx(0.24 * 0.03, rel=1e-12)


def test_a_lintel_that_is_cut_is_an_error():
    outline = np.array([[0.08, 0.45], [0.32, 0.45], [0.32, 0.48], [0.08, 0.48]])
    hole = polygon(np.array([[0.26, 0.4], [0.4, 0.4], [0.4, 0.5], [0.26, 0.5]]))
    with pytest.raises(InputError, match="found 25 % of it cut away"):
        SingleStone(UnitCell(0.03, 0.08), outline).tiles(Field("lintel", less(polygon(outline), [hole]), (0.0, 0.84)))
