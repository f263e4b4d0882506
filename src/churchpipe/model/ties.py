"""Ties: bars that pull stones together, as an analysis takes them."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind, finite, listed, text, text_or_empty
from churchpipe.model.arrays import FloatArray, IntArray, NameArray, ReadOnly, floats, indices, rows_of, store, store_arrays


@dataclass(frozen=True, slots=True)
class Anchor(ReadOnly):
    """Where an end of a tie pulls.

    Parameters
    ----------
    stone
        The stones (k,) that bear it.
    point
        Where it pulls on each of them (k, 3), m.
    share
        Share of the tension (k,) that each takes; they add up to one.
    wall
        Name of the panel (k,) of each stone.
    """

    stone: IntArray
    point: FloatArray
    share: FloatArray
    wall: NameArray

    def __post_init__(self) -> None:
        count = rows_of("Anchor.stone", self.stone)
        share = floats("Anchor.share", self.share, (count,))
        if not count or (share < 0).any() or abs(float(share.sum()) - 1) > 1e-9:
            raise InputError(
                "Anchor.share", "not shares of a whole", found=share.tolist(), expected="numbers >= 0 with the sum 1"
            )
        store_arrays(self, stone=(count,), point=(count, 3), wall=(count,))
        store(self, share=share)


@dataclass(frozen=True, slots=True)
class Tie(ReadOnly):
    """A bar without weight between two anchors: it pulls with 0 <= T <= strength, and never pushes.

    The bar is ductile.

    Parameters
    ----------
    name
        What messages and results call it.
    start, end
        The anchors, points (3,) m.
    stones
        Indices (i, j) of the stones that they pull on; None: those that contain or touch the anchors.
    strength
        N, the least of yield, punching of the wall and bearing under the plates.
    anchors
        Where start and end pull, if not on one stone each.
    stiffness
        Force over elongation E A / L, N/m, which the path of a capacity curve needs; a limit analysis does not.
    pretension
        N, at most the strength. It changes no load factor, since the bar is ductile.
    ultimate
        Elongation at which it breaks, m.
    governs
        What its strength is that of, in words.
    seated
        Whether it is a joist, that falls off its bearings where it breaks.

    Raises
    ------
    InputError
        No name, no length, a number out of its range, both ends on one stone.
    """

    name: str
    start: FloatArray
    end: FloatArray
    stones: tuple[int, int] | None
    strength: float
    anchors: tuple[Anchor, Anchor] | None
    stiffness: float | None
    pretension: float
    ultimate: float
    governs: str
    seated: bool

    def __init__(
        self,
        name: str,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        stones: tuple[int, int] | None = None,
        *,
        strength: float,
        anchors: tuple[Anchor, Anchor] | None = None,
        stiffness: float | None = None,
        pretension: float = 0.0,
        ultimate: float = np.inf,
        governs: str = "",
        seated: bool = False,
    ) -> None:
        text("Tie.name", name)
        where = f"tie {name}"
        first, second = floats(f"{where}: start", start, (3,)), floats(f"{where}: end", end, (3,))
        if not np.linalg.norm(second - first) > 0:
            raise InputError(where, "no length", found=f"both ends at {first.tolist()} m", expected="two anchors apart")
        if finite(f"{where}: strength", strength) < 0:
            raise InputError(f"{where}: strength", "out of range", found=strength, expected=">= 0 N")
        pair = None
        if stones is not None:
            i, j = indices(f"{where}: stones", stones, (2,)).tolist()
            pair = i, j
            if i == j:
                raise InputError(where, "both ends on one stone", found=f"stones {i} and {j}", expected="two stones")
        if stiffness is not None and not finite(f"{where}: stiffness", stiffness) > 0:
            raise InputError(f"{where}: stiffness", "out of range", found=stiffness, expected="> 0 N/m")
        if not 0 <= finite(f"{where}: pretension", pretension) <= strength:
            raise InputError(
                f"{where}: pretension",
                "out of range",
                found=f"{pretension / 1e3:g} kN",
                expected=f"0 to its strength, {strength / 1e3:g} kN",
            )
        # Infinite: it never breaks.
        if not (isinstance(ultimate, float) and ultimate == np.inf) and not finite(f"{where}: ultimate elongation", ultimate) > 0:
            raise InputError(f"{where}: ultimate elongation", "out of range", found=ultimate, expected="> 0 m")
        held = None if anchors is None else tuple(listed(f"{where}: anchors", anchors, Anchor))
        if held is not None and len(held) != 2:
            raise InputError(f"{where}: anchors", "not two anchors", found=len(held), expected="one at each end")
        store(self, name=name, start=first, end=second, stones=pair, strength=float(strength), anchors=held)
        store(self, stiffness=stiffness, pretension=float(pretension), ultimate=float(ultimate))
        store(self, governs=text_or_empty(f"{where}: governs", governs))
        check_kind(f"{where}: seated", seated, bool)
        store(self, seated=seated)

    @property
    def length(self) -> float:
        """From anchor to anchor, m."""
        return float(np.linalg.norm(self.end - self.start))

    @property
    def axis(self) -> FloatArray:
        """Unit vector (3,) from start to end."""
        span = self.end - self.start
        return np.asarray(span / np.linalg.norm(span))


@dataclass(frozen=True, slots=True)
class RankedTie:
    """What a candidate tie adds.

    Parameters
    ----------
    tie
        The candidate.
    rate
        d load_factor / d strength at strength 0, 1/N: the rate at which the mechanism lengthens it. Without dilatancy it is for
        normal forces held as they are.
    most
        Load factor that it cannot exceed: that of the structure plus rate times strength. The load factor is concave in the
        strength, so that the true one is less where another mechanism takes over. NaN without dilatancy, where there is no such
        bound: a tie that presses joints together raises their friction, too.
    load_factor
        With the tie, by a new analysis; NaN where none was made.
    """

    tie: Tie
    rate: float
    most: float
    load_factor: float = np.nan
