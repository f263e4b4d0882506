"""The pictures of docs/church.md, strengthening.md, house.md and capacity_curve.md that no run of a ready case holds.

    python benchmarks/pictures.py [PICTURE ...]     # all, or those named; they go to docs/pictures

The figures of their captions are printed. All take some two minutes of processor time, most of it church_mechanisms.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from church import LOADS
from PIL import Image
from report_pictures import FOLDER, drawing_photographed

import churchpipe as cp
from churchpipe.generators import chapel, wall
from churchpipe.large_displacements.cracks import joint_cracks
from churchpipe.loading.placing import place_loads
from churchpipe.model.arrays import FloatArray
from churchpipe.model.placed_loads import Applied
from churchpipe.report.cracks import crack_map_svg
from churchpipe.report.figures import mechanism_picture, save_screenshot
from churchpipe.stones.footing import footing

FRICTION = 0.6
MATERIALS = (cp.Material("default", 18e3, FRICTION),)
CHURCH = "pipeline/cases/church.toml"
SIZE = (760, 560)
# From the facade and from the apse.
SIDES = ((-0.75, -0.55, 0.4), (0.6, 0.7, 0.45))
PUSHED = ("+x", "-y", "tower +x")


def church_stones() -> None:
    """Draw the stones of R14 from two sides, coloured by macro-element."""
    stones = cp.derive_blocks(cp.read_case(CHURCH).building())
    with TemporaryDirectory() as folder:
        files = [Path(folder) / f"{number}.png" for number in range(len(SIDES))]
        for file, side in zip(files, SIDES, strict=True):
            mechanism_picture(stones, None, file, size=SIZE, toward=np.array(side) / np.linalg.norm(side))
        save_screenshot(beside(files), FOLDER / "church_stones.png")


def church_mechanisms() -> None:
    """Draw R14 at collapse, associative, under three loads."""
    stones = cp.derive_blocks(cp.read_case(CHURCH).building())
    contacts = cp.find_contacts(stones)
    with TemporaryDirectory() as folder:
        files = [Path(folder) / f"{number}.png" for number in range(len(PUSHED))]
        for file, name in zip(files, PUSHED, strict=True):
            state = cp.limit_analysis(stones, contacts, LOADS[name], FRICTION)
            print(f"church_mechanisms, {name}: {state.load_factor:.4f}", flush=True)
            mechanism_picture(stones, state.velocities, file, LOADS[name].direction, size=SIZE)
        save_screenshot(beside(files), FOLDER / "church_mechanisms.png")


def strengthening() -> None:
    """Draw a chapel with the loads of its roof and one tie, pushed across."""
    building = chapel(
        width=6.0, length=9.0, height=5.0, ridge=7.2, thickness=0.7, course=0.25, stone_length=0.5, materials=MATERIALS
    )
    roof = [
        cp.LineLoad(name, dead=4.5e3, thrust=300.0, toward=(way, 0, 0)) for name, way in (("nave_left", -1), ("nave_right", 1))
    ]
    bar = cp.TieBar(
        "tie", start=("nave_left", 4.5, 4.5), end=("nave_right", 4.5, 4.5), area=400e-6, steel_strength=235e6,
        plate=(0.3, 0.3), bearing_strength=1e6, punching_strength=0.1e6,
    )  # fmt: skip
    stones, load = cp.derive_blocks(building), cp.LoadCase((1, 0, 0))
    ties = cp.place_ties(stones, [bar])
    state = cp.limit_analysis(stones, cp.find_contacts(stones), cp.loaded(load, stones, roof), FRICTION, ties=ties)
    pulled = f"tie {state.tie_forces[0] / 1e3:.1f} of {ties[0].strength / 1e3:.0f} kN"
    print(f"strengthening: {int((~stones.fixed).sum())} stones, {state.load_factor:.4f}, {pulled}", flush=True)
    applied = Applied(place_loads(stones, roof), tuple(ties))
    mechanism_picture(stones, state.velocities, FOLDER / "strengthening.png", load.direction, applied)


def house() -> None:
    """Draw the ready case of a house, its stones and how it falls along -y, with its floors and roof."""
    case = cp.read_case("pipeline/cases/house.toml")
    stones = cp.derive_blocks(case.building())
    contacts = cp.find_contacts(stones)
    (load,) = (load for load in case.loads if load.name == "-y")
    floors = case.carries.area_loads
    state = cp.limit_analysis(
        stones, contacts, cp.loaded(load, stones, floors), *cp.joint_strength(stones, contacts, case.materials)
    )
    print(f"house: {int((~stones.fixed).sum())} stones, {load.name}: {state.load_factor:.4f}", flush=True)
    with TemporaryDirectory() as folder:
        files = [Path(folder) / "stones.png", Path(folder) / "mechanism.png"]
        # From the front, above the eaves.
        mechanism_picture(stones, None, files[0], size=SIZE, toward=np.array([-0.5, -0.75, 0.45]))
        mechanism_picture(stones, state.velocities, files[1], load.direction, Applied(place_loads(stones, floors)), size=SIZE)
        save_screenshot(beside(files), FOLDER / "house.png")


def crack_map() -> None:
    """Draw the cracks of a facade whose left corner has sunk by 60 mm."""
    holes = [
        {"start": 1.0, "width": 0.8, "sill_courses": 5, "height_courses": 5, "lintel_bearing": 0.2},
        {"start": 3.4, "width": 1.2, "sill_courses": 0, "height_courses": 10, "lintel_bearing": 0.2},
    ]
    building = wall(length=6.0, brick=(0.4, 0.25, 0.2), courses=20, openings=holes, materials=MATERIALS)
    whole = cp.derive_blocks(building)
    foot = footing(whole, cp.find_contacts(whole), ((-0.1, -0.5), (1.2, 0.5)))
    stones, contacts = foot.stones, cp.find_contacts(foot.stones)
    path = cp.settlement_path(stones, contacts, foot.support, friction=FRICTION, furthest=0.06)
    least = cp.settlement_analysis(stones, contacts, foot.support, friction=FRICTION)
    weight = stones.weight[~stones.fixed].sum()
    reactions = (
        f"{least.reaction / 1e3:.2f} kN at least, {path.reaction[0] / 1e3:.2f} without dilatancy, of {weight / 1e3:.1f} kN"
    )
    opening, _ = joint_cracks(stones, contacts, path.position[-1], path.rotation[-1])
    bears = ~stones.fixed[contacts.blocks].all(axis=1)
    print(f"crack_map: {int((opening[bears] > 1e-3).sum())} joints open by more than 1 mm, {reactions}", flush=True)
    drawing_photographed(crack_map_svg(stones, contacts, np.where(bears, opening, 0.0), "wall"), FOLDER / "crack_map.png")


def beside(files: Sequence[Path]) -> FloatArray:
    """Return pictures of one height as one (rows, columns, 3), one beside the other."""
    return np.concatenate([np.asarray(Image.open(file).convert("RGB")) for file in files], axis=1)


PICTURES = {draw.__name__: draw for draw in (church_stones, church_mechanisms, strengthening, house, crack_map)}

if __name__ == "__main__":
    for name in sys.argv[1:] or PICTURES:
        PICTURES[name]()
