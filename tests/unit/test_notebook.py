"""Models and results in a notebook: tables, pictures, diagrams, files."""

import io
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.model.contacts import KINDS
from churchpipe.report import colours
from solids import box, on_ground

STONES = on_ground(box((0, 1), (0, 1), (0, 2)), box((0, 1), (0, 1), (2, 3)), unit_weight=2e4, reach=3)
CONTACTS = cp.find_contacts(STONES)
STATE = cp.limit_analysis(STONES, CONTACTS, cp.LoadCase((1, 0, 0)), friction=0.7)
BUILDING = cp.read_case(Path(__file__).parents[2] / "pipeline" / "cases" / "wall.toml").building()


def same(one: object, other: object) -> bool:
    pairs = [(getattr(one, field.name), getattr(other, field.name)) for field in fields(one)]
    return all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in pairs if isinstance(a, np.ndarray))


def test_models_and_results_show_themselves() -> None:
    assert "<td>2</td>" in STONES._repr_html_()
    assert "interfaces" in CONTACTS._repr_html_()
    html = STATE._repr_html_()
    assert f"{STATE.load_factor:.6g}" in html
    assert "optimal" in html
    evil = replace(STONES, panel=np.array(["ground", "<script>", "b"]))
    assert "<script>" not in evil._repr_html_()
    assert "&lt;script&gt;" in evil._repr_html_()


def test_models_and_results_are_printed_as_their_tables() -> None:
    assert repr(STONES).startswith("Assemblage: stones 2; fixed 1; weight, kN 60;")
    assert repr(CONTACTS).startswith("Contacts: interfaces 2;")
    wall = cp.derive_blocks(BUILDING)
    roof = cp.place_loads(wall, [cp.LineLoad("wall", dead=1e3, name="roof")])
    assert repr(roof).startswith(f"Placed loads: parts {len(roof.stone)}; stones {len(np.unique(roof.stone))}; mass, kN ")
    assert repr(roof).endswith(f"; line load roof (x, y, z), kN (0, 0, {roof.dead[:, 2].sum() / 1e3:.4g})")
    assert f"load factor {STATE.load_factor:.6g}; status optimal; flow rule associative" in str(STATE)


@pytest.mark.parametrize("value", [STONES, CONTACTS, STATE], ids=lambda value: type(value).__name__)
def test_what_is_saved_is_loaded(value: object, tmp_path: Path) -> None:
    cp.save(value, tmp_path / "value.npz")
    found = cp.load(tmp_path / "value.npz")
    assert type(found) is type(value)
    assert same(value, found)


def test_what_cannot_be_saved_or_loaded_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="save: value: not a model or a result; found dict; expected Assemblage"):
        cp.save({}, tmp_path / "value.npz")
    with pytest.raises(InputError, match="another ending"):
        cp.save(STONES, tmp_path / "value.pkl")
    (tmp_path / "value.npz").write_bytes(b"no archive")
    with pytest.raises(
        InputError,
        match=r"damaged, or not a file of churchpipe.* Name a file that churchpipe wrote; if it is one of a run, delete it",
    ):
        cp.load(tmp_path / "value.npz")


def test_tables_have_a_row_a_stone_and_an_interface() -> None:
    table = cp.to_pandas(STONES)
    assert table["weight"].sum() == pytest.approx(6e4)
    assert table.loc[~table["fixed"], "z"].tolist() == pytest.approx([1.0, 2.5])
    assert len(cp.to_pandas(CONTACTS)) == len(CONTACTS.blocks)
    with pytest.raises(InputError, match="no table of this"):
        cp.to_pandas(STATE)


def test_meshes_have_a_cell_a_stone_and_a_facet() -> None:
    mesh = cp.to_meshio(STONES)
    assert sum(len(block.data) for block in mesh.cells) == STONES.count
    shell = cp.derive_shell(BUILDING, element_size=0.5)
    assert len(cp.to_meshio(shell).cells[0].data) == len(shell.triangles)
    with pytest.raises(InputError, match="to_meshio: model: wrong kind; found Contacts; expected an Assemblage or a ShellModel"):
        cp.to_meshio(CONTACTS)


