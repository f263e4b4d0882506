"""The Python interface: arguments of the wrong kind are named where they are given."""

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.code_check import Floor, Site
from churchpipe.displacement_check import displacement_check
from churchpipe.errors import InputError
from churchpipe.generators import arch, wall
from churchpipe.large_displacements.cracks import joint_cracks
from churchpipe.model.building import CylinderChart, Junction, Opening, Part
from churchpipe.spectrum import SiteSpectrum
from churchpipe.stones.footing import footing
from solids import BOX_FACES, box, on_ground

nan = float("nan")
GIVEN = box((0, 1), (0, 1), (0, 1))
CUBE = np.asarray(GIVEN[0])
ABOVE = box((0, 1), (0, 1), (1, 2))
STONES = on_ground(box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)), unit_weight=2e4, reach=3)
CONTACTS = cp.find_contacts(STONES)
PUSH = cp.LoadCase([1, 0, 0])
CURVE = cp.block_pushover(STONES, CONTACTS, PUSH, steps=1)
STONE = cp.Material("default", 18e3, 0.6)

POLYHEDRA: list[tuple[Any, str]] = [
    (None, r"polyhedra: not a list; found None"),
    (3, r"polyhedra: not a list; found 3"),
    ("cube", r"polyhedra: not a list; found 'cube'"),
    ({"a": GIVEN}, r"polyhedra: not a list; found dict"),
    (GIVEN, r"polyhedra\[0\]: not a pair; found ndarray; expected \(vertices, faces\)"),
    ([GIVEN, None], r"polyhedra\[1\]: not a pair; found None"),
    ([CUBE], r"polyhedra\[0\]: not a pair"),
    ([(CUBE, BOX_FACES, 1)], r"polyhedra\[0\]: not a pair"),
    ([(CUBE, None)], r"polyhedra\[0\] faces: not a list; found None"),
    ([(CUBE, [])], r"polyhedra\[0\]: no faces"),
    ([(CUBE, [1, 2, 3])], r"polyhedra\[0\]: bad face; found 1"),
    ([(CUBE, ["abc"])], r"polyhedra\[0\]: bad face; found abc"),
    ([(CUBE, [[nan, 1, 2]])], r"polyhedra\[0\]: bad face"),
    ([("abc", BOX_FACES)], r"polyhedra\[0\] vertices: not numbers; found 'abc'"),
    ([([[0, 0], [1, 2, 3]], BOX_FACES)], r"polyhedra\[0\] vertices: no array"),
    ([(CUBE * 1j, BOX_FACES)], r"polyhedra\[0\] vertices: not numbers; found complex128"),
    ([(None, BOX_FACES)], r"polyhedra\[0\] vertices: not numbers; found None"),
]


