"""Parameters of the generators in Python: what is wrong is named where it is given, and what is given counts."""

from collections.abc import Callable
from dataclasses import MISSING, Field, fields, replace
from typing import Any, get_type_hints

import numpy as np
import pytest

import churchpipe as cp
from churchpipe import generators
from churchpipe.errors import InputError
from churchpipe.generators.arched import ArchedOpening
from churchpipe.generators.openings import RectangularOpening
from churchpipe.model import quantities
from churchpipe.model.building import BondRegion, Opening, Panel, Part, PlaneChart, UnitCell
from churchpipe.model.quantities import Quantity

nan = float("nan")
WALL: dict[str, Any] = {"length": 1.2, "brick": (0.4, 0.25, 0.2), "courses": 3}
ARCH: dict[str, Any] = {"mean_radius": 1.0, "thickness": 0.3, "width": 0.5, "voussoirs": 7}
PROTOTYPE: dict[str, Any] = {"brick": (0.4, 0.2, 0.2), "partition_length": 1.0, "courses": 4, "main_wall_bricks": 5}
TOWER: dict[str, Any] = {"course": 0.25, "stone_length": 0.5, "width": 3.0, "depth": 3.2, "height": 4.0, "thickness": 0.6}
DOOR: dict[str, Any] = {"name": "d", "wall": "front", "centre": 0.0, "width": 0.8, "springing": 1.5, "voussoirs": 7, "depth": 0.3}
CHURCH: dict[str, Any] = {"course": 0.25, "stone_length": 0.5}
NAVE: dict[str, Any] = {"width": 3.0, "length": 5.0, "height": 3.0, "thickness": 0.6}
TUFF = cp.Material("default", 18e3, 0.6)
ONE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
CELL = UnitCell(0.2, 0.4)


def declared(kind: type) -> list[tuple[Field[Any], Quantity]]:
    """Return the fields of a parameter class that are one number, and what they are declared as."""
    hints = get_type_hints(kind, include_extras=True)
    known = [(item, quantities.declared(kind)[item.name].quantity) for item in fields(kind)]
    several = [name for name, hint in hints.items() if any(word in str(hint) for word in ("tuple[", "Sequence["))]
    return [(item, quantity) for item, quantity in known if quantity is not None and item.name not in several]


def door(**changed: Any) -> cp.Building:
    return generators.tower(**TOWER, openings=[DOOR | changed])


def panel(**changed: Any) -> Panel:
    region = BondRegion("bond", ONE, "running", CELL)
    return Panel(
        **{"name": "p", "chart": PlaneChart([0, 0, 0], [1, 0, 0]), "outline": ONE, "thickness": 0.2, "regions": [region]}
        | changed
    )


