"""The record of a support that moves, declared once: SI in the file of its stage, the units of its keys in summary.json."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from churchpipe.io.records import Strength, common
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.materials import JointStrength
from churchpipe.model.quantities import Quantity
from churchpipe.model.results import Status
from churchpipe.model.settlement import SettlementPath

# How the path of a support ends, after the place where it does.
ENDINGS = {
    "collapsed": "the structure collapses",
    "free": "nothing rests on the support any more and the structure stands without it",
    "parted": "what rests on the support has parted from the structure, which stands without it",
    "unfinished": "it was not followed further",
    "unbounded": "the stones hold the support fast",
    "not-converged": "a step was not solved",
}


@dataclass(frozen=True, slots=True)
class Crack:
    """The widest opening and the largest slip of the joints of a wall."""

    wall: str
    opening: Annotated[float, Quantity("_mm")]
    slip: Annotated[float, Quantity("_mm")]

    @property
    def place(self) -> str:
        """The wall, or what stands in none, as stones of a mesh do."""
        return self.wall or "stones of no wall"


@dataclass(frozen=True, slots=True, kw_only=True)
class Movement:
    """A support that moves: how it is asked, and what came out. Either a `Shift` or a `Turn`, which give the units.

    name, variant, geometry, swept: its place in the plan of the run. movement: name of the support in the case. turns: whether it
    turns about an axis. reaction: at each of `displacement`; least_reaction: of all that equilibrium allows as the motion begins.
    ultimate: the displacement at which the structure collapses, NaN where it does not. cracks: of each wall at the end, the most
    cracked wall first. ending to misfit: see `SettlementPath`.
    """

    name: str
    variant: str | None
    movement: str
    direction: tuple[float, ...]
    turns: bool
    friction: Strength
    status: Status
    ending: str
    message: str
    least_reaction: float
    displacement: tuple[float, ...]
    reaction: tuple[float, ...]
    ultimate: float
    largest_displacement: Annotated[float, Quantity("_mm")]
    fallen_stones: tuple[str, ...]
    cracks: tuple[Crack, ...]
    steps: int
    equilibrium_residual: float
    cone_violation: float
    misfit: float
    seconds: float
    geometry: str | None = None
    swept: dict[str, Any] = field(default_factory=dict)

    @property
    def left_out(self) -> list[str]:
        """What of the case the movement does without, as its message says it: ties, cohesion."""
        return [remark for remark in self.message.split("; ") if remark.endswith("left out")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shift(Movement):
    """A support that moves along a line: m and N."""

    least_reaction: Annotated[float, Quantity("_kN")]
    displacement: Annotated[tuple[float, ...], Quantity(key="movement_mm")]
    reaction: Annotated[tuple[float, ...], Quantity("_kN")]
    ultimate: Annotated[float, Quantity("_mm")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn(Movement):
    """A support that turns about an axis: rad and Nm."""

    least_reaction: Annotated[float, Quantity("_kNm")]
    displacement: Annotated[tuple[float, ...], Quantity(key="movement_deg")]
    reaction: Annotated[tuple[float, ...], Quantity("_kNm")]
    ultimate: Annotated[float, Quantity("_deg")]


def movement_record(
    path: SettlementPath,
    settings: Mapping[str, Any],
    stones: Assemblage,
    materials: Sequence[JointStrength],
    cracks: Sequence[Crack],
    joints: Sequence[JointGroup] = (),
) -> Shift | Turn:
    """Return the record of a movement; settings: those of its stage. cracks: see `widest_cracks`."""
    turns = settings["about"] is not None
    remarks = ["cohesion, which opening joints lose, is left out"] if any(one.cohesion for one in (*materials, *joints)) else []
    remarks += ["ties are left out"] if settings["without_ties"] else []
    if any(material.compressive_strength is not None for material in materials):
        remarks.append("joints crush")
    if "contact_model" in settings:
        remarks.append("friction acts about the centres of pressure")
    status: Status = "converged" if path.proved and path.status != "not-converged" else "not-converged"
    if path.status in ("unstable", "failed") or (path.status == "unbounded" and not len(path.movement)):
        status = path.status
    return (Turn if turns else Shift)(
        name="",
        variant=None,
        movement=settings["name"],
        direction=tuple(settings["direction"]),
        turns=turns,
        friction=common({material.name: material.friction for material in materials}),
        status=status,
        ending=path.status,
        message="; ".join(text for text in (path.message, *remarks) if text),
        least_reaction=path.least,
        displacement=tuple(path.movement.tolist()),
        reaction=tuple(path.reaction.tolist()),
        ultimate=path.ultimate,
        largest_displacement=float(path.largest.max(initial=0.0)),
        fallen_stones=tuple(str(name) for part in path.fallen for name in stones.block_id[part.stones].tolist()),
        cracks=tuple(cracks),
        steps=len(path.movement),
        equilibrium_residual=float(path.residual.max(initial=0.0)),
        cone_violation=float(path.violation.max(initial=0.0)),
        misfit=float(path.misfit.max(initial=0.0)),
        seconds=round(path.seconds, 3),
    )


def widest_cracks(stones: Assemblage, contacts: Contacts, opening: FloatArray, slip: FloatArray) -> list[Crack]:
    """Return the widest opening and slip (ni,) m of each wall's joints, the most cracked wall first.

    A joint between two walls counts for both.
    """
    out: list[Crack] = []
    for name in np.unique(stones.panel[~stones.fixed]).tolist():
        # Ground may have the name of a wall, or none as stones of no wall have none.
        mine = ((stones.panel == name) & ~stones.fixed)[contacts.blocks].any(axis=1)
        if mine.any():
            out.append(Crack(str(name), float(opening[mine].max()), float(slip[mine].max())))
    return sorted(out, key=lambda crack: -crack.opening)
