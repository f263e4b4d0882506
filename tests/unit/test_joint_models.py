"""Contact models and crushing from the case file to the summary and the report."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from case_texts import WALL, case_file
from churchpipe import stages
from churchpipe.code_check import Site
from churchpipe.compare import contact_models, guidance, safety
from churchpipe.configuring import configure
from churchpipe.displacement_check import displacement_check
from churchpipe.dxf.properties import decode_properties, encode_materials
from churchpipe.io.atomic import read_json
from churchpipe.io.recording import shell_record_of
from churchpipe.io.records import Analysis
from churchpipe.large_displacements.pushover import block_pushover
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength, Material
from churchpipe.report.contact_models import contact_model_rows
from churchpipe.report.safety import check_table
from churchpipe.report.table import Row, columns_for
from churchpipe.rigid_blocks.limit import limit_analysis
from churchpipe.spectrum import SiteSpectrum
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.joints import crushing_strength
from records import analysis
from solids import box, on_ground

CASE = WALL.replace("friction = 0.6\n", "friction = 0.6\ncompressive_strength_MPa = 0.1\n") + (
    '[rigid]\ncontact_model = ["corners", "torsion"]\ncrushing_parts = 4\n'
    '[check]\na_g_m_s2 = 1.5\nsoil_factor = 1.2\nknowledge_level = "LC3"\n'
)


def test_from_the_case_to_the_summary(tmp_path: Path) -> None:
    run = tmp_path / "run"
    configure(case_file(tmp_path, CASE), run)
    place = run / "geometry" / "base"
    stages.source(place / "settings.json", place / "building.json")
    stages.blocks(place / "building.json", place / "assemblage.npz", place / "stones.dxf", place / "stones.vtu")
    stages.contacts(place / "tolerances.json", place / "assemblage.npz", place / "contacts.npz")
    for name in ("+y_associative", "+y_associative_torsion"):
        folder = run / "rigid" / name
        stages.rigid(
            folder / "settings.json",
            place / "assemblage.npz",
            place / "contacts.npz",
            folder / "rigid.npz",
            folder / "rigid.json",
        )
    stages.compare(run / "plan.json", run / "summary.json", run / "table.csv")
    summary = read_json(run / "summary.json")
    corners, torsion = summary["analyses"]
    assert (corners["contact_model"], torsion["contact_model"]) == ("corners", "torsion")
    for record in (corners, torsion):
        assert record["status"] == "optimal"
        assert record["compressive_strength_MPa"] == 0.1
        # Three courses of .25 m, .2 m thick: without crushing .2 / .6 of overturning, or friction.
        assert 0.2 < record["load_factor"] < 0.25 / 0.6
        assert record["check"]["confidence_factor"] == 1.0
        assert record["check"]["zeta_e"] == pytest.approx(1.35 * record["check"]["zeta_e_lc1"])
    (pair,) = summary["contact_models"]
    assert pair["corners"] == corners["load_factor"]
    assert "sentence" not in pair
    assert "compressive_strength_MPa" in (run / "table.csv").read_text()


def record(model: str, factor: float, **more: Any) -> Analysis:
    return analysis(**{"name": f"a {model}", "flow": "associative", "contact_model": model, "load_factor": factor} | more)


def test_models_that_differ_get_a_sentence() -> None:
    (pair,) = contact_models([record("corners", 0.444), record("torsion", 0.419)])
    assert pair.difference == pytest.approx(0.419 / 0.444 - 1)
    assert "twist" in pair.sentence
    alike = contact_models([record("corners", 0.444), record("torsion", 0.435)])
    assert alike[0].sentence == ""
    assert contact_models([record("corners", 0.444), record("torsion", 0.419, load="+y")]) == []
    assert contact_models([record("corners", 0.444), record("torsion", 0.419, flow="non-associative")]) == []
    shown = contact_model_rows([pair, *alike])
    assert shown is not None
    assert shown["rows"][0] == ["+x", "associative", "0.4440", "0.4190", "\u22125.6 %"]
    assert shown["sentences"] == [pair.sentence]
    assert contact_model_rows([]) is None
    # Pairs of a sweep, and of variants, are told apart.
    places = {"variant": "tied"}, {"swept": {"material.default.friction": 0.5}, "friction": 0.5}
    pairs = [contact_models([record("corners", 0.4, **place), record("torsion", 0.4, **place)])[0] for place in places]
    rows = contact_model_rows(pairs)
    assert rows is not None
    assert [row[0] for row in rows["rows"]] == ["+x, tied", "+x, friction 0.5"]
    (advice,) = guidance([record("corners", 0.444), record("torsion", 0.419)])
    assert "use 0.4190 (rigid blocks, associative, torsion)" in advice
    assert "uniform pressure" in advice


def test_what_crushes_is_named() -> None:
    crushing = record("torsion", 0.3, compressive_strength_MPa=1.5)
    assert crushing.kind == "associative, torsion, crushing"
    assert record("corners", 0.3).kind == "associative"
    assert analysis(model="homogenised-shell", method="limit", compressive_strength_MPa=1.5).kind == "limit load"
    rows = [Row(crushing), Row(record("corners", 0.4))]
    (column,) = [column for column in columns_for(rows) if column.title == "Strength, MPa"]
    assert [column.text(row) for row in rows] == ["1.5", ""]


def test_the_knowledge_level_counts_where_stones_crush() -> None:
    stones = on_ground(box((0, 0.9), (0, 1), (0, 12)))
    load, site = LoadCase((1, 0, 0)), Site(1.5, 1.2, knowledge_level="LC2")
    state = limit_analysis(stones, find_contacts(stones), load, 0.7, compressive_strength=1e6)
    found = safety(stones, state, load, site, crushing=True)
    assert found.confidence_factor == 1.2
    assert found.zeta_e == pytest.approx(2 * state.load_factor * 9.80665 / 1.2 / (1.2 * 1.5))
    assert found.zeta_e_lc1 == pytest.approx(found.zeta_e * 1.2 / 1.35)
    plain = safety(stones, state, load, site)
    assert plain.confidence_factor == 1.35
    assert math.isnan(plain.zeta_e_lc1)
    table = check_table([Row(replace(record("corners", 0.06, compressive_strength_MPa=1.0), check=found))])
    assert table is not None
    assert "\u03b6_E, FC 1.35" in [title for title, _ in table["headings"][1:-1]]
    assert table["kinds"] == ["crushing"]


def test_the_knowledge_level_counts_on_a_curve_that_crushes() -> None:
    stones = on_ground(box((0, 0.9), (0, 1), (0, 12)))
    load, site = LoadCase((1, 0, 0)), Site(1.5, knowledge_level="LC2", spectrum=SiteSpectrum(2.5, 0.5, soil="B"))
    curve = block_pushover(stones, find_contacts(stones), load, 0.7, step=0.1, compressive_strength=1e6)
    found = displacement_check(curve, stones, load, site, crushing=True)
    assert found.alpha0 == pytest.approx(0.0588, abs=1e-6)
    assert found.confidence_factor == 1.2
    assert displacement_check(curve, stones, load, site).confidence_factor == 1.35


def test_analyses_without_crushing_say_so() -> None:
    soft = JointStrength("tuff", 0.6, compressive_strength=2e6)
    load = LoadCase((1, 0, 0))
    refused = shell_record_of("refused", load, [soft], method="limit", planes="paper")
    assert refused.message == (
        'refused; nothing crushes here: compressive_strength enters analyses of stones, and shells with planes = "cell"'
    )
    assert refused.compressive_strength == 2e6
    assert not refused.crushes
    cell = shell_record_of("refused", load, [soft], method="limit", planes="cell")
    assert cell.message == "refused"
    assert cell.crushes
    plain = shell_record_of("refused", load, [JointStrength("tuff", 0.6)], method="limit", planes="paper")
    assert plain.message == "refused"


def test_a_drawing_keeps_the_strength() -> None:
    soft = Material("tuff", 16e3, 0.6, compressive_strength=2.5e6)
    stored = encode_materials([soft])
    assert '"compressive_strength_MPa": 2.5' in stored[0][1]
    materials, _, findings = decode_properties(stored)
    assert materials == (soft,)
    assert not findings


def test_the_weaker_material_crushes_where_two_meet() -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)))
    stones = replace(stones, material=np.array(["ground", "tuff", "brick"]))
    contacts = find_contacts(stones)
    tuff, brick = JointStrength("tuff", 0.6, compressive_strength=2e6), JointStrength("brick", 0.6, compressive_strength=1e6)
    found = crushing_strength(stones, contacts, [tuff, brick])
    assert found is not None
    assert dict(zip(map(tuple, contacts.blocks.tolist()), found.tolist(), strict=True)) == {(0, 1): 2e6, (1, 2): 1e6}
    assert crushing_strength(stones, contacts, [replace(tuff, compressive_strength=None), JointStrength("brick", 0.6)]) is None
