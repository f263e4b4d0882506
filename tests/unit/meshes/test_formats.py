"""Every format: the stones that were written come back, and their load factor."""

import json
import re
import zipfile
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.findings import FindingsError
from churchpipe.model.assemblage import Assemblage
from mesh_files import METRES, WRITERS, solids, write_3dec, write_3dm, write_3mf, write_glb, write_obj, write_ply, write_stl
from solids import box, on_ground, prism

GROUND = box((-1, 2), (-1, 1), (-0.5, 0))
# Sizes that have an exact binary form, for formats that hold 32 bits.
BRICKS = [
    box((x + 0.125 * (z % 2), x + 0.25 + 0.125 * (z % 2)), (0, 0.125), (0.125 * z, 0.125 * z + 0.125))
    for z in range(4)
    for x in (0, 0.25, 0.5)
]
# Formats that hold no names have no ground.
NAMELESS = ("ply", "ply-binary", "stl-binary")


def wall(*, ground: bool = True) -> Assemblage:
    solids = [GROUND, *BRICKS] if ground else BRICKS
    return Assemblage.from_polyhedra(solids, 18e3, fixed=[0] if ground else [])


def arch() -> Assemblage:
    """Seven voussoirs over a half circle on two fixed blocks, no coordinate of them a round number."""
    angle = np.linspace(0.1, np.pi - 0.1, 8)
    outlines = [[(r * np.cos(a), r * np.sin(a)) for r, a in ((1.0, s), (1.3, s), (1.3, t), (1.0, t))] for s, t in pairwise(angle)]
    feet = []
    for a in (angle[0], angle[-1]):
        inner, outer = (np.cos(a), np.sin(a)), (1.3 * np.cos(a), 1.3 * np.sin(a))
        feet.append([inner, outer, (outer[0], -0.2), (inner[0], -0.2)])
    return Assemblage.from_polyhedra([prism(o, 0.3) for o in [*outlines, *feet]], 18e3, fixed=[7, 8])


def load_factor(stones: Assemblage) -> float:
    contacts = cp.find_contacts(stones)
    cp.check_soundness(stones, contacts)
    state = cp.limit_analysis(stones, contacts, cp.LoadCase(direction=(1, 0, 0)), friction=0.6)
    assert state.status == "optimal"
    return state.load_factor


@pytest.mark.parametrize("name", WRITERS)
def test_what_was_written_comes_back(name: str, tmp_path: Path) -> None:
    stones = wall(ground=name not in NAMELESS)
    path = WRITERS[name](stones, tmp_path)
    read, findings = cp.read_stones(path, unit_weight=18e3, support="base" if name in NAMELESS else "drawn")
    assert {code[0] for code in findings.codes} <= {"W"}
    assert set(findings.codes) <= {"W12", "W43", "W45"}
    free = ~read.fixed
    assert free.sum() == 12
    # Triangles are faces again.
    assert np.diff(read.block_face_ptr).tolist() == [6] * read.count
    order = np.lexsort(read.centroid[free].round(6).T)
    written = stones.centroid[~stones.fixed]
    np.testing.assert_allclose(read.centroid[free][order], written[np.lexsort(written.round(6).T)], atol=1e-12)
    np.testing.assert_allclose(read.volume[free], 0.25 * 0.125**2, rtol=1e-12)
    assert load_factor(read) == pytest.approx(load_factor(wall()), rel=1e-6)


@pytest.mark.parametrize("name", [name for name in WRITERS if name not in NAMELESS])
def test_an_arch_has_the_load_factor_of_the_one_that_was_written(name: str, tmp_path: Path) -> None:
    stones = arch()
    read, _ = cp.read_stones(WRITERS[name](stones, tmp_path), unit_weight=18e3)
    assert read.count == 9
    if name == "glb":
        # The format holds 32 bits: the coordinates are off by 1e-8 m.
        np.testing.assert_allclose(np.sort(read.volume), np.sort(stones.volume), rtol=1e-6)
    else:
        np.testing.assert_allclose(np.sort(read.volume), np.sort(stones.volume), rtol=1e-12)
    assert load_factor(read) == pytest.approx(load_factor(stones), rel=1e-6)


def test_names_materials_and_ground_are_kept(tmp_path: Path) -> None:
    read, findings = cp.read_stones(write_obj(wall(), tmp_path / "wall.obj"), unit_weight=18e3)
    assert read.block_id.tolist()[:3] == ["ground-0", "B1", "B2"]
    assert set(read.material) == {"stone"}
    assert read.fixed.tolist() == [True] + [False] * 12
    assert "obj/W43 wall.obj: 1 body is ground by its name: ground-0." in str(findings)


