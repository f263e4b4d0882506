"""The least and the greatest thrust of a structure on one of its supports."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.large_displacements.settlement import least_step, settlement_model
from churchpipe.model.arrays import floats
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.names import ContactModel


@dataclass(frozen=True, slots=True)
class ThrustRange:
    """The thrusts of a structure on a support along a direction, among all its equilibria: least, greatest, N (infinite where
    friction wedges the stones); bound_gap, the larger difference between static and kinematic bound, over the thrust.
    """

    least: float
    greatest: float
    bound_gap: float


def thrust_range(
    stones: Assemblage,
    contacts: Contacts,
    support: npt.ArrayLike,
    direction: npt.ArrayLike,
    friction: npt.ArrayLike = 0.6,
    *,
    dead: LoadCase | npt.ArrayLike | None = None,
    contact_model: ContactModel = "corners",
    compressive_strength: npt.ArrayLike | None = None,
    solver: str = "auto",
) -> ThrustRange:
    """Return the least and the greatest thrust of a structure on a support, along a direction.

    The least thrust is what remains as the support gives way, the greatest what can be raised by pushing it back. Between both
    lies every equilibrium: how near they are says how much the structure can give, and how much it depends on its supports.

    Parameters
    ----------
    stones
        Of the whole structure.
    contacts
        Their interfaces.
    support
        Indices of fixed stones, as one body.
    direction
        Of the thrust on the support, such as outwards.
    friction
        Coefficient, a number or one an interface.
    dead
        As in `settlement_analysis`.
    contact_model, compressive_strength, solver
        As in `settlement_analysis`.

    Raises
    ------
    InputError
        A support that is not there, not fixed or bears nothing, no direction; a structure that does not stand; a solver that
        finds nothing.
    """
    along = floats("thrust_range: direction", direction, (3,))
    found: list[float] = []
    gaps: list[float] = []
    for sign in (1.0, -1.0):
        model, state, status, message = settlement_model(
            stones, contacts, (support, sign * along, None), friction, dead, None, solver, contact_model, compressive_strength
        )
        if status != "stable":
            raise InputError(
                "thrust_range", "the structure does not stand", found=message, expected="one that carries its weight"
            )
        answer = least_step(model, state).answer
        if answer.outcome == "unbounded":
            # Friction wedges the stones: the support may push as hard as it likes.
            found.append(-np.inf)
            gaps.append(0.0)
            continue
        if answer.outcome != "solved":
            raise InputError("thrust_range", "no solver finds the thrust", found=answer.message, expected="another solver")
        # The load factor is of a push along the movement; the support resists it.
        found.append(-answer.load_factor * model.force)
        gaps.append(float(answer.bound_gap))
    return ThrustRange(found[0], -found[1], max(gaps))
