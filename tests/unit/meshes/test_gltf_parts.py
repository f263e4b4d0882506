"""Meshes of a glTF with a part (primitive) for each of their materials."""

import json
import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import churchpipe as cp
from churchpipe.findings import FindingsError
from churchpipe.model.arrays import FloatArray
from solids import box

Part = tuple[FloatArray, Sequence[Sequence[int]], str]

WALL = [box((x, x + 0.5), (0, 0.25), (z, z + 0.25)) for z in (0, 0.25) for x in (0, 0.5)]
GROUND = box((-1, 2), (-1, 1), (-0.25, 0))


def glb(path: Path, nodes: dict[str, list[Part]]) -> Path:
    """Write nodes by their names, each with a mesh of parts: points z up, polygons, the name of a material."""
    data, views, accessors, meshes = b"", [], [], []
    materials = sorted({stuff for parts in nodes.values() for *_, stuff in parts})
    for parts in nodes.values():
        primitives = []
        for points, faces, stuff in parts:
            places = (points @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])).astype("<f4")
            corners = np.array([(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)], dtype="<u2").ravel()
            for array, kind, numbers in ((places, "VEC3", 5126), (corners, "SCALAR", 5123)):
                views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
                accessors.append({"bufferView": len(views) - 1, "componentType": numbers, "count": len(array), "type": kind})
                data += array.tobytes() + b"\0" * (-array.nbytes % 4)
            accessors[-2] |= {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
            where = {"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1}
            primitives.append({**where, "material": materials.index(stuff)})
        meshes.append({"primitives": primitives})
    table = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [*range(len(nodes))]}],
        "nodes": [{"name": name, "mesh": number} for number, name in enumerate(nodes)],
        "meshes": meshes,
        "materials": [{"name": name} for name in materials],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(table).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path


@pytest.mark.parametrize("split", [1, 2, 3, 5])
def test_a_stone_with_two_materials_is_one_stone(split: int, tmp_path: Path) -> None:
    nodes = {
        f"stone{n}": [(points, faces[:split], "plaster"), (points, faces[split:], "brick")]
        for n, (points, faces) in enumerate(WALL)
    }
    read, findings = cp.read_stones(glb(tmp_path / "wall.glb", {"ground": [(*GROUND, "rock")], **nodes}), unit_weight=18e3)
    materials = dict(zip(read.block_id.tolist(), read.material.tolist(), strict=True))
    assert materials == {"ground": "rock", **dict.fromkeys(nodes, "plaster")}
    np.testing.assert_allclose(read.volume[~read.fixed], 0.5 * 0.25 * 0.25, rtol=1e-6)
    assert len(cp.find_contacts(read).area) == 2 + 2 + 2
    assert f"{4 * 2 * (6 - split)} faces have another material" in str(findings)


def test_parts_that_close_are_bodies_with_the_same_names_at_each_reading(tmp_path: Path) -> None:
    file = glb(tmp_path / "wall.glb", {"all": [(*GROUND, "ground"), *((*stone, f"stone{n}") for n, stone in enumerate(WALL))]})
    first, second = (cp.read_stones(file, unit_weight=18e3)[0] for _ in range(2))
    assert first.block_id.tolist() == second.block_id.tolist() == [f"all-{n}" for n in range(1, 6)]
    assert first.material.tolist() == ["ground", "stone0", "stone1", "stone2", "stone3"]
    assert first.fixed.tolist() == [True, False, False, False, False]


def test_stones_in_another_scene_are_not_lost(tmp_path: Path) -> None:
    """They are not shown; whether they belong to the building nobody can tell."""
    file = glb(tmp_path / "a.glb", {"ground": [(*GROUND, "rock")], "stone": [(*WALL[0], "brick")]})
    file.write_bytes(file.read_bytes().replace(b'"scenes": [{"nodes": [0, 1]}]', b'"scenes": [{"nodes": [0]   }]'))
    with pytest.raises(FindingsError, match=r"E03 .*2 meshes stand in its nodes, and 1 of them can be read .*in one scene"):
        cp.read_stones(file, unit_weight=18e3)