@pytest.mark.parametrize(
    ("name", "fixed"), [("Ground floor wall", False), ("ground_storey 3", False), ("Ground slab", True), ("Grounds", True)]
)
def test_the_ground_floor_is_a_storey(name: str, fixed: bool, tmp_path: Path) -> None:
    stones = replace(wall(), block_id=np.array(["ground", name, *(f"b{number}" for number in range(11))]))
    read, _ = cp.read_stones(write_obj(stones, tmp_path / "wall.obj"), unit_weight=18e3)
    assert read.block_id[1] == name
    assert read.fixed.tolist() == [True, fixed] + [False] * 11


@pytest.mark.parametrize("unit", METRES)
def test_a_3mf_is_read_in_the_unit_that_it_says(unit: str, tmp_path: Path) -> None:
    stones = wall()
    read, _ = cp.read_stones(write_3mf(stones, tmp_path / "wall.3mf", unit=unit), unit_weight=18e3)
    np.testing.assert_allclose(read.volume, stones.volume, rtol=1e-6)


def test_a_3mf_in_a_unit_of_its_own_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FindingsError, match="its unit is 'cubit'"):
        cp.read_stones(write_3mf(wall(), tmp_path / "wall.3mf", unit="cubit"))


def coloured_ply(path: Path, stones: Assemblage, colours: list[tuple[int, int, int]], *, of_faces: bool) -> Path:
    vertices, faces, offset = [], [], 0
    for (_, points, around, _), shade in zip(solids(stones), colours, strict=True):
        words = "" if of_faces else "".join(f" {value}" for value in shade)
        vertices += [" ".join(map(repr, point)) + words for point in points.tolist()]
        words = "".join(f" {value}" for value in shade) if of_faces else ""
        faces += [f"{len(face)} {' '.join(str(node + offset) for node in face)}{words}" for face in around]
        offset += len(points)
    shades = [f"property uchar {name}" for name in ("red", "green", "blue")]
    head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property double {axis}" for axis in "xyz")]
    head += [*([] if of_faces else shades), f"element face {len(faces)}", "property list uchar int vertex_indices"]
    path.write_text("\n".join([*head, *(shades if of_faces else []), "end_header", *vertices, *faces]) + "\n")
    return path


@pytest.mark.parametrize("of_faces", [True, False])
def test_colours_tell_materials_apart_where_they_are_few(of_faces: bool, tmp_path: Path) -> None:
    stones = wall(ground=False)
    few = [(200, 160, 80) if number % 2 else (90, 90, 90) for number in range(stones.count)]
    read, findings = cp.read_stones(coloured_ply(tmp_path / "few.ply", stones, few, of_faces=of_faces), support="base")
    assert read.material[~read.fixed].tolist() == ["colour-c8a050" if shade[0] == 200 else "colour-5a5a5a" for shade in few]
    many = [(20 * number, 0, 0) for number in range(stones.count + 1)]
    one = [(200, 160, 80)] * stones.count
    # Thirteen colours are one a stone, and one colour tells nothing.
    read, findings = cp.read_stones(coloured_ply(tmp_path / "many.ply", wall(), many, of_faces=of_faces), support="base")
    assert set(read.material) == {"default"}
    assert "left out: 13 colours, too many for materials" in str(findings)
    read, findings = cp.read_stones(coloured_ply(tmp_path / "one.ply", stones, one, of_faces=of_faces), support="base")
    assert (set(read.material), "colours" in str(findings)) == ({"default"}, False)


@pytest.mark.parametrize("how", ["vertices", "material", "3dm"])
def test_glb_and_3dm_keep_colours(how: str, tmp_path: Path) -> None:
    stones = wall(ground=False)
    few = [(200, 160, 80) if number % 2 else (90, 90, 90) for number in range(stones.count)]
    path = write_3dm(stones, tmp_path / "a.3dm", few) if how == "3dm" else write_glb(stones, tmp_path / "a.glb", few, by=how)
    read, _ = cp.read_stones(path, support="base")
    shade = dict(zip(read.block_id, read.material, strict=True))
    assert [shade[name] for name in stones.block_id] == ["colour-c8a050" if red == 200 else "colour-5a5a5a" for red, _, _ in few]


