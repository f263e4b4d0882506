"""What files of real models had: each fault in a small file, and exactly the findings it deserves."""

import os
import zipfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.findings import Findings, FindingsError
from churchpipe.geometry.degenerate import degenerate
from churchpipe.meshes.reader import digest_of
from churchpipe.model.arrays import FloatArray
from churchpipe.model.surfaces import edges
from mesh_files import fortran, triangles, write_compas
from solids import BOX_FACES, box

Faces = list[list[int]]
Solid = tuple[str, FloatArray, Faces]
LOW = box((0, 1), (0, 1), (0, 0.5))[0]
HIGH = box((0, 1), (0, 1), (0.5, 1))[0]
GROUND: Solid = ("ground", box((-1, 2), (-1, 2), (-0.5, 0))[0], BOX_FACES)
TOWER: list[Solid] = [("low", LOW, BOX_FACES), ("high", HIGH, BOX_FACES)]
# Of every OBJ that is read: no unit weight, ground by its name, no unit.
ALWAYS = {"W19", "W43", "W45"}


def obj(path: Path, *bodies: Solid, digits: str = ".17g") -> Path:
    lines, offset = [], 1
    for name, points, faces in bodies:
        lines += [f"o {name}", *("v " + " ".join(f"{value:{digits}}" for value in point) for point in points.tolist())]
        lines += ["f " + " ".join(str(node + offset) for node in face) for face in faces]
        offset += len(points)
    path.write_text("\n".join(lines) + "\n")
    return path


def tower(path: Path, points: FloatArray, faces: Faces) -> Path:
    """A sound stone on the ground, and the one in question on it."""
    return obj(path, GROUND, ("low", LOW, BOX_FACES), ("high", points, faces))


def codes(findings: Findings) -> set[str]:
    return set(findings.codes) - ALWAYS


def soup(points: FloatArray, faces: Faces) -> tuple[FloatArray, Faces]:
    """Each face with vertices of its own."""
    ends = np.cumsum([0, *(len(face) for face in faces)])
    return np.concatenate([points[face] for face in faces]), [list(range(a, b)) for a, b in pairwise(ends)]


def warped() -> tuple[FloatArray, Faces]:
    points = HIGH.copy()
    points[7] += [0, 0, 0.02]
    return points, BOX_FACES


def noisy_soup() -> tuple[FloatArray, Faces]:
    points, faces = soup(HIGH, BOX_FACES)
    return points + 1e-6 * np.random.default_rng(0).uniform(-1, 1, points.shape), faces


def edge_corner() -> tuple[FloatArray, Faces]:
    return np.vstack([HIGH, [0.5, 0, 0.5]]), [*BOX_FACES[:2], [0, 8, 4, 5, 1], *BOX_FACES[3:]]


