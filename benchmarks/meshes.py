"""Processor time and memory of reading a wall of 5000 stones from OBJ, as polygons and as triangles, STL and DXF.

.venv/bin/python benchmarks/meshes.py [STONES]
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import churchpipe as cp
from mesh_files import write_dxf_drawing, write_obj, write_stl
from solids import box


def wall(count: int) -> cp.Assemblage:
    """A wall in running bond, 100 stones a course, on a plate."""
    length, height, depth = 0.25, 0.1, 0.3
    bricks = [
        box((x * length + 0.125 * (z % 2), (x + 1) * length + 0.125 * (z % 2)), (0, depth), (z * height, (z + 1) * height))
        for z in range(-(-count // 100))
        for x in range(100)
    ][:count]
    return cp.Assemblage.from_polyhedra([box((-1, 30), (-1, 1), (-0.5, 0)), *bricks], 18e3, fixed=[0])


def main() -> None:
    """Write, read, print."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 5000
    stones = wall(count)
    joints = len(cp.find_contacts(stones).blocks)
    print("| file | size, MB | read, processor s | contacts, processor s | stones | joints | largest memory, MB |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        files = {
            "OBJ, polygons": write_obj(stones, Path(folder) / "polygons.obj"),
            "OBJ, triangles": write_obj(stones, Path(folder) / "triangles.obj", triangulated=True),
            "STL, binary": write_stl(stones, Path(folder) / "facets.stl", binary=True),
            "DXF, inserts": write_dxf_drawing(stones, Path(folder)),
        }
        # What is loaded at the first reading is not counted.
        cp.read_stones(files["STL, binary"], unit_weight=18e3, support="base")
        for name, path in files.items():
            begin = time.process_time()
            read, _ = cp.read_stones(path, unit_weight=18e3, support="base")
            middle = time.process_time()
            found = cp.find_contacts(read)
            end = time.process_time()
            faces = np.diff(read.block_face_ptr)
            assert read.fixed.sum() == 1
            assert (faces == 6).all()
            assert len(found.blocks) >= joints
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            cells = f"{path.stat().st_size / 1e6:.1f} | {middle - begin:.2f} | {end - middle:.2f} | {read.count - 1}"
            print(f"| {name} | {cells} | {len(found.blocks)} | {memory:.0f} |", flush=True)


if __name__ == "__main__":
    main()