@pytest.mark.parametrize(("polyhedra", "said"), POLYHEDRA)
def test_polyhedra(polyhedra: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        cp.Assemblage.from_polyhedra(polyhedra, 18e3)


COLUMNS: list[tuple[dict[str, Any], str]] = [
    ({"unit_weight": "18"}, r"unit_weight: not numbers; found '18'"),
    ({"unit_weight": {"default": 18e3}}, r"unit_weight: not numbers; found dict"),
    ({"unit_weight": [1, 2, 3]}, r"unit_weight: wrong shape; found \(3,\); expected one for all, or \(2,\)"),
    ({"unit_weight": [[1, 2]]}, r"unit_weight: wrong shape"),
    ({"fixed": None}, r"fixed: not a list; found None"),
    ({"fixed": 0}, r"fixed: not a list; found 0"),
    ({"fixed": "B0"}, r"fixed: not a list; found 'B0'"),
    ({"fixed": ["B0"]}, r"fixed: not whole numbers"),
    ({"fixed": [[0]]}, r"fixed: wrong shape"),
    ({"fixed": np.ma.masked_array([0, 1], [False, True])}, r"fixed: masked entries"),
    ({"material": None}, r"material: not texts; found None"),
    ({"material": ["a", None]}, r"material: not texts"),
    ({"material": ["a", "b", "c"]}, r"material: wrong shape"),
    ({"panel": None}, r"panel: not texts"),
    ({"course": "a"}, r"course: not whole numbers; found 'a'"),
    ({"course": 1.5}, r"course: not whole numbers; found 1\.5"),
    ({"course": [1, 2, 3]}, r"course: wrong shape"),
    ({"block_id": "ab"}, r"block_id: not a list; found 'ab'"),
    ({"block_id": 3}, r"block_id: not a list; found 3"),
    ({"block_id": [None, None]}, r"block_id: not texts"),
]


@pytest.mark.parametrize(("changed", "said"), COLUMNS)
def test_columns_of_an_assemblage(changed: dict[str, Any], said: str) -> None:
    arguments = {"unit_weight": 18e3} | changed
    with pytest.raises(InputError, match=said):
        cp.Assemblage.from_polyhedra([GIVEN, ABOVE], **arguments)


HALF = "a\ud800b"
HALVED: list[tuple[Callable[[], object], str]] = [
    (lambda: cp.Assemblage.from_polyhedra([GIVEN], 18e3, panel=HALF), "panel"),
    (lambda: cp.Assemblage.from_polyhedra([GIVEN], 18e3, block_id=[HALF]), "block_id"),
    (lambda: cp.Assemblage.from_polyhedra([GIVEN], 18e3, material=HALF), "material"),
    (lambda: replace(STONES, panel=np.array([HALF] * STONES.count)), "Assemblage.panel"),
    (lambda: cp.LoadCase((1, 0, 0), name=HALF), "LoadCase.name"),
    (lambda: cp.LoadCase((1, 0, 0), panels=["a", HALF]), r"LoadCase.panels\[1\]"),
    (lambda: cp.PointLoad("a", 1.0, dead=1e3, name=HALF), "point load: name"),
    (lambda: cp.LineLoad(dead=1e3, wall=HALF), "line load: wall"),
    (lambda: cp.Material(HALF, 18e3, 0.6), "material: name"),
    (lambda: Part(HALF, [[0, 0], [1, 0], [1, 1]]), "Part.name"),
]


@pytest.mark.parametrize(("call", "where"), HALVED)
def test_a_name_with_half_of_a_character_is_refused_where_it_is_given(call: Callable[[], object], where: str) -> None:
    # Found by the first file that is written, it would be a UnicodeEncodeError from the depths.
    with pytest.raises(InputError, match=rf"{where}: half of a character.*found 'a\\ud800b'; expected whole") as raised:
        call()
    assert str(raised.value).encode()


def test_a_value_for_all_and_one_each_are_taken() -> None:
    pair = [GIVEN, ABOVE]
    stones = cp.Assemblage.from_polyhedra(iter(pair), [18e3, 20e3], material="tuff", course=[0, 1], block_id=("a", "b"))
    assert stones.unit_weight.tolist() == [18e3, 20e3]
    assert stones.material.tolist() == ["tuff", "tuff"]
    assert stones.course.tolist() == [0, 1]
    assert stones.block_id.tolist() == ["a", "b"]


CALLS: list[tuple[Callable[[], object], str]] = [
    (lambda: cp.LoadCase("+x"), r"LoadCase\.direction: a text; found \'\+x\'; expected a vector, such as \[1, 0, 0\]"),
    (lambda: cp.LoadCase(), r"LoadCase: nothing is pushed; found no live wrenches; expected a direction, live wrenches"),
    (lambda: cp.LoadCase(live=np.zeros((3, 6))), r"LoadCase: nothing is pushed; found live wrenches that are all zero"),
    (lambda: cp.LoadCase(live=np.ones((3, 6)), profile="linear"), r"LoadCase: no weight is pushed; found panels or a profile"),
    (lambda: cp.LoadCase(live=np.ones((3, 6)), panels=["a"]), r"LoadCase: no weight is pushed; found panels or a profile"),
    (lambda: cp.LoadCase(["1", "0", "0"]), r"LoadCase\.direction: not numbers"),
    (lambda: cp.LoadCase({"x": 1}), r"LoadCase\.direction: not numbers; found dict"),
    (lambda: cp.LoadCase([1, 0, 0], name=3), r"LoadCase\.name: no name; found 3"),
    (lambda: cp.LoadCase([1, 0, 0], panels="wall"), r"LoadCase\.panels: wrong kind; found 'wall'; expected a list of str"),
    (lambda: cp.LoadCase([1, 0, 0], panels=3), r"LoadCase\.panels: wrong kind; found 3"),
    (lambda: cp.LoadCase([1, 0, 0], panels=["a", None]), r"LoadCase\.panels\[1\]: wrong kind; found None"),
    (lambda: cp.LoadCase([1, 0, 0], profile=[]), r"LoadCase\.profile: unknown value; found list"),
    (lambda: cp.LoadCase([1, 0, 0], dead="a"), r"LoadCase\.dead: not numbers"),
    (lambda: cp.Material("a", "18", 0.6), r"material a: unit_weight: not a number; found '18'"),
    (lambda: cp.Material("a", 18e3, None), r"material a: friction: not a number; found None"),
    (lambda: cp.Material("a", 18e3, [0.6]), r"material a: friction: not a number; found list"),
    (lambda: cp.Material("a", 18e3, nan), r"material a: friction: out of range; found nan"),
    (lambda: cp.Material("a", 18e3, True), r"material a: friction: not a number; found True"),
    (lambda: cp.Material(None, 18e3, 0.6), r"material: name: no name; found None"),
    (lambda: cp.Material("a", 18e3, 0.6, 0.0, {}), r"material a: elastic: wrong kind; found dict; expected an Elastic"),
    (lambda: cp.find_contacts(None), r"find_contacts: stones: wrong kind; found None; expected an Assemblage"),
    (lambda: cp.find_contacts(STONES, "1 mm"), r"find_contacts: contact_gap: not a number"),
    (lambda: cp.limit_analysis(CONTACTS, STONES, PUSH), r"stones: wrong kind; found Contacts; expected an Assemblage"),
    (lambda: cp.limit_analysis(STONES, None, PUSH), r"limit_analysis: contacts: wrong kind; found None"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, "+x"), r"limit_analysis: load: wrong kind; found '\+x'; expected a LoadCase"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, [1, 0, 0]), r"limit_analysis: load: wrong kind; found list"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, [STONE]), r"friction: not numbers"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, "0.6"), r"friction: not numbers; found '0\.6'"),
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, progress=3), r"limit_analysis: progress: not a function; found 3"),
    (lambda: cp.minimum_thickness(None, 0.1, 0.2), r"minimum_thickness: make: not a function; found None; expected a function"),
    (lambda: cp.settlement_path(STONES, CONTACTS, [0], keep=3), r"settlement_path: keep: not a function; found 3"),
    (lambda: cp.settlement_path(STONES, CONTACTS, [0], step=1e30), r"settlement_path: step: a step longer than the structure"),
    (
        lambda: displacement_check(None, STONES, PUSH, None),
        r"displacement_check: wrong kind; found None; expected a BlockCapacityC",
    ),
    (lambda: displacement_check(CURVE, STONES, "+x", None), r"displacement_check: wrong kind; found '\+x'; expected a LoadCase"),
    (lambda: displacement_check(CURVE, STONES, PUSH, 1.5), r"displacement_check: wrong kind; found 1.5; expected a Site"),
    (lambda: displacement_check(CURVE, STONES, PUSH, None, crushing="no"), r"wrong kind; found 'no'; expected a bool"),
    (lambda: Site(None, 1.2), r"check: ground_acceleration: not a number; found None"),
    (lambda: Site((), 1.2), r"check: ground_acceleration: not a number; found tuple"),
    (lambda: Site(1.5, spectrum=3), r"check: spectrum: wrong kind; found 3; expected a SiteSpectrum"),
    (lambda: Site(1.5, 1.2, floor=6.0), r"check: floor: wrong kind; found 6.0; expected a Floor"),
    (lambda: Site(1.5, 1.2, knowledge_level="LC4"), r'check: knowledge_level: unknown value; found LC4; expected "LC1" or'),
    (lambda: Floor(None, 12.0, 3, 3.1), r"check: height: not a number; found None"),
    (lambda: SiteSpectrum(2.5, 0.35, soil=[]), r"spectrum: soil: unknown value; found list"),
    (lambda: SiteSpectrum(2.5, 0.35, soil=""), r"spectrum: soil: unknown value"),
    (lambda: SiteSpectrum(2.5, 0.35, soil="B", topography=None), r"spectrum: topography: unknown value; found None"),
    (lambda: SiteSpectrum(np.zeros(0), 0.35), r"spectrum: amplification: not a number; found ndarray"),
    (lambda: footing(STONES, CONTACTS, 3), r"footing: place: wrong shape"),
    (lambda: footing(STONES, CONTACTS, ((0, 0), (1, nan))), r"footing: place: not a finite number"),
    (lambda: footing(None, CONTACTS, "a"), r"footing: stones: wrong kind"),
    (lambda: joint_cracks(STONES, None, STONES.centroid, 0 * STONES.centroid), r"joint_cracks: contacts: wrong kind"),
    (lambda: joint_cracks(STONES, CONTACTS, STONES.centroid, None), r"joint_cracks: rotation: not numbers; found None"),
    (lambda: joint_cracks(STONES, CONTACTS, STONES.centroid[:1], STONES.centroid), r"joint_cracks: position: wrong shape"),
    (
        lambda: cp.Tie("rod", (0, 0, 0), (0, 0, 1), strength=1e3, ultimate=np.zeros(0)),
        r"ultimate elongation: not a number; found ndarray",
    ),
    (lambda: replace(CURVE, d0="a"), r"BlockCapacityCurve.d0: wrong kind; found 'a'"),
    (lambda: replace(CURVE, last=None), r"BlockCapacityCurve.last: wrong kind; found None"),
    (lambda: replace(CURVE, fallen=3), r"BlockCapacityCurve.fallen: wrong kind; found 3"),
    (lambda: cp.derive_blocks("case.toml"), r"derive_blocks: building: wrong kind; found 'case\.toml'.*read_case"),
    (lambda: cp.derive_shell(STONES, 0.1), r"derive_shell: building: wrong kind; found Assemblage; expected a Building"),
    (lambda: cp.match_models(STONES, CONTACTS, STONES), r"match_models: shell: wrong kind; found Assemblage"),
    (lambda: cp.write_dxf(None, "a.dxf"), r"write_dxf: assemblage: wrong kind; found None"),
    (
        lambda: cp.write_dxf(STONES, "a.dxf", materials=STONE),
        r"write_dxf: materials: wrong kind; found Material; expected a list",
    ),
    (lambda: cp.write_dxf(STONES, "a.dxf", loads=["+x"]), r"write_dxf: loads\[0\]: wrong kind; found '\+x'"),
    (lambda: cp.write_dxf(STONES, "."), r"\.: the drawing cannot be written; found a folder"),
    (lambda: cp.write_dxf(STONES, "/dev/null"), r"/dev/null: the drawing cannot be written; found a folder or a device"),
    (lambda: cp.write_dxf(STONES, "x" * 300 + ".dxf"), r"the drawing cannot be written; found File name too long"),
    (lambda: cp.write_dxf(STONES, None), r"write_dxf: path: not a path; found None"),
    (lambda: cp.read_dxf(None), r"read_dxf: path: not a path; found None"),
    (lambda: cp.read_dxf("a\0b"), r"read_dxf: path: not a path"),
    (lambda: cp.read_dxf("a.dxf", unit_weight="18"), r"unit weight: not a number; found '18'"),
    (lambda: cp.read_dxf("a.dxf", unit_weight={"tuff": "18"}), r"unit weight of 'tuff': not a number"),
    (lambda: cp.read_dxf("a.dxf", units=3), r"units: unknown unit; found 3"),
    (lambda: cp.read_dxf("a.dxf", repair="no"), r"repair: wrong kind; found 'no'; expected a bool"),
    (lambda: cp.read_case(None), r"read_case: path: not a path"),
    (lambda: cp.read_case("/dev/null"), r"/dev/null: not a file"),
]