HARMLESS: dict[str, tuple[FloatArray, Faces, set[str], str]] = {
    "triangles": (HIGH, triangles(HIGH, BOX_FACES), set(), ""),
    "inside out": (HIGH, [face[::-1] for face in BOX_FACES], {"W40"}, "the body was inside out and was turned"),
    "mixed windings": (
        HIGH,
        [face[:: -1 if k in (0, 3) else 1] for k, face in enumerate(BOX_FACES)],
        {"W40"},
        "turned to run like",
    ),
    "closed by welding": (*soup(HIGH, BOX_FACES), {"W40"}, "vertices at one place were welded (16)"),
    "warped": (*warped(), {"W10"}, "1 face is warped, by"),
}
# From the edge of the bottom at the origin through the stone, and three points of a fin that ends within it.
DIAGONAL = [k for at in ((0, 0, 0.5), (0, 0, 1), (1, 1, 1), (1, 1, 0.5)) for k in range(8) if (HIGH[k] == at).all()]
HANGING = np.vstack([HIGH, [0.5, 0.5, 0.9], [0.5, 0.5, 0.7], [0.4, 0.3, 0.7]])
MENDED: dict[str, tuple[FloatArray, Faces, str]] = {
    "every face twice": (HIGH, BOX_FACES * 2, "faces given more than once were dropped (6); volume 1 m3 before, 0.5 m3 after"),
    "both sides": (HIGH, [*BOX_FACES, *(face[::-1] for face in BOX_FACES)], "faces given more than once were dropped (6)"),
    "nearly meeting": (*noisy_soup(), "vertices that nearly met were joined (16)"),
    "corner on an edge": (*edge_corner(), "corners on an edge of a neighbour were put into it (1)"),
    "hole of one face": (HIGH, BOX_FACES[:-1], "holes of one face were closed (1)"),
    "a fin across it": (HIGH, [*BOX_FACES, DIAGONAL], "faces that bound nothing were dropped (1)"),
    "a fin across it that comes first": (HIGH, [DIAGONAL, *BOX_FACES], "faces that bound nothing were dropped (1)"),
    "a fin of two triangles": (
        HIGH,
        [DIAGONAL[:3], *BOX_FACES, [DIAGONAL[k] for k in (0, 2, 3)]],
        "that bound nothing were dropped (2)",
    ),
    "a fin that hangs from an edge": (
        HANGING[:10],
        [*BOX_FACES, [*DIAGONAL[:2], 8, 9]],
        "faces that bound nothing were dropped (1)",
    ),
    "a loose face within": (HANGING, [*BOX_FACES, [8, 9, 10]], "faces that bound nothing were dropped (1)"),
    "a face of its surface twice": (HIGH, [*BOX_FACES, BOX_FACES[1]], "dropped (1)"),
}


@pytest.mark.parametrize("name", HARMLESS)
def test_what_changes_no_shape_is_mended_and_told(name: str, tmp_path: Path) -> None:
    points, faces, expected, text = HARMLESS[name]
    stones, findings = cp.read_stones(tower(tmp_path / "tower.obj", points, faces))
    assert codes(findings) == expected
    assert text in str(findings)
    assert stones.count == 3
    contacts = cp.find_contacts(stones)
    assert contacts.area.sum() == pytest.approx(2.0)
    if name != "warped":
        assert stones.volume[2] == pytest.approx(0.5)
        assert np.diff(stones.block_face_ptr).tolist() == [6, 6, 6]


@pytest.mark.parametrize("name", MENDED)
def test_what_may_change_a_shape_is_an_error_with_its_remedy_and_mended_on_request(name: str, tmp_path: Path) -> None:
    points, faces, text = MENDED[name]
    path = tower(tmp_path / "tower.obj", points, faces)
    with pytest.raises(FindingsError) as raised:
        cp.read_stones(path)
    assert codes(raised.value.findings) - {"W40"} == {"E10"}
    assert "Pass --repair to mend it." in str(raised.value)
    stones, findings = cp.read_stones(path, repair=True)
    assert codes(findings) - {"W10"} == {"W41"}
    assert text in str(findings)
    assert stones.volume[2] == pytest.approx(0.5, rel=1e-5)


def test_a_stone_that_stays_open_is_named_with_its_place(tmp_path: Path) -> None:
    path = tower(tmp_path / "tower.obj", HIGH, [BOX_FACES[0], BOX_FACES[2], BOX_FACES[4]])
    for repair in (False, True):
        with pytest.raises(FindingsError) as raised:
            cp.read_stones(path, repair=repair)
        text = str(raised.value)
        assert 'obj/E10 tower.obj: object "high" at' in text
        assert "its faces do not close a solid, an open edge: expected every edge shared by two faces." in text
        assert "Close it in the program that made it." in text


