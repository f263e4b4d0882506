"""A church with a barrel over its nave, a dome on slabs over its crossing, a half dome on its apse: docs/vault_validation.md."""

from functools import cache

import pytest

import churchpipe as cp
from churchpipe.config.case import Case
from churchpipe.stones.joints import joint_strength
from manual_pages import ROOT

# Load factors, by the name of the load.
STONES = {
    "+x": 0.0797,
    "-x": 0.0797,
    "+y": 0.4076,
    "-y": 0.3063,
    "tower +x": 0.4126,
    "+x, linear": 0.0414,
    "-y, linear": 0.1978,
}
SHELL = {
    "+x": 0.0855,
    "-x": 0.0754,
    "+y": 0.3395,
    "-y": 0.2669,
    "tower +x": 0.3387,
    "+x, linear": 0.0451,
    "-y, linear": 0.1730,
}


@cache
def church() -> tuple[Case, cp.Assemblage, cp.Contacts, cp.ShellModel]:
    case = cp.read_case(ROOT / "pipeline" / "cases" / "church_vaults.toml")
    building = case.building()
    stones = cp.derive_blocks(building)
    return case, stones, cp.find_contacts(stones), cp.derive_shell(building, 1.0)


@pytest.mark.slow("docs/vault_validation.md: the church with all its vaults, one building in both models")
def test_stones_and_shell_are_one_church() -> None:
    _, stones, contacts, shell = church()
    match = cp.match_models(stones, contacts, shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]
    # Dome, barrel and half dome have facets; the eight stones below the dome are bodies; vaults press on the walls at their ends.
    assert {"vault_nave", "vault_crossing", "vault_apse", "vault_apse front"} <= set(shell.panel)
    assert shell.beams.count == 8


@pytest.mark.slow("docs/vault_validation.md: the church with all its vaults, stones")
@pytest.mark.parametrize("name", STONES)
def test_the_stones_of_the_vaulted_church(name: str) -> None:
    case, stones, contacts, _ = church()
    (load,) = (load for load in case.loads if load.name == name)
    state = cp.limit_analysis(stones, contacts, load, *joint_strength(stones, contacts, case.materials))
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(STONES[name], abs=5.1e-5)


@pytest.mark.slow("docs/vault_validation.md: the church with all its vaults, shell")
@pytest.mark.parametrize("name", SHELL)
def test_the_shell_of_the_vaulted_church(name: str) -> None:
    case, _, _, shell = church()
    (load,) = (load for load in case.loads if load.name == name)
    state = cp.shell_limit_analysis(shell, load, case.materials)
    assert state.status == "optimal"
    assert state.load_factor == pytest.approx(SHELL[name], abs=1e-4)
