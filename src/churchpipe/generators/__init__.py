"""Parameters in, a building out: one module a family of structures."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from churchpipe.bond.count import check_counts
from churchpipe.generators.apse import ApseParameters, apse
from churchpipe.generators.arch import ArchParameters, arch
from churchpipe.generators.arch_piers import ArchPiersParameters, arch_piers
from churchpipe.generators.box import BoxParameters, box
from churchpipe.generators.buttresses import with_buttresses
from churchpipe.generators.chapel import ChapelParameters, chapel
from churchpipe.generators.church import ChurchParameters, church
from churchpipe.generators.dome import DomeParameters, dome
from churchpipe.generators.fields import as_dataclass
from churchpipe.generators.house import HouseParameters, house
from churchpipe.generators.prototype import PrototypeParameters, prototype
from churchpipe.generators.tower import TowerParameters, tower
from churchpipe.generators.vault import VaultParameters, vault
from churchpipe.generators.wall import WallParameters, wall
from churchpipe.model.arguments import one_of
from churchpipe.model.building import MOST_STONES, Building
from churchpipe.model.buttress import Buttress
from churchpipe.model.materials import UnitWeight
from churchpipe.model.ring_beam import RingBeam


@dataclass(frozen=True, slots=True)
class Generator:
    """A parameter class (a frozen dataclass in SI) and the function that takes its fields as keywords, and `name` and
    `materials` besides."""

    parameters: type
    build: Callable[..., Building]


GENERATORS = {
    "wall": Generator(WallParameters, wall),
    "arch": Generator(ArchParameters, arch),
    "arch_piers": Generator(ArchPiersParameters, arch_piers),
    "prototype": Generator(PrototypeParameters, prototype),
    "box": Generator(BoxParameters, box),
    "house": Generator(HouseParameters, house),
    "tower": Generator(TowerParameters, tower),
    "apse": Generator(ApseParameters, apse),
    "chapel": Generator(ChapelParameters, chapel),
    "church": Generator(ChurchParameters, church),
    "vault": Generator(VaultParameters, vault),
    "dome": Generator(DomeParameters, dome),
}

__all__ = [
    "GENERATORS",
    "Generator",
    "apse",
    "arch",
    "arch_piers",
    "box",
    "chapel",
    "church",
    "dome",
    "generate",
    "house",
    "prototype",
    "tower",
    "vault",
    "wall",
    "with_buttresses",
]


def generate(
    generator: str,
    parameters: Mapping[str, Any],
    materials: Iterable[UnitWeight],
    name: str,
    *,
    ring_beams: Iterable[RingBeam] = (),
    buttresses: Iterable[Buttress] = (),
    most_stones: int = MOST_STONES,
) -> Building:
    """Return the building that a generator makes of its parameters, SI, with buttresses and ring beams.

    Raises
    ------
    InputError: no such generator, or what it cannot take.
    """
    one_of("generate: generator", generator, *GENERATORS)
    if generator == "dome":
        # Its stones are made one by one.
        check_counts(name, {name: as_dataclass(DomeParameters, "dome", parameters).stones_about}, most_stones)
    built = GENERATORS[generator].build(**parameters, name=name, materials=tuple(materials))
    return replace(with_buttresses(built, buttresses), ring_beams=tuple(ring_beams), most_stones=most_stones)