@pytest.mark.parametrize("repair", [False, True])
def test_what_cannot_be_mended_is_told_of_the_body_as_it_is_in_the_file(repair: bool, tmp_path: Path) -> None:
    # A fin of two planes; closed by a repair its faces would lie on each other.
    bent = [*BOX_FACES, [*DIAGONAL[:2], 8, 9], [8, 9, 10]]
    with pytest.raises(FindingsError) as raised:
        cp.read_stones(tower(tmp_path / "tower.obj", HANGING, bent), repair=repair)
    (error,) = raised.value.findings.errors
    assert "has the corners of" not in error.found
    assert "an open edge" in error.found


def test_two_faces_with_the_same_corners_are_named_by_their_place(tmp_path: Path) -> None:
    path = tower(tmp_path / "tower.obj", HIGH, BOX_FACES * 2)
    with pytest.raises(FindingsError, match="a face lies on another, two faces have the same corners"):
        cp.read_stones(path)


def test_joints_and_ground_of_one_face_are_left_out_or_thickened(tmp_path: Path) -> None:
    flat = np.array([[-1.0, -1, 0], [2, -1, 0], [2, 2, 0], [-1, 2, 0]])
    joint = np.array([[0.0, 0, 0.5], [1, 0, 0.5], [1, 1, 0.5], [0, 1, 0.5]])
    bodies = [
        ("ground", flat, [[0, 1, 2, 3]]),
        ("low", LOW, BOX_FACES),
        ("high", HIGH, BOX_FACES),
        ("joint", joint, [[0, 1, 2, 3]]),
    ]
    stones, findings = cp.read_stones(obj(tmp_path / "tower.obj", *bodies))
    assert codes(findings) == {"W18"}
    assert "left out: 1 flat faces that enclose nothing" in str(findings)
    assert stones.fixed.tolist() == [True, False, False]
    assert cp.find_contacts(stones).area.tolist() == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize("place", [0.0, 0.3, 5e5])
@pytest.mark.parametrize("lean", [0.0, 0.7])
def test_a_sheet_with_two_sides_is_left_out(place: float, lean: float, tmp_path: Path) -> None:
    # Its sides are cut into other triangles, so that no face lies on another. Turned, it has a volume by rounding alone.
    outline = np.array([[1.6, 0, 0.1], [1.9, 0, 0], [2, 0, 0.6], [1.3, 0, 1.2], [1, 0, 0.7]])
    turn = np.array([[np.cos(lean), -np.sin(lean), 0], [np.sin(lean), np.cos(lean), 0], [0, 0, 1]])
    sides = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [4, 3, 2], [4, 2, 1], [4, 1, 0]]
    bodies: list[Solid] = [GROUND, *TOWER, ("sheet", outline @ turn, sides)]
    moved = [(name, points + place, faces) for name, points, faces in bodies]
    stones, findings = cp.read_stones(obj(tmp_path / "tower.obj", *moved))
    assert codes(findings) == {"W18"}
    assert "left out: 1 flat faces that enclose nothing" in str(findings)
    assert stones.count == 3


def test_stones_drawn_twice_are_an_error_and_dropped_on_request(tmp_path: Path) -> None:
    path = obj(tmp_path / "tower.obj", GROUND, ("low", LOW, BOX_FACES), ("again", LOW, BOX_FACES))
    with pytest.raises(FindingsError, match=r"obj/E11"):
        cp.read_stones(path)
    stones, findings = cp.read_stones(path, repair=True)
    assert codes(findings) == {"W11"}
    assert stones.count == 2


def test_several_solids_under_one_name_are_stones_of_their_own(tmp_path: Path) -> None:
    both = np.concatenate([LOW, HIGH]), [*BOX_FACES, *([node + 8 for node in face] for face in BOX_FACES)]
    stones, findings = cp.read_stones(obj(tmp_path / "pier.obj", GROUND, ("pier", *both)))
    assert codes(findings) == {"W42"}
    assert stones.block_id.tolist() == ["ground", "pier.1", "pier.2"]


