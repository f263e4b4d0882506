"""The case file: what it gives, and what it says about mistakes."""

import dataclasses
import inspect
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

import churchpipe as cp
from case_texts import case_file
from churchpipe.config.analyses import ShellSettings
from churchpipe.config.case import Drawing, Generated, read_case, read_variants
from churchpipe.config.overrides import parse_override, set_key
from churchpipe.config.plan import Plan, plan
from churchpipe.config.section import Section, section_in
from churchpipe.config.settings import load_of, strengths_of, weights_of
from churchpipe.config.sources import GENERATED
from churchpipe.dxf.reading import Reading
from churchpipe.errors import InputError, UsageError
from churchpipe.generators import GENERATORS, generate
from churchpipe.model.quantities import bare, in_si
from churchpipe.resources import pipeline_folder, sample_case, sample_names

WALL = """
[source]
generator = "wall"
length_m = 1.2
brick_mm = [400, 250, 200]
courses = 3
[material.default]
unit_weight_kN_m3 = 18
friction = 0.6
cohesion_kPa = 2.5
elastic = { block_E_GPa = 3.18, block_nu = 0.23, joint_E_GPa = 0.303, joint_nu = 0.3, joint_thickness_mm = 1.0 }
[[load]]
direction = [0, 3, 0]
[rigid]
flow = ["associative", "non-associative"]
"""


