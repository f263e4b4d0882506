"""Files damaged at random: stones or a finding, never a traceback or a wall that is smaller without a word."""

import random
from pathlib import Path

import pytest

from mesh_files import DXF_WRITERS, WRITERS, fuzz_wall
from mutations import MUTATIONS, outcome


@pytest.mark.parametrize("name", [*WRITERS, *DXF_WRITERS])
def test_a_damaged_file_is_refused_or_read_whole(name: str, tmp_path: Path) -> None:
    stones = fuzz_wall()
    path = (WRITERS | DXF_WRITERS)[name](stones, tmp_path)
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    chance = random.Random(name)
    for _ in range(12):
        target = chance.choice(files)
        data = target.read_bytes()
        target.write_bytes(chance.choice(MUTATIONS)(data, chance))
        kind, text = outcome(path, stones.count, float(stones.volume.sum()))
        assert kind in ("read", "refused", "another shape"), ascii(text)
        target.write_bytes(data)
