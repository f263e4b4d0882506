"""Groups of an OBJ name the walls whose stones they hold, as layers of a drawing do."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.errors import InputError
from churchpipe.generators import house
from churchpipe.recognition.panels import fit_panels
from mesh_files import write_obj, write_stl
from solids import Solid, box, prism


def grouped(path: Path, group: dict[str, str]) -> Path:
    """Put each object of an OBJ into its group."""
    lines = path.read_text().splitlines()
    path.write_text("\n".join(f"{line}\ng {group[line[2:]]}" if line[:2] == "o " else line for line in lines) + "\n")
    return path


def test_walls_of_stones_written_as_obj_come_back_by_their_names(tmp_path: Path) -> None:
    walls = [
        {"name": "south", "start": (0, 0), "end": (4, 0), "toward": "+y"},
        {"name": "west", "start": (0, 0), "end": (0, 3), "toward": "+x"},
    ]
    stones = cp.derive_blocks(house(course=0.5, stone_length=1.0, height=2.0, thickness=0.5, walls=walls))
    cp.write_obj(stones, tmp_path / "a.obj")
    read, _ = cp.read_stones(tmp_path / "a.obj", unit_weight=18e3)
    free = ~stones.fixed
    assert (
        dict(zip(read.block_id.tolist(), read.panel.tolist(), strict=True)).items()
        >= dict(zip(stones.block_id[free].tolist(), stones.panel[free].tolist(), strict=True)).items()
    )
    assert sorted(panel.name for panel in fit_panels(read).panels) == ["south", "west"]


def test_a_fill_lies_on_the_ring_of_a_bridge_that_a_group_names(tmp_path: Path) -> None:
    angle = np.linspace(np.pi / 4, 3 * np.pi / 4, 8)
    ring = [[(r * np.cos(a), r * np.sin(a)) for r, a in ((5.0, s), (5.6, s), (5.6, t), (5.0, t))] for s, t in pairwise(angle)]
    solids = [box((-6, 6), (-1, 3), (-1, 0)), *(prism(outline, 3.0) for outline in ring)]
    stones = cp.Assemblage.from_polyhedra(solids, 20e3, fixed=[0], block_id=["ground", *(f"v{k}" for k in range(7))])
    path = write_obj(stones, tmp_path / "a.obj")
    names = dict.fromkeys(stones.block_id.tolist(), "ring") | {"ground-0": "base"}
    read, _ = cp.read_stones(grouped(path, names), unit_weight=20e3)
    assert read.panel.tolist() == [""] + ["ring"] * 7
    load = cp.with_fill(cp.LoadCase((1, 0, 0)), read, "ring", 6.0, 18e3)
    # Between z = 6 and the chords of the extrados, 3 m wide.
    x, z = 5.6 * np.cos(angle), 5.6 * np.sin(angle)
    column = float(-np.trapezoid(6.0 - z, x))
    assert load.dead is not None
    assert load.dead[:, 2].sum() == pytest.approx(-18e3 * 3.0 * column)


def test_a_group_around_each_stone_names_no_walls(tmp_path: Path) -> None:
    stones = cp.Assemblage.from_polyhedra(
        [box((-1, 2), (-1, 1), (-1, 0)), box((0, 1), (0, 0.5), (0, 0.5)), box((0, 1), (0, 0.5), (0.5, 1))], 18e3, fixed=[0]
    )
    names = {name: name for name in ("ground-0", *stones.block_id.tolist())}
    path = grouped(write_obj(stones, tmp_path / "a.obj"), names)
    assert cp.read_stones(path, unit_weight=18e3, support="base")[0].panel.tolist() == [""] * 3


def test_groups_of_3dec_name_walls_and_vaults(tmp_path: Path) -> None:
    """As those of an OBJ do: the blocks of a group are numbered, and the group is their wall."""
    groups = {"barrel": barrel(*STAGGERED), "north": spandrel(2.6, 3.0), "south": spandrel(0.0, 0.4)}
    names = ["base", *(name for name, own in groups.items() for _ in own)]
    solids = [box((-5, 5), (-2, 5), (-0.5, 0.5)), *(solid for own in groups.values() for solid in own)]
    lines = []
    for name, (points, faces) in zip(names, solids, strict=True):
        # The program wants its faces clockwise from outside.
        around = [" ".join(map(repr, points[face[::-1]].ravel().tolist())) for face in faces]
        lines.append(f'block create polyhedron {" ".join(f"face {corners}" for corners in around)} group "{name}"')
    path = tmp_path / "a.3ddat"
    path.write_text("\n".join([*lines, 'block fix range group "base"']) + "\n")
    read, _ = cp.read_stones(path, unit_weight=20e3)
    assert read.panel.tolist() == [""] + ["barrel"] * 32 + ["north"] * 12 + ["south"] * 12
    assert read.block_id[[1, 32, 33]].tolist() == ["barrel.1", "barrel.32", "north.1"]


def test_blocks_of_3dec_joined_from_two_groups_are_of_none(tmp_path: Path) -> None:
    """A region that is one stone, with blocks of two groups, belongs to neither wall: then no group names a part."""
    bricks = [f"block create brick {x} {x + 1} 0 0.5 {z} {z + 0.5}" for z in (0, 0.5) for x in (0, 1, 2)]
    ends = [' region 1 group "a"', ' region 1 group "b"', ' group "b"', ' group "a"', ' group "a"', ' group "b"']
    path = tmp_path / "a.3ddat"
    path.write_text("\n".join([*map(str.__add__, bricks, ends), "block join range region 1"]) + "\n")
    read, _ = cp.read_stones(path, unit_weight=20e3, support="base")
    assert read.panel.tolist() == [""] * 6


def barrel(*heads: tuple[float, ...]) -> list[Solid]:
    """Nine courses of a barrel. heads: where the stones of its courses end, in turn, m."""
    angle = np.linspace(np.pi / 6, 5 * np.pi / 6, 10)
    out: list[Solid] = []
    for course, (s, t) in enumerate(pairwise(angle)):
        outline = [(r * np.cos(a), r * np.sin(a)) for r, a in ((2.0, s), (2.4, s), (2.4, t), (2.0, t))]
        for low, high in pairwise(heads[course % len(heads)]):
            points, faces = prism(outline, high - low)
            out.append((points + np.array([0.0, low, 0.0]), faces))
    return out


STAGGERED = (0, 0.5, 1.5, 2.5, 3), (0, 1, 2, 3)


def spandrel(low: float, high: float) -> list[Solid]:
    return [box((x, x + 1), (low, high), (z, z + 0.3)) for z in (2.4, 2.7) for x in range(-3, 3)]


def parts(path: Path, groups: dict[str, list[Solid]]) -> Path:
    """Write an OBJ with a group for the stones of each part, on ground."""
    owner = [name for name, own in groups.items() for _ in own]
    solids = [box((-5, 5), (-2, 5), (-0.5, 0.5)), *(solid for own in groups.values() for solid in own)]
    ids = ["ground", *(f"s{k}" for k in range(len(owner)))]
    stones = cp.Assemblage.from_polyhedra(solids, 20e3, fixed=[0], block_id=ids)
    group = dict(zip(stones.block_id.tolist(), ["base", *owner], strict=True)) | {"ground-0": "base"}
    return grouped(write_obj(stones, path), group)


def test_a_vault_several_stones_wide_has_the_name_of_its_group_and_bears_a_fill(tmp_path: Path) -> None:
    walls = {"north": spandrel(2.6, 3.0), "south": spandrel(0.0, 0.4)}
    path = parts(tmp_path / "a.obj", {"barrel": barrel(*STAGGERED), **walls})
    read, _ = cp.read_stones(path, unit_weight=20e3)
    assert read.panel.tolist() == [""] + ["barrel"] * 32 + ["north"] * 12 + ["south"] * 12
    load = cp.with_fill(cp.LoadCase((1, 0, 0)), read, "barrel", 3.0, 18e3)
    assert load.dead is not None
    # Between z = 3 and the chords of the extrados, and between the spandrels.
    angle = np.linspace(np.pi / 6, 5 * np.pi / 6, 10)
    x, z = 2.4 * np.cos(angle), 2.4 * np.sin(angle)
    assert load.dead[:, 2].sum() == pytest.approx(18e3 * 2.2 * float(np.trapezoid(3.0 - z, x)))


def test_a_dome_and_a_round_wall_have_the_names_of_their_groups(tmp_path: Path) -> None:
    turn, ring = np.linspace(0, 2 * np.pi, 13), np.radians([0, 20, 40, 60])
    around = list(pairwise(turn))
    dome = [
        wedge([(r * np.cos(a), 2 + r * np.sin(a)) for a, r in ((s, 2.0), (s, 2.4), (t, 2.4), (t, 2.0))], *own)
        for s, t in pairwise(ring)
        for own in around
    ]
    drum = [wedge([(2.0, z), (2.4, z), (2.4, z + 0.5), (2.0, z + 0.5)], *own) for z in (0.5, 1.0, 1.5) for own in around]
    read, _ = cp.read_stones(parts(tmp_path / "a.obj", {"dome": dome, "drum": drum}), unit_weight=20e3)
    assert read.panel.tolist() == [""] + ["dome"] * 36 + ["drum"] * 36


def wedge(section: list[tuple[float, float]], start: float, end: float) -> Solid:
    """Turn a section of radius and height, counter-clockwise, about the upright axis."""
    points = [(r * np.cos(a), r * np.sin(a), z) for a in (start, end) for r, z in section]
    count = len(section)
    sides = [[k, (k + 1) % count, (k + 1) % count + count, k + count] for k in range(count)]
    return np.array(points), [list(range(count))[::-1], [*range(count, 2 * count)], *sides]


MIXED = {
    "arches of three walls": {"arches": barrel((0, 0.5)) + barrel((1.5, 2)) + barrel((3, 3.5))},
    "a vault and its walls": {"all": barrel(*STAGGERED) + spandrel(0.0, 0.4), "north": spandrel(2.6, 3.0)},
}


@pytest.mark.parametrize("groups", MIXED.values(), ids=MIXED)
def test_a_group_of_several_parts_names_none(groups: dict[str, list[Solid]], tmp_path: Path) -> None:
    read, _ = cp.read_stones(parts(tmp_path / "a.obj", groups), unit_weight=20e3)
    assert set(read.panel.tolist()) == {""}


def test_files_of_a_folder_name_the_parts_whose_stones_they_hold(tmp_path: Path) -> None:
    for name, own in {
        "barrel": barrel(*STAGGERED),
        "north": spandrel(2.6, 3.0),
        "ground": [box((-5, 5), (-2, 5), (-0.5, 0.5))],
    }.items():
        write_stl(cp.Assemblage.from_polyhedra(own, 1.0), tmp_path / f"{name}.stl", binary=True)
    read, _ = cp.read_stones(tmp_path, unit_weight=20e3)
    assert read.panel.tolist() == ["barrel"] * 32 + [""] + ["north"] * 12


def test_stones_without_names_are_told_how_to_get_some(tmp_path: Path) -> None:
    solids = [box((-5, 5), (-2, 5), (-0.5, 0.5)), *barrel(*STAGGERED), *spandrel(0, 0.4)]
    path = write_stl(cp.Assemblage.from_polyhedra(solids, 1.0), tmp_path / "a.stl", binary=True)
    read, _ = cp.read_stones(path, unit_weight=20e3, support="base")
    with pytest.raises(InputError, match="a folder with one for each part"):
        cp.with_fill(cp.LoadCase((1, 0, 0)), read, "barrel", 3.0, 18e3)
