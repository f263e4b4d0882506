"""Every damaged drawing is answered with its finding, and nothing but findings ever comes out."""

import re
from pathlib import Path

import numpy as np
import pytest
from ezdxf.filemanagement import new
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from churchpipe.dxf.reader import read_drawing
from churchpipe.errors import InputError
from churchpipe.findings import CODES, Findings, FindingsError
from churchpipe.generators import arch
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from damaged_drawings import DAMAGES, SAMPLES, write_damaged
from dxf_models import BOX_FACES, STONE, box


@pytest.fixture(scope="session")
def damaged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with every damaged drawing."""
    folder = tmp_path_factory.mktemp("damaged")
    write_damaged(folder)
    return folder


def findings_of(path: Path, **options) -> Findings:
    try:
        return read_drawing(path, **options).findings
    except FindingsError as error:
        return error.findings


def bare(path: Path, draw, code: int) -> Path:
    """Write a drawing of another program: $INSUNITS and what `draw` puts in, and a patch of ground."""
    document = new("R2010")
    document.header["$INSUNITS"] = code
    document.modelspace().add_3dface([(-1, -1, 0), (2, -1, 0), (2, 1, 0), (-1, 1, 0)], dxfattribs={"layer": "CP-SUPPORT"})
    draw(document)
    document.saveas(path)
    return path


def rotation(angle: float) -> np.ndarray:
    return np.array([(np.cos(angle), np.sin(angle), 0), (-np.sin(angle), np.cos(angle), 0), (0, 0, 1)])


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_found(damaged: Path, name: str) -> None:
    findings = findings_of(damaged / f"{name}.dxf")
    assert set(findings.codes) == DAMAGES[name]
    assert all(finding.code in CODES for finding in findings)


@pytest.mark.parametrize(("name", "stones"), [("sound", 3), ("arch", 27), ("s5", 326), ("s22", 869)])
def test_sound_drawings_have_no_findings(name: str, stones: int) -> None:
    # Numbers of stones: Malena et al. 2019 as computed for this project, one parity for S5.
    drawing = read_drawing(SAMPLES / f"{name}.dxf")
    assert drawing.findings.codes == ()
    assert int((~drawing.stones.fixed).sum()) == stones


def test_a_finding_reads_as_one_line_with_place_and_remedy(damaged: Path) -> None:
    text = str(findings_of(damaged / "decimal_comma.dxf"))
    assert re.fullmatch(
        r'dxf/E07 decimal_comma\.dxf: INSERT #[0-9A-F]+ "CP_Q2" at \(0\.40, 0\.00, 0\.00\) m: attribute VOLUME = "0,016": '
        r"expected a number with a decimal point\. Correct it, or pass --repair to recompute the volume from the faces\.",
        text,
    )


def test_all_errors_are_shown_together(damaged: Path) -> None:
    with pytest.raises(FindingsError) as caught:
        read_drawing(damaged / "many_errors.dxf")
    lines = str(caught.value).splitlines()
    assert lines[0] == "many_errors.dxf: 5 errors in the file."
    assert [line.split()[0] for line in lines[1:]] == ["dxf/E04", "dxf/E06", "dxf/E07", "dxf/E07", "dxf/E12"]


@pytest.mark.parametrize(
    ("name", "codes"), [("decimal_comma", {"W07"}), ("decimal_comma_in_block", {"W07"}), ("bad_course", {"W07"})]
)
def test_repair_recomputes_what_cannot_be_understood(damaged: Path, name: str, codes: set[str]) -> None:
    drawing = read_drawing(damaged / f"{name}.dxf", repair=True)
    assert set(drawing.findings.codes) == codes
    np.testing.assert_allclose(drawing.stones.volume[1:], 0.016, rtol=1e-12)


@pytest.mark.parametrize("name", ["open_body", "moved_vertex", "missing_vertex", "doubled_face"])
def test_repair_mends_the_body_of_a_definition(damaged: Path, name: str) -> None:
    with pytest.raises(FindingsError, match=r"E10 .*Pass --repair to mend it\."):
        read_drawing(damaged / f"{name}.dxf")
    drawing = read_drawing(damaged / f"{name}.dxf", repair=True)
    assert set(drawing.findings.codes) == {"W41"}
    sound = read_drawing(SAMPLES / "sound.dxf")
    np.testing.assert_allclose(drawing.stones.volume, sound.stones.volume, rtol=1e-12)
    assert len(find_contacts(drawing.stones).blocks) == len(find_contacts(sound.stones).blocks)


def test_repair_drops_the_copy_of_a_stone(damaged: Path) -> None:
    drawing = read_drawing(damaged / "duplicate_stone.dxf", repair=True)
    assert drawing.findings.codes == ("W11",)
    assert drawing.stones.block_id.tolist() == ["ground", "left", "right", "top"]


def test_base_support_bears_the_lowest_stones_and_fixes_none_of_them(damaged: Path) -> None:
    drawing = read_drawing(damaged / "no_support.dxf", support="base")
    assert drawing.findings.codes == ("W12",)
    assert "at z = 0 m; 2 stones stand on it (left, right)" in str(drawing.findings)
    stones = drawing.stones
    assert dict(zip(stones.block_id, stones.fixed, strict=True)) == {
        "left": False,
        "right": False,
        "top": False,
        "ground-1": True,
    }
    assert len(find_contacts(stones).blocks) == 5


# $INSUNITS and metres: the reference of DXF, group 70; of surveys in the United States 1 m is 39.37 inches.
LENGTHS = {3: 1609.344, 9: 2.54e-5, 13: 1e-6, 14: 0.1, 15: 10, 16: 100}
LENGTHS |= {21: 12 / 39.37, 22: 1 / 39.37, 23: 36 / 39.37, 24: 63360 / 39.37}


@pytest.mark.parametrize(("code", "metre"), LENGTHS.items())
def test_every_unit_that_is_a_length_is_read(tmp_path: Path, code: int, metre: float) -> None:
    def brick(document) -> None:
        corners = np.array([(x, y, z) for z in (0, 0.2) for x, y in ((0, 0), (0.4, 0), (0.4, 0.2), (0, 0.2))]) / metre
        mesh = document.modelspace().add_mesh()
        with mesh.edit_data() as data:
            data.vertices = corners.tolist()
            data.faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]

    drawing = read_drawing(bare(tmp_path / "brick.dxf", brick, code), unit_weight=18e3, support="base")
    assert not {"E04", "E05"} & set(drawing.findings.codes)
    np.testing.assert_allclose(drawing.stones.volume[~drawing.stones.fixed], 0.016, rtol=1e-9)


def test_a_unit_of_no_building_is_named(tmp_path: Path) -> None:
    with pytest.raises(FindingsError, match=r"\$INSUNITS = 18 \(astronomical units\), in which no building is drawn"):
        read_drawing(bare(tmp_path / "far.dxf", lambda _: None, 18))
    with pytest.raises(FindingsError, match=r"\$INSUNITS = 25, which is no length"):
        read_drawing(bare(tmp_path / "none.dxf", lambda _: None, 25))


def test_units_passed_settle_the_doubt(damaged: Path) -> None:
    # Drawn in metres, flagged as inches: the stones are 0.4 x 0.2 x 0.2 m.
    drawing = read_drawing(damaged / "wrong_units.dxf", units="m")
    assert drawing.findings.codes == ("W04",)
    np.testing.assert_allclose(drawing.stones.volume[1:], 0.016, rtol=1e-12)
    hint = str(findings_of(damaged / "wrong_units.dxf"))
    assert "--units m (252 mm)" in hint


def test_stones_without_attributes_get_names_and_default_material(damaged: Path) -> None:
    stones = read_drawing(damaged / "solids_only.dxf").stones
    assert stones.fixed.tolist() == [False, False, False, True]
    np.testing.assert_allclose(np.sort(stones.volume[:3]), 0.016, rtol=1e-12)
    np.testing.assert_allclose(stones.centroid[:3], [(0.2, 0.1, 0.1), (0.6, 0.1, 0.1), (0.4, 0.1, 0.3)], atol=1e-12)
    assert set(stones.material) == {"default"}


def test_a_stretched_stone_has_the_stretched_volume(damaged: Path) -> None:
    np.testing.assert_allclose(read_drawing(damaged / "stretched_insert.dxf").stones.volume[3], 0.016 * 1.5, rtol=1e-12)


def test_stones_that_run_into_a_table_are_missed(tmp_path: Path) -> None:
    """Half of the stones come after the head of a table, which the parser then takes them to be rows of."""

    def draw(doc) -> None:
        for place in range(4):
            with doc.modelspace().add_mesh().edit_data() as mesh:
                mesh.vertices, mesh.faces = box((place, 0, 0), (1, 1, 1))[0].tolist(), [list(face) for face in BOX_FACES]

    path = bare(tmp_path / "a.dxf", draw, code=6)
    assert len(read_drawing(path).stones.fixed) == 5
    first, *rest = path.read_text().split("\nMESH\n")
    table = "\nENDSEC\n  0\nSECTION\n  2\nTABLES\n  0\nTABLE\n  2\nVPORT\n  5\n8\n330\n0\n  0\nMESH\n"
    path.write_text(table.join((f"{first}\nMESH\n{rest[0]}\nMESH\n{rest[1]}", f"{rest[2]}\nMESH\n{rest[3]}")))
    assert "entities were lost on reading: 2 of 4 MESH" in str(findings_of(path))


def test_a_stone_that_runs_into_the_end_of_another_is_missed(tmp_path: Path) -> None:
    """The group code of its kind is damaged, so that the parser takes all of it for a part of the entity before it."""

    def draw(doc) -> None:
        corners, faces = box((0, 0, 0), (1, 1, 1))[0].tolist(), [list(face) for face in BOX_FACES]
        doc.modelspace().add_polyface().append_faces([[corners[index] for index in face] for face in faces])
        with doc.modelspace().add_mesh().edit_data() as mesh:
            mesh.vertices, mesh.faces = [[x, y, z + 1] for x, y, z in corners], faces

    path = bare(tmp_path / "a.dxf", draw, code=6)
    assert len(read_drawing(path).stones.fixed) == 3
    path.write_text(path.read_text().replace("\n  0\nMESH\n", "\n  7\nMESH\n"))
    assert "SEQEND" in str(findings_of(path))
    assert "two entities run into each other here" in str(findings_of(path))


def test_a_model_that_shows_another_block_is_missed(tmp_path: Path) -> None:
    """The record of a layout's block is lost, and with it which block the model shows."""

    def draw(doc) -> None:
        with doc.blocks.new("ONE").add_mesh().edit_data() as mesh:
            mesh.vertices, mesh.faces = box((0, 0, 0), (1, 1, 1))[0].tolist(), [list(face) for face in BOX_FACES]
        for place in range(4):
            doc.modelspace().add_blockref("ONE", (place, 0, 0))

    path = bare(tmp_path / "a.dxf", draw, code=6)
    before, record, after = re.split(r"(\n  0\nBLOCK_RECORD\n  5\n1B\n(?:.*\n)*?281\n0)(?=\n  0\n)", path.read_text(), maxsplit=1)
    assert "*Paper_Space" in record
    path.write_text(f"{before}\n  2{after[4:]}")
    assert "the layout of the model shows another block than *Model_Space" in str(findings_of(path))