CALLS: list[tuple[Callable[[], object], str]] = [
    (lambda: generators.wall(), r"wall\.length: missing"),
    (lambda: generators.wall(**WALL, lenght=3), r"wall\.lenght: unknown key; expected length, brick"),
    (lambda: generators.wall(**WALL | {"length": "1"}), r"wall\.length: not a number; found '1'"),
    (lambda: generators.wall(**WALL | {"courses": 2.5}), r"wall\.courses: out of range; found 2\.5; expected a whole number"),
    (lambda: generators.wall(**WALL | {"brick": None}), r"wall\.brick: not a list; found None"),
    (lambda: generators.wall(**WALL | {"brick": (0.4, 0, 0.2)}), r"wall\.brick\[1\]: out of range; found 0"),
    (lambda: generators.wall(**WALL | {"brick": (0.4, 0.2)}), r"wall\.brick: wrong number of dimensions; found 2"),
    (lambda: generators.wall(**WALL, joints="best"), r'wall\.joints: unknown value; found best; expected "grid" or "bay"'),
    (lambda: generators.wall(**WALL, pattern="opus"), r'wall\.pattern: unknown value; found opus; expected "running"'),
    (lambda: generators.arch(**ARCH, half_angle=3), r"arch\.half_angle: out of range; found 3"),
    (lambda: generators.church(**CHURCH, nave=NAVE | {"width": 0}), r"church\.nave\.width: out of range; found 0"),
    (lambda: generators.wall(**WALL, openings=3), r"wall\.openings: not a list; found 3"),
    (lambda: generators.wall(**WALL, openings=[None]), r"wall\.openings\[0\]: wrong kind; found None; .* mapping of its fields"),
    (lambda: generators.wall(**WALL, materials=()), r"wall\.materials: no material"),
    (lambda: generators.wall(**WALL, materials=TUFF), r"wall\.materials: wrong kind; found Material; expected a list"),
    (lambda: generators.wall(**WALL, materials=[None]), r"wall\.materials\[0\]: wrong kind; found None"),
    (lambda: generators.arch(**ARCH | {"mean_radius": 1e300}), r"arch\.mean_radius: out of range; .* at most 100000 m"),
    (lambda: generators.arch(**ARCH | {"thickness": 1e-300}), r"arch\.thickness: lost to rounding"),
    (lambda: generators.arch(**ARCH, half_angle="1"), r"arch\.half_angle: not a number"),
    (lambda: generators.prototype(**PROTOTYPE, partitions_x=""), r"prototype\.partitions_x: not a list; found ''"),
    (lambda: generators.prototype(**PROTOTYPE, partitions_x=[True]), r"prototype\.partitions_x\[0\]: not a number; found True"),
    (lambda: door(centre=[]), r"opening d: centre: the opening is nowhere"),
    (lambda: door(wall=()), r"opening d: wall: the opening is nowhere"),
    (lambda: door(wall=3), r"opening d: wall: not a list; found 3"),
    (lambda: door(rise="high"), r"opening d: rise: not a number"),
    (lambda: door(voussoirs=7.5), r"opening d: voussoirs: out of range; found 7\.5"),
    (lambda: door(voussoirs=1_000_000), r"opening d: voussoirs: out of range; found 1000000; expected .* from 2 to 1000"),
    (lambda: generators.arch(**ARCH | {"voussoirs": 1_000_000}), r"arch\.voussoirs: out of range; found 1000000"),
    (lambda: door(name=3), r"opening: name: no name; found 3"),
    (lambda: door(width=1e-9), r"opening d: width: lost to rounding"),
    (lambda: generators.church(**CHURCH, nave=None), r"church\.nave: wrong kind; found None; expected Nave, or a mapping"),
    (lambda: generators.church(**CHURCH, nave=NAVE | {"width": np.float32(nan)}), r"church\.nave\.width: out of range"),
    (lambda: generators.church(**CHURCH, nave=NAVE, apses=[None]), r"church\.apses\[0\]: wrong kind"),
    (lambda: panel(regions=[BondRegion("a", ONE, "running", CELL)] * 2), r"wall p\.regions: names are not unique; found a, a"),
    (lambda: panel(openings=[Opening("o", ONE + 5)]), r"wall p: opening o: lies beside the wall; found \[5\.0, 5\.0\]"),
    (lambda: panel(parts=[Part("left", ONE - 1)]), r"wall p: part left: lies beside the wall"),
    (lambda: Opening("o", ONE[:2]), r"Opening o\.outline: no polygon; found 2 corners"),
]


