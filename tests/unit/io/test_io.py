"""Artifacts come back as they were written, or are named when they cannot."""

import csv
import dataclasses
import errno
import json
import pickle
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
import pyvista

from churchpipe.errors import InputError
from churchpipe.generators import GENERATORS
from churchpipe.io.atomic import canonical_json, read_json, replacing, write_if_changed
from churchpipe.io.building_json import SCHEMA, read_building, write_building
from churchpipe.io.npz import Absent, read_if_made, read_npz, write_npz
from churchpipe.io.tables import write_table
from churchpipe.io.vtu import write_vtu
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.materials import Elastic, Material
from churchpipe.model.results import CapacityCurve, CapacityStep, Iteration, LimitState, ShellLimitState, StartRun
from churchpipe.model.shell import ShellModel
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.joints import joint_strength
from records import analysis
from solids import box, moved, on_ground, prism

ROOT2, ROOT3, PI = np.sqrt(2.0), np.sqrt(3.0), np.pi


def irrational() -> Assemblage:
    """Two boxes and a prism of irrational size, turned by an irrational angle."""
    stones = on_ground(
        box((0, ROOT2), (0, PI / 3), (0, ROOT3 / 2)),
        box((0.1 * PI, ROOT2), (0, PI / 3), (ROOT3 / 2, ROOT3)),
        prism([(2, 0), (2 + ROOT2, 0), (2 + ROOT3, PI / 2)], 1 / PI),
        reach=4 * PI,
    )
    c, s = np.cos(ROOT2), np.sin(ROOT2)
    return moved(stones, np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), np.array([PI, -ROOT2, ROOT3]))


def state(count: int, points: int) -> LimitState:
    random = np.random.default_rng(5)
    return LimitState(
        load_factor=ROOT2,
        status="converged",
        lower_bound=np.nan,
        upper_bound=np.inf,
        forces=random.normal(size=(points, 3)),
        velocities=random.normal(size=(count, 6)),
        flow="non-associative",
        history=(Iteration(0.3, 0.1), Iteration(0.25, 0.01, 1e-9)),
        interval=(0.2, PI),
        fixed_points=(0.25, 0.26),
        starts=(
            StartRun("dead-load", 0.25, True, 1e-9, (0.2, PI), (Iteration(0.3, 0.1), Iteration(0.25, 0.01, 1e-9))),
            StartRun("associative", 0.26, False, np.nan, (np.nan, np.nan), ()),
        ),
        message="späte Konvergenz",
        tie_forces=np.array([PI, 0.0]),
        tie_sensitivity=np.array([ROOT2, np.nan]),
    )


def assert_equal(one: Any, other: Any) -> None:
    assert type(one) is type(other)
    for field in dataclasses.fields(one):
        left, right = getattr(one, field.name), getattr(other, field.name)
        if isinstance(left, np.ndarray):
            assert left.dtype == right.dtype
            np.testing.assert_array_equal(left, right)
        elif dataclasses.is_dataclass(left):
            assert_equal(left, right)
        elif isinstance(left, tuple) and left and dataclasses.is_dataclass(left[0]):
            assert len(left) == len(right)
            for a, b in zip(left, right, strict=True):
                assert_equal(a, b)
        else:
            np.testing.assert_equal(left, right)


def artifacts() -> list[Any]:
    stones = irrational()
    contacts = find_contacts(stones)
    assert len(contacts.point) > 8
    return [stones, contacts, state(stones.count, len(contacts.point))]


@pytest.mark.parametrize("value", artifacts(), ids=lambda value: type(value).__name__)
def test_npz_round_trip_is_exact(value: Any, tmp_path: Path) -> None:
    path = tmp_path / "deep" / "artifact.npz"
    write_npz(path, value)
    assert_equal(read_npz(path, type(value)), value)
    assert [p.name for p in path.parent.iterdir()] == ["artifact.npz"]


def test_npz_of_equal_content_is_equal_to_the_byte(tmp_path: Path) -> None:
    for name in ("one.npz", "two.npz"):
        write_npz(tmp_path / name, irrational())
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()


