"""Files damaged at random: stones or a finding, never a traceback or a wall that is smaller without a word."""

import random
from pathlib import Path

import pytest

from mutations import MUTATIONS, outcome
from ways_of_reading import WAYS


@pytest.mark.parametrize("name", WAYS)
def test_a_damaged_file_is_refused_or_read_whole(name: str, tmp_path: Path) -> None:
    way = WAYS[name]
    stones = way.stones()
    path = way.write(stones, tmp_path)
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    chance = random.Random(name)
    for _ in range(12):
        target = chance.choice(files)
        data = target.read_bytes()
        target.write_bytes(chance.choice(MUTATIONS)(data, chance))
        kind, text = outcome(path, *way.size(stones), way.options, way.windows)
        assert kind in ("read", "refused", "another shape"), ascii(text)
        target.write_bytes(data)
