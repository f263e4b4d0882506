"""Make the drawings of this folder: `python cad_samples/make.py`. The same code makes the same bytes (with the same ezdxf)."""

from pathlib import Path
from typing import Any

import ezdxf

from churchpipe.dxf.writer import write_dxf
from churchpipe.generators import arch, prototype
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from churchpipe.stones.blocks import derive_blocks

HERE = Path(__file__).parent
BOX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))

# Malena et al. 2019, section 4.1 and Table 1; lengths in m.
BRICK = Material("brick", 28.6e3, 0.7, elastic=Elastic(3.18e9, 0.23, 0.303e9, 0.3, 1e-3))
STONE = Material("stone", 18e3, 0.7)
PROTOTYPES: dict[str, tuple[dict[str, Any], LoadCase]] = {
    "s5": (
        {"main_wall_bricks": 8, "partitions_x": [0.0, 0.6], "partition_length": 0.32},
        LoadCase((0, 1, 0)),
    ),
    "s22": (
        {
            "main_wall_bricks": 14,
            "partitions_x": [0.0, 0.52, 1.08],
            "partition_length": 0.84,
            "opening": {"start": 0.12, "width": 0.16, "height_courses": 15, "lintel_bearing": 0.04},
        },
        LoadCase((0, -1, 0)),
    ),
}


def small_wall() -> Assemblage:
    """Three stones of 0.4 x 0.2 x 0.2 m on a plate: two in the first course, one across their joint."""
    brick = (0.4, 0.2, 0.2)
    boxes = [((-0.2, -0.2, -0.1), (1.2, 0.6, 0.1)), ((0, 0, 0), brick), ((0.4, 0, 0), brick), ((0.2, 0, 0.2), brick)]
    return Assemblage.from_polyhedra(
        [(_corners(origin, size), BOX_FACES) for origin, size in boxes],
        unit_weight=18e3,
        fixed=[0],
        material="stone",
        panel=["", "wall", "wall", "wall"],
        course=[-1, 0, 0, 1],
        block_id=["ground", "left", "right", "top"],
    )


def _corners(origin: tuple[float, ...], size: tuple[float, ...]) -> list[tuple[float, float, float]]:
    (x, y, z), (a, b, c) = origin, size
    plan = [(x, y), (x + a, y), (x + a, y + b), (x, y + b)]
    return [(u, v, z) for u, v in plan] + [(u, v, z + c) for u, v in plan]


def main() -> None:
    ezdxf.options.write_fixed_meta_data_for_testing = True
    for name, (parameters, load) in PROTOTYPES.items():
        building = prototype(name=name, materials=(BRICK,), brick=(0.08, 0.04, 0.03), courses=21, **parameters)
        write_dxf(derive_blocks(building), HERE / f"{name}.dxf", materials=[BRICK], loads=[load], units="mm")
    ring = arch(name="arch", materials=(STONE,), mean_radius=1.0, thickness=0.2, width=0.4, voussoirs=27)
    write_dxf(derive_blocks(ring), HERE / "arch.dxf", materials=[STONE], loads=[LoadCase((1, 0, 0))])
    write_dxf(small_wall(), HERE / "sound.dxf", materials=[Material("stone", 18e3, 0.6)], loads=[LoadCase((1, 0, 0))])


if __name__ == "__main__":
    main()
