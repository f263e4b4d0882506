"""[[variants]]: what a building could be, beside what it is."""

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.config.case import Generated, read_case, read_variants
from churchpipe.config.plan import plan
from churchpipe.config.plausible import questions
from churchpipe.errors import InputError
from churchpipe.resources import sample_case
from command_line import call

GROUTED = """
[[variants]]
name = "grouted"
change = { "material.default.cohesion_kPa" = 50 }
cost = { EUR = 12000, "grouted, m3" = 1.5 }
"""
THICKER = """
[[variants]]
name = "thicker, pushed along"
change = { source = { thickness_mm = 500 } }
[[variants.add.load]]
direction = [1, 0, 0]
"""


def line(text: str, of: str) -> int:
    return next(number for number, found in enumerate(text.splitlines(), 1) if found.startswith(of))


def test_a_variant_changes_adds_and_removes(tmp_path: Path) -> None:
    text = (
        WALL
        + GROUTED
        + THICKER
        + '[[variants]]\nname = "without its load"\nremove = ["load.+y"]\nadd.load = [{ direction = [0, -1, 0] }]\n'
    )
    text = text.replace("direction = [0, 1, 0]", 'direction = [0, 1, 0]\nname = "+y"')
    asis, grouted, thicker, turned = read_variants(case_file(tmp_path, text))
    assert (asis.variant, asis.materials[0].cohesion) == (None, 0)
    assert grouted.variant is not None
    assert (grouted.variant.name, grouted.materials[0].cohesion) == ("grouted", 50e3)
    assert grouted.variant.cost == {"EUR": 12000, "grouted, m3": 1.5}
    assert isinstance(thicker.source, Generated)
    assert thicker.source.parameters["thickness"] == 0.5
    assert [load.name for load in thicker.loads] == ["+y", "+x"]
    assert [load.name for load in turned.loads] == ["-y"]


def test_what_a_variant_leaves_as_it_is_is_made_once(tmp_path: Path) -> None:
    text = WALL + GROUTED + THICKER + '[[variants]]\nname = "as before"\ncost = { EUR = 0 }\n[shell]\nelement_size_mm = 200\n'
    todo = plan(read_variants(case_file(tmp_path, text)))
    assert list(todo.geometries) == ["base", "thicker,pushedalong"]
    assert [(mesh["name"], mesh["geometry"]) for mesh in todo.index["shells"]] == [(name, name) for name in todo.geometries]
    names = {variant["name"]: variant["analyses"] for variant in todo.index["variants"]}
    assert names[None] == names["as before"] == ["+y_associative", "+y_limit"]
    assert names["grouted"] == ["+y_associative_grouted", "+y_limit_grouted"]
    assert len(names["thicker, pushed along"]) == 4
    assert len(todo.analyses) == 8
    entry = next(entry for entry in todo.index["analyses"] if entry["name"] == "+y_limit_grouted")
    assert (entry["variant"], entry["geometry"], entry["shell"]) == ("grouted", "base", "base")
    without = plan(read_variants(case_file(tmp_path, WALL)))
    assert without.analyses["+y_associative"] == todo.analyses["+y_associative"]
    assert without.geometries["base"] == todo.geometries["base"]


def test_another_demand_is_another_check_of_the_same_analysis(tmp_path: Path) -> None:
    check = "[check]\nag_g = 0.2\nsoil_factor = 1.0\n"
    todo = plan(read_variants(case_file(tmp_path, WALL + check + '[[variants]]\nname = "q"\nchange.check.q = 1.5\n')))
    assert [entry["check"]["behaviour_factor"] for entry in todo.index["analyses"]] == [2.0, 1.5]


def test_variants_are_swept_too_but_for_what_they_change(tmp_path: Path) -> None:
    sweep = '[sweep]\n"material.default.friction" = [0.5, 0.6]\n"source.courses" = [3, 4]\n'
    cases = read_variants(case_file(tmp_path, WALL + '[[variants]]\nname = "pinned"\nchange."source.courses" = 5\n' + sweep))
    assert [len(case.swept) for case in cases] == [2, 2, 2, 2, 1, 1]
    sources = [case.source for case in cases if isinstance(case.source, Generated)]
    assert [source.parameters["courses"] for source in sources] == [3, 4, 3, 4, 5, 5]
    todo = plan(cases)
    assert len(todo.geometries) == 3


ROOFS = """
[[line_loads]]
name = "roof"
wall = "wall"
dead_kN_m = 4.0
[[line_loads]]
name = "floor"
wall = "wall"
dead_kN_m = 9.0
[[variants]]
name = "other"
"""


