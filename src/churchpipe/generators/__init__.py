"""Parameters in, a building out: one module a family of structures."""

from collections.abc import Callable
from dataclasses import dataclass

from churchpipe.generators.arch import ArchParameters, arch
from churchpipe.generators.box import BoxParameters, box
from churchpipe.generators.prototype import PrototypeParameters, prototype
from churchpipe.generators.wall import WallParameters, wall
from churchpipe.model.building import Building


@dataclass(frozen=True, slots=True)
class Generator:
    """A parameter class (a frozen dataclass in SI) and the function that takes its fields as keywords, and `name` and
    `materials` besides."""

    parameters: type
    build: Callable[..., Building]


GENERATORS = {
    "wall": Generator(WallParameters, wall),
    "arch": Generator(ArchParameters, arch),
    "prototype": Generator(PrototypeParameters, prototype),
    "box": Generator(BoxParameters, box),
}

__all__ = ["GENERATORS", "Generator", "arch", "box", "prototype", "wall"]
