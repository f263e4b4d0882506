"""The periodic cell computed from its stones, against the one derived by hand."""

import numpy as np
import pytest

from churchpipe.bond.period import period_of
from churchpipe.errors import InputError
from churchpipe.homogenised_shell.cell_limit import cell_limit
from churchpipe.homogenised_shell.rigid_cell import rigid_cell
from hand_cell import hand_closing

A, B, H, MU = 0.03, 0.08, 0.04, 0.7


@pytest.mark.parametrize(("a", "b", "h"), [(A, B, H), (0.275, 0.57, 0.9), (0.4, 0.3, 0.1)])
def test_running_bond_from_its_stones_is_as_strong_as_the_cell_derived_by_hand(a: float, b: float, h: float) -> None:
    rng = np.random.default_rng(1)
    unit = np.array([1, 1, 1, h, h, h])
    found, expected = rigid_cell("running", a, b, h).closing, hand_closing(a, b, h)
    assert found.shape == expected.shape
    for _ in range(6):
        direction, base = rng.normal(size=6) * unit, np.array([-2.0, -3.0, 0, 0, 0, 0])
        mine, by_hand = (cell_limit(closing, MU, h, direction, base=base) for closing in (found, expected))
        assert mine.outcome == by_hand.outcome
        assert mine.factor == pytest.approx(by_hand.factor, rel=1e-6)


@pytest.mark.parametrize(
    ("bond", "corners", "motions"), [("stack", 8, 3), ("leaves", 24, 6), ("flemish", 52, 15), ("english", 68, 21)]
)
def test_cells_have_the_joints_of_their_stones(bond: str, corners: int, motions: int) -> None:
    closing = rigid_cell(bond, A, B, H).closing
    assert closing.shape == (corners, 3, 6 + motions)


@pytest.mark.parametrize("bond", ["running", "stack", "leaves", "flemish", "english"])
def test_a_wall_rocks_out_of_its_plane_on_the_edge_of_a_bed(bond: str) -> None:
    # Under a bed pressure N the bending moment of the beds is at most N h / 2, or of two loose leaves N h / 4.
    arm = H / 4 if bond == "leaves" else H / 2
    found = cell_limit(rigid_cell(bond, A, B, H).closing, MU, H, [0, 0, 0, 0, 1, 0], base=[0, -1, 0, 0, 0, 0])
    assert found.factor == pytest.approx(arm, rel=1e-6)


@pytest.mark.parametrize("bond", ["running", "stack", "leaves", "flemish", "english"])
@pytest.mark.parametrize("share", [0.1, 0.6])
def test_a_bed_that_crushes_bears_the_moment_of_its_pressed_strip(bond: str, share: float) -> None:
    # A pressure N per length needs a strip N / f of the thickness h: |M22| <= N / 2 (h - N / f), and half of that for two loose
    # leaves.
    cell, strength = rigid_cell(bond, A, B, H), 1e6
    pressure, depth = share * strength * H, H / 2 if bond == "leaves" else H
    base = [0, -pressure, 0, 0, 0, 0]
    found = cell_limit(cell.closing, MU, H, [0, 0, 0, 0, 1, 0], base=base, capacity=strength * cell.joints)
    assert found.factor == pytest.approx(pressure * depth * (1 - share) / 2, rel=1e-6)
    crushed = cell_limit(cell.closing, MU, H, [0, -1, 0, 0, 0, 0], capacity=strength * cell.joints)
    assert crushed.factor == pytest.approx(strength * H, rel=2e-6)


def test_an_unknown_bond_is_named() -> None:
    with pytest.raises(InputError, match="bond: unknown; found dutch"):
        period_of("dutch", A, B, H)
