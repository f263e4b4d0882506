"""A case with [sample], from its file to summary.json and samples.csv, without an engine."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from case_texts import WALL, case_file
from churchpipe import stages
from churchpipe.configuring import configure
from churchpipe.io.atomic import remove_parts
from churchpipe.run_folder import RunFolder

THICKNESS = """
[check]
ag_g = 0.1
soil_factor = 1.0
[sample]
number = 24
demands = [0.3]
parameters = [
  { key = "source.thickness_mm", distribution = "normal", mean = 250, standard_deviation = 20 },
  { key = "material.default.unit_weight_kN_m3", distribution = "uniform", low = 16, high = 22 },
]
"""


def run_all(folder: Path, text: str) -> Path:
    """Run a case with one geometry and rigid blocks, and its samples; return the folder of the run."""
    plan = configure(case_file(folder, text), folder / "run")
    index, run = json.loads(plan.read_text()), plan.parent
    stones = run / "geometry" / "base"
    stages.source(stones / "settings.json", stones / "building.json")
    stages.blocks(stones / "building.json", stones / "assemblage.npz")
    stages.contacts(stones / "tolerances.json", stones / "assemblage.npz", stones / "contacts.npz")
    for entry in index["analyses"]:
        own, kind = run / entry["kind"] / entry["name"], entry["kind"]
        inputs = own / "settings.json", stones / "assemblage.npz", stones / "contacts.npz"
        stages.STAGES[kind](*inputs, own / f"{kind}.npz", own / f"{kind}.json")
        if entry.get("halved"):
            stages.halved(*inputs, own / "halved.npz")
    for name in index["sample"]["names"]:
        own = run / "sample" / name
        stages.sample(own / "settings.json", Path("none"), own / "records.json", *map(Path, index["sample"]["shared"]))
    stages.compare(plan, run / "summary.json", run / "table.csv", run / "samples.csv")
    return run


def test_a_wall_of_uncertain_thickness_overturns_at_thickness_over_height(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run = run_all(tmp_path, WALL + THICKNESS)
    summary = json.loads((run / "summary.json").read_text())
    # The building as it is, 0.25 m thick and 0.6 m high, stays what it is.
    assert [record["load_factor"] for record in summary["analyses"]] == pytest.approx([0.25 / 0.6], abs=1e-6)
    study = summary["uncertainty"]
    thickness, weight = (study["points"][key] for key in ("source.thickness_mm", "material.default.unit_weight_kN_m3"))
    (found,) = study["analyses"]
    assert found["load_factors"] == pytest.approx(np.array(thickness) / 600, abs=1e-6)
    # Of a normal thickness the load factor is normal; 24 quasi-random samples have its mean and its spread.
    exact = stats.norm(250 / 600, 20 / 600)
    assert found["mean"] == pytest.approx(exact.mean(), rel=0.01)
    assert found["standard_deviation"] == pytest.approx(exact.std(), rel=0.15)
    assert found["quantiles"]["0.5"] == pytest.approx(exact.ppf(0.5), rel=0.02)
    assert found["rank_correlation"]["source.thickness_mm"] == pytest.approx(1.0)
    assert abs(found["rank_correlation"]["material.default.unit_weight_kN_m3"]) < 0.3
    assert found["explained"] == pytest.approx(1.0)
    assert found["demands"][0] == {"demand": 0.3, "probability": 0.0, "low": 0.0, "high": pytest.approx(0.117, abs=1e-3)}
    assert found["mechanisms"] == [
        {
            "moves": "",
            "count": 24,
            "share": 1.0,
            "mean": found["mean"],
            "low": min(found["load_factors"]),
            "high": max(found["load_factors"]),
        }
    ]
    check = summary["analyses"][0]["check"]
    assert found["ground_acceleration"]["demands"][0]["demand"] == check["a_g_m_s2"]
    capacity = np.array(found["ground_acceleration"]["capacity_m_s2"])
    assert capacity / found["load_factors"] == pytest.approx(check["a_g_slv_m_s2"] / summary["analyses"][0]["load_factor"])
    rows = list(csv.DictReader((run / "samples.csv").open()))
    assert [row["sample"] for row in rows] == [f"{number:05d}" for number in range(1, 25)]
    assert [float(row["source.thickness_mm"]) for row in rows] == thickness
    assert [float(row["material.default.unit_weight_kN_m3"]) for row in rows] == weight
    assert [float(row["load_factor"]) for row in rows] == found["load_factors"]


def test_samples_of_friction_use_the_stones_that_there_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = WALL.replace("0, 1, 0", "1, 0, 0") + '[sample]\nnumber = 4\n[[sample.parameters]]\nkey = "material.default.friction"\n'
    run = run_all_in(monkeypatch, tmp_path, text + 'distribution = "uniform"\nlow = 0.2\nhigh = 0.4\n')
    study = json.loads((run / "summary.json").read_text())["uncertainty"]
    # Pushed along, the wall slides on its foot.
    assert study["analyses"][0]["load_factors"] == pytest.approx(study["points"]["material.default.friction"], abs=1e-6)


def run_all_in(monkeypatch: pytest.MonkeyPatch, folder: Path, text: str) -> Path:
    """As the engine does, with paths from the folder of the run."""
    (folder / "run").mkdir()
    monkeypatch.chdir(folder / "run")
    return run_all(folder, text)


def test_a_sample_that_cannot_be_built_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = WALL.replace("courses = 3", "courses = 3\nopenings = [{ start_mm = 400, width_mm = 400, height_courses = 2 }]")
    text += '[sample]\nnumber = 8\n[[sample.parameters]]\nkey = "source.openings.0.start_mm"\ndistribution = "uniform"\n'
    run = run_all_in(monkeypatch, tmp_path, text + "low = 400\nhigh = 1200\n")
    study = json.loads((run / "summary.json").read_text())["uncertainty"]
    starts = np.array(study["points"]["source.openings.0.start_mm"])
    # Of a wall 1.2 m long; between a door 0.4 m wide and its end a quarter of a stone must fit.
    beyond = [f"{number:05d}" for number, start in enumerate(starts, 1) if start > 700]
    assert 0 < len(beyond) < 8
    assert [one["sample"] for one in study["refused"]] == beyond
    assert "narrower than a quarter of a stone" in study["refused"][0]["message"]
    assert study["analyses"][0]["count"] == 8 - len(beyond)
    assert study["analyses"][0]["without_result"] == {"refused": len(beyond)}


@pytest.mark.slow
def test_curves_that_are_checked_are_followed_in_half_the_step_and_those_of_samples_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    spectrum = THICKNESS.replace("number = 24", "number = 2").replace(
        "[sample]", "[check.spectrum]\nF0 = 2.5\nTC_star_s = 0.35\n[rigid.curve]\nstep_mm = 60\n[sample]"
    )
    summary = json.loads((run_all(tmp_path, WALL + spectrum) / "summary.json").read_text())
    (record,) = [record for record in summary["analyses"] if record.get("method") == "curve"]
    # A wall that rocks as one body: the steps do not matter.
    assert record["halved"]["difference"] < 0.01
    assert record["halved"]["d0_m"] == pytest.approx(record["d0_m"], rel=1e-3)
    assert len(record["halved"]["displacement_m"]) > len(record["displacement_m"])
    assert "With steps half as long the curve is up to" in record["check"]["halved"]
    (study,) = [one for one in summary["uncertainty"]["analyses"] if one["name"] == record["name"]]
    assert study["load_factors"] == pytest.approx(
        np.array(summary["uncertainty"]["points"]["source.thickness_mm"]) / 600, rel=1e-3
    )


def test_what_a_killed_sample_leaves_lies_in_its_run_and_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = configure(case_file(tmp_path, WALL + THICKNESS), tmp_path / "run").parent
    left: list[Path] = []

    def keep(of_sample: RunFolder, *_: object) -> None:
        shutil.copytree(of_sample.path, of_sample.path.with_name(f"{of_sample.path.name}-killed"))
        left.append(of_sample.path)
        raise KeyboardInterrupt

    monkeypatch.setattr("churchpipe.sample_run._analyse", keep)
    own = run / "sample" / "00001"
    with pytest.raises(KeyboardInterrupt):
        stages.sample(own / "settings.json", Path("none"), own / "records.json")
    assert left[0].parent == own
    assert sorted(path.name for path in own.iterdir()) == [f"{left[0].name}-killed", "settings.json"]
    remove_parts(run)
    assert [path.name for path in own.iterdir()] == ["settings.json"]