def test_a_case_is_in_si(tmp_path: Path) -> None:
    case = read_case(case_file(tmp_path, WALL, "parish.toml"))
    assert case.name == "parish"
    assert case.source == Generated(
        "wall",
        {
            "length": 1.2,
            "brick": (0.4, 0.25, 0.2),
            "courses": 3,
            "pattern": "running",
            "headers": "english",
            "joints": "grid",
            "through_offset": 0.0,
            "openings": (),
        },
    )
    material = case.materials[0]
    assert (material.unit_weight, material.friction, material.cohesion) == (18e3, 0.6, 2.5e3)
    assert material.elastic is not None
    assert dataclasses.astuple(material.elastic) == (3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
    assert case.loads[0].name == "+y"
    np.testing.assert_array_equal(case.loads[0].direction, [0, 1, 0])
    building = case.building()
    assert [panel.name for panel in building.panels] == ["wall"]
    np.testing.assert_allclose(np.ptp(building.panels[0].outline, axis=0), [1.2, 0.6])


def test_millimetres_are_divided_not_multiplied() -> None:
    assert in_si({"a_mm": [30, 80.0], "b_mm": 520, "t": {"c_deg": 180.0, "d_kPa": 2}, "n": 3, "on": True}) == {
        "a": (0.03, 0.08),
        "b": 0.52,
        "t": {"c": np.pi, "d": 2000.0},
        "n": 3,
        "on": True,
    }


def test_a_table_is_made_of_the_parameters_of_its_generator() -> None:
    for name, generator in GENERATORS.items():
        fields = [field.name for field in dataclasses.fields(generator.parameters)]
        assert [bare(key) for key in GENERATED[name].model_fields] == ["generator", *fields]
    assert GENERATED["arch"].model_fields["half_angle_deg"].default == 90
    assert GENERATED["prototype"].model_fields["main_wall_bricks"].default is None


def test_lengths_of_nested_tables_may_be_in_metres(tmp_path: Path) -> None:
    metres = read_case(case_file(tmp_path, sample_case("church"))).source
    text = (
        sample_case("church")
        .replace("centre_m = [-1.5, 1.5]", "centre_mm = [-1500, 1500]")
        .replace("width_m = 5.6", "width_mm = 5600")
    )
    assert read_case(case_file(tmp_path, text)).source == metres
    assert isinstance(metres, Generated)
    assert metres.parameters["openings"][2]["centre"] == (-1.5, 1.5)
    assert metres.parameters["openings"][0]["wall"] == ("facade",)


# Buttresses of five variants, each fitted to the stones of a church; the variants of the chapel are read in the same way.
LARGE = pytest.mark.slow("docs/strengthening.md: the ready case of a church and its measures is read")
NAMES = [pytest.param(name, marks=LARGE) if name == "church_strengthened" else name for name in sample_names()]


@pytest.mark.parametrize("name", NAMES)
def test_every_sample_case_runs(name: str, tmp_path: Path) -> None:
    assert "#" in sample_case(name)
    for case in read_variants(case_file(tmp_path, sample_case(name))):
        building = case.building()
        assert building.panels or building.vaults


def test_the_sample_cases_are_all_offered() -> None:
    assert set(sample_names()) == {path.stem for path in (pipeline_folder() / "cases").iterdir()} | {"prototype"}
    assert set(sample_names()) >= set(GENERATORS)


def _keys(section: type[Section]) -> set[str]:
    inner = [found for field in section.model_fields.values() if (found := section_in(field.annotation))]
    return set(section.model_fields).union(*map(_keys, inner))


@pytest.mark.parametrize("name", GENERATED)
def test_a_sample_case_names_every_key_of_its_generator(name: str) -> None:
    words = set(re.findall(r"\w+", sample_case(name)))
    missing = {key for key in _keys(GENERATED[name]) if not {key, key.removesuffix("mm") + "m"} & words}
    assert not missing


def test_the_cases_of_the_church_lay_the_same_church() -> None:
    folder = pipeline_folder() / "cases"
    church = read_case(folder / "church.toml").source
    for name in ("church_friction", "church_sliding"):
        assert all(case.source == church for case in read_variants(folder / f"{name}.toml"))


# One mistake each: the override that makes it, and what must be said.
MISTAKES = [
    ("source.lenght_m=3", r'source\.lenght_m: unknown key.*Did you mean "length_m"\?'),
    ('source={generator="wall", thickness_m=0.2}', r"source\.length_m: missing key; expected a number"),
    ("rigid.FLOW=1", r'rigid\.FLOW: unknown key.*Did you mean "flow"\?'),
    ("rigid.frow=1", r'rigid\.frow: unknown key.*flow, solver, method, start.*Did you mean "flow"\?'),
    ('ties=[{name="t", diameter_mm=25}]', r"ties\.0\.diameter_mm: unknown key; expected [^?]*ultimate_strain\.(?! Did)"),
    ("materail.default.friction=1", r'materail: unknown key.*Did you mean "material"\?'),
    ("material.default.frictoin=1", r'material\.default\.frictoin: unknown key.*Did you mean "friction"\?'),
    ("material.default.elastic.block_E_Gpa=1", r'elastic\.block_E_Gpa: unknown key.*Did you mean "block_E_GPa"\?'),
    ("load.0.directoin=[1,0,0]", r'load\.0\.directoin: unknown key.*Did you mean "direction"\?'),
    ("shell.element_size_mm=0", r"shell\.element_size_mm: wrong value; found 0; expected greater than 0"),
    ("shell.element_sise_mm=30", r'element_sise_mm: unknown key.*Did you mean "element_size_mm"\?'),
    ("rigid.solver=clarabell", r"rigid\.solver: wrong value; found 'clarabell'; expected \"auto\", \"interior-point\", "),
    ('shell={element_size_mm=30, solver="cvxpy"}', r"shell\.solver: wrong value; found 'cvxpy'"),
    ('shell={element_size_mm=30, planes="nine"}', r"shell\.planes: wrong value; found 'nine'"),
    ('shell={element_size_mm=30, analyses=["collapse"]}', r"shell\.analyses\.0: wrong value; found 'collapse'"),
    ("shell={element_size_mm=30, control_point=7, control_point_mm=[0, 0, 600]}", r"shell: two control points"),
    ("material.default.friction=high", r"material\.default\.friction: wrong value; found 'high'; expected a number"),
    ("material.default.friction=-0.1", r"found -0\.1; expected greater than or equal to 0"),
    ("material.default.friction=nan", r"found nan; expected a finite number"),
    ("source.brick_mm=[1,2]", r"source\.brick_mm: wrong value.*at least 3 items"),
    ("source.courses=2.5", r"source\.courses: wrong value; found 2\.5; expected a whole number"),
    (
        "source.generator=walls",
        r'unknown generator; found \'walls\'; expected wall, arch, arch_piers, prototype, box.*Did you mean "wall"\?',
    ),
    ("source.dxf=a.dxf", r"source: no single source; found generator and dxf"),
    ("source={}", r"source: no single source"),
    ("source=wall", r"source: wrong value"),
    (
        "load.0.direction=-y",
        r"load\.0\.direction: wrong value; found '-y'; expected a list in \[brackets\], such as \[0, -1, 0\]",
    ),
    ("load.0.direction=[0,0,0]", r"load\.0: no direction"),
    ("load=[{direction=[1,0,0]},{direction=[2,0,0]}]", r"load: two loads of one name"),
    ('rigid.flow=["asociative"]', r"rigid\.flow\.0: wrong value; found 'asociative'; expected 'associative' or"),
    ("name=a/b", r"name: wrong value; found 'a/b'"),
    ("load.3.direction=[1,0,0]", r"--set load\.3\.direction: no such entry; found 3; expected 0, the only one"),
    ("material.defualt.friction=0.5", r'expected material\.defualt\.unit_weight_kN_m3.*Did you mean "default"\?'),
    ('sweep={"rigid.solver"=3}', r"--set, sweep\.rigid\.solver: nothing to sweep; found 3"),
    ("name.first=x", r"name\.first: name is not a table"),
    ('sweep."rigid.solver"=[3]', r"--set sweep.*: a key in quotes; expected the dotted key alone: sweep\.rigid\.solver"),
    ("sweep.name=x", r"sweep\.name: nothing to sweep; found 'x'"),
    ("sweep=3", r"case\.toml: --set, sweep: not a table"),
    ("source.length_mm=1200", r"source\.length_m: a length given twice; found length_m and length_mm; expected one of them"),
    ("material.default.friction=1e300", r"case\.toml: --set, material\.default\.friction: out of range"),
    ('source={dxf="a.dxf", units="furlong"}', r"case\.toml: --set, source\.units: unknown unit; found 'furlong'"),
    ('source={dxf="a.dxf", thickness_mm=1e300}', r"case\.toml: --set, source\.thickness_mm: no length of a building"),
    ('source={dxf="a.dxf", joint_mm=1e-9}', r"case\.toml: --set, source\.joint_mm: no length of a building"),
    (f"source.courses={'9' * 5000}", r"source\.courses: wrong value; found '999"),
]


@pytest.mark.parametrize(("override", "said"), MISTAKES, ids=[override[:60] for override, _ in MISTAKES])
def test_a_mistake_is_named(override: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        read_case(case_file(tmp_path, 'name = "w"' + WALL), [override])


def test_all_mistakes_are_told_at_once(tmp_path: Path) -> None:
    path = case_file(tmp_path, WALL)
    with pytest.raises(InputError) as caught:
        read_case(path, ["source.courses=none", "rigid.frow=1", "material.default.friction=high"])
    assert str(caught.value).startswith(f"{path}: 3 errors:")
    assert all(key in str(caught.value) for key in ("source.courses", "rigid.frow", "material.default.friction"))


def test_what_an_import_left_out_is_listed(tmp_path: Path) -> None:
    text = '[source]\ndxf = "plan.dxf"\n[material.tuff]\n[material.brick]\nfriction = 0.5\n'
    with pytest.raises(InputError) as caught:
        read_case(case_file(tmp_path, text))
    said = str(caught.value)
    for key in ("material.tuff.unit_weight_kN_m3", "material.tuff.friction", "material.brick.unit_weight_kN_m3", "[[load]]"):
        assert key in said
    assert "material.brick.friction" not in said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a = = 1", "not TOML.*line 1"),
        ("a = .5", r"not TOML.*line 1.*digits on both sides of its point \(0\.5, not \.5 or 0,5\)"),
        ("[load]\n[load]\n", r"not TOML; found a table given twice, 'load' \(.*name \[\[two\]\]"),
        ("[source]\ngenerator = 'wall'\nlength = 3.2\n", r"source\.length_m+: missing key"),
        ("a = 1\na = 2\n\n", r"not TOML; found a key given twice \(at line 2"),
        pytest.param(f"a = {'9' * 5000}", "not TOML", id="digits"),
        ("", "source: missing key"),
        ("name = 3", "name: wrong value; found 3"),
    ],
)
def test_a_file_that_is_no_case(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        read_case(case_file(tmp_path, text))


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read; found No such file"):
        read_case(tmp_path / "none.toml")
    (tmp_path / "latin.toml").write_bytes('name = "Pfarrkirche Sankt Jürgen"'.encode("latin-1"))
    with pytest.raises(InputError, match="not a text in UTF-8"):
        read_case(tmp_path / "latin.toml")


def test_a_drawing_is_found_beside_its_case(tmp_path: Path) -> None:
    text = WALL.replace(WALL[: WALL.index("[material")], '[source]\ndxf = "cad/plan.dxf"\nsupport = "base"\n')
    case = read_case(case_file(tmp_path, text))
    assert case.source == Drawing(tmp_path / "cad" / "plan.dxf", Reading(support="base"))
    with pytest.raises(InputError, match=r"a drawing gives stones, not a building; found plan\.dxf"):
        case.building()


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("a.b=0.5", "a.b", 0.5),
        ("a = [1, 2]", "a", [1, 2]),
        ("a=cvxpy:MOSEK", "a", "cvxpy:MOSEK"),
        ('a="0.5"', "a", "0.5"),
        ("a=x=y", "a", "x=y"),
        ("a=true", "a", True),
    ],
)
def test_overrides_are_toml_or_words(text: str, key: str, value: Any) -> None:
    assert parse_override(text) == (key, value)