@pytest.mark.parametrize(
    ("swept", "change", "expected"),
    [
        # By its name, and by a table that holds it: what a variant changes is not swept.
        ("line_loads.0.dead_kN_m", 'change = { "line_loads.roof.dead_kN_m" = 2 }', [[2e3, 9e3]]),
        ("line_loads.1.dead_kN_m", 'change = { "line_loads.floor.dead_kN_m" = 2 }', [[4e3, 2e3]]),
        ("line_loads.1.dead_kN_m", 'change = { line_loads = [{ wall = "wall", dead_kN_m = 3.0 }] }', [[3e3]]),
        ("line_loads.0.dead_kN_m", 'remove = ["line_loads.roof"]', [[9e3]]),
        # The numbers of a sweep are those of the file, whatever a variant takes away before them.
        ("line_loads.1.dead_kN_m", 'remove = ["line_loads.roof"]', [[0.5e3], [8e3]]),
        ("line_loads.1.dead_kN_m", 'change = { "line_loads.roof.dead_kN_m" = 2 }', [[2e3, 0.5e3], [2e3, 8e3]]),
    ],
)
def test_a_sweep_follows_the_entries_that_a_variant_changes_or_takes_away(
    swept: str, change: str, expected: list[list[float]], tmp_path: Path
) -> None:
    sweep = f'[sweep]\n"{swept}" = [0.5, 8]\n'
    cases = read_variants(case_file(tmp_path, f"{WALL}{ROOFS}{change}\n{sweep}"))
    found = [[load.dead for load in case.carries.line_loads] for case in cases if case.variant]
    assert found == expected


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("chnage = {}", r'line \d+, variants\.0\.chnage: unknown key; .*Did you mean "change"\?'),
        ("cost = { EUR = [1] }", r"variants\.0\.cost\.EUR"),
        ("cost = { EUR = inf }", r"line {cost}, variants\.0\.cost\.EUR.*: wrong value; found inf; expected a finite number"),
        ('change."material.defualt.friction" = 0.7', r'the case has no material\.defualt\.friction.*Did you mean "default"\?'),
        ('change."material.default.frictoin" = 0.7', r'line {change}, variant "v", material\.default\.frictoin: unknown key'),
        (
            'change."material.default.friction" = -1',
            r'line {change}, variant "v", material\.default\.friction: wrong value; found -1',
        ),
        ('change."load.+z.direction" = [0, 0, 1]', r"line {change}, variants\.0\.change\..*: no such entry; found \+z"),
        ('remove = ["source.openings"]', r"line {remove}, variants\.0\.remove: the case has no source\.openings"),
        ('remove = ["load.7"]', r"variants\.0\.remove: no such entry; found 7"),
        ("add.material.default.friction = 0.7", r"line {add}, variants\.0\.add\.material\.default\.friction: is there already"),
        ("add.load = [{ direction = [0, 0, 0] }]", r'line {add}, variant "v", load\.1: no direction'),
        ('change.source = { generator = "arch" }', r"source\.mean_radius_m: missing key"),
        ('[[variants]]\nname = "v"', r"line \d+, variants\.1\.name: two variants of one name; found v"),
    ],
)
def test_a_variant_that_cannot_be_made(text: str, said: str, tmp_path: Path) -> None:
    whole = f'{WALL}[[variants]]\nname = "v"\n{text}\n'
    places = {word: line(whole, word) if f"\n{word}" in whole else 0 for word in ("change", "remove", "add", "cost")}
    with pytest.raises(InputError, match=said.format(**places)):
        read_variants(case_file(tmp_path, whole))


@pytest.mark.parametrize("value", ["1.5", "nan", "true", '"x"', "[1]", "[{ name = 3 }]", "{ name = 3 }"])
def test_variants_that_are_no_tables_hide_no_other_mistake(value: str, tmp_path: Path) -> None:
    """Where a mistake stands is looked for among the variants, too: `source` is missing here, or they are refused."""
    with pytest.raises(InputError, match=r"line \d+, (source|variants)"):
        read_variants(case_file(tmp_path, f"variants = {value}\n" + WALL.replace("1.2", '"1.2"')))


def test_what_a_generator_refuses_of_a_variant_is_said_of_it(tmp_path: Path) -> None:
    case = read_variants(
        case_file(tmp_path, WALL + '[[variants]]\nname = "v"\nchange = { source = { length_mm = 1, height_m = 0.6 } }\n')
    )[1]
    with pytest.raises(InputError, match=r'line \d+, variant "v", source'):
        case.building()