@pytest.mark.parametrize(("call", "said"), CALLS)
def test_parameters(call: Callable[[], object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        call()


RANGES = [
    (name, item.name, quantity)
    for name in ("wall", "arch", "arch_piers", "prototype", "box", "house", "tower", "apse", "chapel", "church")
    for item, quantity in declared(generators.GENERATORS[name].parameters)
    if quantity.low is not None
]


@pytest.mark.parametrize(("name", "key", "quantity"), RANGES)
def test_every_declared_range_holds_in_python(name: str, key: str, quantity: Quantity) -> None:
    kind = generators.GENERATORS[name].parameters
    sound = {item.name: 1 for item, _ in declared(kind)} | {"brick": (1, 1, 1), "partitions_x": (), "backfill": None}
    needed = {item.name for item in fields(kind) if item.default is MISSING and item.default_factory is MISSING}
    given = {item: sound.get(item, {}) for item in needed} | {key: quantity.low - (not quantity.above)}
    with pytest.raises(InputError, match=rf"^{name}\.{key}: out of range; found"):
        kind(**given)


@pytest.mark.parametrize(
    ("second", "overlap"),
    [
        ({"start": 0.6, "width": 0.4, "height_courses": 2}, True),
        ({"start": 0.9, "width": 0.2, "height_courses": 1}, True),
        ({"start": 0.9, "width": 0.2, "height_courses": 1, "sill_courses": 3}, False),
        ({"start": 1.2, "width": 0.2, "height_courses": 2}, False),
    ],
)
def test_openings_of_a_wall_do_not_overlap(second: dict[str, Any], overlap: bool) -> None:
    # The lintel of the first reaches to 1 m.
    first = RectangularOpening(start=0.4, width=0.4, height_courses=2, lintel_bearing=0.2)
    given = WALL | {"length": 2.0, "courses": 6, "openings": [first, second]}
    if not overlap:
        assert len(generators.wall(**given).panels[0].openings) == 2
        return
    with pytest.raises(InputError, match=r"wall\.openings\.1: openings overlap; found one from 0\.4 to 0\.8 m, one from"):
        generators.wall(**given)


def test_iterators_arrays_and_whole_floats_count_like_lists_and_numbers() -> None:
    expected = cp.derive_blocks(generators.prototype(**PROTOTYPE, partitions_x=[0, 1.8]))
    for places in (iter([0, 1.8]), np.array([0, 1.8])):
        assert cp.derive_blocks(generators.prototype(**PROTOTYPE, partitions_x=places)).count == expected.count
    window = {"start": 0.4, "width": 0.4, "height_courses": 1}
    room = {"length": 1.6, "width": 1.6, "courses": 3, "brick": (0.4, 0.2, 0.2)}
    once, listed = (generators.box(**room, openings_x=given) for given in (iter([window]), [window]))
    assert [len(p.openings) for p in once.panels] == [len(p.openings) for p in listed.panels] == [1, 1, 0, 0]
    assert ArchedOpening(**DOOR | {"centre": np.array([-0.5, 0.5])}).centres == (-0.5, 0.5)
    pieces = generators.arch(**ARCH | {"voussoirs": 7.0}).panels[0].regions[0].pieces
    assert (pieces, type(pieces)) == (7, int)


def test_contacts_of_other_stones_are_refused() -> None:
    stones, other = (cp.derive_blocks(generators.wall(**WALL | {"length": length})) for length in (1.2, 1.6))
    contacts, others = cp.find_contacts(stones), cp.find_contacts(other)
    push = cp.LoadCase([1, 0, 0])
    with pytest.raises(InputError, match=r"made for another assemblage; found a contact of .* beside one"):
        cp.limit_analysis(other, contacts, push, friction=0.6)
    with pytest.raises(InputError, match="contacts: made for another assemblage"):
        cp.joint_strength(stones, others, [TUFF])
    with pytest.raises(InputError, match="contacts: made for another assemblage"):
        cp.check_soundness(stones, others)
    shell = cp.derive_shell(generators.wall(**WALL), 0.4)
    with pytest.raises(InputError, match="contacts: made for another assemblage"):
        cp.match_models(stones, others, shell)


def test_openings_know_their_rings() -> None:
    (front,) = (wall for wall in door(shape="circle", voussoirs=8, springing=2.0).panels if wall.name == "front")
    assert [(opening.kind, opening.rings) for opening in front.openings] == [("arched", ("d-ring-1", "d-ring-2"))]
    with pytest.raises(InputError, match=r"wall front: opening d\.rings: no such ring; found d-ring-2; expected d-ring-1"):
        replace(front, regions=front.regions[:-1])
