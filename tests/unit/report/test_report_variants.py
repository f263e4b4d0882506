"""The building as it is beside its variants, in the report."""

import re
from dataclasses import replace
from pathlib import Path

from churchpipe.io.records import Analysis
from churchpipe.io.summary import VariantResult
from churchpipe.model.checks import DisplacementCheck
from churchpipe.report.variants import variants_section
from records import analysis
from report_pages import Page, record_of, report, state_of, tower

SITE = {"zeta_e": 0.8, "zeta_e_stones": 1.1, "satisfied": False, "satisfied_stones": True}
MOVES = [{"name": "facade", "motion": 0.93, "moving": 1.0, "weight_kN": 3.0, "displacement": 1.0}]


def record(name: str, factor: float | None, variant: str | None = None, load: str = "-y", **more: object) -> Analysis:
    base = {"name": name, "variant": variant, "flow": "associative", "load": load, "geometry": "base"}
    return analysis(**base | {"load_factor": factor, "status": "unstable" if factor is None else "optimal"} | more)


SHELL = {"model": "homogenised-shell", "method": "limit", "flow": None}
ANALYSES = [
    record("a", 0.2, check=SITE, parts=MOVES),
    record("b", 0.3, load="+x"),
    record("s", 0.21, **SHELL),
    record("a ties", 0.25, "two ties", check=SITE | {"zeta_e": 1.05, "satisfied": True}),
    record("s ties", 0.24, "two ties", **SHELL),
    record("a thick", None, "thicker", geometry="thicker"),
]
VARIANTS = [
    VariantResult(None, "base", {}, ("a", "b", "s")),
    VariantResult("two ties", "base", {"tie, m": 24, "EUR": 9500.5}, ("a ties", "b", "s ties")),
    VariantResult("thicker", "thicker", {"EUR": 40000}, ("a thick",)),
]


def test_the_check_by_displacements_governs_where_a_variant_has_a_curve() -> None:
    made = {"zeta_e": 0.6, "zeta_e_stones": 0.9, "satisfied": False, "satisfied_stones": False}
    checks = {"d": DisplacementCheck(**made), "d ties": DisplacementCheck(message="no proved step")}
    curves = [
        replace(record("d", 0.2, method="curve"), check=checks["d"]),
        replace(record("d ties", 0.25, "two ties", method="curve"), check=checks["d ties"]),
    ]
    variants = [
        VariantResult(None, "base", {}, ("a", "d")),
        VariantResult("two ties", "base", {}, ("a ties", "d ties")),
    ]
    section = variants_section(variants, [*ANALYSES, *curves], "base")
    assert section is not None
    # A curve without a check leaves that of accelerations; load factors are those of the other analyses.
    assert [row["check"] for row in section["rows"]] == ["ζ_E = 0.60, not satisfied", "ζ_E = 1.05, satisfied"]
    assert section["headings"] == ["rigid blocks, associative"]


def test_a_change_that_rounds_to_nothing_is_no_loss() -> None:
    changed = [replace(one, load_factor=0.19999) if one.name == "a ties" else one for one in ANALYSES]
    section = variants_section(VARIANTS, changed, "base")
    assert section is not None
    assert section["rows"][1]["factors"][0] == ("0.2000", "+0.0 %")


def test_each_load_has_the_building_as_it_is_and_its_variants() -> None:
    section = variants_section(VARIANTS, ANALYSES, "base")
    assert section is not None
    assert section["headings"] == ["rigid blocks, associative", "shell, limit load"]
    assert section["costs"] == ["tie, m", "EUR"]
    rows = {(row["load"], row["name"]): row for row in section["rows"]}
    assert list(rows) == [
        ("−y", "as it is"),
        ("−y", "two ties"),
        ("−y", "thicker"),
        ("+x", "as it is"),
        ("+x", "two ties"),
    ]
    asis, ties, thick = (rows["−y", name] for name in ("as it is", "two ties", "thicker"))
    assert asis["factors"] == [("0.2000", ""), ("0.2100", "")]
    assert ties["factors"] == [("0.2500", "+25.0 %"), ("0.2400", "+14.3 %")]
    assert thick["factors"] == [("unstable", ""), ("", "")]
    assert (asis["moves"], asis["check"]) == ("facade 93 %", "ζ_E = 0.80, only with e* of stones")
    assert ties["check"] == "ζ_E = 1.05, satisfied"
    assert (ties["costs"], thick["costs"], asis["costs"]) == (["24", "9,500.5"], ["", "40,000"], ["", ""])
    # What a variant leaves as it is has the same load factor, and was solved once.
    assert rows["+x", "two ties"]["factors"][0] == ("0.3000", "+0.0 %")
    assert "two ties" in section["chart"]


