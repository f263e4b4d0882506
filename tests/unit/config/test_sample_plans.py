"""[sample] in a case file: what it takes, what it refuses, and the plan of its samples."""

from pathlib import Path

import pytest

from case_texts import WALL, case_file
from churchpipe.config.case import read_case
from churchpipe.config.samples import plan_with_samples
from churchpipe.errors import InputError

FRICTION = '{ key = "material.default.friction", distribution = "normal", mean = 0.6, standard_deviation = 0.05 }'
THICKNESS = '{ key = "source.thickness_mm", distribution = "uniform", low = 200, high = 300 }'


def sampled(*parameters: str, number: int = 6) -> str:
    lines = ",\n  ".join(parameters)
    return f"{WALL}[sample]\nnumber = {number}\nparameters = [\n  {lines},\n]\n"


def test_a_sample_is_read(tmp_path: Path) -> None:
    case = read_case(case_file(tmp_path, sampled(FRICTION, THICKNESS)))
    sample = case.sample
    assert sample is not None
    assert (sample.number, sample.seed, sample.method) == (6, 0, "sobol")
    assert [parameter.key for parameter in sample.parameters] == [("material.default.friction",), ("source.thickness_mm",)]
    # The building as it is keeps the values of the file.
    assert case.materials[0].friction == 0.6
    assert read_case(case.path, ["sample.number=12"]).sample.number == 12


@pytest.mark.parametrize(
    ("parameter", "words"),
    [
        (FRICTION.replace("0.05", "0.2"), ["material.default.friction", "its distribution reaches -0.35", "lognormal"]),
        (THICKNESS.replace("low = 200", "low = -10"), ["source.thickness_mm", "reaches -10", "greater than 0"]),
        (
            THICKNESS.replace("thickness_mm", "thicknes_mm"),
            ["source.thicknes_mm: unknown key; expected", 'Did you mean "thickness_m"?'],
        ),
        (FRICTION.replace("material.default.friction", "name"), ["not to be sampled"]),
        # No sample depends on them.
        (FRICTION.replace("material.default.friction", "sample.demands.0"), ["sample.parameters.0.key", "not to be sampled"]),
        (FRICTION.replace("material.default.friction", "movements.0.furthest_mm"), ["not to be sampled"]),
        (FRICTION.replace("material.default.friction", "variants.0.cost.EUR"), ["not to be sampled"]),
        (FRICTION.replace("default", "brick"), ["sample.parameters.0.key: unknown material; found brick; expected default"]),
        (FRICTION.replace("default", "defualt"), ["unknown material; found defualt", 'Did you mean "default"?']),
        (FRICTION.replace("mean = 0.6,", ""), ["sample.parameters.0.mean", "missing"]),
        (FRICTION.replace("standard_deviation", "deviation"), ["unknown key", "standard_deviation"]),
        (FRICTION.replace('"normal"', '"gauss"'), ["sample.parameters.0.distribution", "'normal'"]),
        (f"{FRICTION}, {FRICTION}", ["two distributions for one key"]),
        (
            '{ key = "source.brick_mm.1", distribution = "normal", mean = 10, standard_deviation = 9 }',
            ["source.brick_mm", "reaches -"],
        ),
        (
            '{ key = "source.courses", distribution = "uniform", low = 4, high = 5 }',
            ["source.courses", "found 4.5; expected a whole number. Not even its median is a value of the key"],
        ),
    ],
)
def test_what_cannot_be_is_refused_with_its_line(tmp_path: Path, parameter: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        read_case(case_file(tmp_path, sampled(parameter)))
    for word in [*words, "case.toml: line 1"]:
        assert word in str(caught.value)


def test_the_plan_of_samples_grows_and_shares_what_they_leave_as_it_is(tmp_path: Path) -> None:
    text = sampled(FRICTION) + "[shell]\nelement_size_mm = 200\n"
    todo, samples = plan_with_samples(case_file(tmp_path, text))
    assert todo.index["sample"]["names"] == list(samples) == ["00001", "00002", "00003", "00004", "00005", "00006"]
    stones, mesh = ("assemblage.npz", "contacts.npz"), ("shell.npz", "match.json")
    shared = [f"geometry/base/{name}" for name in stones] + [f"shell/base/{name}" for name in mesh]
    assert todo.index["sample"]["shared"] == shared
    # The analyses of a sample have the names of those of the building as it is.
    own = [entry["name"] for entry in samples["00001"]["index"]["analyses"]]
    assert own == [entry["name"] for entry in todo.index["analyses"]] == ["+y_associative", "+y_limit"]
    friction = [table["rigid/+y_associative/settings"]["material"]["default"]["friction"] for table in samples.values()]
    assert friction == todo.index["sample"]["points"]["material.default.friction"]
    assert len(set(friction)) == 6
    more, grown = plan_with_samples(tmp_path / "case.toml", ["sample.number=20"])
    assert list(grown)[:6] == list(samples)
    assert all(grown[name] == table for name, table in samples.items())
    assert more.analyses == todo.analyses


def test_samples_of_a_thickness_have_stones_of_their_own(tmp_path: Path) -> None:
    todo, samples = plan_with_samples(case_file(tmp_path, sampled(FRICTION, THICKNESS)))
    assert todo.index["sample"]["shared"] == []
    thickness = [table["geometry/base/settings"]["source"]["parameters"]["thickness"] for table in samples.values()]
    assert min(thickness) > 0.2
    assert max(thickness) < 0.3
    assert len(set(thickness)) == 6


def test_samples_of_variants_are_the_same_points(tmp_path: Path) -> None:
    variants = """
[[variants]]
name = "thicker"
change = { source.thickness_mm = 500 }
[[variants]]
name = "wet"
change = { "material.default.friction" = 0.3 }
"""
    todo, samples = plan_with_samples(case_file(tmp_path, sampled(FRICTION) + variants))
    assert [entry["name"] for entry in samples["00003"]["index"]["analyses"]] == list(todo.analyses)
    asis, thicker, wet = (samples["00003"][f"rigid/{name}/settings"]["material"]["default"]["friction"] for name in todo.analyses)
    # What a variant changes is not sampled in it.
    assert asis == thicker == todo.index["sample"]["points"]["material.default.friction"][2]
    assert wet == 0.3


@pytest.mark.parametrize("sweep", ['"source.brick_mm" = [[400, 250, 200], [400, 300, 200]]', '"source.brick_mm.1" = [300, 350]'])
def test_what_lies_within_a_swept_key_is_not_sampled(tmp_path: Path, sweep: str) -> None:
    # The swept list would take the place of every value that is drawn.
    width = '{ key = "source.brick_mm.1", distribution = "uniform", low = 200, high = 300 }'
    with pytest.raises(InputError, match=r"line \d+, sample.parameters.0.key: swept and sampled; found source.brick_mm.1"):
        read_case(case_file(tmp_path, f"{sampled(width)}[sweep]\n{sweep}\n"))


def test_a_key_in_another_unit_than_the_file_s_is_told_so(tmp_path: Path) -> None:
    length = '{ key = "source.length_mm", distribution = "uniform", low = 1000, high = 2000 }'
    with pytest.raises(InputError, match=r"a length given twice.*expected one of them\.$"):
        read_case(case_file(tmp_path, sampled(length)))
