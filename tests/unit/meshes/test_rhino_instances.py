"""Blocks of Rhino: a stone for each instance, by the name and on the layer of the instance."""

from pathlib import Path
from typing import Any

import numpy as np
import rhino3dm as untyped

from churchpipe.meshes.reader import read_stones

# Its stubs take what can be set for read-only.
rhino3dm: Any = untyped
CORNERS = [(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def attributes(name: str = "", layer: int = 0) -> Any:
    found = rhino3dm.ObjectAttributes()
    found.Name, found.LayerIndex = name, layer
    return found


def mesh(low: tuple[float, ...], high: tuple[float, ...]) -> Any:
    found = rhino3dm.Mesh()
    for corner in np.array(low) + np.array(CORNERS) * (np.array(high) - np.array(low)):
        found.Vertices.Add(*corner.tolist())
    for side in SIDES:
        found.Faces.AddFace(*side)
    return found


def placed(model: Any, definition: int, name: str, shift: tuple[float, ...], layer: int = 0, mirror: float = 1.0) -> None:
    move = rhino3dm.Transform.Identity()
    move.M00, (move.M03, move.M13, move.M23) = mirror, shift
    reference = rhino3dm.InstanceReference(model.InstanceDefinitions[definition].Id, move)
    model.Objects.AddInstanceObject(reference, attributes(name, layer))


def test_instances_have_names_and_layers_of_their_own(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    model.Layers.AddLayer("Default", (0, 0, 0, 255))
    tuff = model.Layers.AddLayer("tuff", (200, 0, 0, 255))
    define = model.InstanceDefinitions.Add
    origin = rhino3dm.Point3d(0, 0, 0)
    brick = define("brick", "", "", "", origin, (mesh((0, 0, 0), (0.5, 0.3, 0.25)),), (attributes("as drawn"),))
    pair = (mesh((0, 0, 0), (0.5, 0.3, 0.25)), mesh((0, 0, 0.25), (0.5, 0.3, 0.5)))
    two = define("two", "", "", "", origin, pair, (attributes("lower"), attributes()))
    slab = define("slab", "", "", "", origin, (mesh((-0.5, -0.2, -0.3), (2.0, 0.5, 0.0)),), (attributes(),))
    placed(model, brick, "left", (0.0, 0.0, 0.0), tuff)
    placed(model, brick, "right", (1.0, 0.0, 0.0), mirror=-1.0)
    placed(model, two, "pier", (1.0, 0.0, 0.0))
    placed(model, slab, "ground", (0.0, 0.0, 0.0))
    assert model.Write(str(tmp_path / "blocks.3dm"), 7)
    stones, _ = read_stones(tmp_path / "blocks.3dm", unit_weight=18e3)
    free = ~stones.fixed
    # Of a block of two bodies the named one keeps its name.
    assert set(stones.block_id[free].tolist()) == {"left", "right", "lower", "pier"}
    assert stones.block_id[~free].tolist() == ["ground"]
    assert dict(zip(stones.block_id.tolist(), stones.material.tolist(), strict=True))["left"] == "tuff"
    np.testing.assert_allclose(stones.volume[free], 0.5 * 0.3 * 0.25, rtol=1e-6)


def test_what_lies_on_a_layer_in_a_hidden_one_is_hidden(tmp_path: Path) -> None:
    """Rhino shows nothing of a layer that is on itself but lies in one that is off."""
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    layers = [0, 0]
    for name, shown in (("Default", True), ("survey", False), ("of 1999", True), ("north", True)):
        layer = rhino3dm.Layer()
        layer.Name, layer.Visible = name, shown
        if name in ("of 1999", "north"):
            layer.ParentLayerId = model.Layers[layers[-1]].Id
        layers.append(model.Layers.Add(layer))
    model.Objects.AddMesh(mesh((-1, -1, -0.3), (2, 2, 0)), attributes("ground"))
    for number, layer in enumerate(layers[2:]):
        model.Objects.AddMesh(mesh((0, 0, 0.25 * number), (0.5, 0.3, 0.25 * number + 0.25)), attributes(f"stone{number}", layer))
    assert model.Write(str(tmp_path / "a.3dm"), 7)
    stones, findings = read_stones(tmp_path / "a.3dm", unit_weight=18e3)
    assert stones.block_id.tolist() == ["ground", "stone0"]
    assert "left out: 3 hidden objects" in str(findings)