@pytest.mark.parametrize("text", ["friction", "=3", "a..b=3", ".a=1"])
def test_what_is_no_override(text: str) -> None:
    with pytest.raises(UsageError, match="not an override"):
        parse_override(text)


def test_set_key_reaches_lists_and_makes_tables() -> None:
    table: dict[str, Any] = {"load": [{"direction": [1, 0, 0]}, {}]}
    set_key(table, "load.1.direction", [0, 1, 0])
    set_key(table, "load.0.direction.2", 5)
    set_key(table, "a.b", 1)
    assert table == {"load": [{"direction": [1, 0, 5]}, {"direction": [0, 1, 0]}], "a": {"b": 1}}


SWEEP = WALL.replace("friction = 0.6\n", "") + '[sweep]\n"material.default.friction" = [0.4, 0.5]\nsource.courses = [3, 4, 5]\n'


def test_a_table_that_is_left_out_is_not_swept(tmp_path: Path) -> None:
    path = case_file(tmp_path, SHELL + '[sweep]\n"shell.element_size_mm" = [200, 100]\n')
    assert [(case.swept, case.shell) for case in read_variants(path, ["shell=false"])] == [({}, None)]
    assert len(read_variants(path, ["shell=true"])) == 2


def test_a_sweep_is_a_product(tmp_path: Path) -> None:
    cases = read_variants(case_file(tmp_path, SWEEP))
    assert [(c.materials[0].friction, c.swept["source.courses"]) for c in cases] == [
        (0.4, 3),
        (0.4, 4),
        (0.4, 5),
        (0.5, 3),
        (0.5, 4),
        (0.5, 5),
    ]
    todo = plan(cases)
    assert list(todo.geometries) == ["courses=3", "courses=4", "courses=5"]
    assert len(todo.analyses) == 12
    assert "+y_non-associative_friction=0.5_courses=4" in todo.analyses
    entry = next(e for e in todo.index["analyses"] if e["name"] == "+y_associative_friction=0.4_courses=5")
    assert entry["geometry"] == "courses=5"
    assert entry["swept"] == {"material.default.friction": 0.4, "source.courses": 5}


