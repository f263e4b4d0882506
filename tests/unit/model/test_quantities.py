"""The range that a field declares is the one that its dataclass keeps, in a case file and in Python."""

import math
from typing import Any

import pytest

from churchpipe.code_check import Floor, Site
from churchpipe.config.tables import table_of
from churchpipe.errors import InputError
from churchpipe.model.carried import AreaLoad, LineLoad, PointLoad, Pressure
from churchpipe.model.diaphragm import Diaphragm
from churchpipe.model.fill import Fill
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.materials import Elastic, JointStrength
from churchpipe.model.quantities import declared, in_range, si
from churchpipe.model.tie_bars import TieBar
from churchpipe.spectrum import SiteSpectrum

ELASTIC: dict[str, Any] = {"block_modulus": 3e9, "block_poisson": 0.2, "joint_modulus": 3e8, "joint_poisson": 0.2}
RECORDS: list[tuple[type, dict[str, Any]]] = [
    (Site, {"ground_acceleration": 1.0, "soil_factor": 1.0}),
    (Floor, {"height": 1.0, "building_height": 9.0, "storeys": 2, "spectral_acceleration": 3.0}),
    (SiteSpectrum, {"amplification": 2.4, "start": 0.3}),
    (Elastic, ELASTIC | {"joint_thickness": 0.01}),
    (JointStrength, {"name": "m", "friction": 0.6}),
    (JointGroup, {"name": "g", "kind": "bed", "friction": 0.6}),
    (TieBar, {"name": "t", "start": (0, 0, 1), "end": (1, 0, 1), "area": 1e-4, "steel_strength": 2e8, "plate": (0.2, 0.2)}),
    (LineLoad, {"wall": "w", "dead": 1e3}),
    (PointLoad, {"wall": "w", "along": 1.0, "dead": 1e3}),
    (AreaLoad, {"walls": ("a", "b"), "dead": 1e3}),
    (Diaphragm, {"walls": ("a", "b"), "dead": 1e3, "spacing": 0.5, "friction": 0.3}),
    (Pressure, {"wall": "w", "toward": "+x", "unit_weight": 1e4, "top": 2.0}),
    (Fill, {"on": ("v",), "unit_weight": 1.5e4, "top": 2.0}),
]
LIMITS = [
    (kind, given, item, sign, limit)
    for kind, given in RECORDS
    for item in declared(kind).values()
    if item.quantity and not item.tables
    for sign, limit in ((-1, item.quantity.low), (1, item.quantity.high))
    if limit is not None
]


@pytest.mark.parametrize(
    ("kind", "given", "item", "sign", "limit"),
    LIMITS,
    ids=[f"{kind.__name__}.{item.name}{'<' if sign < 0 else '>'}" for kind, _, item, sign, _ in LIMITS],
)
def test_a_value_out_of_its_declared_range_is_refused(
    kind: type, given: dict[str, Any], item: Any, sign: int, limit: float
) -> None:
    out: Any = si(item.key, limit + sign * 0.5)
    pair = item.name in ("plate", "joist")
    with pytest.raises(InputError):
        kind(**given | {item.name: (out, out) if pair else out})


@pytest.mark.parametrize(("kind", "given"), RECORDS, ids=[kind.__name__ for kind, _ in RECORDS])
def test_values_in_their_ranges_are_taken(kind: type, given: dict[str, Any]) -> None:
    kind(**given)


@pytest.mark.parametrize("value", [-1.0, 0.5, 2.0, math.nan, "stiff", None])
def test_poissons_ratio_is_the_same_in_a_case_and_in_python(value: object) -> None:
    with pytest.raises(InputError, match=r"elastic\.block_nu: "):
        in_range(Elastic, "block_poisson", "elastic.block_nu", value)
    table = dict.fromkeys(("block_E_GPa", "joint_E_GPa", "joint_thickness_mm"), 1.0) | {"block_nu": value, "joint_nu": -0.1}
    with pytest.raises(ValueError, match="block_nu"):
        table_of(Elastic, "Elastic").model_validate(table)
    table_of(Elastic, "Elastic").model_validate(table | {"block_nu": -0.5})
    Elastic(**ELASTIC | {"block_poisson": -0.5, "joint_thickness": 0.01})


def test_a_range_is_told_in_the_unit_of_the_field() -> None:
    with pytest.raises(InputError, match=r"check: behaviour_factor: out of range; found 0\.5; expected >= 1"):
        Site(1.0, 1.0, behaviour_factor=0.5)