def test_an_obj_with_coloured_vertices_and_a_3mf_with_base_materials_have_materials(tmp_path: Path) -> None:
    text = write_obj(wall(), tmp_path / "plain.obj").read_text().replace("usemtl stone\n", "")
    lines, shades = [], {"o ground-0": "0.2 0.2 0.2", "o B1": "1 0.5 0"}
    shade = ""
    for line in text.splitlines():
        shade = shades.get(line, "0.6 0.6 0.6") if line.startswith("o ") else shade
        lines.append(f"{line} {shade}" if line.startswith("v ") else line)
    (tmp_path / "wall.obj").write_text("\n".join(lines) + "\n")
    read, _ = cp.read_stones(tmp_path / "wall.obj")
    assert read.material[:3].tolist() == ["colour-333333", "colour-ff8000", "colour-999999"]
    path = write_3mf(wall(), tmp_path / "wall.3mf")
    with zipfile.ZipFile(path) as archive:
        model = archive.read("3D/3dmodel.model").decode()
    named = "".join(f'<base name="{name}" displaycolor="#C8A050"/>' for name in ("tuff", "brick"))
    bases = f'<basematerials id="90">{named}</basematerials>'
    model = model.replace("<resources>", f"<resources>{bases}").replace('name="B1"', 'name="B1" pid="90" pindex="1"')
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
    read, _ = cp.read_stones(path)
    assert read.material[:3].tolist() == ["default", "brick", "default"]


def test_units_scale_and_the_axis_that_points_up(tmp_path: Path) -> None:
    stones = wall()
    lying = [(points[:, [0, 2, 1]] * [1000, 1000, -1000], faces) for _, points, faces, _ in solids(stones)]
    path = write_obj(Assemblage.from_polyhedra(lying, 1.0, fixed=[0]), tmp_path / "lying.obj")
    with pytest.raises(FindingsError, match=r"obj/E04 lying.obj: the file says no unit; .*--units mm"):
        cp.read_stones(path)
    read, _ = cp.read_stones(path, units="mm", up="y", unit_weight=18e3)
    np.testing.assert_allclose(read.centroid, stones.centroid, atol=1e-9)
    doubled, _ = cp.read_stones(path, units="mm", up="y", scale=2.0, unit_weight=18e3)
    np.testing.assert_allclose(doubled.volume, 8 * stones.volume, rtol=1e-9)


@pytest.mark.parametrize(
    ("up", "columns", "signs"),
    [
        ("x", [2, 1, 0], [1, 1, -1]),
        ("-x", [2, 1, 0], [-1, 1, 1]),
        ("y", [0, 2, 1], [1, 1, -1]),
        ("-y", [0, 2, 1], [1, -1, 1]),
        ("-z", [0, 1, 2], [1, -1, -1]),
    ],
)
def test_any_axis_may_point_up(up: str, columns: list[int], signs: list[int], tmp_path: Path) -> None:
    # Each is the wall turned as a body: columns of the wall and their signs are the axes of the file.
    stones = wall()
    lying = [(points[:, columns] * signs, faces) for _, points, faces, _ in solids(stones)]
    path = write_obj(Assemblage.from_polyhedra(lying, 1.0, fixed=[0]), tmp_path / "lying.obj")
    read, _ = cp.read_stones(path, up=up, unit_weight=18e3)
    np.testing.assert_allclose(read.centroid, stones.centroid, atol=1e-9)
    assert load_factor(read) == pytest.approx(load_factor(stones), rel=1e-6)


@pytest.mark.parametrize(("columns", "said"), [([0, 2, 1], True), ([2, 1, 0], True), ([0, 1, 2], False)])
def test_a_building_that_lies_on_its_side_is_told_of(columns: list[int], said: bool, tmp_path: Path) -> None:
    # Its plate of ground stands upright beside it, and is as high as the building is long.
    turned = [(points[:, columns] * [1, 1, -1 if said else 1], faces) for _, points, faces, _ in solids(wall())]
    path = write_obj(Assemblage.from_polyhedra(turned, 1.0, fixed=[0]), tmp_path / "lying.obj")
    _, findings = cp.read_stones(path, units="m", unit_weight=18e3)
    assert [finding.code for finding in findings.warnings if "point up" in finding.found] == ["W45"] * said
    _, findings = cp.read_stones(path, units="m", up="z", unit_weight=18e3)
    assert all(finding.code != "W45" for finding in findings.warnings)


def named(stones: Assemblage, **names: list[str]) -> Assemblage:
    return replace(stones, **{key: np.array(value) for key, value in names.items()})