@pytest.mark.parametrize(
    ("sweep", "words"),
    [
        # One of both would be lost.
        (
            '"source.brick_mm" = [[400, 250, 200], [400, 300, 200]]\n"source.brick_mm.1" = [250, 300]',
            r"line \d+, sweep\.source\.brick_mm\.1: swept twice; found source\.brick_mm too; expected one of them",
        ),
        (
            '"source.length_mm" = [800]\n"source.length_m" = [1.2]',
            r"sweep\.source\.length_m: swept twice; found source\.length_mm too",
        ),
        (
            '"material.default.friction" = [0.4]\n[sweep.material.default]\nfriction = [0.5]',
            r"sweep\.material\.default\.friction: swept twice; found material\.default\.friction too",
        ),
        # A table without a value is not left out in silence.
        (
            'source.courses = [3, 4]\n"material.default.friction" = {}',
            r"sweep\.material\.default\.friction: nothing to sweep; found \{\}",
        ),
        ('"source.courses" = "4"', r"sweep\.source\.courses: nothing to sweep; found '4'; expected a list"),
        ('"load.-1.direction" = [[1, 0, 0]]', r"line (\d+), sweep\.load\.-1\.direction: no such entry; found -1"),
    ],
)
def test_a_sweep_that_would_lose_values_is_refused(tmp_path: Path, sweep: str, words: str) -> None:
    text = f"{WALL}[sweep]\n{sweep}\n"
    with pytest.raises(InputError, match=words) as caught:
        read_variants(case_file(tmp_path, text))
    number = re.search(r"line (\d+)", str(caught.value))
    assert number
    assert int(number[1]) > len(WALL.splitlines())


