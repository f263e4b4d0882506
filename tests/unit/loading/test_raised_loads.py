"""Chimneys, pinnacles and parapets: loads whose own centroid lies above the wall that they stand on."""

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators.wall import wall
from churchpipe.model.carried import Carried
from solids import box

B, H, LENGTH, GAMMA = 0.5, 3.0, 4.0, 18e3
W = GAMMA * B * H * LENGTH
OUT = cp.LoadCase((0, 1, 0))


def brick_wall() -> cp.Building:
    return wall(length=LENGTH, brick=(1.0, B, 0.5), courses=6, materials=[cp.Material("default", GAMMA, 2.0)])


def by_hand(p: float, rise: float, thrust: float = 0.0) -> float:
    """About the edge of the foot: the weight p stands on the middle of the wall, its mass acts so far above the top."""
    return (W * B / 2 + p * B / 2 - thrust * H) / (W * H / 2 + p * (H + rise))


LOADS: list[tuple[Carried, float, float, float]] = [
    (cp.PointLoad("wall", 2.0, dead=12e3, rise=1.0), 12e3, 1.0, 0.0),
    (cp.PointLoad("wall", 1.3, dead=12e3, rise=0.4, thrust=500.0, toward="+y"), 12e3, 0.4, 500.0),
    (cp.LineLoad("wall", dead=3e3, rise=0.6), 12e3, 0.6, 0.0),
    (cp.LineLoad("wall", dead=3e3, rise=0.6, thrust=200.0, toward="+y"), 12e3, 0.6, 800.0),
]


@pytest.mark.parametrize(("load", "p", "rise", "thrust"), LOADS)
def test_a_mass_above_a_wall_turns_it_over_by_its_own_height(load: Carried, p: float, rise: float, thrust: float) -> None:
    stones = cp.derive_blocks(brick_wall())
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(OUT, stones, [load]), 2.0)
    assert state.load_factor == pytest.approx(by_hand(p, rise, thrust), rel=1e-6)


@pytest.mark.parametrize(("load", "p", "rise", "thrust"), LOADS)
def test_both_models_take_the_same_forces_and_moments(load: Carried, p: float, rise: float, thrust: float) -> None:
    building = brick_wall()
    stones, shell = cp.derive_blocks(building), cp.derive_shell(building, element_size=0.5)
    placed = cp.place_loads(stones, [load])
    for push in (OUT, cp.LoadCase((1, 0, 0))):
        of_stones, of_shell = cp.loaded(push, stones, placed), cp.shell_loaded(push, shell, stones, placed)
        for part in ("dead", "live"):
            sums: list[np.ndarray] = []
            for centroid, case in ((stones.centroid, of_stones), (shell.body_centroid, of_shell)):
                wrench = getattr(case, part)
                turn = wrench[:, 3:] + np.cross(centroid, wrench[:, :3])
                sums.append(np.concatenate([wrench[:, :3].sum(axis=0), turn.sum(axis=0)]))
            np.testing.assert_allclose(sums[1], sums[0], rtol=1e-9, atol=1e-9 * np.abs(sums[0]).max())
    figures = cp.match_models(stones, cp.find_contacts(stones), shell, placed).figures
    assert all(figure.passed for figure in figures if "loads" in figure.name)
    # What the shell makes of the load beside what it makes of the wall: the ratio by hand.
    bare = cp.shell_limit_analysis(shell, OUT, building.materials).load_factor
    under = cp.shell_limit_analysis(shell, cp.shell_loaded(OUT, shell, stones, placed), building.materials).load_factor
    assert under / bare == pytest.approx(by_hand(p, rise, thrust) / (B / H), rel=0.03)


def test_a_chimney_goes_down_with_its_wall() -> None:
    """On a capacity curve its weight travels with the stone: it falls where the centroid of both stands over the edge."""
    stones = cp.Assemblage.from_polyhedra(
        [box((-9, 9), (-9, 9), (-1, 0)), box((0, LENGTH), (0, B), (0, H))], GAMMA, [0], panel=["", "wall"]
    )
    push = cp.loaded(OUT, stones, [cp.PointLoad("wall", 2.0, dead=12e3, rise=1.0)])
    curve = cp.block_pushover(stones, cp.find_contacts(stones), push, 2.0, step=0.05)
    tilt = np.arctan((W + 12e3) * B / 2 / (W * H / 2 + 12e3 * (H + 1.0)))
    middle = H / 2 * np.sin(tilt) + B / 2 * (1 - np.cos(tilt))
    assert curve.status == "vanished"
    last = float(np.interp(0.0, -curve.load_factor, curve.position[:, 1, 1])) - B / 2
    assert last == pytest.approx(middle, rel=2e-3)


def test_a_centroid_below_its_foot_is_none() -> None:
    with pytest.raises(InputError, match=r"point load wall: rise: out of range; found -0.1"):
        cp.PointLoad("wall", 2.0, dead=1e3, rise=-0.1)