def test_a_mesh_without_a_unit_is_told_in_which_units_its_stones_are_of_usual_size(tmp_path: Path) -> None:
    # Cubes of half a metre, written in feet (.3048 m) as 1.64 and in inches (.0254 m) as 19.7.
    cubes = on_ground(*(box((x, x + 0.5), (0, 0.5), (0, 0.5)) for x in (0.0, 1.0, 2.0)), reach=3)
    for name, metres in (("feet", 0.3048), ("inches", 0.0254)):
        cp.write_obj(replace(cubes, points=cubes.points / metres), tmp_path / f"{name}.obj")
    _, findings = cp.read_stones(tmp_path / "feet.obj")
    (assumed,) = (finding for finding in findings if finding.code == "W45")
    assert assumed.found.endswith("measures 1.64 m")
    assert assumed.remedy == "Pass --units in (41.7 mm), --units ft (500 mm), or --up, if that is wrong."
    with pytest.raises(FindingsError, match=r"E04 .* 19\.7 m.* --units cm \(197 mm\), --units in \(500 mm\), or --units m if"):
        cp.read_stones(tmp_path / "inches.obj")


@pytest.mark.parametrize("make", [wall, arch])
def test_a_mesh_that_was_written_comes_back(make: Callable[[], Assemblage], tmp_path: Path) -> None:
    stones = make()
    cp.write_obj(stones, tmp_path / "new" / "stones.obj")
    read, findings = cp.read_stones(tmp_path / "new" / "stones.obj", unit_weight=18e3)
    # The unit, and the ground: by its group.
    assert set(findings.codes) == {"W43", "W45"}
    assert read.block_id.tolist() == stones.block_id.tolist()
    assert read.fixed.tolist() == stones.fixed.tolist()
    # To the last digit: the file has every corner as it is.
    order = [np.lexsort(each.T) for each in (read.points, stones.points)]
    np.testing.assert_array_equal(read.points[order[0]], stones.points[order[1]])
    assert load_factor(read) == pytest.approx(load_factor(stones), rel=1e-9)


def test_a_mesh_names_no_free_stone_as_ground(tmp_path: Path) -> None:
    names = ["base", "foundation stone", "a#1", "a 1", "a/ground-1", *(f"s{k}" for k in range(8))]
    walls, stuff = ["", *["ground floor"] * 6, *["support"] * 6], ["rock"] + ["foundation"] * 12
    stones = named(wall(), block_id=names, panel=walls, material=stuff)
    cp.write_obj(stones, tmp_path / "stones.obj")
    read, _ = cp.read_stones(tmp_path / "stones.obj", unit_weight=18e3)
    assert read.fixed.tolist() == stones.fixed.tolist()
    assert read.block_id.tolist()[:5] == ["base", "stone foundation stone", "a 1", "a 1 (2)", "stone a ground-1"]
    assert set(read.material[~read.fixed]) == {"material foundation"}
    text = (tmp_path / "stones.obj").read_text()
    assert [text.count(f"g {panel}\n") for panel in ("ground", "ground floor", "panel support")] == [1, 6, 6]


def test_a_mesh_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="write_obj: the file cannot be written"):
        cp.write_obj(wall(), tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="a file where a folder would be"):
        cp.write_obj(wall(), tmp_path / "file" / "stones.obj")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_file_in_another_format_is_named_with_those_that_are_read(tmp_path: Path) -> None:
    path = tmp_path / "wall.skp"
    path.write_bytes(b"\xff\xfe\xff")
    with pytest.raises(FindingsError, match=r'import/E01 wall.skp: a file that ends in ".skp": expected one of DXF, OBJ, STL'):
        cp.read_stones(path)


def test_stones_that_touch_in_one_soup_are_told_apart_by_the_order_of_their_facets(tmp_path: Path) -> None:
    read, _ = cp.read_stones(write_stl(wall(ground=False), tmp_path / "wall.stl", binary=True), support="base", unit_weight=1.0)
    assert (~read.fixed).sum() == 12


def shuffle(path: Path, seed: int, turned: float = 0.0) -> None:
    """Put the facets of a binary STL in any order; turned: the share that is made to look inwards."""
    chance = np.random.default_rng(seed)
    head, data = path.read_bytes()[:84], np.frombuffer(path.read_bytes()[84:], dtype=np.uint8).reshape(-1, 50).copy()
    inwards = chance.random(len(data)) < turned
    data[inwards, 24:48] = data[inwards][:, [*range(36, 48), *range(24, 36)]]
    path.write_bytes(head + chance.permutation(data).tobytes())