def test_a_key_that_is_set_is_not_swept(tmp_path: Path) -> None:
    cases = read_variants(case_file(tmp_path, SWEEP), ["source.courses=7"])
    assert [case.swept for case in cases] == [{"material.default.friction": mu} for mu in (0.4, 0.5)]
    todo = plan(cases)
    assert list(todo.geometries) == ["base"]
    assert todo.geometries["base"]["source"]["parameters"]["courses"] == 7


def test_a_unit_weight_changes_the_stones_and_a_strength_does_not(tmp_path: Path) -> None:
    def settings(*overrides: str) -> tuple[Any, Any]:
        todo = plan(read_variants(case_file(tmp_path, WALL), overrides))
        return todo.geometries, todo.analyses

    geometry, analyses = settings()
    for override in ("material.default.friction=0.3", "material.default.cohesion_kPa=1", "load.0.direction=[1,0,0]"):
        same, other = settings(override)
        assert same == geometry
        assert other != analyses
    other, same = settings("material.default.unit_weight_kN_m3=20")
    assert other != geometry
    assert same == analyses
    _, changed = settings("rigid.method=paper", "rigid.start=uniform")
    assert changed["+y_associative"] == analyses["+y_associative"]
    assert changed["+y_non-associative"] != analyses["+y_non-associative"]


SHELL = WALL + '[shell]\nelement_size_mm = 100\nanalyses = ["limit", "pushover"]\ncontrol_point_mm = [0, 125, 600]\n'


def test_a_shell_is_in_si(tmp_path: Path) -> None:
    assert read_case(case_file(tmp_path, WALL)).shell is None
    shell = read_case(case_file(tmp_path, SHELL)).shell
    assert shell == ShellSettings(0.1, analyses=("limit", "pushover"), control_place=(0.0, 0.125, 0.6))


def test_the_strength_of_the_cell_is_taken_where_nobody_names_one(tmp_path: Path) -> None:
    """The planes of the paper overrate it; a generated case, a drawing's and the functions of Python take the exact cell."""
    drawn = '[source]\ndxf = "stones.dxf"\n' + WALL[WALL.index("[material") :]
    for text in (WALL, drawn):
        shell = read_case(case_file(tmp_path, text + "[shell]\nelement_size_mm = 100\n")).shell
        assert shell is not None
        assert shell.planes == "cell"
    for function in (cp.shell_limit_analysis, cp.pushover):
        assert inspect.signature(function).parameters["planes"].default == "cell"


def test_a_capacity_curve_needs_elastic_constants(tmp_path: Path) -> None:
    stiff = next(line for line in SHELL.splitlines(keepends=True) if line.startswith("elastic"))
    with pytest.raises(InputError, match=r"missing keys; expected material\.default\.elastic"):
        read_case(case_file(tmp_path, SHELL.replace(stiff, "")))
    assert read_case(case_file(tmp_path, SHELL.replace(stiff, "")), ['shell.analyses=["limit"]']).shell is not None


def test_one_flow_rule_or_method_needs_no_brackets(tmp_path: Path) -> None:
    overrides = ['rigid.flow="non-associative"', 'shell.analyses="limit"']
    alone = plan(read_variants(case_file(tmp_path, SHELL), overrides))
    listed = plan(read_variants(case_file(tmp_path, SHELL), ['rigid.flow=["non-associative"]', 'shell.analyses=["limit"]']))
    assert list(alone.analyses) == list(listed.analyses) == ["+y_non-associative", "+y_limit"]