@pytest.mark.parametrize(("call", "said"), CALLS)
def test_arguments(call: Callable[[], object], said: str, tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=said):
        call()
    assert not list(tmp_path.iterdir())


def test_changes_of_the_wrong_kind(tmp_path: Any) -> None:
    path = tmp_path / "case.toml"
    path.write_text("")
    wrong: tuple[Any, ...] = (3, "rigid.solver=clarabel", [None])
    for overrides in wrong:
        with pytest.raises(InputError, match=r"overrides.*: wrong kind"):
            cp.read_case(path, overrides)


SIZES: list[tuple[tuple[Any, ...], str]] = [
    ((None,), r"element size of wall: not a number; found None"),
    (([0.1],), r"element size of wall: not a number; found list"),
    ((0.3, 3), r"derive_shell: sizes: wrong kind; found 3"),
    ((0.3, {"wall": "fine"}), r"element size of wall: not a number; found 'fine'"),
    ((40.0,), r"element size of wall: longer than every wall; found 40\.0; expected at most "),
    ((1e-3,), r"element size: too small for this building; found about 1,440,000 elements of 0\.001 m"),
]


@pytest.mark.parametrize(("sizes", "said"), SIZES)
def test_sizes_of_elements(sizes: tuple[Any, ...], said: str) -> None:
    from churchpipe.generators import wall

    building = wall(length=1.2, brick=(0.4, 0.25, 0.2), courses=3)
    with pytest.raises(InputError, match=said):
        cp.derive_shell(building, *sizes)


