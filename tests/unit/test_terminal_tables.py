"""Tables of the terminal: on a narrow one nothing is cut that tells one row from another."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from churchpipe.mechanism import Part
from churchpipe.model.checks import DisplacementCheck
from churchpipe.terminal import mechanism_table, remarks, results_table, runs_table
from records import analysis, summary

MOVING = (Part("nave_left", 2e4, 1.0, 0.5, 0.75),)


def shown(table: object, width: int) -> str:
    stream = io.StringIO()
    Console(file=stream, width=width, color_system=None).print(table)
    return stream.getvalue()


@pytest.mark.parametrize("width", [60, 80, 120])
def test_rows_of_a_sweep_differ_on_a_narrow_terminal(width: int) -> None:
    records = [
        replace(
            analysis(flow="associative"),
            name=f"+y_associative_friction=0.{digit}_thickness_mm=300_stone_length_mm=500",
            parts=MOVING,
            swept={"source.stone_length_mm": 500, "source.thickness_mm": 300 + digit},
        )
        for digit in range(3)
    ]
    found = replace(summary(), analyses=tuple(records))
    for table in (mechanism_table(found), results_table(found)):
        assert "…" not in shown(table, width)
    lines = shown(mechanism_table(found), width).splitlines()
    first = "".join(line[1:].split("  ")[0].strip() for line in lines[4:])
    for record in records:
        assert record.name in first


@pytest.mark.parametrize(("flows", "said"), [(["associative"], True), (["associative", "non-associative"], False)])
def test_load_factors_that_are_associative_alone_are_called_upper_estimates(flows: list[str], said: bool) -> None:
    found = replace(summary(), analyses=tuple(analysis(flow=flow) for flow in flows))
    assert ("associative: an upper estimate where joints slide" in shown(results_table(found), 140)) == said


def test_frictions_of_single_joints_that_are_swept_have_a_column() -> None:
    records = tuple(
        analysis(flow="associative", swept={"material.default.friction": 0.7, "joints.0.friction": mu}) for mu in (0.25, 0.35)
    )
    text = shown(results_table(replace(summary(), analyses=records)), 120)
    assert "joints.0.friction" in text
    assert "material.default.friction" not in text
    assert "0.25" in text
    assert "0.35" in text


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("variant", [None, "with ties"], ids=["alone", "variants"])
def test_words_stay_whole(variant: str | None, width: int) -> None:
    ends = {"load_factor": 0.155032, "interval": [0.1548, 0.1552], "seconds": 1423.4, "status": "not-converged"}
    records = (
        analysis(flow="associative", variant=variant, load_factor=0.161234, lower_bound=0.1612, upper_bound=0.161243),
        analysis(flow="non-associative", contact_model="torsion", variant=variant, **ends),
        analysis(model="homogenised-shell", method="limit", variant=variant, element_size_mm=300.0),
    )
    text = shown(results_table(replace(summary(), analyses=records)), width)
    words = {word.rstrip(";") for word in text.split()}
    assert {"associative", "friction", "0.161234", "limit", "0.1552"} <= words
    for begin, rest in (("non-", "associative,"), ("not-", "converged")):
        assert begin + rest in words or {begin, rest} <= words
    assert max(map(len, text.splitlines())) <= width


@pytest.mark.parametrize("width", [80, 100, 112])
def test_a_long_name_ends_a_line_between_its_parts(width: int) -> None:
    parts = tuple(Part(f"wall_{number}", 2e4, 1.0, 0.5, 0.2) for number in range(5))
    records = [
        replace(analysis(flow="associative"), name=name, parts=parts) for name in ("+x_associative", "+x_associative_twoties")
    ]
    told = shown(mechanism_table(replace(summary(), analyses=tuple(records))), width)
    assert "+x_associative" in told
    assert "twoties" in told


def test_a_long_name_of_a_run_is_whole(tmp_path: Path) -> None:
    name = "church_with_" * 8 + "end"
    (tmp_path / name).mkdir()
    (tmp_path / name / "plan.json").write_text("{}")
    assert "…" not in shown(runs_table(tmp_path), 60)


def test_the_checks_of_curves_of_one_load_are_told_apart() -> None:
    governs = DisplacementCheck(governs="The displacement-based check governs.")
    swept = analysis(method="curve", swept={"material.default.friction": 0.5})
    records = [replace(one, check=governs) for one in (analysis(method="curve"), analysis(method="curve", variant="tied"), swept)]
    said = [line for line in remarks(replace(summary(), analyses=tuple(records))) if "governs" in line]
    assert [line.partition(": ")[0] for line in said] == ["Load +x", "Load +x, tied", "Load +x, friction 0.5"]


def test_no_limit_is_explained_once_for_all_loads() -> None:
    endless = analysis(load="-z", status="unbounded", load_factor=None, flow="associative")
    tied = replace(endless, variant="tied", flow="non-associative")
    found = replace(summary(), analyses=(endless, replace(endless, flow="non-associative"), tied, analysis(flow="associative")))
    (said,) = [line for line in remarks(found) if "no limit" in line]
    assert said.startswith('Load -z, -z (tied): "no limit" means that no multiple of it brings down what is modelled.')
    assert not any("no limit" in line for line in remarks(replace(summary(), analyses=(analysis(flow="associative"),))))
