"""What the report and the terminal say of the force with which a support resists."""

from dataclasses import replace

import numpy as np
import pytest

from churchpipe.io.movement_record import Shift
from churchpipe.model.quantities import as_read
from churchpipe.model.settlement import SettlementPath
from churchpipe.report.movements import movements_shown
from churchpipe.stones.contacts import find_contacts
from churchpipe.terminal import remarks
from records import WORDS, summary
from solids import box, on_ground

RECORD = {
    **{key: WORDS[key] for key in ("name", "variant", "direction", "friction", "message", "equilibrium_residual", "seconds")},
    "movement": "pier",
    "turns": False,
    "status": "converged",
    "ending": "unfinished",
    "movement_mm": [0.0],
    "steps": 1,
    "ultimate_mm": None,
    "largest_displacement_mm": 0.0,
    "fallen_stones": [],
    "cracks": [],
    "cone_violation": 0.0,
    "misfit": 0.0,
}


@pytest.mark.parametrize(
    ("least", "first", "report", "terminal"),
    [
        (8.0, 9.0, "must resist with 9 kN, without dilatancy;", "it must resist with 9 kN without dilatancy, 8 kN at the least"),
        (
            -2.0,
            -1.5,
            "must be pushed along with 2 kN at most (1.5 kN without",
            "it must be pushed with 2 kN at most (1.5 kN without",
        ),
        # Without dilatancy it resists, and the least of all equilibria pulls.
        (
            -2.0,
            1.5,
            "must resist with 1.5 kN, without dilatancy;",
            "it must resist with 1.5 kN without dilatancy, -2 kN at the least",
        ),
    ],
)
def test_a_support_resists_or_is_pushed(least: float, first: float, report: str, terminal: str) -> None:
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), unit_weight=2e4)
    still, none = np.zeros(1), np.zeros((1, stones.count, 3))
    path = SettlementPath(
        movement=still, reaction=np.array([1e3 * first]), least=1e3 * least, status="unfinished", position=stones.centroid[None],
        rotation=none, largest=still, residual=still, violation=still, misfit=still, dissipation=still,
    )  # fmt: skip
    record = as_read(Shift, RECORD | {"least_reaction_kN": least, "reaction_kN": [first]})
    (shown,) = movements_shown([(record, stones, find_contacts(stones), path)])
    assert report in shown.sentence
    assert ("is \u22122 kN, below zero" in shown.sentence) == (least < 0 < first)
    # Only what a support bears that gives way is known, which is little beside what it bears at rest.
    assert ("A support that does not give way may bear many times as much." in shown.sentence) == ("resist" in report)
    assert any(terminal in line for line in remarks(replace(summary(), movements=(record,))))


def test_cracks_of_stones_that_stand_in_no_wall_say_so() -> None:
    # Stones of a mesh have no walls.
    stones = on_ground(box((0, 1), (0, 1), (0, 1)), unit_weight=2e4)
    gone, none = np.array([0.0, 0.03]), np.zeros((2, stones.count, 3))
    path = SettlementPath(
        movement=gone, reaction=np.zeros(2), least=0.0, status="unfinished", position=np.stack([stones.centroid] * 2),
        rotation=none, largest=gone, residual=gone, violation=gone, misfit=gone, dissipation=gone,
    )  # fmt: skip
    moved = {"movement_mm": [0.0, 30.0], "reaction_kN": [0.0, 0.0], "least_reaction_kN": 0.0, "steps": 2}
    cracks = [{"wall": "", "opening_mm": 30.0, "slip_mm": 0.0}, {"wall": "nave", "opening_mm": 2.0, "slip_mm": 0.0}]
    record = as_read(Shift, RECORD | moved | {"cracks": cracks})
    (shown,) = movements_shown([(record, stones, find_contacts(stones), path)])
    assert [row[0] for row in shown.rows] == ["stones of no wall", "nave"]
