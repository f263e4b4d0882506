"""What the building of a case carries: keys, units, the settings of stages, and errors with their lines."""

import re
from pathlib import Path

import numpy as np
import pytest

from churchpipe.config.carries import carries_of, placed
from churchpipe.config.case import read_case, read_variants
from churchpipe.config.plan import plan
from churchpipe.config.settings import joints_of
from churchpipe.configuring import configure
from churchpipe.errors import InputError
from churchpipe.io.building_json import read_building, write_building
from churchpipe.match import match_models
from churchpipe.resources import sample_case
from churchpipe.shell_mesh.shell import derive_shell
from churchpipe.stages import source
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import check_soundness

READY = Path(__file__).parents[3] / "pipeline" / "cases"
CASE = """
name = "loaded"
[source]
generator = "wall"
length_m = 4.0
brick_mm = [1000, 500, 500]
courses = 6
[material.default]
unit_weight_kN_m3 = 18.0
friction = 0.6
[[load]]
direction = [0, 1, 0]
[[line_loads]]
name = "roof"
wall = "wall"
from_m = 0.5
to_m = 3.5
dead_kN_m = 9.0
thrust_kN_m = 0.5
toward = [0, 1, 0]
eccentricity_m = 0.1
seismic_mass_kN_m = 4.0
[[point_loads]]
at_m = [2.0, 0.25, 3.0]
dead_kN = 5.0
[[pressures]]
wall = "wall"
toward = [0, -1, 0]
unit_weight_kN_m3 = 10.0
top_m = 1.0
[[ties]]
name = "chain"
start = { wall = "wall", along_m = 0.0, height_m = 2.75 }
end = { wall = "wall", along_m = 4.0, height_m = 2.75 }
area_mm2 = 400
steel_strength_MPa = 235
plate_mm = [200, 200]
bearing_strength_MPa = 2.0
pretension_kN = 10
"""


def case_of(folder: Path, text: str = CASE) -> Path:
    path = folder / "loaded.toml"
    path.write_text(text)
    return path


def test_keys_become_si(tmp_path: Path) -> None:
    carries = read_case(case_of(tmp_path)).carries
    (roof,) = carries.line_loads
    assert (roof.dead, roof.thrust, roof.mass, roof.begin, roof.end) == (9e3, 500.0, 4e3, 0.5, 3.5)
    assert roof.toward == pytest.approx([0, 1, 0])
    assert carries.point_loads[0].dead == 5e3
    assert carries.pressures[0].unit_weight == 10e3
    (chain,) = carries.ties
    assert (chain.area, chain.steel_strength, chain.plate, chain.pretension) == (4e-4, 235e6, (0.2, 0.2), 10e3)


def test_settings_of_a_stage_say_the_same(tmp_path: Path) -> None:
    case = read_case(case_of(tmp_path))
    again = carries_of(case.carries.settings())
    assert again.settings() == case.carries.settings()
    stones = derive_blocks(case.building())
    first, second = placed(case.carries, stones), placed(again, stones)
    np.testing.assert_array_equal(first.loads.dead, second.loads.dead)
    assert first.loads.weight.sum() == pytest.approx(3 * 9e3 + 5e3)
    assert first.ties[0].strength == second.ties[0].strength == pytest.approx(80e3)


BAD = [
    (
        'wall = "wall"\nfrom',
        'wall = "wal"\nfrom',
        r"line 13, line_loads.0: line load roof: no such wall; found wal; expected wall",
    ),
    ("to_m = 3.5", "to_m = 4.5", r"line 13, line_loads.0: line load roof: beyond the wall wall"),
    ("dead_kN_m = 9.0", "dead_kN_m = -9.0", r"line 18, line_loads.0.dead_kN_m: wrong value; found -9.0"),
    (
        "dead_kN_m = 9.0",
        "dead_kN_m = 1e300",
        r"line 18, line_loads.0.dead_kN_m: out of range; found 1e\+300 kN/m; expected >= 0 and <= 1e\+27 kN/m",
    ),
    ("dead_kN = 5.0", "dead_kN = 0", r"line 23, point_loads.0: no load"),
    ("area_mm2 = 400", "area_mm2 = -400", r"line 35, ties.0.area_mm2: wrong value; found -400"),
    ("along_m = 4.0", "along_m = 40.0", r"line 31, ties.0: tie chain: end: beyond the wall wall; found 40 m"),
    ("plate_mm = [200, 200]", "plate_mm = [900, 200]", r"line 31, ties.0: tie chain: start: its plate overhangs the masonry"),
    ("eccentricity_m", "eccentricity_mm", r"line 21, line_loads.0.eccentricity_mm: unknown key"),
]


