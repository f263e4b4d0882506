"""From the stones of a drawing to panels: the same shell as from the generator."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from churchpipe.bond.voussoir import ring_outline
from churchpipe.derive.blocks import derive_blocks
from churchpipe.derive.contacts import find_contacts
from churchpipe.derive.match import match_models
from churchpipe.derive.panels import fit_panels
from churchpipe.derive.shell import derive_shell
from churchpipe.dxf.reader import read_drawing
from churchpipe.errors import InputError
from churchpipe.generators import arch, box, prototype, wall
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import BondRegion, Opening, UnitCell
from churchpipe.model.materials import Material

SAMPLES = Path(__file__).parents[2] / "cad_samples"
BRICK = (0.08, 0.04, 0.03)
PARAMETERS = {
    "s5": {"brick": BRICK, "main_wall_length": 0.64, "partitions_x": [0.0, 0.6], "partition_length": 0.32, "courses": 21},
    "s22": {
        "brick": BRICK,
        "main_wall_length": 1.12,
        "partitions_x": [0.0, 0.52, 1.08],
        "partition_length": 0.84,
        "courses": 21,
        "opening": {"start": 0.12, "width": 0.16, "height_courses": 15, "lintel_bearing": 0.04},
    },
}
TUFF = Material("default", 18e3, 0.6)


def untagged(stones):
    return replace(stones, panel=np.where(stones.fixed, stones.panel, ""))


def middle(shell):
    return shell.points[shell.triangles].mean(axis=1)


def arched_house():
    ring = ring_outline((1.5, 0.8), 0.4, 0.7, 0.0, math.pi, 9)
    house = box(length=3.0, width=2.5, thickness=0.5, brick=(0.5, 0.5, 0.2), courses=12, materials=(TUFF,))
    front = house.panels[0]
    door = np.concatenate([[[1.1, 0.0], [1.9, 0.0]], ring[:9:-1]])
    region = BondRegion("ring", ring, "voussoir", UnitCell(0.19, 0.3), centre=(1.5, 0.8), pieces=9)
    front = replace(front, openings=(Opening("door", door),), regions=(*front.regions, region))
    return replace(house, panels=(front, *house.panels[1:]))


@pytest.mark.parametrize("name", ["s5", "s22"])
@pytest.mark.parametrize("tagged", [True, False], ids=["tagged", "untagged"])
def test_a_drawing_gives_the_shell_of_the_generator(name, tagged):
    drawing = read_drawing(SAMPLES / f"{name}.dxf")
    fitted = fit_panels(drawing.stones if tagged else untagged(drawing.stones), drawing.materials)
    assert not len(fitted.unfit)
    expected = derive_shell(prototype(**PARAMETERS[name], materials=drawing.materials), 0.03)
    shell = derive_shell(fitted.building, 0.03)
    assert shell.area.sum() == pytest.approx(expected.area.sum(), rel=1e-9)
    np.testing.assert_allclose(shell.unit_cells, expected.unit_cells, rtol=1e-6)
    assert shell.points[shell.supported].shape == expected.points[expected.supported].shape
    assert len(shell.triangles) == len(expected.triangles)
    apart, twin = cKDTree(middle(expected)).query(middle(shell))
    assert apart.max() < 1e-6
    assert len(np.unique(twin)) == len(twin)
    for field in ("axes", "thickness", "surface_weight", "yields", "area"):
        found, wanted = getattr(shell, field).astype(float), getattr(expected, field)[twin].astype(float)
        np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=1e-9, err_msg=field)


@pytest.mark.parametrize("name", ["s5", "s22", "arch"])
def test_shell_and_stones_of_a_drawing_pass_the_gate(name):
    drawing = read_drawing(SAMPLES / f"{name}.dxf")
    shell = derive_shell(fit_panels(drawing.stones, drawing.materials).building, 0.1 if name == "arch" else 0.04)
    match = match_models(drawing.stones, find_contacts(drawing.stones), shell)
    assert match.passed, [figure for figure in match.figures if not figure.passed]


def test_voussoirs_are_recognised_by_their_turning_beds():
    bow = arch(mean_radius=1.0, thickness=0.2, width=0.5, voussoirs=27, materials=(TUFF,))
    panel = fit_panels(derive_blocks(bow), (TUFF,)).building.panels[0]
    (ring,) = panel.regions
    assert (ring.pattern, ring.pieces) == ("voussoir", 27)
    # s is measured from the arch's left end, x = -1.1; cells as from the generator, chords for arcs.
    np.testing.assert_allclose(ring.centre, [1.1, 0], atol=1e-9)
    assert ring.cell.b == pytest.approx(0.2, rel=1e-9)
    assert ring.cell.a == pytest.approx(2 * math.sin(math.pi / 54), rel=1e-9)
    np.testing.assert_allclose(ring.outline - [1.1, 0], bow.panels[0].outline, atol=1e-9)


@pytest.mark.parametrize("tagged", [True, False], ids=["tagged", "untagged"])
def test_a_ring_over_a_door_keeps_its_wall(tagged):
    stones = derive_blocks(arched_house())
    fitted = fit_panels(stones if tagged else untagged(stones), (TUFF,))
    assert not len(fitted.unfit)
    expected, shell = derive_shell(arched_house(), 0.2), derive_shell(fitted.building, 0.2)
    assert shell.area.sum() == pytest.approx(expected.area.sum(), rel=1e-6)
    assert shell.weight.sum() == pytest.approx(expected.weight.sum(), rel=1e-6)
    rings = [r for p in fitted.building.panels for r in p.regions if r.pattern == "voussoir"]
    assert [r.pieces for r in rings] == [9]
    assert sum(len(p.openings) for p in fitted.building.panels) == 1


def test_open_joints_are_closed():
    stones = derive_blocks(wall(length=1.2, brick=(0.2, 0.1, 0.05), courses=6, materials=(TUFF,)))
    owner = np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr))
    centre = stones.centroid[owner]
    # Each stone half a millimetre shorter to every side, in the plane of the wall.
    inward = np.where(stones.fixed[owner], 0.0, 1.0)[:, None] * np.sign(stones.points - centre) * [0.0005, 0, 0.0005]
    shrunk = replace(stones, points=stones.points - inward, volume=stones.volume, centroid=stones.centroid)
    panel = fit_panels(shrunk, (TUFF,)).building.panels[0]
    np.testing.assert_allclose(np.ptp(panel.outline, axis=0), [1.199, 0.299], atol=1e-6)
    assert not panel.openings
    assert (panel.regions[0].cell.a, panel.regions[0].cell.b) == pytest.approx((0.049, 0.199), rel=1e-6)


def test_stack_bond_and_walls_that_always_run_through_are_seen():
    stack = wall(length=1.2, brick=(0.2, 0.1, 0.05), courses=6, pattern="stack", materials=(TUFF,))
    assert fit_panels(derive_blocks(stack), (TUFF,)).building.panels[0].regions[0].pattern == "stack"
    building = prototype(**PARAMETERS["s22"], materials=(TUFF,))
    butted = replace(building, panels=(replace(building.panels[0], runs_through=None), *building.panels[1:]))
    assert fit_panels(derive_blocks(building), (TUFF,)).building.panels[0].runs_through == 0
    assert fit_panels(derive_blocks(butted), (TUFF,)).building.panels[0].runs_through is None


def test_stones_that_fit_no_wall_are_named():
    stones = derive_blocks(wall(length=1.2, brick=(0.2, 0.1, 0.05), courses=6, materials=(TUFF,)))
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    tetrahedron = ([(0, 0, 0.3), (0.1, 0, 0.3), (0.05, 0.1, 0.3), (0.05, 0.05, 0.4)], faces)
    odd = Assemblage.from_polyhedra([_polyhedron(stones, k) for k in range(stones.count)] + [tetrahedron], 18e3, fixed=[0])
    fitted = fit_panels(odd, (TUFF,))
    assert fitted.unfit.tolist() == [f"B{stones.count}"]
    with pytest.raises(InputError, match="no wall can be fitted"):
        fit_panels(Assemblage.from_polyhedra([tetrahedron], 18e3), (TUFF,))


def _polyhedron(stones, number):
    start, stop = stones.block_point_ptr[number : number + 2]
    faces = range(*stones.block_face_ptr[number : number + 2])
    nodes = [(stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - start).tolist() for f in faces]
    return stones.points[start:stop], nodes