def test_no_ground_is_an_error_that_names_the_way_out(tmp_path: Path) -> None:
    path = obj(tmp_path / "tower.obj", ("low", LOW, BOX_FACES), ("high", HIGH, BOX_FACES))
    with pytest.raises(FindingsError, match=r"obj/E12 .*such as ground.stl, and read the folder .* or pass --support base"):
        cp.read_stones(path)
    stones, findings = cp.read_stones(path, support="base")
    assert codes(findings) == {"W12"}
    assert stones.fixed.tolist() == [False, False, True]


def lmgc90(tmp_path: Path, *bodies: str) -> Path:
    path = tmp_path / "BODIES.DAT"
    path.write_text("! File BODIES\n" + "".join(bodies))
    return path


def polyr(points: FloatArray, faces: Faces) -> str:
    lines = [f" POLYR      1  color  BLEUx  nb_vertex={len(points):5d}      nb_face={len(faces):5d}"]
    lines += [" " * 29 + "  ".join(f"coo{k + 1}={fortran(v)}" for k, v in enumerate(row)) for row in points.tolist()]
    lines += [" " * 29 + "  ".join(f"ver{k + 1}= {node + 1:<14d}" for k, node in enumerate(face)) for face in faces]
    return "\n".join(lines) + "\n"


def record(number: int, *contactors: str, kind: str = "RBDY3", node: str = "NO6xx") -> str:
    places = "coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00"
    head = f"$bdyty\n {kind}  {number:5d}\n$blmty\n PLAIN      1  behav  PLEXx  avrd= 0.0D+00  gyrd= 0.0D+00\n"
    return f"{head}$nodty\n {node}      1                {places}\n$tacty\n{''.join(contactors)}$$$$$$\n"


def test_a_stone_of_several_hulls_is_united(tmp_path: Path) -> None:
    # An L of two hulls that share a face, on a plate.
    hulls = [box((0, 2), (0, 1), (0, 1))[0], box((0, 1), (0, 1), (1, 2))[0]]
    plate = " PLANx      1  color  BLEUx  axe1= 0.5000000D+01  axe2= 0.5000000D+01  axe3= 0.1000000D+00\n"
    ground = record(2, plate).replace("coo3= 0.0000000D+00", "coo3=-0.1000000D+00")
    path = lmgc90(tmp_path, record(1, *(polyr(p, triangles(p, BOX_FACES)) for p in hulls)), ground)
    stones, findings = cp.read_stones(path)
    assert set(findings.codes) == {"W19", "W44", "W45"}
    assert "2 hulls were united to one stone; volume 3 m3 together, 3 m3 united" in str(findings)
    assert stones.fixed.tolist() == [False, True]
    assert stones.volume[0] == pytest.approx(3.0)
    assert np.diff(stones.block_face_ptr)[0] == 8
    assert cp.find_contacts(stones).area.sum() == pytest.approx(2.0)


def test_a_model_of_the_plane_asks_for_its_thickness(tmp_path: Path) -> None:
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5)]
    rows = "".join(" " * 29 + f"coo1={fortran(x)}  coo2={fortran(y)}\n" for x, y in corners)
    stone = f" POLYG      1  color  BLEUx  nb_vertex=    4      byrd= 0.0000000D+00\n{rows}"
    plate = " JONCx      1  color  BLEUx  ax1 = 0.5000000D+01  ax2 = 0.1000000D+00\n"
    ground = record(2, plate, kind="RBDY2", node="NO3xx").replace("coo2= 0.0000000D+00", "coo2=-0.1000000D+00")
    path = lmgc90(tmp_path, record(1, stone, kind="RBDY2", node="NO3xx"), ground)
    with pytest.raises(FindingsError, match=r"lmgc90/E\d\d BODIES.DAT: .*--thickness"):
        cp.read_stones(path)
    stones, _ = cp.read_stones(path, thickness=0.3)
    assert stones.volume[0] == pytest.approx(0.15)
    assert cp.find_contacts(stones).area.tolist() == pytest.approx([0.3])