def test_lengths_in_findings_are_in_metres(tmp_path: Path) -> None:
    # A stone 400 mm long, one corner 10 mm too high: a quarter of that is out of the plane of its warped face.
    def warp(doc) -> None:
        with doc.modelspace().add_mesh().edit_data() as mesh:
            corners = box((0, 0, 0), (400, 200, 200))[0]
            corners[6, 2] += 10
            mesh.vertices = corners.tolist()
            mesh.faces = [list(face) for face in BOX_FACES]

    text = str(read_drawing(bare(tmp_path / "a.dxf", warp, code=4)).findings)
    assert re.search(r"W10 .*MESH #\w+ at \(0\.00, 0\.00, 0\.00\) m: warped faces, with corners up to 0\.0025 m out of", text)


def test_bodies_with_flaws_have_a_say_in_the_size_of_the_stones(tmp_path: Path) -> None:
    # Bricks of 250 x 120 x 65 drawn in mm and flagged metres: all but a pebble of 2 mm lack a face.
    def draw(doc) -> None:
        space = doc.modelspace()
        for place in range(5):
            with space.add_mesh().edit_data() as mesh:
                mesh.vertices = box((300 * place, 0, 0), (250, 120, 65))[0].tolist()
                mesh.faces = [list(face) for face in BOX_FACES[: 5 if place else 6]]
        with space.add_mesh().edit_data() as mesh:
            mesh.vertices, mesh.faces = box((0, 0, 65), (2, 2, 2))[0].tolist(), [list(face) for face in BOX_FACES]

    findings = findings_of(bare(tmp_path / "a.dxf", draw, code=6))
    assert "4 times: MESH" in str(findings)
    assert "the median stone measures 125 m" in str(findings)


