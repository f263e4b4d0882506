"""Stones drawn as a net of lines that miss each other have the load factors of the stones that were meant."""

from pathlib import Path

import ezdxf
import numpy as np
import pytest
from scipy.spatial import Voronoi

import churchpipe as cp
from churchpipe.model.arrays import FloatArray

LENGTH, HEIGHT, STONES = 2.5, 1.6, 18


def masonry(seed: int) -> list[FloatArray]:
    """The corners, in turn, of random stones that fill a wall."""
    seeds = np.random.default_rng(seed).random((STONES, 2)) * [LENGTH, HEIGHT]
    for _ in range(4):
        mirrored = [seeds * [-1, 1], seeds * [1, -1], [2 * LENGTH, 0] - seeds * [1, -1], [0, 2 * HEIGHT] - seeds * [-1, 1]]
        cells = Voronoi(np.concatenate([seeds, *mirrored]))
        stones = [cells.vertices[cells.regions[cells.point_region[k]]] for k in range(STONES)]
        seeds = np.array([stone.mean(axis=0) for stone in stones])
    turned = [np.argsort(np.arctan2(*(stone - stone.mean(axis=0)).T[::-1])) for stone in stones]
    return [stone[order] for stone, order in zip(stones, turned, strict=True)]


def load_factors(stones: list[FloatArray], path: Path, off: float, seed: int) -> tuple[FloatArray, list[str]]:
    """Load factors both ways along the wall, and the codes of findings, of a drawing with a line for each side."""
    rng, document = np.random.default_rng(seed), ezdxf.new("R2010", units=6)
    sides = {}
    for stone in stones:
        for a, b in zip(stone, np.roll(stone, -1, axis=0), strict=True):
            sides[tuple(sorted([tuple(np.round(a, 6)), tuple(np.round(b, 6))]))] = np.array([a, b])
    for side in sides.values():
        document.modelspace().add_line(*(side + rng.uniform(-off, off, (2, 2))))
    document.saveas(path)
    blocks, findings = cp.read_stones(path, unit_weight=20e3, thickness=0.4, support="base")
    contacts = cp.find_contacts(blocks)
    cases = [cp.limit_analysis(blocks, contacts, cp.LoadCase((x, 0, 0)), 0.7) for x in (1, -1)]
    return np.array([case.load_factor for case in cases]), [finding.code for finding in findings.items]


@pytest.mark.parametrize("seed", range(5))
def test_scattered_ends_do_not_key_stones_to_each_other(seed: int, tmp_path: Path) -> None:
    stones = masonry(seed)
    meant, codes = load_factors(stones, tmp_path / "exact.dxf", 0.0, seed)
    assert "W25" not in codes
    drawn, codes = load_factors(stones, tmp_path / "drawn.dxf", 1e-3, seed)
    assert "W25" in codes
    np.testing.assert_allclose(drawn, meant, rtol=0.05)
