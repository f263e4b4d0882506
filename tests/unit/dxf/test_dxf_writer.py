"""The drawing as others find it: layers, attributes, units; and what is refused before a file exists."""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

import solids
from churchpipe.dxf.reader import read_drawing, read_dxf
from churchpipe.dxf.writer import write_dxf
from churchpipe.errors import InputError
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from dxf_models import STONE, box, wedge_and_ground


def test_the_schema_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "wedge.dxf"
    write_dxf(wedge_and_ground(), path, materials=[STONE], units="mm")
    document = ezdxf.readfile(path)
    assert (document.dxfversion, document.header["$INSUNITS"]) == ("AC1024", 4)
    assert document.appids.has_entry("CHURCHPIPE")
    store = dict(document.header.custom_vars)
    assert (store["CP_SCHEMA"], store["CP_UNITS"]) == ("1", "mm")
    assert "CP_MATERIAL_stone" in store
    inserts: Any = document.modelspace().query("INSERT")
    ground, wedge = inserts
    assert (ground.dxf.layer, wedge.dxf.layer) == ("CP-SUPPORT", "CP-BLOCKS")
    assert {a.dxf.tag: a.dxf.text for a in wedge.attribs} == {"ID": "wedge", "MATERIAL": "stone"}
    block = document.blocks.get(wedge.dxf.name)
    constants = {a.dxf.tag: float(a.dxf.text) for a in block.get_const_attdefs()}
    # 600 x 300 / 2 x 200 mm, a prism over a triangle: five faces.
    assert constants == {"VOLUME": 1.8e7, "NFACES": 5.0}
    tags = {p.get_xdata("CHURCHPIPE")[0].value: (p.dxf.layer, p.dxf.location) for p in block.query("POINT")}
    assert set(tags) == {"G", *(f"V{i}" for i in range(6))}
    assert tags["V1"][0] == "CP-VERTEX"
    np.testing.assert_allclose(tags["V1"][1], (600, 0, 0), atol=1e-9)
    assert tags["G"][0] == "CP-CENTROID"
    np.testing.assert_allclose(tags["G"][1], (200, 100, 100), atol=1e-9)
    assert [e.dxf.layer for e in block.query("MESH")] == ["CP-SOLID"]


def calls(work: Callable[[], object]) -> int:
    """How many functions of Python a piece of work calls: its cost, the same on every machine."""
    count = 0

    def counted(_: object, event: str, __: object) -> None:
        nonlocal count
        count += event == "call"

    sys.setprofile(counted)
    try:
        work()
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.slow
def test_a_stone_more_costs_little_to_write_and_to_read(tmp_path: Path) -> None:
    # Of 20 000 alike stones an entity each took 14 s to write, 1600 calls a stone; one definition and a text each take 45 calls.
    # Reading takes 1320, of which ezdxf has the most; a walk over all stones for each of them would grow without end.
    made = [solids.on_ground(*(solids.box((i, i + 0.9), (0, 1), (0, 1)) for i in range(n))) for n in (50, 100, 400)]
    for number, stones in enumerate(made):
        write_dxf(stones, tmp_path / f"{number}.dxf")
        read_dxf(tmp_path / f"{number}.dxf")
    for work, most in (
        (lambda k: write_dxf(made[k], tmp_path / "again.dxf"), 60),
        (lambda k: read_dxf(tmp_path / f"{k}.dxf"), 1600),
    ):
        few, more, many = (calls(partial(work, k)) for k in range(3))
        assert (many - more) / 300 < most
        assert (many - more) / 300 < 1.1 * (more - few) / 50


def test_the_drawing_passes_the_audit_of_ezdxf(tmp_path: Path) -> None:
    write_dxf(wedge_and_ground(), tmp_path / "a.dxf", materials=[STONE], loads=[LoadCase((1, 0, 0))])
    auditor = ezdxf.readfile(tmp_path / "a.dxf").audit()
    assert (auditor.errors, auditor.fixes) == ([], [])


def test_recurrent_stones_share_a_definition(tmp_path: Path) -> None:
    solids = [box((i, 0, 0), (0.4, 0.2, 0.2)) for i in range(5)] + [box((0, 5, 0), (0.4, 0.2, 0.2000001))]
    write_dxf(Assemblage.from_polyhedra(solids, 1.0, fixed=[0]), tmp_path / "a.dxf")
    inserts = ezdxf.readfile(tmp_path / "a.dxf").modelspace().query("INSERT")
    assert [i.dxf.name for i in inserts] == ["CP_Q1"] * 5 + ["CP_Q2"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"units": "ft"}, "not a unit drawings are written in"),
        ({"materials": [Material("stone", 20e3, 0.6)]}, "contradicts the stones made of it"),
        ({"materials": [STONE, STONE]}, "names are not unique"),
        ({"loads": [LoadCase((1, 0, 0), dead=np.zeros((2, 6)))]}, "cannot hold extra wrenches"),
        ({"loads": [LoadCase((1, 0, 0), name="L"), LoadCase((0, 1, 0), name="L")]}, "loads: names are not unique; found .*L"),
        ({"loads": [LoadCase((1, 0, 0), name="two\nlines")]}, "cannot hold this name"),
        ({"loads": [LoadCase((1, 0, 0), panels=["a wall with a long name"] * 100)]}, "too long for a document property"),
    ],
)
def test_what_a_drawing_cannot_hold_is_refused(options, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        write_dxf(wedge_and_ground(), tmp_path / "a.dxf", **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["two\nlines", " blank", "escape \\U+0041", "nul\0 inside", "caret^", "x" * 300])
def test_names_that_dxf_would_change_are_refused(name: str, tmp_path: Path) -> None:
    stones = Assemblage.from_polyhedra([box((0, 0, 0), (1, 1, 1))], 1.0, block_id=[name])
    with pytest.raises(InputError, match="cannot hold this name"):
        write_dxf(stones, tmp_path / "a.dxf")
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_leaves_the_old_drawing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.dxf"
    path.write_text("old", encoding="utf-8")

    def full_disk(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("ezdxf.document.Drawing.write", full_disk)
    with pytest.raises(InputError, match="cannot be written"):
        write_dxf(wedge_and_ground(), path)
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_drawing_has_the_name_of_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"write_dxf: path: not the name of a drawing; found a\.obj; expected .* ends in \.dxf"):
        write_dxf(wedge_and_ground(), tmp_path / "a.obj")
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_made(tmp_path: Path) -> None:
    """As `save` and `write_report` make it."""
    write_dxf(wedge_and_ground(), tmp_path / "none" / "below" / "a.dxf")
    assert read_drawing(tmp_path / "none" / "below" / "a.dxf").stones.count == wedge_and_ground().count


def test_a_file_in_the_place_of_a_folder_is_an_input_error(tmp_path: Path) -> None:
    (tmp_path / "none").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="cannot be written"):
        write_dxf(wedge_and_ground(), tmp_path / "none" / "a.dxf")
    assert (tmp_path / "none").read_text(encoding="utf-8") == "mine"