@pytest.mark.parametrize(("given", "wrong", "said"), BAD)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, given: str, wrong: str, said: str) -> None:
    assert given in CASE
    with pytest.raises(InputError, match=rf"loaded\.toml: {said}"):
        read_case(case_of(tmp_path, CASE.replace(given, wrong))).building()


def test_ties_have_names_of_their_own(tmp_path: Path) -> None:
    again = CASE[CASE.index("[[ties]]") :]
    with pytest.raises(InputError, match=r"loaded\.toml: line \d+, ties\.1\.name: two ties of one name; found chain"):
        read_case(case_of(tmp_path, f"{CASE}\n{again}"))
    # The analysis with the candidates has both.
    candidate = again.replace("[[ties]]", "[[tie_candidates]]")
    with pytest.raises(
        InputError, match=r"line \d+, tie_candidates\.0\.name: two ties of one name; found chain; .* candidates too"
    ):
        read_case(case_of(tmp_path, f"{CASE}\n{candidate}"))


ENDS = {"start": "east", "end": "west"}


def test_two_floors_of_the_same_walls_are_told_to_have_names(tmp_path: Path) -> None:
    floor = '\n[[diaphragms]]\nwalls = ["east", "west"]\nheight_m = {}\ndead_kN_m2 = 2.0\nspacing_m = 0.8\nfriction = 0.4\n'
    box = """name = "room"
source = {{ generator = "box", length_m = 4.0, width_m = 3.0, courses = 20, brick_m = [0.5, 0.4, 0.2] }}
[material.default]
unit_weight_kN_m3 = 18.0
friction = 0.6
[[load]]
direction = [1, 0, 0]
{}"""
    both = floor.format(1.4) + floor.format(2.8)
    case = read_case(case_of(tmp_path, box.format(both)))
    with pytest.raises(InputError, match=r"diaphragms\.1: two ties of one name; found east west 1; .* name = \"upper floor\""):
        placed(case.carries, derive_blocks(case.building()))
    # A tie may have the name of a joist, one that might be added too.
    for table in ("ties", "tie_candidates"):
        ends = "".join(f'{end} = {{ wall = "{wall}", along_m = 1.0, height_m = 2.9 }}\n' for end, wall in ENDS.items())
        bar = f'\n[[{table}]]\nname = "east west 2"\n{ends}area_mm2 = 400\nsteel_strength_MPa = 235\n'
        case = read_case(case_of(tmp_path, box.format(floor.format(1.4) + bar)))
        with pytest.raises(InputError, match=r"two ties of one name; found east west 2; .* a number\. Give the tie another name"):
            placed(case.carries, derive_blocks(case.building()))
    named = read_case(case_of(tmp_path, box.format(floor.format(1.4) + floor.format(2.8) + 'name = "upper floor"\n')))
    assert len(placed(named.carries, derive_blocks(named.building())).ties) > 4


BEAM = """
[[ring_beams]]
walls = ["wall"]
height_m = 0.3
material = "concrete"
[material.concrete]
unit_weight_kN_m3 = 25.0
friction = 0.5
"""


def test_a_ring_beam_of_a_case_is_a_stone_on_its_wall(tmp_path: Path) -> None:
    building = read_case(case_of(tmp_path, CASE + BEAM)).building()
    write_building(tmp_path / "building.json", building)
    stones = derive_blocks(read_building(tmp_path / "building.json"))
    assert (str(stones.panel[-1]), str(stones.material[-1])) == ("beam on wall", "concrete")
    assert stones.weight[-1] == pytest.approx(25e3 * 4.0 * 0.5 * 0.3)
    assert building.macro_elements == ("wall", "beam on wall")
    shell = derive_shell(building, 0.5)
    assert (shell.beams.name.tolist(), shell.beams.material.tolist()) == (["beam on wall"], ["concrete"])
    assert (shell.beams.of_node >= 0).tolist() == (shell.points[:, 2] > building.panels[0].outline[:, 1].max() - 1e-6).tolist()


