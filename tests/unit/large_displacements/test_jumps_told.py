"""What is said of the steps of a path that are no equilibria."""

from types import SimpleNamespace
from typing import cast

import pytest

from churchpipe.large_displacements.record import Record

JUMPS = "on the structure jumps, or stones of it hang, with forces across open gaps"


@pytest.mark.parametrize(
    ("misfits", "told"),
    [
        ("..", []),
        (".x.xx", ["step 2 is no equilibrium: from 10 mm", "steps 4 to 5 are no equilibria: from 30 mm"]),
        (
            "x.x.x.xx",
            [
                "step 1 is no equilibrium: from 0 mm",
                "step 3 is no equilibrium: from 20 mm",
                "step 5 is no equilibrium: from 40 mm",
                "steps 7 to 8 are no equilibria: from 60 mm",
            ],
        ),
    ],
)
def test_steps_are_told_by_the_places_where_the_structure_jumps(misfits: str, told: list[str]) -> None:
    assert words(misfits) == [f"{each} {JUMPS}" for each in told]


def test_of_many_places_the_first_are_told_and_the_others_are_counted() -> None:
    said = words("x.x.x.xx.x...x")
    assert len(said) == 4
    assert said[3] == "from 60 mm on 4 more steps, in 3 places, are no equilibria, either"


def words(misfits: str) -> list[str]:
    """What is said of steps 10 mm apart, of which those marked x are no equilibria."""
    proofs = [(0.0, 0.0, 1.0 if mark == "x" else 0.0) for mark in misfits]
    path = SimpleNamespace(proofs=proofs, displacement=[0.01 * step for step in range(len(misfits))])
    return Record.jumps(cast("Record", path))