@pytest.mark.parametrize("seed", range(5))
def test_stones_that_touch_in_one_soup_are_told_apart_in_any_order_of_their_facets(seed: int, tmp_path: Path) -> None:
    # They share whole faces and edges: to drop what is given twice would make one stone of all six.
    pile = Assemblage.from_polyhedra([box((x, x + 1), (0, 1), (z, z + 0.5)) for x in (0, 1) for z in (0, 0.5, 1)], 1.0)
    path = write_stl(pile, tmp_path / "pile.stl", binary=True)
    shuffle(path, seed)
    for repair in (False, True):
        read, findings = cp.read_stones(path, support="base", repair=repair)
        assert read.volume[~read.fixed] == pytest.approx([0.5] * 6)
        assert set(findings.codes) == {"W12", "W19", "W45"}


def test_facets_in_mixed_directions_make_one_stone_on_request_alone_and_that_is_said(tmp_path: Path) -> None:
    two = Assemblage.from_polyhedra([box((0, 1), (0, 1), (z, z + 0.5)) for z in (0, 0.5)], 1.0)
    path = write_stl(two, tmp_path / "two.stl", binary=True)
    shuffle(path, 3, turned=0.5)
    with pytest.raises(FindingsError, match="E10"):
        cp.read_stones(path, support="base")
    read, findings = cp.read_stones(path, support="base", repair=True)
    assert read.volume[~read.fixed].tolist() == [pytest.approx(1.0)]
    assert "so that what they parted is one stone (4)" in str(findings)


@pytest.mark.parametrize("cut", [0.3, 0.7, 0.99])
@pytest.mark.parametrize("write", [write_stl, write_ply, write_3dec, write_obj])
def test_a_truncated_file_is_never_a_smaller_wall(write: object, cut: float, tmp_path: Path) -> None:
    path = write(wall(ground=False), tmp_path / f"wall.{write.__name__[6:].replace('3dec', '3ddat')}")  # type: ignore[operator]
    data = path.read_bytes()
    path.write_bytes(data[: int(cut * len(data))])
    with pytest.raises(FindingsError):
        cp.read_stones(path, support="base")


@pytest.mark.parametrize("required", [True, False])
def test_meshes_that_an_extension_of_gltf_places_are_not_read_as_one(required: bool, tmp_path: Path) -> None:
    # Blender writes instances so on request: one node, and the places of its stones in a table that is no part of glTF 2.0.
    path = write_glb(wall(), tmp_path / "wall.glb")
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    table = json.loads(data[20 : 20 + length])
    node = next(node for node in table["nodes"] if "mesh" in node)
    node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {}}}
    if required:
        table["extensionsRequired"] = ["KHR_texture_transform", "EXT_mesh_gpu_instancing"]
    text = json.dumps(table).encode()
    text += b" " * (-len(text) % 4)
    size = (12 + 8 + len(text) + len(data) - 20 - length).to_bytes(4, "little")
    path.write_bytes(data[:8] + size + len(text).to_bytes(4, "little") + data[16:20] + text + data[20 + length :])
    with pytest.raises(FindingsError, match=r"E21 .*meshes that are not read without EXT_mesh_gpu_instancing\. Export without"):
        cp.read_stones(path, unit_weight=18e3)


def test_a_group_called_ground_fixes_the_objects_in_it(tmp_path: Path) -> None:
    # Rhino writes its layers as groups, and a number as the name of each object.
    lines = write_obj(wall(), tmp_path / "wall.obj").read_text().splitlines()
    names = iter(range(1000))
    renamed = [f"g {line[2:]}\no object_{next(names)}" if line.startswith("o ") else line for line in lines]
    grouped = [line if "ground" in line else re.sub("^g .*", "g wall", line) for line in renamed]
    (tmp_path / "grouped.obj").write_text("\n".join(grouped) + "\n")
    plain, _ = cp.read_stones(tmp_path / "wall.obj", unit_weight=18e3)
    stones, _ = cp.read_stones(tmp_path / "grouped.obj", unit_weight=18e3)
    assert (stones.count, stones.fixed.sum()) == (plain.count, plain.fixed.sum())
    assert plain.fixed.any()


def test_faces_of_a_second_material_in_a_body_are_told(tmp_path: Path) -> None:
    path = write_obj(wall(), tmp_path / "wall.obj")
    head, last, tail = path.read_text().rpartition("\nf ")
    path.write_text(f"{head}\nusemtl plaster{last}{tail}")
    _, findings = cp.read_stones(path, unit_weight=18e3)
    assert "1 face has another material than the body, which has that of its first face" in str(findings)