def test_a_beam_on_a_gable_is_refused_with_the_reason(tmp_path: Path) -> None:
    beam = '\n[[ring_beams]]\nwalls = ["facade", "nave_left"]\nheight_m = 0.3\n'
    with pytest.raises(InputError, match=r"ring_beams.0: ring beam on facade: the top of the wall facade is not level"):
        read_case(case_of(tmp_path, sample_case("chapel") + beam)).building()


@pytest.mark.slow
def test_a_beam_that_runs_into_a_gable_is_told_where_the_wall_is_free(tmp_path: Path) -> None:
    beam = '\n[[ring_beams]]\nwalls = ["nave_left"]\nheight_m = 0.3\n'
    with pytest.raises(
        InputError, match=r"ring_beams.0: ring beam on nave_left: it runs into stones that stand higher"
    ) as raised:
        read_case(case_of(tmp_path, sample_case("chapel") + beam)).building()
    free = re.search(r"from ([\d.]+) to ([\d.]+) m along the wall \(from_m and to_m\)", str(raised.value))
    assert free
    stops = f"from_m = {free[1]}\nto_m = {free[2]}\n"
    building = read_case(case_of(tmp_path, sample_case("chapel") + beam + stops)).building()
    stones = derive_blocks(building)
    check_soundness(stones, find_contacts(stones))


ANOTHER = '\n[[ring_beams]]\nwalls = ["wall"]\nheight_m = 0.3\n'


def test_two_beams_on_one_wall_have_names_of_their_own(tmp_path: Path) -> None:
    first, second = (f"{ANOTHER}from_m = {begin}\nto_m = {end}\n" for begin, end in ((0, 1.5), (2.5, 4)))
    with pytest.raises(InputError, match=r"ring_beams.1: ring beam on wall: not the only one of its name\. .*name of its own"):
        read_case(case_of(tmp_path, CASE + first + second)).building()
    building = read_case(case_of(tmp_path, CASE + first + second + 'name = "east"\n')).building()
    stones = derive_blocks(building)
    assert stones.panel[-2:].tolist() == ["beam on wall", "beam east on wall"]
    shell = derive_shell(building, 0.5)
    assert shell.beams.name.tolist() == ["beam on wall", "beam east on wall"]
    assert match_models(stones, find_contacts(stones), shell).passed


def test_a_beam_on_another_beam_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"ring_beams.1: ring beam on wall: it runs into stones .*; found beam on wall"):
        read_case(case_of(tmp_path, f'{CASE}{ANOTHER}{ANOTHER}name = "upper"\n')).building()


def test_a_floor_of_joists_without_a_weight_is_named(tmp_path: Path) -> None:
    floor = '\n[[diaphragms]]\nwalls = ["nave_left", "nave_right"]\nfixing_kN = 5\nspacing_m = 0.8\n'
    with pytest.raises(InputError, match=r"line \d+, diaphragms\.0: no load; expected dead_kN_m2"):
        read_case(case_of(tmp_path, sample_case("chapel") + floor))


def test_more_joists_than_any_floor_has_are_refused(tmp_path: Path) -> None:
    floor = '\n[[diaphragms]]\nwalls = ["nave_left", "nave_right"]\ndead_kN_m2 = 1.5\nfriction = 0.4\nspacing_m = 0.001\n'
    with pytest.raises(InputError, match=r"diaphragms.0: .*: spacing: too many joists; found 9,000; expected at most 500"):
        read_case(case_of(tmp_path, sample_case("chapel") + floor)).building()


