"""Many limit analyses of one structure: what they share is made once."""

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np
import numpy.typing as npt

from churchpipe.conic.solve import Solve, solver_for
from churchpipe.conic.wrenches import Wrenches
from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, listed, one_of
from churchpipe.model.arrays import FloatArray, array_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.loads import LoadCase
from churchpipe.model.names import ContactModel, Flow
from churchpipe.model.results import LimitState
from churchpipe.model.ties import Tie
from churchpipe.rigid_blocks.certificate import Strength
from churchpipe.rigid_blocks.equilibrium import check_connected, equilibrium
from churchpipe.rigid_blocks.limit import analysed, point_strength
from churchpipe.rigid_blocks.sliding import SlidingOptions
from churchpipe.rigid_blocks.ties import with_ties


class LimitStudy:
    """A structure whose friction, cohesion, load or strength of ties is varied.

    The balance of its stones and the order in which its matrix is factorised are found once. That the weight is carried is not
    asked again where weaker joints have carried it.

    Parameters
    ----------
    stones, contacts
        The structure and its joints, from `find_contacts`.
    ties
        Bars that pull stones together.
    contact_model, solver
        As in `limit_analysis`.

    Raises
    ------
    InputError
        Arguments of the wrong kind; contacts of other stones.
    """

    def __init__(
        self,
        stones: Assemblage,
        contacts: Contacts,
        *,
        ties: Sequence[Tie] = (),
        contact_model: ContactModel = "corners",
        solver: str = "auto",
    ) -> None:
        check_kind("LimitStudy: stones", stones, Assemblage)
        check_kind("LimitStudy: contacts", contacts, Contacts)
        check_contacts_of(stones, contacts)
        one_of("LimitStudy: contact_model", contact_model, "corners", "torsion")
        self._stones, self._contacts, self._solver = stones, contacts, solver
        self._model: ContactModel = contact_model
        self._ties = listed("LimitStudy: ties", ties, Tie)
        self._shared: tuple[Wrenches, Solve] | None = None
        # Dead loads with strengths that carry them.
        self._standing: list[tuple[FloatArray, Strength]] = []

    def limit_analysis(
        self,
        load: LoadCase,
        friction: npt.ArrayLike = 0.6,
        cohesion: npt.ArrayLike = 0.0,
        *,
        tie_strengths: npt.ArrayLike | None = None,
        flow: Flow = "associative",
    ) -> LimitState:
        """Return what `limit_analysis` returns.

        Parameters
        ----------
        load
            What the load factor multiplies.
        friction, cohesion
            Scalar or one an interface (ni,); cohesion in Pa.
        tie_strengths
            N, one a tie (nt,); 0 for a tie that is not there. None: as the ties say.
        flow
            "associative" or "non-associative".

        Raises
        ------
        InputError
            Arguments out of range, stones without a path to a support.
        """
        check_kind("LimitStudy: load", load, LoadCase)
        one_of("LimitStudy: flow", flow, "associative", "non-associative")
        if flow == "non-associative" and self._model == "torsion":
            # Friction then acts about the centres of pressure, which are another balance in each analysis.
            raise InputError(
                "LimitStudy: flow",
                'no study without dilatancy with contact_model = "torsion"',
                found=flow,
                expected='"associative", or contact_model = "corners"',
                remedy="limit_analysis makes such an analysis.",
            )
        begin = perf_counter()
        balance = equilibrium(self._stones, self._contacts, load, self._model)
        strength = point_strength(self._contacts, friction, cohesion, balance.force)
        balance, strength = with_ties(balance, strength, self._stones, self._ties)
        if tie_strengths is not None:
            strength = replace(strength, bound=self._bounds(strength, tie_strengths, balance.force))
        if self._shared is None:
            check_connected(self._stones, self._contacts, balance)
            self._shared = balance.wrenches, solver_for(balance.wrenches, self._solver)
        wrenches, solve = self._shared
        balance = replace(balance, wrenches=wrenches)
        stands = any(np.array_equal(dead, balance.dead) and _as_strong(strength, weak) for dead, weak in self._standing)
        state = analysed(balance, strength, solve, flow, SlidingOptions(), None, stands=stands)
        if not stands and state.status not in ("unstable", "failed"):
            self._standing.append((balance.dead, strength))
        return replace(state, seconds=perf_counter() - begin)

    def _bounds(self, strength: Strength, tie_strengths: npt.ArrayLike, force: float) -> FloatArray:
        """Return the bounds (nc + nt,) of all points with other ones of the ties, N."""
        given = np.atleast_1d(array_of("LimitStudy: tie_strengths", tie_strengths, "iuf", "numbers").astype(np.float64))
        if given.shape != (len(self._ties),):
            expected = f"one a tie ({len(self._ties)})"
            raise InputError("LimitStudy: tie_strengths", "wrong length", found=given.size, expected=expected)
        if not (np.isfinite(given) & (given >= 0)).all():
            raise InputError("LimitStudy: tie_strengths", "out of range", found=given.tolist(), expected="finite numbers >= 0")
        bound = strength.bound.copy()
        bound[len(bound) - len(given) :] = given / force
        return bound


def _as_strong(strength: Strength, other: Strength) -> bool:
    """Return whether every force that one strength bears the other one bears, too."""
    pairs = ((strength.friction, other.friction), (strength.cohesion, other.cohesion), (strength.bound, other.bound))
    return all(bool((mine >= theirs).all()) for mine, theirs in pairs)