def test_too_many_stones_are_counted_not_laid() -> None:
    from churchpipe.generators import wall

    # 14 m taken for millimetres: 14 km of bricks.
    building = wall(length=14000.0, brick=(0.25, 0.12, 0.06), courses=100)
    with pytest.raises(InputError, match=r"building wall: too many stones; found about 5,600,000, of them 5,600,000 in wall"):
        cp.derive_blocks(building)


def test_stones_are_counted_before_walls_that_cross_are() -> None:
    from churchpipe.generators import box

    tall = box(length=3.0, width=3.0, brick=(0.25, 0.12, 0.06), courses=1_000_000)
    for derive in (cp.derive_blocks, lambda building: cp.derive_shell(building, element_size=5e5)):
        with pytest.raises(InputError, match=r"building box: too many stones; found about 48,000,000"):
            derive(tall)


def test_names_given_as_objects_are_texts() -> None:
    ids = np.array(["a", "b"], dtype=object)
    stones = cp.Assemblage.from_polyhedra([GIVEN, ABOVE], 18e3, block_id=ids)
    assert stones.block_id.dtype.kind == "U"


WALL = cp.generators.wall(length=1.2, brick=(0.4, 0.25, 0.2), courses=3, materials=(STONE,))
STATE = cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6)
SHELL = cp.derive_shell(WALL, 0.4)
ELASTIC = (3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
TWICE = [STONE, cp.Material("default", 18e3, 0.1)]

OTHERS: list[tuple[Callable[[], Any], str]] = [
    (lambda: cp.Material("m", 18e3, 1e-300), r"material m: friction: out of range; found 1e-300; expected 0, or 1e-06 to 1000"),
    (lambda: cp.Material("m", 1e24, 0.6), r"material m: unit_weight: out of range"),
    (lambda: cp.read_stones("a.obj", scale=nan), r"scale: out of range; found nan; expected a finite number > 0\."),
    (lambda: cp.Material("m", 10**400, 0.6), r"material m: unit_weight: out of range; .* expected a finite number"),
    (lambda: cp.Elastic(*ELASTIC[:4], True), r"elastic.joint_thickness: not a number; found True"),
    (lambda: cp.Elastic(*ELASTIC[:4], 1e-300), r"elastic.joint_thickness: out of range"),
    (lambda: cp.Elastic(1e308, *ELASTIC[1:]), r"elastic.block_modulus: out of range"),
    (lambda: cp.Elastic(3.18e9, 0.5, *ELASTIC[2:]), r"elastic.block_poisson: out of range; found 0.5"),
    (lambda: cp.joint_strength(STONES, CONTACTS, TWICE), r"material default: given twice"),
    (lambda: cp.joint_strength(None, CONTACTS, [STONE]), r"joint_strength: stones: wrong kind; found None"),  # pyright: ignore
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, bipotential_gap=None), r"bipotential_gap: not a number"),  # pyright: ignore
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, solver=None), r"solver: no name; found None"),  # pyright: ignore
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, start=False), r"start: wrong kind; found False"),  # pyright: ignore
    (lambda: cp.block_pushover(STONES, CONTACTS, PUSH, 0.6, ties=None), r"block_pushover: ties: wrong kind"),  # pyright: ignore
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, method=[]), r"method: unknown method"),  # pyright: ignore
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, 10**400), r"friction: .*; found "),
    (lambda: cp.limit_analysis(STONES, CONTACTS, PUSH, 0.6, cohesion=10**400), r"cohesion: .*; found "),
    (lambda: cp.shell_limit_analysis(SHELL, PUSH, [STONE], membrane=np.zeros(2)), r"membrane: unknown element; found \["),  # pyright: ignore
    (lambda: cp.shell_limit_analysis(SHELL, PUSH, [STONE], stations=np.zeros(0)), r"stations: unknown"),  # pyright: ignore
    (lambda: cp.shell_limit_analysis(SHELL, PUSH, [STONE], solver=np.zeros(0)), r"solver: unknown value; found ndarray"),  # pyright: ignore
    (lambda: cp.rank_ties(STATE, [], STONES, None, PUSH), r"rank_ties: contacts: wrong kind; found None"),  # pyright: ignore
    (lambda: cp.rank_ties(STATE, [], STONES, CONTACTS, "+x"), r"rank_ties: load: wrong kind; found '\+x'"),  # pyright: ignore
    (lambda: cp.shell_loaded("+x", SHELL, STONES, []), r"shell_loaded: load: wrong kind; found '\+x'"),  # pyright: ignore
    (lambda: cp.with_ring_beams(STONES, ["a"], height=None), r"ring beam: height: not a number; found None"),  # pyright: ignore
    (
        lambda: cp.minimum_thickness(lambda _: STONES, 0.1, 0.2, contact_model=np.zeros(2)),  # pyright: ignore
        r"minimum_thickness: contact_model: unknown value; found ndarray",
    ),
    (lambda: cp.derive_shell(WALL, 0.4, sizes=np.zeros(2)), r"derive_shell: sizes: wrong kind; found ndarray"),  # pyright: ignore
]


