"""Constants of the analyses without dilatancy are checked where they are made."""

from typing import Any

import pytest

from churchpipe.errors import InputError
from churchpipe.rigid_blocks.settings import PaperSettings, SchemeSettings


@pytest.mark.parametrize(
    ("kind", "values", "named"),
    [
        (SchemeSettings, {"momentum": 1.0}, "momentum"),
        (SchemeSettings, {"stage_b": 0}, "stage_b"),
        (SchemeSettings, {"bipotential_gap": float("nan")}, "bipotential_gap"),
        (SchemeSettings, {"more_cohesion": (1e-3, -1.0)}, "more_cohesion"),
        (PaperSettings, {"beta": 1.5}, "beta"),
        (PaperSettings, {"cohesion": 1e-6}, "cohesion"),
    ],
)
def test_a_constant_out_of_range_is_named(kind: type[Any], values: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=named):
        kind(**values)
