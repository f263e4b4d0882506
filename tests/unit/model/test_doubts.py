"""Python asks about odd values as the case file does: by a warning of its own, and only whoever gives them by hand."""

import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.code_check import Site
from churchpipe.generators import wall
from churchpipe.spectrum import SiteSpectrum
from solids import box, on_ground

STONES = on_ground(box((0, 1), (0, 1), (0, 2)), unit_weight=2e4)
CONTACTS = cp.find_contacts(STONES)
PUSH = cp.LoadCase((1, 0, 0))
CORPUS = Path(__file__).parents[2] / "corpus"
WALL = cp.derive_blocks(wall(length=1.2, brick=(0.4, 0.2, 0.2), courses=2))
SOUND = cp.Material("brick", 18e3, 0.6)

CALLS: list[tuple[Callable[[], Any], str]] = [
    (
        lambda: cp.Material("brick", 18.0, 0.6),
        r"Material\.unit_weight is 0\.018 kN/m3 \(given as 18 in SI units\), usual are 8 to",
    ),
    (lambda: cp.Material("brick", 18e3, 6.0), r"Material\.friction is 6, usual are 0\.1 to 1\.5: slopes of .* Is it meant\?"),
    (lambda: cp.JointStrength("brick", 6.0), r"JointStrength\.friction is 6, usual"),
    (lambda: replace(SOUND, friction=6.0), r"Material\.friction is 6, usual"),
    (lambda: cp.Material("brick", 18e3, 0.6, compressive_strength=3.0), r"compressive_strength is 3e-06 MPa \(given as 3 in SI"),
    (
        lambda: Site(0.15, soil_factor=1.2),
        r"Site\.ground_acceleration is 0\.0153 g \(given as 0\.15 in SI units\), usual are 0\.04",
    ),
    (
        lambda: SiteSpectrum(amplification=25.0, start=0.35, soil="C"),
        r"SiteSpectrum\.amplification is 25, usual are 2\.2 to 3\.2",
    ),
    (
        lambda: Site(1.5, 1.2, spectrum=SiteSpectrum(period=(0.0, 0.5, 2.0), level=(0.15, 0.4, 0.1))),
        r"begins at the period 0 with 0\.15 m/s2, where S_e is a_g S, here 1\.8 m/s2\. Is it meant\?",
    ),
    (
        lambda: cp.AreaLoad(["a", "b"], dead=1.5e6),
        r"AreaLoad\.dead is 1500 kN/m2 \(given as 1\.5e\+06 in SI units\), usual are 0 to 50",
    ),
    (lambda: cp.JointGroup("beds", kind="bed", friction=6.0), r"JointGroup\.friction is 6, usual"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, friction=6.0), r"limit_analysis: friction is 6, usual are 0\.1 to 1\.5"),
    (
        lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6, cohesion=20e6),
        r"limit_analysis: cohesion is 2e\+04 kPa \(given",
    ),
    (
        lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6, compressive_strength=2.0),
        r"limit_analysis: compressive_strength is 2e-06 MPa \(given as 2 in SI units\), usual are 0\.3 to 50 MPa",
    ),
    (
        lambda: cp.find_contacts(STONES, contact_gap=12.0),
        r"find_contacts: contact_gap is 1\.2e\+04 mm \(given as 12 in",
    ),
    (lambda: cp.find_contacts(STONES, overlap=2.0), r"find_contacts: overlap is 2000 mm \(given as 2 in SI units\), usual are"),
    (lambda: cp.block_pushover(STONES, CONTACTS, PUSH, 6.0, steps=1), r"block_pushover: friction is 6, usual"),
    (lambda: cp.settlement_analysis(STONES, CONTACTS, [0], friction=[6.0]), r"settlement_analysis: friction is 6, usual"),
    (lambda: cp.settlement_path(STONES, CONTACTS, [0], furthest=1e-3, steps=1), "The support takes along all ground that the"),
    (
        lambda: cp.Assemblage.from_polyhedra([box((0, 400), (0, 1), (0, 1))], unit_weight=18e3),
        r"the longest side of a stone is 400 m, usual are 0\.005 to 25 m",
    ),
    (
        lambda: cp.Assemblage.from_polyhedra([box((0, 1), (0, 1), (0, 1))], unit_weight=18.0),
        r"from_polyhedra: unit_weight is 0\.018 kN/m3 \(given as 18 in SI units\)",
    ),
    (
        lambda: cp.read_stones(CORPUS / "sound.obj", unit_weight=18.0),
        r"read_stones: unit_weight is 0\.018 kN/m3 \(given as 18",
    ),
    (
        lambda: cp.read_dxf(CORPUS / "sound.dxf", unit_weight={"default": 18e3, "granite": 26.0}, thickness=0.12),
        r"read_dxf: unit_weight is 0\.026 kN/m3 \(given as 26 in SI",
    ),
    (
        lambda: cp.derive_blocks(cp.generators.wall(length=1200, brick=(0.4, 0.25, 0.2), courses=3)),
        r"the length of the structure is 1200 m, usual are 0\.05 to 500 m",
    ),
    (lambda: cp.with_ring_beams(WALL, ["wall"], height=0.2, unit_weight=25.0), r"with_ring_beams: unit_weight is 0\.025 kN/m3"),
    (
        lambda: cp.with_fill(PUSH, WALL, "wall", 2.0, 15.0, cp.find_contacts(WALL)),
        r"with_fill: unit_weight is 0\.015 kN/m3 \(given as 15 in SI",
    ),
]


@pytest.mark.parametrize(("call", "said"), CALLS)
def test_an_odd_value_is_asked_about_where_it_is_given(call: Callable[[], Any], said: str) -> None:
    with pytest.warns(cp.DoubtfulValue, match=said) as caught:
        call()
    assert {Path(one.filename).name for one in caught} == {Path(__file__).name}
    assert len(caught) == 1


class Survey:
    """Somebody's own class, which makes a material as it is made."""

    def __init__(self) -> None:
        self.material = cp.Material("brick", 18e3, 6.0)


def test_the_line_that_gives_the_value_is_named_in_whatever_function_it_stands() -> None:
    with pytest.warns(cp.DoubtfulValue) as caught:
        Survey()
    (one,) = caught
    assert one.lineno == Survey.__init__.__code__.co_firstlineno + 1


def test_nothing_is_asked_about_usual_values_and_inside_the_package(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    text = (Path(__file__).parents[3] / "pipeline" / "cases" / "wall.toml").read_text(encoding="utf-8")
    case.write_text(text.replace("friction = ", "friction = 6.0 # "), encoding="utf-8")
    assert "6.0 #" in case.read_text(encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("error", cp.DoubtfulValue)
        replace(SOUND, friction=0.7)
        cp.limit_analysis(STONES, CONTACTS, PUSH, friction=0.6)
        # Joints that do not crush, stones of a model without units, ground alone.
        cp.limit_analysis(STONES, CONTACTS, PUSH, friction=0.6, compressive_strength=np.inf)
        cp.Assemblage.from_polyhedra([box((0, 400), (0, 1), (0, 1))], unit_weight=1.0)
        cp.Assemblage.from_polyhedra([box((0, 400), (0, 1), (0, 1))], unit_weight=18e3, fixed=[0])
        cp.block_pushover(STONES, CONTACTS, PUSH, 0.6, steps=1)
        # The case has its own questions.
        cp.read_case(case)