BAD_BEAMS = [
    (
        'walls = ["wall"]',
        'walls = ["roof"]',
        r"line 41, ring_beams.0: ring beam on roof: no such wall; found roof",
    ),
    ("height_m = 0.3", "height_m = 0", r"line 43, ring_beams.0.height_m: wrong value"),
    (
        "height_m = 0.3",
        "height_m = 0.3\nwidth_m = 0.6",
        r"line 41, ring_beams.0: ring beam on wall: width: out of range",
    ),
    ("height_m = 0.3", "height_m = 0.3\nto_m = 5.0", r"line 41, ring_beams.0: ring beam on wall: not on the wall's level top"),
    ('material = "concrete"', 'material = "timber"', r"line 44, ring_beams.0.material: unknown material; found timber"),
]


@pytest.mark.parametrize(("given", "wrong", "said"), BAD_BEAMS)
def test_what_is_wrong_with_a_beam_is_said_with_its_line(tmp_path: Path, given: str, wrong: str, said: str) -> None:
    assert given in BEAM
    with pytest.raises(InputError, match=rf"loaded\.toml: .*{said}"):
        read_case(case_of(tmp_path, CASE + BEAM.replace(given, wrong))).building()


FILLS = """
[[fills]]
on = ["wall"]
unit_weight_kN_m3 = 16.0
top_m = 3.5
"""


@pytest.mark.parametrize(
    ("given", "wrong", "said"),
    [
        ('on = ["wall"]', 'on = ["vault"]', "line 41, fills.0: fill vault: on: no such vault; found vault; expected wall"),
        ("top_m = 3.5", "top_m = 2.0", "line 41, fills.0: fill wall: nothing that it could lie on"),
        ("unit_weight_kN_m3 = 16.0", "unit_weight_kN_m3 = 0", "line 43, fills.0.unit_weight_kN_m3: wrong value"),
    ],
)
def test_what_is_wrong_with_fill_is_said_with_its_line(tmp_path: Path, given: str, wrong: str, said: str) -> None:
    stones = derive_blocks((case := read_case(case_of(tmp_path, CASE + FILLS))).building())
    assert placed(case.carries, stones).loads.weight.sum() == pytest.approx(3 * 9e3 + 5e3 + 16e3 * 4.0 * 0.5 * 0.5)
    with pytest.raises(InputError, match=rf"loaded\.toml: {said}"):
        read_case(case_of(tmp_path, CASE + FILLS.replace(given, wrong))).building()


JOINTS = """
[[joints]]
name = "damp course"
kind = "base"
friction = 0.3
[[joints]]
name = "grouted"
walls = ["wall"]
above_m = 1.0
cohesion_kPa = 50
"""


def test_joints_with_a_strength_of_their_own_reach_the_settings_of_the_analyses(tmp_path: Path) -> None:
    index = plan(read_variants(case_of(tmp_path, CASE + JOINTS)))
    (settings,) = index.analyses.values()
    base, grouted = joints_of(settings)
    assert (base.kind, base.friction, base.cohesion) == ("base", 0.3, None)
    assert (grouted.walls, grouted.above, grouted.cohesion) == (("wall",), 1.0, 50e3)
    for given, wrong, said in (
        ('walls = ["wall"]', 'walls = ["roof"]', "line 45, joints.1: no such panel; found roof"),
        ('kind = "base"', 'kind = "bass"', "line 43, joints.0.kind"),
        ("friction = 0.3", "", "line 41, joints.0: no strength"),
        ("friction = 0.3", "friction = -0.3", "line 44, joints.0.friction: wrong value"),
        ("above_m = 1.0", "above_m = 40.0", "line 45, joints.1: joints grouted: no stones there; found above 40 m"),
    ):
        with pytest.raises(InputError, match=rf"loaded\.toml: {said}"):
            read_case(case_of(tmp_path, CASE + JOINTS.replace(given, wrong))).building()


def test_walls_are_of_the_first_material_of_the_case_in_a_run_too(tmp_path: Path) -> None:
    case = read_case(case_of(tmp_path, CASE + BEAM))
    assert {panel.material for panel in case.building().panels} == {"default"}
    configure(tmp_path / "loaded.toml", tmp_path / "run")
    source(tmp_path / "run/geometry/base/settings.json", tmp_path / "building.json")
    assert {panel.material for panel in read_building(tmp_path / "building.json").panels} == {"default"}