def test_a_mark_of_byte_order_is_passed_over(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_bytes(b"\xef\xbb\xbf" + WALL.encode())
    assert read_case(tmp_path / "case.toml").loads[0].name == "+y"


def of_kind(todo: Plan, kind: str) -> list[str]:
    return [entry["name"] for entry in todo.index["analyses"] if entry["kind"] == kind]


def test_a_sweep_of_frictions_shares_the_mesh(tmp_path: Path) -> None:
    todo = plan(read_variants(case_file(tmp_path, SHELL), ['sweep={"material.default.friction"=[0.5,0.6]}']))
    assert todo.index["shells"] == [{"name": "base", "geometry": "base"}]
    assert of_kind(todo, "limit") == ["+y_limit_friction=0.5", "+y_limit_friction=0.6"]
    assert of_kind(todo, "pushover") == ["+y_pushover_friction=0.5", "+y_pushover_friction=0.6"]
    assert len(of_kind(todo, "rigid")) == 4


def test_a_sweep_of_meshes_shares_the_stones_and_their_analyses(tmp_path: Path) -> None:
    todo = plan(read_variants(case_file(tmp_path, SHELL), ['sweep={"shell.element_size_mm"=[200,100,50]}']))
    assert list(todo.geometries) == ["base"]
    # In the order of the file, not of the alphabet.
    assert [mesh["name"] for mesh in todo.index["shells"]] == [f"element_size_mm={size}" for size in (200, 100, 50)]
    assert of_kind(todo, "rigid") == ["+y_associative", "+y_non-associative"]
    assert len(of_kind(todo, "limit")) == 3
    assert todo.shells["element_size_mm=50"]["element_size"] == 0.05


def test_what_one_model_alone_knows_leaves_the_other_alone(tmp_path: Path) -> None:
    sweep = 'sweep={"rigid.start"=["associative","uniform"],"material.default.elastic.joint_E_GPa"=[0.3,0.6]}'
    todo = plan(read_variants(case_file(tmp_path, SHELL), [sweep]))
    assert len(of_kind(todo, "limit")) == 2
    assert len(of_kind(todo, "rigid")) == 4
    assert "elastic" not in todo.analyses[of_kind(todo, "limit")[0]]["material"]["default"]


def test_names_of_folders_are_plain_and_never_shared(tmp_path: Path) -> None:
    loads = '[[load]]\ndirection=[1,0,0]\nname="to the west/left"\n[[load]]\ndirection=[-1,1,0]\n[[load]]\ndirection=[1,1,0]\n'
    loads += '[[load]]\ndirection=[0,1,0]\nname="to the west left"\n'
    text = WALL.replace("[[load]]\ndirection = [0, 3, 0]\n", loads)
    names = list(plan(read_variants(case_file(tmp_path, text), ['rigid.flow=["associative"]'])).analyses)
    assert len(names) == 4
    assert all("/" not in name and " " not in name for name in names)


def test_settings_give_back_the_case(tmp_path: Path) -> None:
    case = read_case(case_file(tmp_path, WALL))
    todo = plan([case])
    geometry = todo.geometries["base"]
    building = generate(**geometry["source"], materials=weights_of(geometry), name=geometry["name"])
    np.testing.assert_array_equal(building.panels[0].outline, case.building().panels[0].outline)
    assert [(material.name, material.unit_weight) for material in building.materials] == [("default", 18e3)]
    settings = todo.analyses["+y_non-associative"]
    load, materials = load_of(settings), strengths_of(settings)
    np.testing.assert_array_equal(load.direction, case.loads[0].direction)
    assert (load.name, load.profile, load.panels) == ("+y", "uniform", None)
    assert [(m.name, m.friction, m.cohesion) for m in materials] == [("default", 0.6, 2.5e3)]


def test_the_table_reads_back_as_the_same_case(tmp_path: Path) -> None:
    case = read_case(case_file(tmp_path, WALL))
    again = read_case(case_file(tmp_path, tomli_w.dumps(case.table)))
    assert tomllib.loads(tomli_w.dumps(case.table)) == case.table
    assert again.table == case.table


def test_a_rigid_beam_needs_no_elastic_constants(tmp_path: Path) -> None:
    text = SHELL + "[material.concrete]\nunit_weight_kN_m3 = 25\nfriction = 0.6\n"
    beam = '[[ring_beams]]\nwalls = ["wall"]\nheight_m = 0.2\nmaterial = "concrete"\n'
    assert read_case(case_file(tmp_path, text + beam)).ring_beams[0].material == "concrete"
    buttress = '[[buttresses]]\nwall = "wall"\nalong_m = [0.6]\ntoward = "-y"\nwidth_m = 0.4\ndepth_m = 0.4\n'
    with pytest.raises(InputError, match=r"missing keys; expected material\.concrete\.elastic \(for the capacity curve\)"):
        read_case(case_file(tmp_path, text + beam + buttress + 'material = "concrete"\n'))