@pytest.mark.parametrize(("decimals", "codes"), [(6, {"W19", "W22"}), (5, {"W10", "W19", "W22"})])
def test_a_rounded_arch_is_taken(decimals: int, codes: set[str], tmp_path: Path) -> None:
    ring = derive_blocks(arch(name="arch", materials=(STONE,), mean_radius=1.0, thickness=0.2, width=0.4, voussoirs=27))
    turned = np.round(ring.points @ rotation(0.3), decimals)

    def draw(doc) -> None:
        for stone in range(ring.count):
            start, stop = ring.block_point_ptr[stone : stone + 2]
            faces = range(*ring.block_face_ptr[stone : stone + 2])
            with doc.modelspace().add_mesh(dxfattribs={"layer": "CP-SUPPORT" if ring.fixed[stone] else "0"}).edit_data() as mesh:
                mesh.vertices = turned[start:stop].tolist()
                mesh.faces = [(ring.face_nodes[ring.face_ptr[f] : ring.face_ptr[f + 1]] - start).tolist() for f in faces]

    drawing = read_drawing(bare(tmp_path / "a.dxf", draw, code=6))
    assert set(drawing.findings.codes) == codes
    assert len(str(drawing.findings).splitlines()) == len(codes)
    np.testing.assert_allclose(drawing.stones.volume[:-1], ring.volume, rtol=1e-4)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(part=st.floats(0.0, 0.999))
