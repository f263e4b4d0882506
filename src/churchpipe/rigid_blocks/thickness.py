"""The smallest thickness with which a structure carries its own weight, and how much thicker it is."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import get_args

import numpy as np

from churchpipe.conic.solve import Solve, solver_for
from churchpipe.errors import InputError
from churchpipe.model.arguments import check_call, check_kind, finite, one_of, positive
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.names import ContactModel
from churchpipe.model.progress import Progress
from churchpipe.rigid_blocks.associative import Standing, dead_load_analysis
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.limit import point_strength
from churchpipe.stones.contacts import find_contacts

# Where between its ends an interval is tried: at its middle, elsewhere where a solver decides nothing there.
_TRIED = (0.5, 0.4, 0.6, 0.3, 0.7)


@dataclass(frozen=True, slots=True)
class MinimumThickness:
    """Where the least thickness of a structure lies: between `falls`, the greatest found with which it falls (NaN where it stands
    with the least one tried), and `stands`, the least with which it stands, m, each proved by a mechanism or by forces. tried:
    number of thicknesses.
    """

    falls: float
    stands: float
    tried: int

    def safety(self, thickness: float) -> float:
        """Return the geometrical safety factor of a thickness, m, on the safe side: thickness over the least that stands."""
        return thickness / self.stands


def minimum_thickness(
    make: Callable[[float], Assemblage],
    low: float,
    high: float,
    friction: float = 0.6,
    cohesion: float = 0.0,
    *,
    tolerance: float = 1e-3,
    contact_model: ContactModel = "corners",
    solver: str = "auto",
    progress: Progress | None = None,
) -> MinimumThickness:
    """Return the least thickness with which a structure carries its own weight, by bisection.

    Whether it stands is proved each time: by forces within friction that balance the weight, or by a mechanism. An equilibrium is
    enough, so the flow rule does not enter.

    Parameters
    ----------
    make
        From a thickness, m, to the stones.
    low
        The least thickness tried, m.
    high
        The greatest thickness tried, m: the structure must stand with it.
    friction
        Coefficient.
    cohesion
        Pa.
    tolerance
        Of the interval, as a share of the thickness.
    contact_model
        As in `limit_analysis`.
    solver
        As in `limit_analysis`.
    progress
        Called with a text before each thickness.

    Raises
    ------
    InputError
        It falls with the greatest thickness, too; no solver decides whether it stands.
    """
    positive("minimum_thickness: low", low)
    positive("minimum_thickness: tolerance", tolerance)
    one_of("minimum_thickness: contact_model", contact_model, *get_args(ContactModel))
    if not finite("minimum_thickness: high", high) > low:
        raise InputError("minimum_thickness: high", "not above low", found=high, expected=f"> {low:g} m")
    check_call("minimum_thickness: make", make, needed=True)
    check_call("minimum_thickness: progress", progress)
    tried = 0

    def standing(thickness: float) -> Standing:
        nonlocal tried
        tried += 1
        if progress:
            progress(f"thickness {1e3 * thickness:.4g} mm", 0.0)
        stones = make(thickness)
        check_kind("minimum_thickness: make", stones, Assemblage)
        return own_weight(stones, find_contacts(stones), friction, cohesion, contact_model, solver)

    if (most := standing(high)) != "stable":
        problem = "it falls with the greatest thickness" if most == "unstable" else "nothing is decided at the greatest thickness"
        raise InputError("minimum_thickness: high", problem, found=f"{high:g} m", expected="a thickness with which it stands")
    if standing(low) == "stable":
        return MinimumThickness(np.nan, low, tried)
    falls, stands = low, high
    while stands - falls > tolerance * stands:
        for share in _TRIED:
            thickness = falls + share * (stands - falls)
            if (found := standing(thickness)) != "failed":
                falls, stands = (falls, thickness) if found == "stable" else (thickness, stands)
                break
        else:
            raise InputError(
                "minimum_thickness",
                "no solver decides whether it stands",
                found=f"between {falls:g} and {stands:g} m",
                expected="a wider tolerance",
            )
    return MinimumThickness(falls, stands, tried)


def own_weight(
    stones: Assemblage,
    contacts: Contacts,
    friction: float,
    cohesion: float = 0.0,
    contact_model: ContactModel = "corners",
    solver: str = "auto",
) -> Standing:
    """Say whether stones carry their own weight: "stable" or "unstable", each proved, or "failed"."""
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)), contact_model)
    solve: Solve = solver_for(balance.wrenches, solver)
    return dead_load_analysis(balance, point_strength(contacts, friction, cohesion, balance.force), solve)[0]
