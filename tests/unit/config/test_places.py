"""Errors name the key that the person wrote, and its line."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from case_texts import WALL, case_file
from churchpipe.config.case import read_case, read_variants
from churchpipe.config.places import line_of
from churchpipe.errors import InputError
from churchpipe.resources import sample_case, sample_names

TEXT = """# A comment
name = "x"   # and = another
[source]
generator = "wall"

openings = [
    { start_mm = 1, width_mm = 2 },
    # between
    { start_mm = 3, width_mm = 4 },
]
note = '''
[material.default]
friction = 3
'''
[material."old brick"]
friction = 0.5
[material.default]
elastic.block_nu = 0.2
friction = 0.6
[[load]]
direction = [1, 0, 0]
[[load]]
direction = [0, 1, 0]
"""


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        (["name"], 2),
        (["source"], 3),
        (["source", "generator"], 4),
        (["source", "openings", "1", "start_mm"], 6),
        (["source", "note"], 11),
        (["material", "old brick", "friction"], 16),
        (["material", "default"], 17),
        (["material", "default", "elastic", "block_nu"], 18),
        (["material", "default", "friction"], 19),
        (["load", "0", "direction"], 21),
        (["load", "1"], 22),
        (["load", "1", "direction", "2"], 23),
    ],
)
def test_the_line_of_a_key(keys: list[str], line: int) -> None:
    assert line_of(TEXT, keys) == line


def leaves(table: Any, path: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Paths of all keys at the ends of tables; lists are ends."""
    if not isinstance(table, dict):
        return [path]
    return [leaf for key, value in table.items() for leaf in leaves(value, (*path, key))]


@pytest.mark.parametrize("name", sample_names())
def test_every_key_of_a_sample_is_found_on_a_line_that_names_it(name: str) -> None:
    text = sample_case(name)
    for path in leaves(tomllib.loads(text)):
        assert path[-1] in text.splitlines()[line_of(text, path) - 1]


CHAPEL = sample_case("chapel")


def line(text: str) -> int:
    """Number of the first line that begins so."""
    return next(number for number, found in enumerate(CHAPEL.splitlines(), 1) if found.startswith(text))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        # A chapel is made as a church, whose nave is what does not fit.
        (
            "height_m = 5.0",
            "height_m = 5.1",
            rf"case\.toml: line {line('height_m')}, source\.height_m: .*whole number of courses",
        ),
        (
            "height_m = 5.0",
            "height_m = -5",
            rf"line {line('height_m')}, source\.height_m: wrong value; found -5; expected greater",
        ),
        ("height_m = 5.0", "heigth_m = 5", rf'line {line("height_m")}, source\.heigth_m: unknown key.*mean "height_m"'),
        ("height_m = 5.0", "", rf"line {line('[source]')}, source\.height_m: missing key"),
        ("friction = 0.6", "friction = -1", rf"line {line('friction')}, material\.default\.friction: wrong value; found -1"),
        ("inner_radius_m = 1.2", "inner_radius_m = 9", rf"line {line('apse =')}, source\.apse.*: "),
    ],
)
def test_a_mistake_has_its_key_and_its_line(old: str, new: str, said: str, tmp_path: Path) -> None:
    assert old in CHAPEL
    with pytest.raises(InputError, match=said):
        read_case(case_file(tmp_path, CHAPEL.replace(old, new, 1))).building()


@pytest.mark.parametrize(
    ("old", "new", "opening", "said"),
    [
        ("springing_m = 4.5", "springing_m = 6.5", "rose", "wall facade: opening rose: reaches"),
        ("[2.4, 5.6]", "[2.4, 3.0]", "window", "wall nave_left: openings window-1 and window-2: overlap"),
        ("[2.4, 5.6]", "[0.9, 5.6]", "window", "wall nave_left: opening window-1: reaches"),
        ("voussoirs = 6", "voussoirs = 7", "window", "opening window: voussoirs: odd"),
    ],
)
def test_a_mistake_of_two_keys_has_the_line_of_its_opening(old: str, new: str, opening: str, said: str, tmp_path: Path) -> None:
    head = line(f'name = "{opening}"') - 1
    test_a_mistake_has_its_key_and_its_line(old, new, rf"line {head}, source\.openings\.\d: {said}", tmp_path)


def test_a_junction_that_is_none_has_the_line_of_its_table(tmp_path: Path) -> None:
    text = sample_case("house").replace("# junctions = [", 'junctions = [{ walls = ["south", "inner"], every = 4 },\n', 1)
    text = text.replace(
        '{ walls = ["south", "inner"], every = 4, cracked_m', '{ walls = ["north", "inne"], every = 4, cracked_m', 1
    )
    with pytest.raises(InputError, match=r"source\.junctions\.1: junction of north and inne: no such wall") as caught:
        read_case(case_file(tmp_path, text)).building()
    number = int(re.findall(r"line (\d+)", str(caught.value))[0])
    assert "inne" in text.splitlines()[number - 1]