def test_a_truncated_drawing_never_becomes_stones(part: float, tmp_path) -> None:
    data = (SAMPLES / "sound.dxf").read_bytes()
    cut = tmp_path / "cut.dxf"
    cut.write_bytes(data[: int(part * len(data))])
    with pytest.raises(FindingsError) as caught:
        read_drawing(cut)
    assert caught.value.findings.codes[0] in ("E01", "E03")


LINES = (SAMPLES / "sound.dxf").read_text(encoding="utf-8").split("\n")
NONSENSE = st.sampled_from(["nan", "inf", "1e400", "-1", "999999999", "0,5", "", "INSERT", "EOF", "  0", " 10", "é\0", "{"])
CHANGES = st.tuples(st.sampled_from(["delete", "replace", "double"]), st.integers(0, len(LINES) - 1), NONSENSE)


@settings(max_examples=250, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(changes=st.lists(CHANGES, min_size=1, max_size=4))
def test_nonsense_gives_findings_or_stones_but_no_other_error(changes, tmp_path) -> None:
    lines = list(LINES)
    for kind, place, text in changes:
        place = min(place, len(lines) - 1)
        lines[place : place + 1] = {"delete": [], "replace": [text], "double": [lines[place]] * 2}[kind]
    path = tmp_path / "nonsense.dxf"
    path.write_text("\n".join(lines), encoding="utf-8")
    assert set(findings_of(path).codes) <= set(CODES)


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.binary(max_size=400))
def test_any_bytes_are_an_input_error(data: bytes, tmp_path) -> None:
    path = tmp_path / "bytes.dxf"
    path.write_bytes(data)
    with pytest.raises(InputError):
        read_drawing(path)


def test_paths_and_arguments_that_are_no_good(tmp_path) -> None:
    for path in (tmp_path / "missing.dxf", tmp_path):
        assert findings_of(path).codes == ("E01",)
    sound = SAMPLES / "sound.dxf"
    with pytest.raises(InputError, match="unknown unit"):
        read_drawing(sound, units="furlong")
    with pytest.raises(InputError, match="support: unknown value"):
        read_drawing(sound, support="air")
    with pytest.raises(InputError, match="out of range"):
        read_drawing(sound, unit_weight=-1.0)


@pytest.mark.parametrize("repair", [False, True])
def test_a_mesh_that_lacks_a_face_is_closed_on_request(repair: bool, tmp_path: Path) -> None:
    document = new("R2010")
    document.header["$INSUNITS"] = 6
    for level, faces in ((0.0, BOX_FACES), (0.2, BOX_FACES[:-1])):
        with document.modelspace().add_mesh().edit_data() as mesh:
            mesh.vertices, mesh.faces = box((0, 0, level), (0.4, 0.2, 0.2))[0].tolist(), list(faces)
    path = tmp_path / "a.dxf"
    document.saveas(path)
    if not repair:
        with pytest.raises(FindingsError, match=r"E10 .* Pass --repair to mend it"):
            read_drawing(path, support="base")
        return
    drawing = read_drawing(path, support="base", repair=True)
    assert "W41" in drawing.findings.codes
    assert drawing.stones.volume[~drawing.stones.fixed].sum() == pytest.approx(0.032, rel=1e-12)