def test_pictures_of_a_model_and_of_its_mechanism_differ() -> None:
    still, moved = np.asarray(cp.show(STONES)), np.asarray(cp.show(STONES, STATE))
    assert np.ptp(still) > 100
    assert (np.abs(np.subtract(still, moved, dtype=np.int16)) > 20).mean() > 0.01
    other = on_ground(box((0, 1), (0, 1), (0, 2)), unit_weight=2e4, reach=3)
    with pytest.raises(InputError, match="not a result of these stones"):
        cp.show(other, STATE)
    with pytest.raises(
        InputError, match="show: model: wrong kind; found None; expected an Assemblage or a Contacts or a ShellModel"
    ):
        cp.show(None)  # pyright: ignore[reportArgumentType]


def test_joints_are_shown_in_the_colours_of_their_kinds() -> None:
    picture = np.asarray(cp.show(CONTACTS)).astype(float)
    row = {}
    for kind in ("base", "bed"):
        colour = 255 * np.array(to_rgb(colours.PANELS[KINDS.index(kind)]))
        shown = np.all(np.abs(picture - colour) < 8, axis=2)
        assert shown.sum() > 10_000
        row[kind] = np.flatnonzero(shown.any(axis=1)).max()
    # What stands higher is drawn higher.
    assert row["bed"] < row["base"]
    with pytest.raises(InputError, match="joints alone have no mechanism"):
        cp.show(CONTACTS, STATE)


def test_a_curve_is_drawn() -> None:
    curve = cp.block_pushover(STONES, CONTACTS, cp.LoadCase((1, 0, 0)), friction=0.7, step=0.1)
    figure = cp.plot(curve)
    [line] = figure.axes[0].lines
    assert line.get_xdata() == pytest.approx(1e3 * curve.displacement)
    figure.savefig(io.BytesIO())
    with pytest.raises(InputError, match="plot: curve: wrong kind"):
        cp.plot(STATE)


@pytest.mark.slow
def test_models_and_results_have_methods_that_show_them() -> None:
    def alike(one: Any, other: Any) -> bool:
        return np.array_equal(np.asarray(one), np.asarray(other))

    assert alike(STONES.show(), cp.show(STONES))
    assert alike(STATE.show(STONES), cp.show(STONES, STATE))
    assert alike(CONTACTS.show(), cp.show(CONTACTS))
    shell, load = cp.derive_shell(BUILDING, element_size=0.5), cp.LoadCase((1, 0, 0))
    state = cp.shell_limit_analysis(shell, load, [cp.Material("default", 2e4, 0.6)])
    assert alike(shell.show(), cp.show(shell))
    assert alike(state.show(shell), cp.show(shell, state))
    curve = cp.block_pushover(STONES, CONTACTS, load, friction=0.7, step=0.1)
    assert curve.plot().axes[0].get_ylabel() == "load factor"
    assert str(curve).startswith("Capacity curve of the stones: first load factor ")


def test_a_support_that_moves_shows_itself() -> None:
    pad = on_ground(box((0, 1), (0, 1), (0, 2)), unit_weight=2e4, reach=1)
    joints = cp.find_contacts(pad)
    onset = cp.settlement_analysis(pad, joints, support=[0], direction=(0, 0, -1), friction=0.6)
    assert "reaction" in onset._repr_html_()
    path = cp.settlement_path(pad, joints, [0], (0, 0, -1), friction=0.6, furthest=0.02, step=0.01)
    assert path.status in path._repr_html_()
    assert str(path).startswith("Support that moves: first reaction, N or Nm ")
    [line] = path.plot().axes[0].lines
    assert line.get_xdata() == pytest.approx(path.movement)
    assert line.get_ydata() == pytest.approx(path.reaction)


def test_results_are_written_as_a_report(tmp_path: Path) -> None:
    load = cp.LoadCase((1, 0, 0))
    brick = cp.Material("default", 2e4, 0.7)
    cp.write_report(tmp_path / "r.html", STONES, CONTACTS, [(load, STATE)], materials=[brick], name="Two <stones>")
    html = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert f"{STATE.load_factor:.4f}" in html
    assert "Two &lt;stones&gt;" in html
    with pytest.raises(InputError, match="write_report: results: not a result of this model; found 3"):
        cp.write_report(tmp_path / "no.html", STONES, CONTACTS, [(load, 3)], materials=[brick])  # pyright: ignore
    assert not (tmp_path / "no.html").exists()