def test_npz_of_another_type_or_form_is_named(tmp_path: Path) -> None:
    write_npz(tmp_path / "stones.npz", irrational())
    with pytest.raises(InputError, match=r"another schema; found churchpipe assemblage 2; expected churchpipe contacts 2"):
        read_npz(tmp_path / "stones.npz", Contacts)
    whole = (tmp_path / "stones.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match=r"cut\.npz: damaged"):
        read_npz(tmp_path / "cut.npz", Assemblage)
    np.savez(tmp_path / "pickled.npz", schema=np.array([Path("a")], dtype=object))
    with pytest.raises(InputError, match="damaged, or not a file of churchpipe"):
        read_npz(tmp_path / "pickled.npz", Assemblage)
    (tmp_path / "pickle.npz").write_bytes(pickle.dumps([1]))
    with pytest.raises(InputError, match="damaged, or not a file of churchpipe"):
        read_npz(tmp_path / "pickle.npz", Assemblage)


def test_a_damaged_file_is_named_and_nothing_is_advised_that_runs_its_code(tmp_path: Path) -> None:
    write_npz(tmp_path / "whole.npz", irrational())
    whole, random = (tmp_path / "whole.npz").read_bytes(), np.random.default_rng(24)
    path, said = tmp_path / "damaged.npz", list[str]()
    for _ in range(400):
        data = bytearray(whole)
        for place in random.integers(len(data), size=random.integers(1, 4)):
            data[place] = random.integers(256)
        path.write_bytes(data[: random.integers(len(data))] if random.random() < 0.2 else data)
        try:
            read_npz(path, Assemblage)
        except InputError as error:
            said.append(str(error))
    assert len(said) > 200
    assert all(text.startswith(str(path)) and "pickle" not in text for text in said)


def test_an_array_with_an_open_bracket_in_its_header_is_damaged(tmp_path: Path) -> None:
    write_npz(tmp_path / "whole.npz", irrational())
    with ZipFile(tmp_path / "whole.npz") as whole, ZipFile(tmp_path / "open.npz", "w") as broken:
        for name in whole.namelist():
            broken.writestr(name, whole.read(name).replace(b"), }", b"((,}"))
    with pytest.raises(InputError, match=r"open\.npz: damaged"):
        read_npz(tmp_path / "open.npz", Assemblage)


@pytest.mark.parametrize(
    "building", ['{"type": "Panel"}', '{"type": "Wall"}', "{}", "3", '{"type": "Building", "name": "a"}', '{"type": []}']
)
def test_a_damaged_building_is_named(building: str, tmp_path: Path) -> None:
    path = tmp_path / "building.json"
    path.write_text(f'{{"schema": "{SCHEMA}", "building": {building}}}')
    with pytest.raises(InputError, match=r"building\.json: damaged"):
        read_building(path)


BRICK = (ROOT2 / 4, ROOT3 / 10, 0.15)
DOOR = {"start": 0.5 * ROOT2, "width": 0.4, "height_courses": 3, "lintel_bearing": 0.1}
BOND = {"course": 0.25, "stone_length": ROOT2 / 3}
WALLS = {"height": 4.0, "thickness": ROOT3 / 3}
APSE = {"inner_radius": PI / 3, "thickness": 0.5, "height": 3.0}
NAVE = {"width": 4.0, "length": 5.0, "height": 4.0, "thickness": 0.5}
END = {"thickness": 0.5, "ridge": 4.0 + ROOT2}
ARMS = {"width": 9.0, "depth": PI, "thickness": 0.5}
WINDOW = {"name": "w", "wall": "front", "centre": 0.0, "width": 0.5, "springing": ROOT2, "voussoirs": 5, "depth": 0.2}
LINE = {"name": "a", "start": (0, 0), "end": (PI + ROOT2, 0)}
DOORWAY = {"name": "d", "wall": "a", "centre": 2.0, "width": ROOT2 / 2, "height": 2.0, "lintel_material": "tuff"}
PARAMETERS: dict[str, dict[str, Any]] = {
    "wall": {"length": PI, "brick": BRICK, "courses": 7, "openings": [DOOR]},
    "arch": {"mean_radius": PI / 3, "thickness": 0.2, "width": ROOT2, "voussoirs": 7, "half_angle": 1.3},
    "prototype": {"brick": BRICK, "main_wall_bricks": 5, "partitions_x": [0, 1.0], "partition_length": PI / 2, "courses": 7},
    "box": {"length": PI, "width": ROOT3, "courses": 5, "brick": BRICK},
    "arch_piers": BOND | WALLS | {"span": ROOT3, "springing": 1.5, "pier_width": 1.0, "voussoirs": 9, "depth": 0.3},
    "house": BOND | WALLS | {"walls": [LINE, LINE | {"name": "b", "end": (0, PI)}], "openings": [DOORWAY]},
    "tower": BOND | WALLS | {"width": PI, "depth": PI, "openings": [WINDOW]},
    "apse": BOND | APSE | {"wall_length": 5.0, "wall_thickness": ROOT2, "wall_height": 4.0},
    "chapel": BOND | WALLS | {"width": PI + ROOT2, "length": 6.0, "apse": APSE},
    "church": BOND | {"nave": NAVE, "triumphal_arch": END, "transept": ARMS, "east": END, "tower": {"height": 5.0}},
    "vault": {"span": PI, "thickness": ROOT3 / 6, "courses": 9, "stone_length": ROOT2 / 3, "kind": "groin"},
    "dome": {"span": PI, "thickness": ROOT3 / 6, "rings": 5, "sides": 16},
}


@pytest.mark.parametrize("name", sorted(GENERATORS))
def test_building_round_trip_is_exact(name: str, tmp_path: Path) -> None:
    elastic = Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3)
    building = GENERATORS[name].build(**PARAMETERS[name], materials=(Material("tuff", 1e4 * PI, ROOT2, 1e3, elastic),))
    write_building(tmp_path / "building.json", building)
    assert_equal(read_building(tmp_path / "building.json"), building)


