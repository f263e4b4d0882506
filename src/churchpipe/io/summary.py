"""summary.json, declared once: what a run found, for people and programs."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from churchpipe.errors import InputError
from churchpipe.io.atomic import read_json, write_json
from churchpipe.io.movement_record import Shift, Turn
from churchpipe.io.records import Analysis
from churchpipe.io.sample_study import SampleStudy
from churchpipe.match import Match
from churchpipe.model.names import RIGID_BLOCKS, SHELL
from churchpipe.model.quantities import Quantity, as_read, as_written, required
from churchpipe.stones.account import JointTolerances, NearMissAccount

_REMEDY = "Delete the file and run the case again."


@dataclass(frozen=True, slots=True, kw_only=True)
class Size:
    """The size of an assemblage, its vaults, and its joints; ground is no block and weighs nothing."""

    blocks: int
    interfaces: int
    contact_points: int
    weight: Annotated[float, Quantity("_kN")]
    vaults: tuple[str, ...] = ()
    near_misses: NearMissAccount
    joints: JointTolerances


@dataclass(frozen=True, slots=True, kw_only=True)
class ShellSize:
    """The size of a mesh; no elements where there is none."""

    elements: int
    nodes: int
    element_size: Annotated[float, Quantity("_mm")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh(ShellSize):
    """The same with the geometry that it belongs to and its gate."""

    geometry: str
    match: Match


@dataclass(frozen=True, slots=True)
class Pair:
    """Analyses of both models, by name, that answer one question; ratio: shell over blocks; overlap: see `compare.overlap`."""

    load: str
    blocks: Annotated[str, Quantity(key=RIGID_BLOCKS)]
    shell: Annotated[str, Quantity(key=SHELL)]
    ratio: float | None
    overlap: float | None = None


@dataclass(frozen=True, slots=True)
class ContactModels:
    """Load factors of both contact models of a joint under one load, their difference over the first, the names of both
    analyses, and what to make of it; variant, swept: those of the analyses."""

    load: str
    flow: str
    corners: float
    torsion: float
    difference: float
    analyses: tuple[str, ...]
    sentence: str = ""
    variant: str | None = None
    swept: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class VariantResult:
    """A variant of the building, None the building as it is: its geometry, its cost figures, and its analyses by name."""

    name: str | None
    geometry: str
    cost: dict[str, Any]
    analyses: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary(Size):
    """What a run found. Size, shell and match are those of the first geometry and of its first mesh.

    geometries, shells: all of them by name, where there are several. analyses: those that answer one question side by side, the
    careful one first. comparison: of both models. guidance: which of several load factors to use, and why they differ.
    questions: about doubtful input.
    """

    case: str
    shell: ShellSize | None = None
    match: Match | None = None
    geometries: dict[str, Size] = field(default_factory=dict)
    shells: dict[str, Mesh] = field(default_factory=dict)
    analyses: tuple[Analysis, ...]
    comparison: tuple[Pair, ...] = ()
    variants: tuple[VariantResult, ...] = ()
    movements: tuple[Shift | Turn, ...] = ()
    contact_models: tuple[ContactModels, ...] = ()
    guidance: tuple[str, ...]
    questions: tuple[str, ...]
    uncertainty: SampleStudy | None = None

    @property
    def sizes(self) -> dict[str, Size]:
        """All geometries by name; "" where there is one alone."""
        return self.geometries or {"": self}

    @property
    def gates(self) -> dict[str, Match]:
        """The gates of all meshes by name; "" where there is one alone."""
        return {name: mesh.match for name, mesh in self.shells.items()} or ({"": self.match} if self.match else {})


def write_summary(path: str | Path, summary: Summary) -> None:
    """Write summary.json: in the units of its keys, without what is not known."""
    write_json(path, {"case": summary.case} | as_written(summary, defaults=False))


def read_summary(path: str | Path) -> Summary:
    """Read summary.json.

    Raises
    ------
    InputError: the file is missing, not JSON, or not as this version writes it.
    """
    stored = read_json(path)
    missing = [key for key in required(Summary) if not isinstance(stored, dict) or key not in stored]
    if missing:
        raise InputError(str(path), "not a summary of a run", found=f"no {missing[0]}", remedy=_REMEDY)
    try:
        return as_read(Summary, stored)
    except (TypeError, AttributeError) as error:
        raise InputError(str(path), "a summary of another version", found=error, remedy=_REMEDY) from error