TIE = """
[[variants]]
name = "tied"
[[variants.add.ties]]
name = "rod"
start = { wall = "wall", along_m = 0.6, height_m = 0.5 }
end = { at_m = [0.6, 3.0, 0.5] }
area_mm2 = 100
steel_strength_MPa = 200
[[variants]]
name = "roofed"
[[variants.add.line_loads]]
name = "roof"
wall = "wall"
dead_kN_m = 2
"""


def test_ties_and_loads_are_added_by_a_variant(tmp_path: Path) -> None:
    cases = read_variants(case_file(tmp_path, WALL + TIE + "[shell]\nelement_size_mm = 200\n"))
    assert [(len(case.carries.ties), len(case.carries.line_loads)) for case in cases] == [(0, 0), (1, 0), (0, 1)]
    todo = plan(cases)
    assert list(todo.geometries) == ["base"]
    assert "ties" in todo.analyses["+y_associative_tied"]
    assert "ties" not in todo.analyses["+y_associative"]
    # The gate of a mesh compares what both models carry in each case of it.
    assert list(todo.shells) == ["base"]
    assert [len(table) for table in todo.carried["base"]] == [0, 1]


def test_the_gate_of_a_mesh_knows_the_loads_of_all_swept_cases(tmp_path: Path) -> None:
    roof = '[[line_loads]]\nwall = "wall"\ndead_kN_m = 2\n[shell]\nelement_size_mm = 200\n'
    todo = plan(read_variants(case_file(tmp_path, WALL + roof + '[sweep]\n"line_loads.0.dead_kN_m" = [1.0, 2.0, 3.0]\n')))
    (swept,) = todo.carried.values()
    assert [table["line_loads"][0]["dead"] for table in swept] == [1e3, 2e3, 3e3]


CHANGED = "change = { source.thickness_mm = 500 }"
REFUSED = [
    ('change = { "variants.0.name" = "b" }', r"variants\.0\.change: a variant of variants; found variants\.0\.name"),
    ('remove = ["variants"]', r"variants\.0\.remove: a variant of variants"),
    ('add.variants = [{ name = "b" }]', r"variants\.0\.add: a variant of variants"),
    ("cost = { EUR = inf }", r"line \d+, variants\.0\.cost\.EUR: wrong value; found inf; expected a finite number, or a text in"),
    # One of its own was passed over.
    ('change = { name = "b" }', r"line \d+, variants\.0\.change: a variant of name; found name; expected keys of the building"),
    (
        'add.project = { title = "b" }',
        r"variants\.0\.add: a variant of project; .* one title block: give the case its \[project\]",
    ),
    ("add.sample = { number = 3 }", r"variants\.0\.add: a variant of sample; .*: give the case its \[sample\]"),
    ('remove = ["load"]', r': variant "a" of line \d+: missing keys; expected load'),
    (
        'remove = ["material.default.friction"]',
        r': line \d+ with variant "a" of line \d+, material.default: missing keys; expected material\.default\.friction',
    ),
    ('remove = ["source"]', r'line 1 with variant "a" of line \d+, source: missing key'),
]