@pytest.mark.parametrize(
    ("line", "code"),
    [
        (" RBDY3      x\n", "E03"),
        (" POLYR      1  color  BLEUx  nb_vertex=    9      nb_face=   12\n", "E03"),
        (" POLYR      1  color  BLEUx  nb_vertex=    8      nb_face=   1x\n", "E03"),
    ],
)
def test_damaged_records_are_named_by_their_line(line: str, code: str, tmp_path: Path) -> None:
    text = record(1, polyr(LOW, triangles(LOW, BOX_FACES)))
    key = line.split()[0]
    damaged = "".join(line if row.split()[:1] == [key] else row for row in text.splitlines(keepends=True))
    with pytest.raises(FindingsError, match=rf"lmgc90/{code} BODIES.DAT: .*line \d+"):
        cp.read_stones(lmgc90(tmp_path, damaged), support="base")


def _cut(text: str) -> str:
    return text[: len(text) // 2]


@pytest.mark.parametrize("change", [_cut, str.upper, lambda text: text.replace("1", "one"), lambda text: text.replace("v", "w")])
def test_a_damaged_obj_is_named(change: Callable[[str], str], tmp_path: Path) -> None:
    path = tower(tmp_path / "tower.obj", HIGH, BOX_FACES)
    path.write_text(change(path.read_text()))
    with pytest.raises(FindingsError):
        cp.read_stones(path)


def test_a_model_cut_after_the_name_of_a_body_is_truncated(tmp_path: Path) -> None:
    stone = record(1, polyr(LOW, triangles(LOW, BOX_FACES)))
    with pytest.raises(FindingsError, match="2 bodies begin and 1 end"):
        cp.read_stones(lmgc90(tmp_path, stone, "$bdyty\n RBDY3"), support="base")


def test_a_number_beyond_all_numbers_is_named_by_its_line(tmp_path: Path) -> None:
    stone = record(1, polyr(LOW, triangles(LOW, BOX_FACES))).replace("D+00", "D99999999", 20)
    with pytest.raises(FindingsError, match=r"lmgc90/E03 BODIES.DAT: .*a number behind each ="):
        cp.read_stones(lmgc90(tmp_path, stone), support="base")


@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize("key", ["vertex", "face"])
def test_a_block_of_json_that_lost_its_vertices_or_faces_is_missed(key: str, old: bool, tmp_path: Path) -> None:
    stones = cp.Assemblage.from_polyhedra([(body[1], body[2]) for body in (GROUND, *TOWER)], unit_weight=2e4, fixed=[0])
    path = write_compas(stones, tmp_path / "wall.json", old=old)
    assert cp.read_stones(path, units="m", unit_weight=2e4)[0].count == 3
    blocks = path.read_text().split('{"attributes": {"name": "Block"}')
    assert len(blocks) == 4
    blocks[2] = blocks[2].replace(f'"{key}":', '"lost":')
    path.write_text('{"attributes": {"name": "Block"}'.join(blocks))
    with pytest.raises(FindingsError, match=r"compas/E03 .*1 meshes whose faces or vertices cannot be understood"):
        cp.read_stones(path, units="m", unit_weight=2e4)


def test_a_name_in_json_with_half_of_a_character_is_refused(tmp_path: Path) -> None:
    stones = cp.Assemblage.from_polyhedra([(body[1], body[2]) for body in (GROUND, *TOWER)], unit_weight=2e4, fixed=[0])
    path = write_compas(stones, tmp_path / "wall.json")
    path.write_text(path.read_text().replace('"name": "Block"', '"name": "a\\ud800b"'))
    with pytest.raises(FindingsError, match=r"compas/E03 wall.json: the name 'a\\ud800b' has half of a character") as raised:
        cp.read_stones(path, unit_weight=2e4)
    assert str(raised.value).encode()


def test_a_key_given_twice_in_json_is_named(tmp_path: Path) -> None:
    path = tmp_path / "wall.json"
    path.write_text('{"vertex": {}, "face": {}, "vertex": {}}')
    with pytest.raises(FindingsError, match='the key "vertex" is given twice'):
        cp.read_stones(path)


def test_a_file_in_another_format_is_not_listed_word_by_word(tmp_path: Path) -> None:
    path = tower(tmp_path / "tower.obj", HIGH, BOX_FACES)
    path.write_text(path.read_text() + "".join(f"word{k}\n" * (2 if k == 40 else 1) for k in range(50)) + "f 1 2 4 3\n")
    with pytest.raises(FindingsError) as raised:
        cp.read_stones(path)
    said = next(finding.found for finding in raised.value.findings if finding.code == "W18")
    assert said.startswith('left out: 2 lines that begin with "word40", ')
    assert said.endswith("and 38 of 38 more kinds")


def test_files_of_a_folder_that_are_left_out_are_named(tmp_path: Path) -> None:
    tower(tmp_path / "tower.obj", HIGH, BOX_FACES)
    for name in ("wall.dxf", "notes.txt", ".hidden"):
        (tmp_path / name).write_text("")
    findings = cp.read_stones(tmp_path)[1]
    assert "left out: 2 files in other formats, notes.txt, wall.dxf. Look whether" in str(findings)


def test_names_of_files_that_are_no_utf_8_can_be_written(tmp_path: Path) -> None:
    """As of a disk of old, in Latin-1: names of stones, of files that are left out, and what tells a changed file."""
    folder = tmp_path / "stones"
    folder.mkdir()
    tower(folder / os.fsdecode(b"m\xfchle.obj"), HIGH, BOX_FACES)
    (folder / os.fsdecode(b"Sto\xdf.txt")).write_text("")
    stones, findings = cp.read_stones(folder)
    assert "m\ufffdhle/high" in stones.block_id.tolist()
    assert "1 file in other formats, Sto\ufffd.txt" in str(findings)
    cp.write_obj(stones, tmp_path / "again.obj")
    assert "o m\ufffdhle/high" in (tmp_path / "again.obj").read_text(encoding="utf-8")
    assert len(digest_of(folder)) == 64


def test_a_3mf_without_a_model_is_told_once(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
        archive.writestr("notes.txt", "")
    with pytest.raises(FindingsError) as raised:
        cp.read_stones(tmp_path / "a.3mf")
    assert str(raised.value).endswith("\n3mf/E03 a.3mf: the file is damaged: there is no model in it. Export it again.")


@pytest.mark.parametrize("loose", [True, False])
def test_triangles_that_are_lines_are_left_out_and_those_that_close_a_gap_stay(tmp_path: Path, loose: bool) -> None:
    """Left in an STL, they were taken for bodies of their own, and hid where one stone ends and the next begins."""
    bodies = [(points, triangles(points, BOX_FACES)) for points in (GROUND[1], LOW, HIGH)]
    made: list[Solid] = []
    for name, (points, faces) in zip(("ground", "low", "high"), bodies, strict=True):
        # A corner once more, and the middle of an edge.
        points = np.concatenate([points, points[:1], points[:2].mean(axis=0)[None]])
        faces = [*faces, [0, 8, 1], [0, 0, 1], [0, 9, 1]]
        made.append((name, *(soup(points, faces) if loose else (points, faces))))
    stones, findings = cp.read_stones(obj(tmp_path / "lines.obj", *made))
    assert codes(findings) == ({"W18", "W40"} if loose else {"W18"})
    assert "left out: 9 faces without an area" in str(findings)
    assert stones.volume.tolist() == pytest.approx([4.5, 0.5, 0.5])
    # The long edge of one face, the two halves of it of its neighbour, and the line between them.
    points, faces = HIGH, triangles(HIGH, BOX_FACES)
    number = next(k for k, face in enumerate(faces) if {0, 1} <= {*face})
    far = next(node for node in faces[number] if node > 1)
    split = [[0, 8, far], [8, 1, far]] if (0, 1) in edges(tuple(faces[number])) else [[1, 8, far], [8, 0, far]]
    line = [0, 1, 8] if (0, 1) in edges(tuple(faces[number])) else [1, 0, 8]
    points = np.concatenate([points, points[:2].mean(axis=0)[None]])
    closed = [*(face for k, face in enumerate(faces) if k != number), *split, line]
    assert degenerate(points, [tuple(face) for face in closed]) == []
    assert degenerate(points, [*map(tuple, closed), (0, 0, 1)]) == [len(closed)]


def test_a_hollow_stone_weighs_what_it_has(tmp_path: Path) -> None:
    """The body that bounds the void was turned to look outwards, so that it was a stone within a stone."""
    inner = box((0.25, 0.75), (0.25, 0.75), (0.125, 0.375))[0]
    points = np.concatenate([LOW, inner])
    faces = [*BOX_FACES, *([8 + node for node in face[::-1]] for face in BOX_FACES)]
    stones, findings = cp.read_stones(obj(tmp_path / "a.obj", GROUND, ("low", points, faces), TOWER[1]))
    assert set(findings.codes) == ALWAYS | {"W29"}
    assert stones.block_id.tolist() == ["ground", "low", "high"]
    np.testing.assert_allclose(stones.volume[1:], [0.5 - 0.0625, 0.5])
    cp.check_soundness(stones, cp.find_contacts(stones))


def test_a_text_stl_in_capitals_is_read(tmp_path: Path) -> None:
    lines: list[str] = []
    for name, points, faces in (GROUND, *TOWER):
        lines.append(f"SOLID {name}")
        for face in triangles(points, faces):
            corners = ["VERTEX {:.6E} {:.6E} {:.6E}".format(*points[node]) for node in face]
            lines += ["FACET NORMAL 0 0 0", "OUTER LOOP", *corners, "ENDLOOP", "ENDFACET"]
        lines.append("ENDSOLID")
    (tmp_path / "a.stl").write_bytes("\r\n".join(lines).encode())
    stones, _ = cp.read_stones(tmp_path / "a.stl", unit_weight=18e3)
    assert stones.block_id.tolist() == ["ground", "low", "high"]
    np.testing.assert_allclose(stones.volume[1:], 0.5)


def test_the_only_component_of_a_3mf_object_has_its_name(tmp_path: Path) -> None:
    """The shape that several stones share was called alike in all of them, and the ground was no ground."""
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    corners = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in box((0, 1), (0, 1), (0, 1))[0].tolist())
    sides = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in triangles(LOW, BOX_FACES))
    shape = f"<mesh><vertices>{corners}</vertices><triangles>{sides}</triangles></mesh>"
    objects = f'<object id="1" name="cube">{shape}</object>'
    places = {"ground": "3 0 0 0 3 0 0 0 .5 -1 -1 -.5", "low": "1 0 0 0 1 0 0 0 .5 0 0 0", "high": "-1 0 0 0 1 0 0 0 .5 1 0 .5"}
    for number, (name, place) in enumerate(places.items(), 2):
        component = f'<component objectid="1" transform="{place}"/>'
        objects += f'<object id="{number}" name="{name}"><components>{component}</components></object>'
    items = "".join(f'<item objectid="{number}"/>' for number in (2, 3, 4))
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
        model = f'<model unit="meter" xmlns="{core}"><resources>{objects}</resources><build>{items}</build></model>'
        archive.writestr("3D/3dmodel.model", model)
    stones, _ = cp.read_stones(tmp_path / "a.3mf", unit_weight=18e3)
    assert stones.block_id.tolist() == ["ground", "low", "high"]
    assert stones.fixed.tolist() == [True, False, False]
    assert len(cp.find_contacts(stones).area) == 2
