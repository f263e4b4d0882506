"""Files damaged at random: stones or a finding, never a traceback or a wall that is smaller without a word."""

import random
from pathlib import Path

import pytest

from mesh_files import WRITERS, fuzz_wall, write_dxf_drawing
from mutations import MUTATIONS, outcome


@pytest.mark.parametrize("name", [*WRITERS, "dxf"])
def test_a_damaged_file_is_refused_or_read_whole(name: str, tmp_path: Path) -> None:
    stones = fuzz_wall()
    path = {**WRITERS, "dxf": write_dxf_drawing}[name](stones, tmp_path)
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    chance = random.Random(name)
    for _ in range(12):
        target = chance.choice(files)
        data = target.read_bytes()
        target.write_bytes(chance.choice(MUTATIONS)(data, chance))
        kind, text = outcome(path, stones.count, float(stones.volume.sum()))
        assert kind in ("read", "refused", "another shape"), text
        target.write_bytes(data)