@pytest.mark.parametrize(("call", "said"), OTHERS)
def test_other_arguments(call: Callable[[], Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        call()


def test_a_shell_starts_on_its_ground_and_has_elements_no_longer_than_its_walls() -> None:
    building = wall(length=1.2, brick=(0.4, 0.25, 0.2), courses=3)
    with pytest.raises(InputError, match=r"element size of wall: longer than every wall; found 1e\+308; expected at most 1.2 m"):
        cp.derive_shell(building, 1e308)
    with pytest.raises(InputError, match=r"building: masonry below the ground; found z = 0 m; expected z >= 0.1 m"):
        cp.derive_shell(replace(building, ground=0.1), 0.4)


BUILDING = wall(length=1.2, brick=(0.4, 0.25, 0.2), courses=3)
ARCH = arch(mean_radius=1.0, thickness=0.3, width=0.5, voussoirs=7)
REGION = BUILDING.panels[0].regions[0]
INSTANCES = {
    "material": STONE,
    "elastic": cp.Elastic(*ELASTIC),
    "load": PUSH,
    "cell": REGION.cell,
    "region": REGION,
    "panel": BUILDING.panels[0],
    "plane": BUILDING.panels[0].chart,
    "cylinder": CylinderChart(np.zeros(3), 2.0),
    "opening": Opening("door", REGION.outline),
    "part": Part("left", REGION.outline),
    "support": ARCH.supports[0],
    "building": ARCH,
    "assemblage": STONES,
    "contacts": CONTACTS,
    "shell": cp.derive_shell(BUILDING, 0.4),
}
JUNK: list[Any] = [
    None,
    True,
    -1,
    1.5,
    nan,
    1e400,
    10**400,
    "",
    "x",
    b"x",
    [],
    [None],
    ["x"],
    {},
    object(),
    np.empty((0, 3)),
    lambda: 0,
]


@pytest.mark.parametrize("kind", INSTANCES)
def test_fields_take_what_they_hold_or_name_what_they_got(kind: str) -> None:
    instance: Any = INSTANCES[kind]
    for field in fields(instance):
        refused: list[str] = []
        for junk in JUNK:
            try:
                replace(instance, **{field.name: junk})
            except InputError as error:
                refused.append(str(error))
        assert len(refused) >= 5, field.name
        assert all(": " in said for said in refused)


def test_a_word_in_the_place_of_a_list_of_walls_is_named() -> None:
    with pytest.raises(
        InputError, match=r"with_ring_beams: walls: not a list; found 'wall'|with_ring_beams: walls: wrong kind; found 'wall'"
    ):
        cp.with_ring_beams(STONES, "wall", height=0.3)


def test_an_option_of_reading_that_there_is_none_of_is_named() -> None:
    with pytest.raises(InputError, match=r"read_stones: thick: no such option; expected units, repair, .*thickness"):
        cp.read_stones("wall.dxf", thick=0.2)


def test_a_place_of_a_tie_that_is_a_mapping_is_none() -> None:
    with pytest.raises(InputError, match=r"tie t: start: no place; found dict; expected x, y, z m, or \(wall"):
        cp.TieBar("t", start={"wall": "wall", "along": 1, "height": 2}, end=(0, 0, 2), area=1e-4, steel_strength=235e6)


def test_more_courses_than_any_wall_has_are_out_of_range() -> None:
    with pytest.raises(InputError, match=r"every: out of range; found 10+; expected a whole number from 0 to 1000000"):
        Junction(("facade", "nave_left"), every=10**30)


def test_places_beyond_all_numbers_are_no_warning(recwarn: pytest.WarningsRecorder) -> None:
    far = cp.TieBar("t", (0.0, 0.5, 0.5), (1.0, 0.5, 0.5), area=1e-4, steel_strength=235e6, plate=(1e300, 1e300))
    with pytest.raises(InputError, match="its plate"):
        cp.place_ties(STONES, [far])
    assert not [one for one in recwarn if one.category is RuntimeWarning]


@pytest.mark.parametrize("length", [1e-300, 1e-9, 1.0, 1e9, 1e300])
def test_the_length_of_a_direction_changes_nothing(length: float) -> None:
    load = cp.LineLoad("wall", thrust=1.0, toward=(3 * length, -4 * length, 0))
    assert load.toward == pytest.approx([0.6, -0.8, 0])
    pressure = cp.Pressure("wall", toward=(length, 0, 0), unit_weight=1e4, top=1.0)
    assert pressure.toward == pytest.approx([1, 0, 0])


def test_ties_are_taken_from_whatever_gives_them() -> None:
    bars = [cp.Tie("rod", (0.5, 0.5, 1.75), (-1.4, 0.5, -0.2), strength=2e3)]
    known = cp.block_pushover(STONES, CONTACTS, PUSH, 0.6, ties=bars, steps=2)
    for given in ((tie for tie in bars), {"rod": bars[0]}.values(), tuple(bars)):
        found = cp.block_pushover(STONES, CONTACTS, PUSH, 0.6, ties=given, steps=2)  # pyright: ignore
        np.testing.assert_array_equal(found.tie_forces, known.tie_forces)
        assert found.given == known.given


def test_a_support_may_be_one_number() -> None:
    paths = [cp.settlement_path(STONES, CONTACTS, given, friction=0.6, step=0.05, steps=1) for given in (0, [0])]
    np.testing.assert_array_equal(paths[0].reaction, paths[1].reaction)
    assert paths[0].given == paths[1].given
