"""Buildings of far too many stones, of any generator, are refused before any stone is laid."""

import tracemalloc
from pathlib import Path

import pytest

from churchpipe.bond.count import check_count
from churchpipe.config.case import read_case
from churchpipe.config.plan import plan
from churchpipe.errors import InputError
from churchpipe.generators import GENERATORS
from churchpipe.resources import sample_case
from churchpipe.stones.blocks import derive_blocks

# One number of the ready case of each generator, mutated. Of an arch the number of voussoirs is limited in itself.
MUTATED = {
    "wall": "source.length_m=9900",
    "arch_piers": "source.pier_width_m=9000",
    "prototype": "source.courses=900000",
    "box": "source.courses=900000",
    "house": "source.walls.2.ridge_m=9900",
    "tower": "source.height_m=9900",
    "apse": "source.wall_height_m=9900",
    "chapel": "source.length_m=8250",
    "church": "source.tower.height_m=9900",
    "vault": "source.length_m=9900",
    "dome": "source.drum_height_m=9900",
}


def test_every_generator_is_here() -> None:
    assert {*MUTATED, "arch"} == {*GENERATORS}


@pytest.mark.parametrize(
    ("generator", "change"),
    [pytest.param(*pair, marks=pytest.mark.slow if pair[0] == "vault" else ()) for pair in MUTATED.items()],
)
def test_a_mutated_number_is_refused_before_stones_take_memory(generator: str, change: str, tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(sample_case(generator), encoding="utf-8")
    # Laid, they would take gigabytes. The courses of a vault are counted joint by joint, which takes 150 MB.
    tracemalloc.start()
    with pytest.raises(InputError) as caught:
        read_case(path, [change]).building()
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 200e6
    said = str(caught.value)
    key = change.partition("=")[0]
    assert f"--set, {key}" in said
    assert "too many stones; found about " in said
    assert f"times as large as in the ready case {generator}; expected at most 100,000" in said
    assert "raise most_stones" in said


def test_whoever_means_it_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(sample_case("wall"), encoding="utf-8")
    with pytest.raises(InputError, match="about 105, of them"):
        read_case(path, ["most_stones=50"]).building()
    building = read_case(path, ["most_stones=1000"]).building()
    check_count(building)
    assert building.most_stones == 1000
    assert derive_blocks(building).count > 50
    (geometry,) = plan([read_case(path, ["most_stones=1000"])]).geometries.values()
    assert geometry["most_stones"] == 1000