def test_what_was_set_has_no_line(tmp_path: Path) -> None:
    path = case_file(tmp_path, CHAPEL)
    with pytest.raises(InputError) as caught:
        read_case(path, ["source.heigth_m=3", "material.default.friction=high"])
    assert "\n  --set, source.heigth_m: unknown key" in str(caught.value)
    assert "\n  --set, material.default.friction: wrong value; found 'high'" in str(caught.value)


# A wall with an opening, a site and a variant: what --set breaks in it, and how the message places it.
SET = (
    WALL.replace("[material", "openings = [{ start_mm = 400, width_mm = 400, sill_courses = 0, height_courses = 1 }]\n[material")
    + "[rigid]\n[check]\nag_g = 0.1\nsoil_factor = 1.2\n[[variants]]\nname = 'b'\nchange = {rigid = {solver = 'auto'}}\n"
)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("name=a/b", "--set, name: wrong value"),
        ("most_stones=no", "--set, most_stones: wrong value; found 'no'"),
        ("project.author=3", "--set, project.author: wrong value; found 3"),
        ("source.courses=0", "--set, source.courses: wrong value; found 0"),
        ("source.brick_mm=[400,250]", "--set, source.brick_mm: wrong value"),
        ("source.brick_mm.1=-3", "--set, source.brick_mm.1: wrong value"),
        ("source.generator=walll", "--set, source.generator: unknown generator; found 'walll'"),
        ("source.generator=chapel", "line 2 with --set source.generator, source.course_m: missing key"),
        ("source.dxf=a.dxf", "line 2 with --set source.dxf, source: no single source"),
        ("source.openings.0.start_mm=9e4", "line 7 with --set source.openings.0.start_mm, source.openings.0: an opening"),
        ("material.default.friction=-1", "--set, material.default.friction: wrong value; found -1"),
        ("material.new.friction=.5", "case.toml: --set, material.new: missing keys; expected material.new.unit_weight_kN_m3."),
        ("load.0.direction=[1,0]", "--set, load.0.direction: wrong value; found [1, 0]"),
        ("load.0.direction=[0,0,0]", "line 11 with --set load.0.direction, load.0: no direction"),
        ("load.3.direction=[1,0,0]", "--set load.3.direction: no such entry; found 3; expected 0, the only one"),
        ("load=[{direction=[0,0,0]}]", "--set, load.0: no direction"),
        ("ties.0.area_mm2=3", "--set ties.0.area_mm2: no such entry; found 0"),
        ("rigid=3", "--set, rigid: wrong value; found 3"),
        ("rigid.curve.steps=-3", "--set, rigid.curve.steps: wrong value; found -3"),
        ("shell.planes=cell", "--set, shell.element_size_mm: missing key"),
        (
            "shell.element_size_mm=2e3",
            "--set, shell.element_size_mm: longer than every wall; found 2000 mm; expected at most 1200 mm.",
        ),
        # Above zero in millimetres, zero in metres.
        ("shell.element_size_mm=5e-324", "--set, shell.element_size_mm: too small for this building; found about inf elements"),
        ("shell.element_size_mm=1e-1", "--set, shell.element_size_mm: too small for this building; found about 144,000,000"),
        ("check.ag_g=-1", "--set, check.ag_g: wrong value; found -1"),
        ("check.site.ag_g=1", "--set, check.site: unknown key"),
        ("check.spectrum.F0=2.5", "--set, check.spectrum: neither formula nor table"),
        ('movements=[{name="c"}]', "--set, movements.0: one support is needed"),
        ('line_loads=[{name="a",wall="q",dead_kN_m=3}]', "--set, line_loads.0: line load a: no such wall; found q"),
        ("sweep.material.default.friction=[]", "--set, sweep.material.default.friction: nothing to sweep"),
        ("sample.number=10", "--set, sample.parameters: missing key"),
        ('variants=[{name="a",change={"source.foo"=3}}]', '--set, variant "a", source.foo: unknown key'),
        ("variants.0.change.rigid.solver=x", '--set, variant "b", rigid.solver: wrong value'),
    ],
)
def test_what_set_broke_is_not_blamed_on_the_file_alone(change: str, said: str, tmp_path: Path) -> None:
    path = case_file(tmp_path, SET)
    assert len([case.building() for case in read_variants(path)]) == 2
    with pytest.raises(InputError) as caught:
        _ = [case.building() for case in read_variants(path, [change])]
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("material.default.friction=0", "--set, material.default.friction: no friction, which the shell needs; found 0"),
        ('joints=[{name="a", kind="bed", friction=0}]', "--set, joints.0.friction: no friction, which the shell needs; found 0"),
    ],
)
def test_a_shell_has_friction(change: str, said: str, tmp_path: Path) -> None:
    path = case_file(tmp_path, WALL)
    assert read_case(path, [change])
    with pytest.raises(InputError) as caught:
        read_case(path, ["shell.element_size_mm=400", change])
    assert said in str(caught.value)
    assert "Leave out [shell]" in str(caught.value)


