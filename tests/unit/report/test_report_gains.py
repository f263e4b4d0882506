"""What more mortar or weight would do, as a table."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from churchpipe.report.applied import gain_table


def row(with_cohesion: float, weight: float = 2e-9) -> Any:
    gain = SimpleNamespace(panel="nave", cohesion=4e-6, with_cohesion=with_cohesion, weight=weight, with_weight=np.nan)
    return SimpleNamespace(label="load +x", record=SimpleNamespace(gains=[gain], load_factor=0.2))


def test_columns_of_new_analyses_stand_only_where_there_are_some() -> None:
    titles, rows = gain_table([row(np.nan)], 5e6)
    assert titles == ["Analysis", "Wall", "10 kPa of cohesion", "10 kN of weight"]
    assert rows == [["load +x", "nave", "+0.0400", "+0.00002"]]
    titles, rows = gain_table([row(0.23)], 5e6)
    assert titles == ["Analysis", "Wall", "10 kPa of cohesion", "analysed", "10 kN of weight"]
    assert rows == [["load +x", "nave", "+0.0400", "+0.03000", "+0.00002"]]
    assert gain_table([], 5e6)[1] == []


def test_a_small_model_is_not_loaded_with_more_than_it_weighs() -> None:
    titles, rows = gain_table([row(np.nan)], 988.0)
    assert titles[-1] == "1 N of weight"
    assert rows[0][-1] == "+0.00000"
    assert gain_table([row(np.nan)], 1.2e5)[0][-1] == "1 kN of weight"


def test_a_loss_has_the_minus_sign_of_the_report() -> None:
    assert gain_table([row(0.19, weight=-2e-9)], 5e6)[1] == [["load +x", "nave", "+0.0400", "\u22120.01000", "\u22120.00002"]]