@pytest.mark.parametrize(("text", "said"), REFUSED, ids=[text[:30] for text, _ in REFUSED])
def test_what_is_wrong_is_said_of_the_variant(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        read_variants(case_file(tmp_path, f'{WALL}[[variants]]\nname = "a"\n{text}\n'))


def test_a_length_that_a_variant_gives_in_another_unit_is_not_swept(tmp_path: Path) -> None:
    sweep = '[sweep]\n"source.length_m" = [2.0, 3.2]\n'
    path = case_file(tmp_path, WALL + '[[variants]]\nname = "short"\nchange."source.length_mm" = 1600\n' + sweep)
    lengths = [case.source.parameters["length"] for case in read_variants(path) if isinstance(case.source, Generated)]
    assert lengths == [2.0, 3.2, 1.6]


def test_a_variant_is_not_called_as_the_building_as_it_is(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"variants\.0\.name: the building without variants; found As it is"):
        read_variants(case_file(tmp_path, f'{WALL}[[variants]]\nname = "As it is"\n{CHANGED}\n'))


def test_a_variant_that_changes_nothing_is_questioned(tmp_path: Path) -> None:
    same = '[[variants]]\nname = "a"\n[[variants]]\nname = "b"\nchange = { "material.default.friction" = 0.6 }\n'
    text = f'{WALL}{same}[[variants]]\nname = "c"\n{CHANGED}\n[[variants]]\nname = "d"\ncost = {{ EUR = 0 }}\n'
    cases = read_variants(case_file(tmp_path, text))
    assert cases[0].materials[0].friction == 0.6
    asked = [f'The variant "{name}" changes nothing: it is the building as it is. Is it meant?' for name in "ab"]
    assert questions(cases) == asked


def test_a_run_refuses_a_variant_with_walls_that_cannot_be_made(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = sample_case("box") + '\n[[variants]]\nname = "thick"\nchange = { source.thickness_mm = 90000 }\n'
    code, _, err = call(capsys, "run", case_file(tmp_path, text), "--out", tmp_path / "run")
    assert code == 1
    assert 'variant "thick"' in err
    assert "case.toml: line" in err
    assert not (tmp_path / "run").exists()


def test_joints_that_are_nowhere_are_found_by_check(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = case_file(tmp_path, f'{WALL}[[joints]]\nname = "loose"\nkind = "butt"\nfriction = 0.3\n')
    code, _, err = call(capsys, "check", path)
    assert code == 1
    assert re.search(r"line \d+, joints\.0: joints loose: no such joint", err)


NAMED = WALL + "".join(
    f'[[line_loads]]\nname = "{name}"\nwall = "wall"\ndead_kN_m = {dead}\n' for name, dead in (("floor", 9.0), ("roof", 4.0))
)


def dead_loads(path: Path, overrides: Sequence[str] = ()) -> list[tuple[float, ...]]:
    """The dead parts of floor and roof, kN/m, of each case of a file."""
    return [tuple(load.dead / 1e3 for load in case.carries.line_loads) for case in read_variants(path, overrides)]


def test_entries_are_set_and_swept_by_their_names(tmp_path: Path) -> None:
    path = case_file(tmp_path, NAMED)
    assert dead_loads(path, ["line_loads.roof.dead_kN_m=8"]) == [(9, 8)]
    swept = case_file(tmp_path, NAMED + '[sweep]\n"line_loads.roof.dead_kN_m" = [1.0, 2.0]\n', "swept.toml")
    assert dead_loads(swept) == [(9, 1), (9, 2)]
    # What is set is not swept any more, by whatever name.
    for key in ("line_loads.roof.dead_kN_m", "line_loads.1.dead_kN_m"):
        assert dead_loads(swept, [f"{key}=8"]) == [(9, 8)]
    with pytest.raises(InputError, match=r"--set line_loads\.rof\.dead_kN_m: no such entry; found rof; expected floor, roof"):
        dead_loads(path, ["line_loads.rof.dead_kN_m=8"])
    with pytest.raises(InputError, match=r"--set, line_loads\.1\.dead_kN_m: wrong value; found 'a'"):
        dead_loads(path, ["line_loads.roof.dead_kN_m=a"])


def test_entries_are_sampled_by_their_names(tmp_path: Path) -> None:
    drawn = '[sample]\nnumber = 4\n[[sample.parameters]]\nkey = "line_loads.roof.dead_kN_m"\n'
    path = case_file(tmp_path, NAMED + drawn + 'distribution = "uniform"\nlow = 1.0\nhigh = 2.0\n')
    sample = read_case(path).sample
    assert sample is not None
    assert sample.parameters[0].key == ("line_loads.1.dead_kN_m",)


@pytest.mark.parametrize("change", ["source.thickness_mm", "source"])
def test_an_empty_table_changes_nothing_and_is_told(tmp_path: Path, change: str) -> None:
    text = f'{WALL}[[variants]]\nname = "thicker"\n[variants.change.{change}]\n'
    with pytest.raises(InputError, match=rf"line \d+, .*{change}: nothing to change; found an empty table"):
        read_variants(case_file(tmp_path, text))


def test_an_empty_table_is_added_with_its_defaults(tmp_path: Path) -> None:
    text = f'{WALL}[[variants]]\nname = "curve"\n[variants.add.rigid.curve]\n'
    assert [case.rigid.curve is not None for case in read_variants(case_file(tmp_path, text))] == [False, True]


def test_a_variant_of_another_drawing_is_a_case_of_its_own(tmp_path: Path) -> None:
    for name in ("a.dxf", "b.dxf"):
        (tmp_path / name).touch()
    path = tmp_path / "drawn.toml"
    path.write_text(
        '[source]\ndxf = "a.dxf"\n[material.default]\nunit_weight_kN_m3 = 18\nfriction = 0.6\n[[load]]\ndirection = [1, 0, 0]\n'
        '[[variants]]\nname = "b"\nchange = { source.dxf = "b.dxf" }\n'
    )
    with pytest.raises(InputError, match=r"found .*b\.dxf; expected .*a\.dxf\. Write a case of its own for it"):
        read_variants(path)
