"""What a support that moves does to a structure, in the words and units of summary.json."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from churchpipe.model.arrays import FloatArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.materials import JointStrength
from churchpipe.model.settlement import SettlementPath


def movement_words(
    path: SettlementPath,
    settings: Mapping[str, Any],
    stones: Assemblage,
    materials: Sequence[JointStrength],
    cracks: Sequence[dict[str, Any]],
) -> dict[str, Any]:
    """Return the record of a movement; settings: those of its stage. cracks: see `widest_cracks`."""
    turns = settings["about"] is not None
    length, unit, force = ("deg", float(np.degrees(1.0)), "kNm") if turns else ("mm", 1e3, "kN")
    bad = path.status in ("unstable", "failed") or (path.status == "unbounded" and not len(path.movement))
    friction = {material.friction for material in materials}
    lost = ["cohesion, which opening joints lose, is left out"] if any(material.cohesion for material in materials) else []
    lost += ["ties are left out"] if settings["without_ties"] else []
    crushing = any(material.compressive_strength is not None for material in materials)
    lost += ["nothing crushes as a support moves: the compressive strength is left out"] if crushing else []
    return {
        "movement": settings["name"],
        "direction": list(settings["direction"]),
        "turns": turns,
        "friction": friction.pop() if len(friction) == 1 else {material.name: material.friction for material in materials},
        "status": path.status if bad else "converged" if path.proved and path.status != "not-converged" else "not-converged",
        "ending": path.status,
        "message": "; ".join(said for said in (path.message, *lost) if said),
        f"least_reaction_{force}": path.least / 1e3,
        f"movement_{length}": (unit * path.movement).tolist(),
        f"reaction_{force}": (path.reaction / 1e3).tolist(),
        f"ultimate_{length}": unit * path.ultimate,
        "largest_displacement_mm": 1e3 * float(path.largest.max(initial=0.0)),
        "fallen_stones": [name for part in path.fallen for name in stones.block_id[part.stones].tolist()],
        "cracks": list(cracks),
        "steps": len(path.movement),
        "equilibrium_residual": float(path.residual.max(initial=0.0)),
        "cone_violation": float(path.violation.max(initial=0.0)),
        "misfit": float(path.misfit.max(initial=0.0)),
        "seconds": round(path.seconds, 3),
    }


def widest_cracks(stones: Assemblage, contacts: Contacts, opening: FloatArray, slip: FloatArray) -> list[dict[str, Any]]:
    """Return the widest opening and slip (ni,) m of each wall's joints, in mm, the most cracked wall first.

    A joint between two walls counts for both.
    """
    walls: list[NameArray] = [stones.panel[side] for side in contacts.blocks.T]
    ground = stones.fixed[contacts.blocks].all(axis=1)
    out: list[dict[str, Any]] = []
    for name in np.unique(stones.panel[~stones.fixed]).tolist():
        mine = ((walls[0] == name) | (walls[1] == name)) & ~ground
        if mine.any():
            widest = {"opening_mm": 1e3 * float(opening[mine].max()), "slip_mm": 1e3 * float(slip[mine].max())}
            out.append({"wall": str(name), **widest})
    return sorted(out, key=lambda wall: -wall["opening_mm"])
