"""The sample church with its roofs, as it is and with four measures (docs/strengthening.md).

Our own figures, held so that they do not move unseen.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.config.carries import placed
from churchpipe.config.case import Case, read_case, read_variants

CASE = Path(__file__).parents[2] / "pipeline" / "cases" / "church_strengthened.toml"
TIES, CHAINS, BEAMS, BOTH = (
    "ties across the nave",
    "chains along the side walls",
    "beams on the side walls",
    "beams and ties across the nave",
)


@cache
def variants() -> dict[str, Case]:
    return {case.variant.name if case.variant else "": case for case in read_variants(CASE)}


@cache
def stones_of(beams: bool) -> tuple[cp.Assemblage, cp.Contacts]:
    stones = cp.derive_blocks(variants()[BEAMS if beams else ""].building())
    return stones, cp.find_contacts(stones)


@pytest.mark.slow("docs/strengthening.md: the church and four measures, stones")
@pytest.mark.parametrize(
    ("variant", "across", "along"),
    [
        ("", 0.21730, 0.24050),
        (TIES, 0.23761, 0.24058),
        (CHAINS, 0.22460, 0.35193),
        (BEAMS, 0.21737, 0.30240),
        (BOTH, 0.24382, 0.30254),
    ],
)
def test_stones(variant: str, across: float, along: float) -> None:
    case = variants()[variant]
    stones, contacts = stones_of(bool(case.ring_beams))
    applied = placed(case.carries, stones)
    friction, cohesion = cp.joint_strength(stones, contacts, case.materials)
    for load, expected in zip(case.loads, (across, along), strict=True):
        state = cp.limit_analysis(stones, contacts, cp.loaded(load, stones, applied.loads), friction, cohesion, ties=applied.ties)
        assert state.status == "optimal"
        assert state.upper_bound == pytest.approx(state.lower_bound, rel=1e-6)
        assert state.load_factor == pytest.approx(expected, abs=2e-5)


@pytest.mark.slow("docs/strengthening.md: the church and four measures, shell")
@pytest.mark.parametrize(
    ("variant", "across", "along"),
    [
        ("", 0.18653, 0.21977),
        (TIES, 0.21476, 0.21978),
        (CHAINS, 0.19129, 0.33310),
        (BEAMS, 0.18294, 0.27060),
        (BOTH, 0.21542, 0.27075),
    ],
)
def test_shell(variant: str, across: float, along: float) -> None:
    case = variants()[variant]
    assert case.shell is not None
    stones, contacts = stones_of(bool(case.ring_beams))
    applied = placed(case.carries, stones)
    shell = cp.derive_shell(case.building(), case.shell.element_size)
    assert cp.match_models(stones, contacts, shell, applied.loads).passed
    for load, expected in zip(case.loads, (across, along), strict=True):
        pushed = cp.shell_loaded(load, shell, stones, applied.loads)
        state = cp.shell_limit_analysis(shell, pushed, case.materials, ties=applied.ties)
        assert state.status == "optimal"
        assert state.load_factor == pytest.approx(expected, abs=2e-5)
        assert not np.isnan(state.tie_forces).any()


@pytest.mark.slow("docs/strengthening.md: a chapel with a flexible roof, both models")
@pytest.mark.parametrize(
    ("table", "stones_hold", "shell_holds"),
    [
        ("area_loads", (0.33998, 0.27796), (0.28513, 0.23681)),
        ("diaphragms", (0.36123, 0.27831), (0.29934, 0.23682)),
        ("anchored", (0.37569, 0.27842), (0.31219, 0.23683)),
    ],
)
def test_a_flexible_roof(tmp_path: Path, table: str, stones_hold: tuple[float, ...], shell_holds: tuple[float, ...]) -> None:
    held = {"area_loads": "", "diaphragms": "spacing_m = 0.8\nfriction = 0.4\n"}
    held["anchored"] = held["diaphragms"] + "fixing_kN = 5.0\n"
    key = "area_loads" if table == "area_loads" else "diaphragms"
    text = f'[[{key}]]\nwalls = ["nave_left", "nave_right"]\ndead_kN_m2 = 1.5\n{held[table]}'
    path = tmp_path / "chapel.toml"
    path.write_text((CASE.parent / "chapel.toml").read_text() + text)
    case = read_case(path)
    stones = cp.derive_blocks(case.building())
    contacts, shell = cp.find_contacts(stones), cp.derive_shell(case.building(), 0.4)
    applied = placed(case.carries, stones)
    friction, cohesion = cp.joint_strength(stones, contacts, case.materials)
    for direction, one, other in zip(((1, 0, 0), (0, -1, 0)), stones_hold, shell_holds, strict=True):
        load = cp.LoadCase(direction)
        state = cp.limit_analysis(stones, contacts, cp.loaded(load, stones, applied.loads), friction, cohesion, ties=applied.ties)
        assert state.load_factor == pytest.approx(one, abs=2e-5)
        pushed = cp.shell_loaded(load, shell, stones, applied.loads)
        assert cp.shell_limit_analysis(shell, pushed, case.materials, ties=applied.ties).load_factor == pytest.approx(
            other, abs=2e-5
        )
