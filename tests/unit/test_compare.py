"""Pairs of analyses that ask the same, and how far two mechanisms are alike."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.compare import bad_news, careful_first, contact_models, guidance, overlap, pairs
from churchpipe.generators import box
from churchpipe.io.records import Analysis
from churchpipe.io.tie_records import TieForce
from churchpipe.match import Match
from churchpipe.model.materials import Material
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stones.blocks import derive_blocks
from records import MATCHED, WORDS, analysis, summary

HOUSE = box(
    length=2.0, width=1.5, thickness=0.25, brick=(0.5, 0.25, 0.25), courses=4, materials=(Material("default", 18e3, 0.6),)
)


def turning(points: np.ndarray) -> np.ndarray:
    """Velocities of a turn about the x axis and a drift along z."""
    return np.cross([1.0, 0, 0], points) + np.array([0, 0, 0.3])


@pytest.fixture(scope="module")
def models():
    stones, shell = derive_blocks(HOUSE), derive_shell(HOUSE, 0.25)
    velocities = np.zeros((stones.count, 6))
    velocities[:, :3] = turning(stones.centroid)
    return stones, velocities, shell


def test_one_motion_in_both_models_overlaps_wholly(models) -> None:
    stones, velocities, shell = models
    motion = turning(shell.points)
    # Linear fields are interpolated exactly on the facets; stones are cut at corners, off the mid-plane by some centimetres.
    assert overlap(stones, velocities, shell, motion) == pytest.approx(1.0, abs=2e-3)
    assert overlap(stones, 5 * velocities, shell, -motion) == pytest.approx(-1.0, abs=2e-3)


def test_motions_at_right_angles_do_not_overlap(models) -> None:
    stones, velocities, shell = models
    assert overlap(stones, velocities, shell, np.tile([1.0, 0, 0], (len(shell.points), 1))) == pytest.approx(0, abs=1e-9)
    assert np.isnan(overlap(stones, velocities, shell, np.zeros_like(shell.points)))


def test_there_are_no_ratios_to_less_than_nothing() -> None:
    stones = analysis(name="r", flow="non-associative", contact_model="corners", load_factor=-0.1)
    shell = analysis(name="s", model="homogenised-shell", load_factor=0.2)
    (pair,) = pairs([stones, shell])
    assert pair.ratio is None
    torsion = replace(stones, contact_model="torsion", load_factor=-0.2)
    assert contact_models([stones, torsion]) == []
    (both,) = contact_models([replace(stones, load_factor=0.2), replace(torsion, load_factor=0.1)])
    assert both.difference == pytest.approx(-0.5)


def test_pairs_ask_the_same_question() -> None:
    def record(name: str, factor: float | None, friction: float = 0.6, load: str = "+x") -> Analysis:
        model, swept = "homogenised-shell" if name.startswith("s") else "rigid-block", {"material.default.friction": friction}
        return analysis(name=name, model=model, load_factor=factor, friction=friction, load=load, swept=swept)

    records = [
        record("r5", 0.18, 0.5),
        record("r6", 0.2),
        replace(record("r6 uniform", 0.19), swept={"material.default.friction": 0.6, "rigid.start": "uniform"}),
        replace(record("s6 fine", 0.21), swept={"material.default.friction": 0.6, "shell.element_size_mm": 30}),
        record("s6 failed", None),
        record("s6 other load", 0.3, load="+y"),
    ]
    found = pairs(records)
    assert [(pair.blocks, pair.shell) for pair in found] == [("r6", "s6 fine"), ("r6 uniform", "s6 fine")]
    assert found[0].ratio == pytest.approx(0.21 / 0.2)


def test_news_of_gates_and_analyses() -> None:
    good, bad = WORDS, WORDS | {"status": "failed"}
    assert bad_news(summary(analyses=[good, bad])) == [analysis(status="failed")]
    assert bad_news(summary(analyses=[good], match={"message": "no walls"})) == [Match(message="no walls")]
    size = {"geometry": "base", "element_size_mm": 60.0, "elements": 1, "nodes": 3}
    meshes = {"coarse": size | {"match": MATCHED}, "fine": size | {"match": {}}}
    assert bad_news(summary(analyses=[good], match=MATCHED, shells=meshes)) == [Match()]


def analysed(factor: float | None, load: str = "-y", status: str = "optimal", **more: object) -> Analysis:
    model = "homogenised-shell" if "method" in more else "rigid-block"
    return analysis(model=model, load=load, load_factor=factor, status=status, **more)


def test_a_sentence_says_which_load_factor_to_use_and_why_they_differ() -> None:
    associative = analysed(0.2065, flow="associative")
    sliding = analysed(0.1887, flow="non-associative", status="converged")
    shell = analysed(0.2216, method="limit", planes="cell", element_size_mm=60)
    [sentence] = guidance([associative, sliding, shell])
    assert sentence.startswith("Load -y: use 0.1887 (rigid blocks, non-associative), the careful value, not 0.2065")
    assert "0.2216 (shell, limit load, 60 mm)" in sentence
    for reason in ("open as they slide", "slide without opening", "infinitely small stones"):
        assert reason in sentence
    assert "planes of the paper" not in sentence
    # Too large by nature: planes never lead where something else is known.
    assert guidance([associative, analysed(0.206501, flow="non-associative")]) == [
        "Load -y: use 0.2065 (rigid blocks, associative; rigid blocks, non-associative), in which all limit analyses agree."
    ]
    # Where the stones agree under both flow rules, dilatancy is not why the shell differs.
    [sentence] = guidance([associative, analysed(0.206501, flow="non-associative"), shell])
    assert "Why they differ: The shell is associative" in sentence
    [sentence] = guidance([associative, analysed(0.15, method="limit", planes="paper")])
    assert sentence.startswith("Load -y: use 0.2065 (rigid blocks, associative)")
    assert "planes of the paper overrate the strength" in sentence


@pytest.mark.parametrize(
    ("tied", "sliding", "said"),
    [
        (0.2547, 0.1882, True),
        # What weakens the building does so by the associative analysis as well.
        (0.2000, 0.1882, False),
        (0.2547, 0.2130, False),
        (0.2547, 0.2200, False),
    ],
)
def test_a_variant_that_is_weaker_without_dilatancy_alone_is_told_of(tied: float, sliding: float, said: bool) -> None:
    # A drawn house of two storeys, pushed along +y, in which a tie along x bears next to nothing.
    as_it_is = [analysed(0.2547, flow="associative"), analysed(0.2136, flow="non-associative", status="converged")]
    with_tie = [
        analysed(tied, flow="associative", variant="tied"),
        analysed(sliding, flow="non-associative", status="converged", variant="tied"),
    ]
    start = "tied, load -y: without dilatancy 0.1882 is below the 0.2136 of the building as it is"
    assert [text.startswith(start) for text in guidance([*as_it_is, *with_tie])] == [False, False, *([True] if said else [])]


def test_a_capacity_curve_that_starts_lower_is_told_of() -> None:
    # A round tower with a door, pushed across: nothing else in the run says how much of its load factor is dilatancy.
    tower = [analysed(0.7416, flow="associative", contact_model=model) for model in ("corners", "torsion")]
    curve = replace(analysed(0.5404, status="converged", method="curve"), model="rigid-block")
    advice, said = guidance([*tower, curve])
    assert advice.endswith("in which all limit analyses agree.")
    assert said.startswith("Load -y: its capacity curve, which is without dilatancy, starts lower, at 0.5404.")
    assert 'flow = ["associative", "non-associative"]' in said
    # Of one analysis as well; not beside one without dilatancy, nor of a curve that is not proved, nor of one that agrees.
    assert guidance([tower[0], curve]) == [said]
    assert len(guidance([*tower, analysed(0.54, flow="non-associative", status="converged"), curve])) == 1
    assert not guidance([tower[0], replace(curve, status="not-converged")])
    assert not guidance([tower[0], replace(curve, load_factor=0.739)])
    many = [replace(one, load=str(number)) for number in range(5) for one in (tower[0], curve)]
    assert guidance(many)[-1] == "2 other curves start lower or higher, too."


def test_a_capacity_curve_that_starts_lower_by_its_ties_is_no_measure_of_dilatancy() -> None:
    # Two walls that turn over, .5 and 1 m thick, with joists between them: no joint slides, and the load factor is .2585 without
    # dilatancy, too. The curve begins with the thin wall alone, .1518, and climbs as the joists stretch.
    joist = TieForce("floor 1", 3.3e3, 3.3e3, 1.0, True, "friction at its bearings", 1e-6)
    walls = replace(analysed(0.2585, flow="associative"), tie_forces=(joist,))
    curve = replace(analysed(0.1518, status="converged", method="curve"), model="rigid-block")
    [said] = guidance([walls, curve])
    assert "without dilatancy and begins with no more in its ties than their pretension, starts lower, at 0.1518. Ask for" in said
    assert "that value" not in said


def test_a_capacity_curve_that_starts_above_the_value_without_dilatancy_is_told_of() -> None:
    # A chapel with a barrel and ties, pushed across: the check by displacements is never below the start of its curve.
    sliding = analysed(0.0760, flow="non-associative", status="converged")
    curve = replace(analysed(0.1318, status="not-converged", method="curve"), model="rigid-block")
    [said] = guidance([sliding, curve])
    assert said.startswith("Load -y: its capacity curve starts at 0.1318, above 0.0760 (rigid blocks, non-associative).")
    assert "check by displacements" in said
    # A curve may begin a little above (docs/capacity_curve.md); of an associative analysis it says nothing.
    assert not guidance([sliding, replace(curve, load_factor=0.0771)])
    assert not guidance([analysed(0.0760, flow="associative"), curve])


def test_a_sentence_names_what_a_sweep_changes() -> None:
    def of(gap: float, friction: float, factor: float) -> Analysis:
        keys = {"rigid.contact_gap_mm": gap, "rigid.planes": "x", "material.default.friction": friction}
        return analysed(factor, flow="associative", friction=friction, swept=keys)

    first, second = guidance([of(1.0, 0.5, 0.125), of(2.0, 0.5, 0.125), of(1.0, 0.6, 0.15), of(2.0, 0.6, 0.16)])
    kind = "rigid blocks, associative, contact gap {} mm, planes x"
    use = f"use 0.1250 ({kind.format('1.0')}; {kind.format('2.0')}), in which all limit analyses agree."
    assert first == f"Load -y, friction 0.5: {use}"
    assert second.startswith(f"Load -y, friction 0.6: use 0.1500 ({kind.format('1.0')}), the careful value, not 0.1600")


def test_cohesion_is_named_where_it_makes_the_shell_stronger() -> None:
    both = {"cohesion_kPa": 5.0}
    stones, shell = analysed(0.25, flow="associative", **both), analysed(0.355, method="limit", **both)
    [sentence] = guidance([stones, shell])
    assert "Joints with cohesion bear tension in the shell" in sentence
    by_material = {"cohesion_kPa": {"a": 0.0, "b": 5.0}}
    [sentence] = guidance([analysed(0.25, flow="associative", **by_material), analysed(0.355, method="limit", **by_material)])
    assert "Joints with cohesion bear tension in the shell" in sentence
    # Nothing of it where joints have none, nor of stones alone.
    [sentence] = guidance([analysed(0.25, flow="associative"), analysed(0.355, method="limit")])
    assert "cohesion" not in sentence
    [sentence] = guidance([stones, analysed(0.2, flow="non-associative", **both)])
    assert "cohesion" not in sentence


def test_stones_that_may_come_out_are_named_for_every_load() -> None:
    told = "the state at -0.0979 from the start centre does not lead: in it 1 stone (N1) comes out whatever pushes"
    loose = [
        analysed(0.2, load=load, flow="non-associative", status="converged", message=f"{told}; found in 24 steps")
        for load in ("+x", "-x", "+y", "-y")
    ]
    assert guidance(loose) == [*(f"Load {load}: {told}." for load in ("+x", "-x", "+y")), "1 other analysis found such stones."]


def test_a_lower_state_that_is_nearly_as_exact_is_told_after_the_value_to_use() -> None:
    told = "the state at 0.2298 from the start centre is lower and nearly as exact: its forces and its motion miss each other by "
    told += "1.3e-05 of the load factor, where 1e-05 is wanted, so do not count on more"
    found = [
        analysed(0.2863, flow="associative"),
        analysed(0.2405, flow="non-associative", status="converged", message=f"{told}; found in 24 steps"),
    ]
    use, lower = guidance(found)
    assert use.startswith("Load -y: use 0.2405")
    assert lower == f"Load -y: {told}."


def test_a_load_factor_below_zero_is_none_to_use() -> None:
    associative, sliding = analysed(0.2342, flow="associative"), analysed(-0.0979, flow="non-associative", status="converged")
    [sentence] = guidance([associative, sliding])
    assert sentence.startswith(
        "Load -y: -0.0979 (rigid blocks, non-associative) is below zero, and no load factor of the building"
    )
    assert sentence.endswith("takes these thrusts for granted: 0.2342 (rigid blocks, associative).")
    assert "use -" not in sentence
    [alone] = guidance([sliding])
    assert alone.endswith("it needs a lintel, an arch or a tie.")


def test_a_load_factor_that_rounds_to_nothing_is_not_below_zero() -> None:
    nothing = [analysed(-5e-11, flow="associative"), analysed(-4e-5, flow="non-associative")]
    assert guidance(nothing) == [
        "Load -y: use 0.0000 (rigid blocks, associative; rigid blocks, non-associative), in which all limit analyses agree."
    ]


def test_there_is_nothing_to_say_of_one_value_or_of_none() -> None:
    assert guidance([analysed(0.2, flow="associative"), analysed(0.3, "+x", flow="associative")]) == []
    failed = [analysed(None, flow="non-associative", status="failed"), analysed(0.19, flow="associative", status="not-converged")]
    assert guidance([analysed(0.2, flow="associative"), *failed]) == []


def test_a_sweep_has_one_sentence() -> None:
    records = [
        analysed(factor, flow=flow, swept={"source.courses": courses})
        for courses in range(4)
        for flow, factor in (("associative", 0.2), ("non-associative", 0.19))
    ]
    [sentence] = guidance(records)
    assert sentence.startswith("Of the load factors for one load and one strength use the lowest.")
    assert "0.2" not in sentence


def test_of_several_answers_to_one_question_the_careful_one_leads() -> None:
    associative = analysed(0.2065, flow="associative")
    sliding = analysed(0.1887, flow="non-associative", status="converged")
    paper = analysed(0.15, method="limit", planes="paper")
    other = analysed(0.1, "+x", flow="associative")
    failed = analysed(None, flow="non-associative", status="failed")
    curve = analysed(0.18, method="curve", status="converged")
    assert careful_first([associative, other, failed, curve, paper, sliding]) == [
        sliding,
        associative,
        paper,
        failed,
        curve,
        other,
    ]
    unstable = analysed(None, flow="associative", status="unstable")
    assert careful_first([paper, unstable]) == [unstable, paper]


def test_of_vaults_the_value_without_dilatancy_counts_and_is_asked_for_where_it_is_missing() -> None:
    associative, sliding = analysed(0.3, flow="associative"), analysed(0.2, flow="non-associative", status="converged")
    first, second = guidance([associative, sliding], {"base": ["groin"]})
    assert first.startswith("groin: stones of vaults are held on all sides.")
    assert first.endswith("Use the load factors without dilatancy (non-associative).")
    assert second.startswith("Load -y: use 0.2000 (rigid blocks, non-associative), the careful value")
    failed = analysed(None, flow="non-associative", status="failed")
    [alone] = guidance([associative, failed], {"base": ["groin"]})
    assert "load factors of load -y are upper estimates" in alone
    assert 'flow = ["associative", "non-associative"]' in alone
    assert guidance([associative, sliding], {"base": []}) == [second]
    assert guidance([failed], {"base": ["groin"]}) == []