def test_other_json_is_no_building(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"schema": "churchpipe building 0"}')
    with pytest.raises(InputError, match="another schema; found churchpipe building 0"):
        read_building(tmp_path / "a.json")


def test_vtu_has_the_stones_and_their_motion(tmp_path: Path) -> None:
    stones = irrational()
    velocities = np.random.default_rng(3).normal(size=(stones.count, 6))
    write_vtu(tmp_path / "stones.vtu", stones, velocities)
    mesh: Any = pyvista.read(tmp_path / "stones.vtu")
    np.testing.assert_allclose(mesh.points, stones.points, rtol=1e-15)
    order = mesh["stone"]
    assert sorted(order.tolist()) == list(range(stones.count))
    for row, stone in enumerate(order):
        cell = mesh.get_cell(row)
        np.testing.assert_array_equal(np.sort(cell.point_ids), np.arange(*stones.block_point_ptr[stone : stone + 2]))
        assert cell.n_faces == np.diff(stones.block_face_ptr)[stone]
    assert mesh["name"].tolist() == stones.block_id[order].tolist()
    assert mesh["panel_name"].tolist() == stones.panel[order].tolist()
    assert mesh["material_name"].tolist() == stones.material[order].tolist()
    # A rigid motion is v + w x r: checked at one corner of one stone by hand.
    stone, corner = 2, stones.block_point_ptr[2]
    v, w = velocities[stone, :3], velocities[stone, 3:]
    r = stones.points[corner] - stones.centroid[stone]
    by_hand = v + np.array([w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]])
    np.testing.assert_allclose(mesh.point_data["velocity"][corner], by_hand, rtol=1e-12)


def test_paraview_sees_the_volumes(tmp_path: Path) -> None:
    stones = irrational()
    write_vtu(tmp_path / "stones.vtu", stones)
    grid: Any = pyvista.read(tmp_path / "stones.vtu").compute_cell_sizes()
    np.testing.assert_allclose(grid["Volume"], stones.volume[grid["stone"]], rtol=1e-6)