@pytest.mark.parametrize(
    ("swept", "said"),
    [
        (
            "source.courses = [3, 3.5]",
            r"case\.toml: line 13, \[sweep\], source\.courses: wrong value; found 3\.5; expected a whole number",
        ),
        ('"material.default.friction" = [0.5, nan]', r"line 13, \[sweep\], material\.default\.friction: wrong value; found nan;"),
        ('"material.defult.friction" = [0.5]', r'line 13 .*, material\.defult: missing keys; .* Did you mean "default"\?'),
        ('"rigid.frow" = [1, 2]', r"line 13, \[sweep\], rigid\.frow: unknown key"),
        (
            '"material.default.friction" = [0.5, 0.6, 0.5]',
            r"line 13, \S+: a value given twice; found 0\.5; expected each value once",
        ),
        ("", r"line 12, sweep: nothing to sweep; found an empty table\. Give keys their values, or leave it out"),
        ('"sweep" = [1]', r"line 13, sweep\.sweep: not to be swept\. Give the values of its key in \[sweep\] itself"),
        ('"sweep.rigid.solver" = ["auto"]', r"line 13, sweep\.sweep\.rigid\.solver: not to be swept"),
        # What would be analysed twice under two names, or once where several values were given.
        ('"project.title" = ["a", "b"]', r"line 13, sweep\.project\.title: not to be swept\. The report has one title block"),
        ('"sample.number" = [2, 4]', r"line 13, sweep\.sample\.number: not to be swept\. All combinations are analysed at the"),
        (
            '"variants.0.change.rigid.solver" = ["auto"]',
            r"line 13, sweep\.variants\.0\.\S+: not to be swept\. Sweep the key that",
        ),
        # Counted before they are compared with each other, which would take minutes.
        (f'"material.default.friction" = {[*range(50_000)]}', r"line 12, sweep: too many combinations; found 50000 = 50,000"),
    ],
)
def test_what_was_swept_is_named_with_its_value(swept: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        read_variants(case_file(tmp_path, f"{WALL}[sweep]\n{swept}\n"))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("material.default.unit_weight_kN_m3=1e15", "found 1e+15 kN/m3; expected 0, or 1e-09 to 1e+06 kN/m3."),
        ("material.default.cohesion_kPa=1e12", "found 1e+12 kPa; expected 0, or 1e-09 to 1e+09 kPa."),
    ],
)
def test_what_is_out_of_range_is_said_in_the_unit_of_its_key(change: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_case(case_file(tmp_path, WALL), [change])
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        (
            "box",
            "length_m = 4.0",
            "length_mm = 100",
            "line 6, source.length_mm: no room inside; found 100 mm; expected > 600 mm.",
        ),
        ("arch", "half_angle_deg = ", "half_angle_deg = 1e-9 # ", "found 1e-09 degrees; expected >= 5.72958e-05 degrees."),
    ],
)
def test_what_a_generator_refuses_is_said_in_the_unit_of_its_key(
    name: str, old: str, new: str, said: str, tmp_path: Path
) -> None:
    text = sample_case(name)
    assert old in text
    with pytest.raises(InputError) as caught:
        read_case(case_file(tmp_path, text.replace(old, new, 1))).building()
    assert said in str(caught.value)


def test_what_no_single_parameter_is_to_blame_for_is_said_of_the_source(tmp_path: Path) -> None:
    case = read_case(case_file(tmp_path, WALL), ["source.height_m=0.6"])
    with pytest.raises(InputError, match=r"case\.toml: line 2 with --set source\.height_m, source: its height is given twice"):
        case.building()


def test_a_table_that_lacks_one_of_two_keys_is_named_with_its_line(tmp_path: Path) -> None:
    text = f"{WALL}[check]\nsoil_factor = 1.2\n"
    line = text.splitlines().index("[check]") + 1
    with pytest.raises(InputError, match=rf"case\.toml: line {line}, check: missing key; expected either a_g_m_s2 or ag_g"):
        read_case(case_file(tmp_path, text))


def test_lines_are_those_of_an_editor(tmp_path: Path) -> None:
    text = WALL.replace("friction = 0.6", "# pasted\u2028\u0085\nfriction = -1")
    path = case_file(tmp_path, text)
    with pytest.raises(InputError, match=rf"line {text[: text.index('friction = -1')].count(chr(10)) + 1}, material"):
        read_case(path)