def test_what_moves_is_told_of_the_lowest_load_factor() -> None:
    sliding = record("n", 0.15, flow="non-associative", parts=[MOVES[0] | {"name": "gable"}])
    section = variants_section([replace(VARIANTS[0], analyses=("a", "n")), VARIANTS[1]], [*ANALYSES, sliding], "base")
    assert section is not None
    assert section["rows"][0]["moves"] == "gable 93 %"


def test_each_value_of_a_sweep_has_a_row_of_its_own() -> None:
    # Friction as well, which other tables show in a column: that of the material, and that of single joints.
    keys = "material.default.friction", "joints.0.friction"
    points = ((0.4, 0.2, 0.2), (0.4, 0.4, 0.4), (0.6, 0.4, 0.5))
    found = [
        record(f"{variant or ''}{number}", factor * (1.5 if variant else 1.0), variant, friction=values[0], swept=values_of)
        for variant in (None, "grouted")
        for number, (*values, factor) in enumerate(points)
        if (values_of := dict(zip(keys, values, strict=True)))
    ]
    variants = [
        VariantResult(name, "base", {}, tuple(one.name for one in found if one.variant == name)) for name in (None, "grouted")
    ]
    section = variants_section(variants, found, "base")
    assert section is not None
    assert [(row["load"], row["name"], *row["factors"][0]) for row in section["rows"]] == [
        (f"\u2212y, friction {mu}, friction of joints.0 {joints}", *cells)
        for mu, joints, factor in points
        for cells in (("as it is", f"{factor:.4f}", ""), ("grouted", f"{1.5 * factor:.4f}", "+50.0 %"))
    ]


def test_names_of_many_loads_stand_beside_each_other_below_the_chart() -> None:
    swept = [{"joints.damp course.friction": mu, "source.stone_length_m": b} for mu in (0.2, 0.4, 0.6) for b in (0.5, 0.7)]
    found = [
        record(f"{variant or ''}{number}", 0.3, variant, swept=values)
        for variant in (None, "grouted")
        for number, values in enumerate(swept)
    ]
    variants = [
        VariantResult(name, "", {}, tuple(one.name for one in found if one.variant == name)) for name in (None, "grouted")
    ]
    section = variants_section(variants, found, "")
    assert section is not None
    texts = re.findall(r">([^<>]+)</t", section["chart"])
    assert "joints.damp" in texts
    assert max(map(len, texts)) <= 11


def test_what_bears_less_than_nothing_has_no_shares() -> None:
    found = [record("a", -0.1), record("b", 0.2, "propped")]
    section = variants_section([VariantResult(None, "", {}, ("a",)), VariantResult("propped", "", {}, ("b",))], found, "")
    assert section is not None
    assert [row["factors"] for row in section["rows"]] == [[("\u22120.1000", "")], [("0.2000", "")]]


def test_pictures_of_other_geometries_are_linked() -> None:
    section = variants_section(VARIANTS, ANALYSES, "base")
    assert section is not None
    assert {row["name"]: row["link"] for row in section["rows"]} == {
        "as it is": "",
        "two ties": "",
        "thicker": "geometry/thicker/report.html",
    }
    other = variants_section(VARIANTS, ANALYSES, "thicker")
    assert other is not None
    assert other["rows"][0]["link"] == "../../report.html"
    assert variants_section([], ANALYSES, "base") is None


def test_variants_of_one_geometry_link_nowhere() -> None:
    section = variants_section(VARIANTS[:2], ANALYSES, "")
    assert section is not None
    assert [row["link"] for row in section["rows"]] == [""] * 4


def test_the_section_stands_on_the_first_page(tmp_path: Path) -> None:
    stones = tower()
    state = state_of(stones)
    own = record_of(state, name="a", geometry="base"), record_of(state, name="c", geometry="base", variant="two <b>ties</b>")
    text = report(
        tmp_path,
        [(one, state) for one in own],
        variants=[
            {"name": None, "geometry": "base", "cost": {}, "analyses": ["a"]},
            {"name": "two <b>ties</b>", "geometry": "base", "cost": {"m": 3}, "analyses": ["c"]},
        ],
    )
    assert 'id="variants"' in text
    assert text.index('id="variants"') < text.index('id="load-factors"')
    assert "two &lt;b&gt;ties" in text
    assert "two <b>ties" not in text.partition("<script")[0]
    assert Page(text)