def test_a_writer_that_fails_leaves_the_old_file_and_no_other(tmp_path: Path) -> None:
    target = tmp_path / "a.txt"
    target.write_text("old")

    def write_half() -> None:
        with replacing(target) as part:
            part.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        write_half()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_what_a_file_system_refuses_is_told_with_the_name_of_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # One that is read-only refuses to delete what is not there, too.
    def refused(path: Path, *_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system", str(path))

    monkeypatch.setattr(Path, "write_text", refused)
    monkeypatch.setattr(Path, "unlink", refused)
    with pytest.raises(OSError, match="Read-only file system") as found:
        write_if_changed(tmp_path / "a.txt", "new")
    assert found.value.filename == str(tmp_path / "a.txt")


def test_unchanged_settings_keep_their_date(tmp_path: Path) -> None:
    target = tmp_path / "settings.json"
    write_if_changed(target, canonical_json({"b": 1, "a": [0.1, float("nan")]}))
    before = target.stat().st_mtime_ns
    write_if_changed(target, canonical_json({"a": [0.1, None], "b": 1}))
    assert target.stat().st_mtime_ns == before
    write_if_changed(target, canonical_json({"a": [0.1], "b": 1}))
    assert json.loads(target.read_text()) == {"a": [0.1], "b": 1}


def test_results_of_the_shell_come_back(tmp_path: Path) -> None:
    random = np.random.default_rng(7)
    limit = ShellLimitState(
        load_factor=ROOT2,
        status="optimal",
        lower_bound=np.nan,
        upper_bound=np.inf,
        stress=random.normal(size=(6, 6)),
        velocities=random.normal(size=(4, 3)),
        edge_rotation=random.normal(size=5),
        plastic=random.normal(size=(2, 6)),
        message="gelöst",
    )
    curve = CapacityCurve(
        load_factor=np.array([0.0, 1 / PI]),
        control=np.array([0.0, ROOT3]),
        control_point=np.int64(3),
        displacement=random.normal(size=(4, 3)),
        edge_rotation=random.normal(size=5),
        plastic=random.normal(size=(2, 6)),
        multipliers=random.normal(size=(2, 8)),
        steps=(CapacityStep(0.0, 0.0, 1e-9, 0.0, np.nan, 12, 0.5), CapacityStep(ROOT3, 1 / PI, 1e-9, 0.0, 1e-8, 9, 0.25)),
        status="converged",
    )
    for value in (limit, curve):
        write_npz(tmp_path / "value.npz", value)
        back = read_npz(tmp_path / "value.npz", type(value))
        for field in dataclasses.fields(value):
            found, wanted = getattr(back, field.name), getattr(value, field.name)
            if field.name == "steps":
                found, wanted = ([dataclasses.astuple(step) for step in steps] for steps in (found, wanted))
            np.testing.assert_equal(found, wanted, err_msg=field.name)


def test_an_artifact_that_could_not_be_made_says_why(tmp_path: Path) -> None:
    write_npz(tmp_path / "shell.npz", Absent("no wall fits"))
    assert read_if_made(tmp_path / "shell.npz", ShellModel) == Absent("no wall fits")
    with pytest.raises(InputError, match="could not be made; found no wall fits"):
        read_npz(tmp_path / "shell.npz", ShellModel)


def test_table_has_what_was_swept_first(tmp_path: Path) -> None:
    rows = [analysis(flow="associative", load_factor=0.25, swept={"source.courses": n}) for n in (3, 4)]
    write_table(tmp_path / "table.csv", rows)
    with (tmp_path / "table.csv").open() as file:
        read = list(csv.DictReader(file))
    assert [row["source.courses"] for row in read] == ["3", "4"]
    assert read[0]["load_factor"] == "0.25"
    assert read[0]["lower_bound"] == ""


def test_a_spreadsheet_computes_nothing_of_a_table(tmp_path: Path) -> None:
    names = ["=cmd|calc!A1", "+1+2", "-2*3", "@SUM(A1)", "\t=1", "\r=1", "+x", "-y", "-yes", "east"]
    write_table(tmp_path / "table.csv", [analysis(load=name, load_factor=-0.5) for name in names])
    with (tmp_path / "table.csv").open(newline="") as file:
        read = list(csv.DictReader(file))
    assert [row["load"] for row in read] == [*(f"'{name}" for name in names[:6]), "+x", "-y", "'-yes", "east"]
    assert read[0]["load_factor"] == "-0.5"


def test_what_is_no_json_is_named(tmp_path: Path) -> None:
    (tmp_path / "bad.json").write_text("{")
    with pytest.raises(InputError, match="not JSON"):
        read_json(tmp_path / "bad.json")


def test_the_weaker_material_rules_the_joint() -> None:
    boxes = [box((0, 1), (0, 1), (0, 1)), box((0, 1), (0, 1), (1, 2)), box((0, 1), (0, 1), (2, 3))]
    plate = box((-5, 5), (-5, 5), (-1, 0))
    stones = Assemblage.from_polyhedra([plate, *boxes], 2e4, fixed=[0], material=["rock", "brick", "tuff", "tuff"])
    contacts = find_contacts(stones)
    friction, cohesion = joint_strength(stones, contacts, [Material("brick", 1.0, 0.5, 7e3), Material("tuff", 1.0, 0.7, 2e3)])
    found = {
        tuple(pair): values for pair, values in zip(contacts.blocks.tolist(), zip(friction, cohesion, strict=True), strict=True)
    }
    assert found == {(0, 1): (0.5, 7e3), (1, 2): (0.5, 2e3), (2, 3): (0.7, 2e3)}
    with pytest.raises(InputError, match=r"unknown material; found tuff; expected brick.*\[material\.tuff\]"):
        joint_strength(stones, contacts, [Material("brick", 1.0, 0.5)])
