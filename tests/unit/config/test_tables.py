"""A key is declared once, on the field of the dataclass that keeps it: its table, its reading and its questions follow."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import pytest
from pydantic import ValidationError

from case_texts import WALL, case_file
from churchpipe.config.case import read_case
from churchpipe.config.tables import record, table_of
from churchpipe.errors import InputError
from churchpipe.model.quantities import Length, Place, Quantity, as_written, declared


@dataclass(frozen=True, slots=True)
class Plate:
    """An anchor plate."""

    side: Annotated[Length, "Side of the plate."] = 0.2


@dataclass(frozen=True, slots=True)
class Rod:
    """A bar.

    Only its first paragraph stands in the reference.
    """

    strength: Annotated[float, Quantity("_kPa", 0.0, high=5e5), "Yield stress."]
    start: Annotated[Place | None, "Where it begins."] = None
    plates: Annotated[tuple[Plate, ...], "At its ends."] = ()
    pull: Annotated[float, Quantity("_g", key="pull_g", other="pull_m_s2"), "How it is pulled."] = 0.0

    def __post_init__(self) -> None:
        if self.strength == 7e3:
            raise InputError("rod: strength", "an unlucky number", found=self.strength)


ROD = table_of(Rod, "Rod")


def read(**table: Any) -> Rod:
    return record(Rod, ROD.model_validate(table).model_dump(exclude_unset=True), "case.toml: rods.0")


def test_a_table_is_read_into_its_dataclass_in_si_and_written_again() -> None:
    table: dict[str, Any] = {
        "strength_kPa": 235.0,
        "start_mm": [0, 250.0, 3000.0],
        "plates": [{"side_mm": 300.0}, {}],
        "pull_g": 2,
    }
    rod = read(**table)
    assert rod == Rod(235e3, (0.0, 0.25, 3.0), (Plate(0.3), Plate()), 2 * 9.80665)
    assert as_written(rod) == table | {"plates": [{"side_mm": 300.0}, {"side_mm": 200.0}], "pull_g": 2.0}
    assert as_written(rod, defaults=False)["plates"] == [{"side_mm": 300.0}, {}]
    assert read(strength_kPa=1, pull_m_s2=3).pull == 3


def test_the_schema_says_what_is_declared() -> None:
    schema = ROD.model_json_schema()
    strength = schema["properties"]["strength_kPa"]
    assert (strength["description"], strength["minimum"], strength["maximum"]) == ("Yield stress.", 0, 5e5)
    assert schema["description"] == "A bar."
    assert schema["$defs"]["Plate"]["properties"]["side_mm"]["default"] == 200
    assert [item.key for item in declared(Rod).values()] == ["strength_kPa", "start_mm", "plates", "pull_g"]
    for wrong in ({"strength_kPa": 6e5}, {"strength": 1}, {"strength_kPa": 1, "start_mm": [1, 2]}, {}):
        with pytest.raises(ValidationError):
            ROD.model_validate(wrong)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"strength_kPa": 7, "pull_g": 1}, r"case\.toml: rods\.0\.strength_kPa: an unlucky number"),
        ({"strength_kPa": 1}, r"rods\.0: missing key; expected either pull_m_s2 or pull_g"),
        ({"strength_kPa": 1, "pull_g": 1, "pull_m_s2": 1}, r"rods\.0: two values for one pull"),
    ],
)
def test_an_error_names_the_key(table: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        read(**table)


WORDS = [
    ("line_loads", "dead_kN_m = 1", "no place; found neither; expected a wall, or between_m."),
    ("line_loads", 'wall = "wall"', "no load; expected dead_kN_m, thrust_kN_m or seismic_mass_kN_m other than zero."),
    (
        "line_loads",
        'wall = "wall"\nthrust_kN_m = 1',
        "a thrust without a direction; expected toward, a level vector such as [1, 0, 0].",
    ),
    ("line_loads", 'wall = "wall"\ndead_kN_m = 1\nfrom_m = 5\nto_m = 2', "found from 5 m to 2 m; expected from_m < to_m."),
    (
        "line_loads",
        'wall = "wall"\nthrust_kN_m = 1\ntoward = "-x"',
        "found '-x'; expected a list in [brackets], such as [0, -1, 0].",
    ),
    ("area_loads", 'walls = ["wall", "other"]', "no load; expected dead_kN_m2 or seismic_mass_kN_m2 other than zero."),
    (
        "line_loads",
        "between_m = [[0, 0, 1], [1, 0, 1]]\ndead_kN_m = 1\nfrom_m = 1\nto_m = 2",
        "a place on a wall, without a wall; expected between_m alone, or a wall beside from_m, to_m.",
    ),
    (
        "area_loads",
        'walls = ["a", "b", "c", "d"]\ndead_kN_m2 = 1\nfrom_m = 1',
        "a part of a floor between four walls; expected two walls beside from_m and to_m, or neither.",
    ),
    (
        "ties",
        'name = "t"\nstart.at_m = [0, 0, 0]\nend.at_m = [1, 0, 0]\narea_mm2 = 4\nsteel_strength_MPa=9\nbearing_strength_MPa = 1',
        "no plate; found a strength of the masonry under it; expected plate_mm, its width and height.",
    ),
    ("point_loads", 'wall = "wall"\ndead_kN = 1', "no place on the wall; expected along_m."),
    ("joints", 'name = "j"\nkind = "base"', "no strength; expected friction, cohesion_kPa or both."),
    ("joints", 'name = "j"\nabove_m = 3\nbelow_m = 1\nfriction = 0.3', "expected above_m < below_m."),
    (
        "ties",
        'name = "t"\nstart = {}\nend = {}\narea_mm2 = 400\nsteel_strength_MPa = 235',
        "no place; expected wall, along_m and height_m; or at_m, a point.",
    ),
]


@pytest.mark.parametrize(("key", "table", "said"), WORDS, ids=[said[:30] for _, _, said in WORDS])
def test_what_is_expected_is_named_by_the_keys_of_the_file(key: str, table: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as raised:
        read_case(case_file(tmp_path, f"{WALL}\n[[{key}]]\n{table}\n"))
    assert said in str(raised.value)


def test_a_table_where_several_are_meant_is_told_its_brackets(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line_loads: wrong value; .*expected a list of tables, each under \[\[line_loads\]\]"):
        read_case(case_file(tmp_path, f'{WALL}\n[line_loads]\nwall = "wall"\ndead_kN_m = 1\n'))
