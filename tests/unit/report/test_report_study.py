"""What a report says of a study: published values, sensitivity, both starts of the iteration, the cut-off of the safety check."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from churchpipe.model.checks import SafetyCheck
from churchpipe.model.results import Iteration, StartRun
from churchpipe.model.swept import heading, setting
from churchpipe.report.block_curves import curve_label
from churchpipe.report.both import partner
from churchpipe.report.html import _cards
from churchpipe.report.notes import convergence_note
from churchpipe.report.plots import convergence_svg
from churchpipe.report.published import published_rows
from churchpipe.report.safety import part_overview, what_moves
from churchpipe.report.sensitivity import sensitivity_plots
from churchpipe.report.table import Row, columns_for
from records import analysis
from report_pages import Page, record_of, report, state_of, tower

NAN = float("nan")


def cited(load: str, model: str, factor: float, flow: str | None = None, friction: float | None = None) -> dict:
    return {"load": load, "model": model, "flow": flow, "load_factor": factor, "source": "Book", "friction": friction}


def row(load: str = "-y", factor: float | None = 0.234, **record: object) -> Row:
    return Row(analysis(**{"flow": "associative", "load": load, "friction": 0.6, "load_factor": factor} | record))


def shell(factor: float = 0.24, **record: object) -> Row:
    base = {"model": "homogenised-shell", "method": "limit", "load": "-y", "friction": 0.6, "element_size_mm": 200.0}
    return Row(analysis(**base | {"load_factor": factor} | record))


def test_published_values_stand_beside_what_answers_them() -> None:
    rows = [row(), row(factor=0.2, flow="non-associative", status="not-converged"), row("+x", 0.3), shell()]
    values = [
        cited("-y", "rigid", 0.237, "associative"),
        cited("-y", "rigid", 0.224, "non-associative"),
        cited("-y", "shell", 0.229),
        cited("-y", "experiment", 0.25),
        cited("+x", "shell", 0.21),
    ]
    table = published_rows(values, rows)
    assert table[0] == [
        "\u2212y",
        "rigid blocks, associative",
        "0.237",
        "rigid blocks, associative",
        "0.2340",
        "\u22121.3 %",
        "Book",
    ]
    assert table[1][3:6] == ["rigid blocks, non-associative, not-converged", "0.2000", "\u221210.7 %"]
    assert table[2][1:6] == ["shell", "0.229", "shell, limit load, 200 mm", "0.2400", "+4.8 %"]
    # What was measured stands beside all of that load.
    assert [cells[3:6:2] for cells in table[3:6]] == [
        ["rigid blocks, associative", "\u22126.4 %"],
        ["rigid blocks, non-associative, not-converged", "\u221220.0 %"],
        ["shell, limit load, 200 mm", "\u22124.0 %"],
    ]
    assert table[6][:6] == ["+x", "shell", "0.210", "not analysed", "", ""]


def test_a_published_value_holds_for_its_friction() -> None:
    swept = [row(factor=factor, friction=mu, swept={"material.default.friction": mu}) for mu, factor in ((0.5, 0.2), (0.6, 0.23))]
    (cells,) = published_rows([cited("-y", "rigid", 0.237, "associative", 0.6)], swept)
    assert cells[1:6] == [
        "rigid blocks, associative, friction 0.6",
        "0.237",
        "rigid blocks, associative, friction 0.6",
        "0.2300",
        "\u22123.0 %",
    ]
    assert len(published_rows([cited("-y", "rigid", 0.237, "associative")], swept)) == 2
    (cells,) = published_rows([cited("-y", "rigid", 0.2, "associative")], [row(factor=None, status="unstable")])
    assert cells[3:6] == ["rigid blocks, associative, unstable", "none", ""]


def test_settings_have_units() -> None:
    assert heading("source.stone_length_m") == "stone length, m"
    assert setting("source.stone_length_m", 0.57) == "stone length 0.57 m"
    assert heading("material.default.unit_weight_kN_m3") == "unit weight, kN/m\u00b3"
    assert setting("shell.planes", "cell") == "planes cell"
    assert heading("material.default.friction") == "friction"
    assert heading("ties.north.strength_kN") == "strength of north, kN"
    assert setting("check.spectrum.TC_star_s", 0.4) == "TC star of spectrum 0.4 s"


def test_settings_of_one_name_are_told_apart() -> None:
    keys = (
        ("source.thickness_m", "source.apse.thickness_m"),
        ("material.default.friction", "material.brick.friction", "joints.base.friction", "joints.0.friction"),
        ("source.brick_mm.0", "source.brick_mm.2", "source.openings.0.width_mm", "source.openings.1.width_mm"),
        ("material.nave.unit_weight_kN_m3", "material.tower.unit_weight_kN_m3"),
    )
    for alike in keys:
        assert len(set(map(heading, alike))) == len({setting(key, 1) for key in alike}) == len(alike)
    assert heading("source.brick_mm.0") == "brick.0, mm"
    assert heading("material.brick.friction") == "friction of brick"


def test_curves_of_a_sweep_are_told_apart() -> None:
    keys = "source.brick_mm.0", "material.nave.friction", "joints.base.friction", "joints.0.friction"
    labels = [curve_label(analysis(method="curve", swept={key: 0.4})) for key in keys]
    assert labels == ["brick.0 0.4 mm", "friction of nave 0.4", "friction of joints.base 0.4", "friction of joints.0 0.4"]


def test_frictions_of_single_joints_are_told_where_they_are_swept() -> None:
    both = [
        row(factor=factor, swept={"material.default.friction": 0.6, "joints.base.friction": mu})
        for mu, factor in ((0.2, 0.2), (0.5, 0.5))
    ]
    assert [one.label for one in both] == [
        f"associative, load \u2212y, friction 0.6, friction of joints.base {mu}" for mu in (0.2, 0.5)
    ]
    assert "friction of joints.base" in [column.title for column in columns_for(both)]
    # Of the shell, the one with the same joints answers the same question.
    assert (
        partner(shell(swept={"joints.base.friction": 0.5}), [row(swept={"joints.base.friction": mu}) for mu in (0.2, 0.5)]) == 1
    )


def test_each_number_that_is_swept_has_its_plot() -> None:
    rows = [
        row(
            factor=0.2 + mu * b,
            friction=mu,
            swept={"material.default.friction": mu, "source.stone_length_m": b, "source.first_course": "x"},
        )
        for mu in (0.5, 0.6)
        for b in (0.46, 0.57, 0.7)
    ]
    plots = dict(sensitivity_plots(rows))
    assert list(plots) == ["friction", "stone length, m"]
    assert all(f"stone length {b} m, first course x" in plots["friction"] for b in (0.46, 0.57, 0.7))
    assert all(f"friction {mu}, first course x" in plots["stone length, m"] for mu in (0.5, 0.6))
    # One curve a friction, three points each.
    assert len(re.findall(r"<use ", plots["stone length, m"])) >= 6
    assert sensitivity_plots(rows[:1]) == []
    meshes = [shell(0.2, swept={"shell.element_size_mm": size}) for size in (200, 100)]
    assert sensitivity_plots(meshes) == []


def test_both_starts_are_drawn_with_their_intervals() -> None:
    steps = (Iteration(0.3, 0.1), Iteration(0.25, 0.0, 1e-3), Iteration(0.24, 0.0, 1e-6))
    runs = (
        StartRun("dead-load", 0.24, True, 1e-7, (0.23, 0.26), steps),
        StartRun("associative", 0.25, False, 1e-3, (NAN, NAN), steps[:2]),
    )
    state = state_of(tower(), flow="non-associative", history=steps, interval=(0.23, 0.26))
    alone, both = convergence_svg(state), convergence_svg(replace(state, starts=runs))
    assert "dead-load" not in alone
    assert "load factor, dead-load start" in both
    assert "gap g / load factor, associative start" in both
    assert both.count("interval of the mechanism, 0.2300 to 0.2600") == 1
    words = convergence_note(Row(analysis(load_factor=0.24, gap=1e-7), replace(state, starts=runs, fixed_points=(0.24,))))
    missed = "forces and motion miss each other by"
    assert f"The dead-load start led to 0.2400 ({missed} 4.2e\u221207 of it, interval 0.2300 to 0.2600)." in words
    assert f"The associative start did not settle; it last was at 0.2500 ({missed} 4.0e\u221203 of it)." in words


def test_the_report_says_what_is_published_and_which_cut_off_it_used(tmp_path: Path) -> None:
    state = state_of(tower())
    check = {"alpha0": 0.25, "moving_weight_kN": 36.0, "moving_stones": 2, "participating_mass_t": 3.0, "mass_fraction": 0.8}
    check |= {"confidence_factor": 1.35, "a0_m_s2": 2.3, "a0_lumped_m_s2": 1.8}
    page = Page(report(tmp_path, [(record_of(state, check=check), state)]))
    assert "exceeds 1/1000 of the mechanism's speed" in page.text
    assert "Beside published values" not in page.text
    assert json.loads(page.scripts["application/json"])["analyses"]


@pytest.mark.parametrize("number", [1, 3])
def test_more_runs_than_three_do_not_break_the_plot(number: int) -> None:
    run = StartRun("uniform", 0.2, True, NAN, (NAN, NAN), (Iteration(0.2, 0.0, 1e-6),))
    assert convergence_svg(replace(state_of(tower()), starts=(run,) * number)).startswith("<svg")


def part(name: str, motion: float, moving: float = 1.0) -> dict:
    return {"name": name, "weight_kN": 10.0, "moving": moving, "displacement": 1.0, "motion": motion}


def test_macro_elements_of_all_loads_stand_in_one_table(tmp_path: Path) -> None:
    state = state_of(tower())
    first = record_of(state, parts=[part("shaft", 0.97), part("belfry", 0.03), part("apse", 0.0, 0.0)])
    second = record_of(state, "-y", parts=[part("belfry", 0.998), part("shaft", 0.002), part("apse", 0.0, 0.0)])
    rows = [Row(first, state), Row(second, state)]
    overview = part_overview(rows)
    assert overview is not None
    assert overview["headings"] == ["Share of the motion", "+x, associative", "\u2212y, associative"]
    assert overview["rows"] == [["belfry", "3 %", "100 %"], ["shaft", "97 %", "< 1 %"]]
    assert overview["still"] == ["apse"]
    assert part_overview(rows[:1]) is None
    assert what_moves(rows[0].record) == "shaft 97 %"
    assert what_moves(row().record) == ""
    few = replace(first, check=SafetyCheck(moving_stones=1, moving_weight=1250.0))
    assert what_moves(few) == "shaft 97 %; no more than 1 stone of 1.25 kN"
    assert what_moves(replace(first, check=SafetyCheck(moving_stones=40, moving_weight=5e4))) == "shaft 97 %"
    page = Page(report(tmp_path, [(first, state), (second, state)]))
    assert "moves: belfry 100 %" in page.text
    assert ["shaft", "97 %", "< 1 %"] in page.rows
    assert "At rest under all of them: apse." in page.text


def test_shares_of_the_motion_are_told_of_the_variant_and_the_setting_that_they_are_of() -> None:
    moving = {"parts": [{"name": "apse", "weight_kN": 1.0, "moving": 1.0, "displacement": 1.0, "motion": 1.0}]}
    # Nothing brings the building down as it is; without its buttresses it falls.
    rows = [
        row("+x", None, status="unbounded"),
        row("+x", variant="no buttresses", **moving),
        row("+y", swept={"source.thickness_m": 0.6}, **moving),
        row("+y", swept={"source.thickness_m": 0.8}, **moving),
    ]
    overview = part_overview(rows)
    assert overview is not None
    assert overview["headings"][1:] == ["+x, associative, no buttresses", "+y, associative, thickness 0.6 m"]


def test_the_card_of_the_careful_value_says_so_and_a_capacity_curve_is_no_rival() -> None:
    sliding = row(factor=0.1885, flow="non-associative", status="converged")
    curve = row(flow=None, method="curve", status="converged")
    assert [card["use"] for card in _cards([sliding, row(), shell(), curve, row("+x")], both_models=True)] == [
        "the careful value: use it",
        *[""] * 4,
    ]
    assert [card["use"] for card in _cards([row(), curve], both_models=False)] == ["", ""]
