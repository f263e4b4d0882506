"""A case with variants, from its file to summary.json: what a variant leaves as it is is solved once."""

import csv
import json
from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe import stages
from churchpipe.configuring import configure
from churchpipe.io.summary import Summary
from churchpipe.model.quantities import as_read
from churchpipe.terminal import results_table

VARIANTS = """
[check]
ag_g = 0.1
soil_factor = 1.0
[[variants]]
name = "wet"
change = { "material.default.friction" = 0.3 }
cost = { EUR = 900 }
[[variants]]
name = "thicker"
change = { source.thickness_mm = 500 }
[[variants]]
name = "checked with q = 1.5"
change = { check.q = 1.5 }
[[variants]]
name = "looked at"
cost = { EUR = 50 }
"""


def test_variants_stand_beside_the_building_as_it_is(tmp_path: Path) -> None:
    plan = configure(case_file(tmp_path, WALL + VARIANTS), tmp_path / "run")
    index, run = json.loads(plan.read_text()), plan.parent
    for name in index["geometries"]:
        folder = run / "geometry" / name
        stages.source(folder / "settings.json", folder / "building.json")
        stages.blocks(folder / "building.json", *(folder / file for file in ("assemblage.npz", "stones.dxf", "stones.vtu")))
        stages.contacts(folder / "tolerances.json", folder / "assemblage.npz", folder / "contacts.npz")
    for entry in index["analyses"]:
        folder, stones = run / "rigid" / entry["name"], run / "geometry" / entry["geometry"]
        joints = stones / "assemblage.npz", stones / "contacts.npz"
        stages.rigid(folder / "settings.json", *joints, folder / "rigid.npz", folder / "rigid.json")
    stages.compare(plan, run / "summary.json", run / "table.csv")
    summary = json.loads((run / "summary.json").read_text())
    records = {record["name"]: record for record in summary["analyses"]}
    factors = {variant["name"]: [records[name]["load_factor"] for name in variant["analyses"]] for variant in summary["variants"]}
    # A wall 0.25 m thick and 0.6 m high overturns at b / h, 0.5 m thick at twice that, but for sliding at 0.6.
    assert factors[None] == pytest.approx([0.25 / 0.6], abs=1e-6)
    assert factors["thicker"] == pytest.approx([0.6], abs=1e-6)
    assert factors["wet"] == pytest.approx([0.3], abs=1e-6)
    assert factors["looked at"] == factors["checked with q = 1.5"] == factors[None]
    assert [record["variant"] for record in summary["analyses"]] == [None, "wet", "thicker", "checked with q = 1.5"]
    assert [variant["cost"] for variant in summary["variants"]] == [{}, {"EUR": 900}, {}, {}, {"EUR": 50}]
    checks = [records[name]["check"]["zeta_e"] for name in ("+y_associative", "+y_associative_checkedwithq=1.5")]
    assert checks[0] / checks[1] == pytest.approx(2 / 1.5)
    rows = list(csv.DictReader((run / "table.csv").open()))
    assert [row["variant"] for row in rows] == ["", "wet", "thicker", "checked with q = 1.5"]
    assert [row["name"] for row in rows] == [record["name"] for record in summary["analyses"]]
    assert [column.header for column in results_table(as_read(Summary, summary)).columns][:2] == ["variant", "load"]