FLOORS = """
[[diaphragms]]
name = "loft"
walls = ["nave_left", "nave_right"]
height_m = 4.5
dead_kN_m2 = 1.0
spacing_m = 1.0
friction = 0.4
fixing_kN = 2.0
bearing_length_mm = 120
"""


def chapel(folder: Path, more: str) -> Path:
    path = folder / "chapel.toml"
    path.write_text((READY / "chapel.toml").read_text() + more)
    return path


def test_what_the_ready_chapel_says_in_comments_holds(tmp_path: Path) -> None:
    head, said, tail = (READY / "chapel.toml").read_text(encoding="utf-8").partition("# What else it carries")
    lines = [line.removeprefix("# ") for line in tail.splitlines()[1:]]
    (tmp_path / "chapel.toml").write_text(head + "\n".join(lines), encoding="utf-8")
    case = read_case(tmp_path / "chapel.toml")
    stones = derive_blocks(case.building())
    found = placed(case.carries, stones)
    assert said
    assert set(found.loads.wall.tolist()) == {"nave_left"}
    assert [tie.name for tie in found.ties] == ["front"]
    assert {"facade buttress 1", "facade buttress 2"} <= set(stones.panel.tolist())
    assert case.check is not None


def test_a_porch_is_two_buttresses_that_bear_a_roof(tmp_path: Path) -> None:
    page = (READY.parents[1] / "docs" / "walls.md").read_text(encoding="utf-8")
    (porch,) = re.findall(r"```toml\n(\[\[buttresses\]\]\nname = \"porch\".*?)```", page, flags=re.DOTALL)
    # The facade of the ready chapel is 6 m wide, that of the page 9 m.
    case = read_case(chapel(tmp_path, porch.replace("[2.5, 6.5]", "[1.5, 4.5]")))
    stones = derive_blocks(case.building())
    found = placed(case.carries, stones)
    weight = {wall: found.loads.weight[found.loads.wall == wall].sum() for wall in np.unique(found.loads.wall)}
    # 1 kN/m2 on 2.5 m clear between them and 2 m out from the facade, half on each.
    assert weight == pytest.approx({"porch buttress 1": 2.5e3, "porch buttress 2": 2.5e3})


def test_a_diaphragm_presses_and_holds(tmp_path: Path) -> None:
    case = read_case(chapel(tmp_path, FLOORS))
    assert carries_of(case.carries.settings()).settings() == case.carries.settings()
    (loft,) = case.carries.diaphragms
    found = placed(case.carries, derive_blocks(case.building()))
    weight = found.loads.weight.sum()
    # 4.6 m clear between the walls, a joist a metre.
    assert len(found.ties) == round(weight / loft.dead / 4.6)
    assert {tie.governs for tie in found.ties} == {"friction and fixing at its bearings"}
    # All joists together hold .4 of what one wall bears, and 2 kN each.
    assert sum(tie.strength for tie in found.ties) == pytest.approx(0.4 * weight / 2 + 2e3 * len(found.ties))
    assert {tie.ultimate for tie in found.ties} == {0.12}


@pytest.mark.parametrize(
    ("given", "wrong", "said"),
    [
        ('"nave_right"]', '"nave_rigth"]', r"diaphragms\.0: diaphragm loft: no such wall; found nave_rigth"),
        ('["nave_left", "nave_right"]', '["nave_left", "facade"]', r"diaphragms\.0: diaphragm loft: walls: not around a floor"),
        ("spacing_m = 1.0", "spacing_m = 0", r"diaphragms\.0\.spacing_m: wrong value"),
        ("friction = 0.4\nfixing_kN = 2.0\n", "", r"diaphragms\.0: nothing holds its joists"),
    ],
)
def test_what_is_wrong_with_a_diaphragm_is_said_with_its_line(tmp_path: Path, given: str, wrong: str, said: str) -> None:
    assert given in FLOORS
    with pytest.raises(InputError, match=rf"chapel\.toml: line \d+, {said}"):
        read_case(chapel(tmp_path, FLOORS.replace(given, wrong))).building()
