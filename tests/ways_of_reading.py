"""Ways of reading a file other than stones as drawn: repaired, with open joints, as whole walls, as a plan, from hatches."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from churchpipe.model.assemblage import Assemblage
from mesh_files import DXF_WRITERS, WRITERS, fuzz_wall, solids, write_dxf_drawing, write_dxf_outlines, write_dxf_solids, write_obj
from solids import box

JOINT = 1 / 64
# A window of the first of the whole walls, and its volume, m3.
VOID = [(-2.5, 0.5), (-2.0, 0.5), (-2.0, 0.75), (-2.5, 0.75)]
WINDOW = 0.5 * 0.25 * 0.25


@dataclass(frozen=True)
class Way:
    """A file and how it is read: what writes stones, the stones, the options.

    windows: outlines that are no stones; voids: boundaries within one.
    """

    write: Callable[[Assemblage, Path], Path]
    stones: Callable[[], Assemblage] = fuzz_wall
    options: dict[str, Any] = field(default_factory=dict)
    windows: int = 0
    voids: int = 0

    def size(self, stones: Assemblage) -> tuple[int, float]:
        """Count of stones written, the ground too, and volume of the free ones without windows."""
        return stones.count, float(stones.volume[~stones.fixed].sum()) - (self.windows + self.voids) * WINDOW


def open_wall() -> Assemblage:
    """The wall of `fuzz_wall` with mortar left out between its bricks, and below them."""
    bricks = [
        box((x + k + JOINT, x + k + 0.25), (0, 0.125), (0.125 * z + JOINT, 0.125 * z + 0.125))
        for z in range(4)
        for k in [0.125 * (z % 2)]
        for x in (0, 0.25, 0.5)
    ]
    return Assemblage.from_polyhedra([box((-1, 2), (-1, 1), (-0.5, 0)), *bricks], 18e3, fixed=[0])


def whole_walls() -> Assemblage:
    """Three walls on a plate, without stones."""
    walls = [box((x, x + 1.5), (0, 0.25), (0, 1.0)) for x in (-3, 0, 3)]
    return Assemblage.from_polyhedra([box((-4, 5), (-1, 1), (-0.5, 0)), *walls], 18e3, fixed=[0])


def write_dxf_hatches(stones: Assemblage, folder: Path) -> Path:
    """The faces that look to -y as boundaries of hatches."""
    import ezdxf

    document = ezdxf.new("R2010", units=6)
    for layer in ("WALL", "GROUND"):
        document.layers.add(layer)
    for _, points, _, fixed in solids(stones):
        (x, _, z), (right, _, top) = points.min(axis=0), points.max(axis=0)
        hatch = document.modelspace().add_hatch(dxfattribs={"layer": "GROUND" if fixed else "WALL"})
        hatch.paths.add_polyline_path([(x, z), (right, z), (right, top), (x, top)], is_closed=True)
    document.saveas(folder / "wall.dxf")
    return folder / "wall.dxf"


def write_dxf_voids(stones: Assemblage, folder: Path) -> Path:
    """Whole walls as hatches, with an island in the first one."""
    import ezdxf

    document = ezdxf.readfile(write_dxf_hatches(stones, folder))
    hatch: Any = document.modelspace().query('HATCH[layer=="WALL"]').first
    hatch.paths.add_polyline_path(VOID, is_closed=True, flags=16)
    document.saveas(folder / "wall.dxf")
    return folder / "wall.dxf"


def write_dxf_walls(stones: Assemblage, folder: Path) -> Path:
    """Outlines of whole walls, with a window in the first one."""
    import ezdxf

    document = ezdxf.readfile(write_dxf_outlines(stones, folder))
    document.layers.add("OPENING")
    document.modelspace().add_lwpolyline(VOID, close=True, dxfattribs={"layer": "OPENING"})
    document.saveas(folder / "wall.dxf")
    return folder / "wall.dxf"


def _as_obj(stones: Assemblage, folder: Path) -> Path:
    return write_obj(stones, folder / "wall.obj")


REPAIR: dict[str, Any] = {"repair": True}
KEEP: dict[str, Any] = {"joint": JOINT, "joint_mode": "keep", "mortar": "ignored"}
LAID: dict[str, Any] = {"bond": "running", "course": 0.125, "stone": 0.25}
WAYS: dict[str, Way] = {name: Way(write) for name, write in (WRITERS | DXF_WRITERS).items()} | {
    "dxf-repair": Way(write_dxf_drawing, options=REPAIR),
    "dxf-solids-repair": Way(write_dxf_solids, options=REPAIR),
    "obj-repair": Way(_as_obj, options=REPAIR),
    "dxf-hatches": Way(write_dxf_hatches, options={"thickness": 0.125}),
    "dxf-voids": Way(write_dxf_voids, whole_walls, {"thickness": 0.25}, voids=1),
    "dxf-plan": Way(write_dxf_outlines, options={"plane": "xy"}),
    "dxf-joints": Way(write_dxf_outlines, open_wall, {"joint": JOINT}),
    "dxf-joints-keep": Way(write_dxf_outlines, open_wall, KEEP),
    "obj-joints": Way(_as_obj, open_wall, {"joint": JOINT}),
    "dxf-laid": Way(write_dxf_walls, whole_walls, LAID, windows=1),
    "obj-laid": Way(_as_obj, whole_walls, LAID | {"bond": "stack"}),
}
