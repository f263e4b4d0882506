"""Ties to the stones that their anchors pull on."""

from collections.abc import Iterable, Sequence

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.locate import inside_stones, stones_at
from churchpipe.geometry.punching import punched_edge
from churchpipe.geometry.walls import WallLine, points_of, wall_line
from churchpipe.loading.joists import joists_of
from churchpipe.loading.plates import plate_on
from churchpipe.model.arguments import check_kind, listed
from churchpipe.model.arrays import FloatArray, IntArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.diaphragm import Diaphragm
from churchpipe.model.tie_bars import AnchorPlace, TieBar
from churchpipe.model.ties import Anchor, Tie

# A bar runs along a wall, and not through it, if the cosine of its angle with the wall's normal is less than this.
_THROUGH = 0.3
_CLOSE = 1e-5
# A bar along a wall is looked at every so many metres, but for its ends; with no stone at two places in a row it is in the open.
_EVERY, _SPARED = 0.05, 0.02


def place_ties(stones: Assemblage, bars: Iterable[TieBar | Diaphragm]) -> list[Tie]:
    """Return bars, and the joists of floors, as ties between the stones that their anchors pull on.

    A bar with a place on a wall goes through that wall to its far face, unless it runs along it. A plate presses on the stones
    that it covers, by area; without one the stones that contain or touch the end share it evenly.

    Parameters
    ----------
    stones
        With the names of their walls as `panel`.
    bars
        The bars; a `Diaphragm` stands for its joists.

    Returns
    -------
    list[Tie]
        With their strength and what governs it, stiffness E A / L and ultimate elongation.

    Raises
    ------
    InputError
        A wall that is not there or is not straight, an anchor beside the masonry or in an opening, a plate that overhangs.
    """
    check_kind("place_ties: stones", stones, Assemblage)
    given = listed("place_ties: bars", bars, TieBar, Diaphragm)
    return [tie for bar in given for tie in (joists_of(stones, bar) if isinstance(bar, Diaphragm) else [_placed(stones, bar)])]


def anchors_of(stones: Assemblage, tie: Tie) -> tuple[Anchor, Anchor]:
    """Return where a tie pulls: its anchors, or the stones that it names or that its ends are in.

    Raises
    ------
    InputError
        An end without a stone or in several, both ends on one stone, or on stones that cannot move.
    """
    where = f"tie {tie.name}"
    if tie.anchors is not None:
        found = [anchor.stone for anchor in tie.anchors]
    else:
        pair = tie.stones or (_stone_at(stones, f"{where}: {end}", at) for end, at in (("start", tie.start), ("end", tie.end)))
        found = [np.array([stone]) for stone in pair]
    every = np.concatenate(found)
    if every.max() >= stones.count:
        raise InputError(f"{where}: stones", "no such stone", found=every.max(), expected=f"indices < {stones.count}")
    both = np.intersect1d(found[0], found[1])
    if len(both):
        named = ", ".join(stones.block_id[both].tolist())
        raise InputError(where, "both ends on one stone", found=named, expected="anchors on different stones")
    if stones.fixed[every].all():
        fixed = " and ".join(stones.block_id[every].tolist())
        raise InputError(where, "both ends on fixed stones", found=fixed, expected="at least one free stone")
    if tie.anchors is not None:
        return tie.anchors
    return _single(stones, int(every[0]), tie.start), _single(stones, int(every[1]), tie.end)


def _stone_at(stones: Assemblage, where: str, place: FloatArray) -> int:
    found = _stones_at(stones, where, place).tolist()
    if len(found) > 1:
        raise InputError(
            where,
            "several stones at the anchor",
            found=f"{', '.join(f'{stones.block_id[i]} ({i})' for i in found)} at {place.round(4).tolist()} m",
            expected="one stone",
            remedy="Move the anchor into one of them, or give the tie's stones=(i, j).",
        )
    return int(found[0])


def _stones_at(stones: Assemblage, where: str, place: FloatArray) -> IntArray:
    found = stones_at(stones, place)
    if not len(found):
        low = np.minimum.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0)
        high = np.maximum.reduceat(stones.points, stones.block_point_ptr[:-1], axis=0)
        apart = np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0.0), axis=1)
        nearest = int(apart.argmin())
        # A point in the notch of a stone is in its box.
        away = f"{apart[nearest]:.3g} m away" if apart[nearest] > 0 else "around it"
        found_at = f"{place.round(4).tolist()} m; the nearest stone, {stones.block_id[nearest]}, is {away}"
        remedy = "Move the anchor onto a stone: it may lie in an opening, or beside the wall."
        raise InputError(where, "no stone at the anchor", found=found_at, expected="a point in or on a stone", remedy=remedy)
    return found


def _single(stones: Assemblage, stone: int, place: FloatArray) -> Anchor:
    chosen = np.array([stone])
    return Anchor(chosen, place[None], np.ones(1), stones.panel[chosen])


def _placed(stones: Assemblage, bar: TieBar) -> Tie:
    where = f"tie {bar.name}"
    walls = [
        wall_line(stones, place.wall, f"{where}: {end}") if place.wall is not None else None
        for end, place in (("start", bar.start), ("end", bar.end))
    ]
    first, second = (
        _middle(stones, f"{where}: {end}", place, wall)
        for end, place, wall in zip(("start", "end"), (bar.start, bar.end), walls, strict=True)
    )
    span = second - first
    if not np.linalg.norm(span) > _CLOSE:
        raise InputError(where, "no length", found=f"both ends at {first.round(4).tolist()} m", expected="two anchors apart")
    axis = span / np.linalg.norm(span)
    _check_within(stones, where, walls, first, span)
    anchors: list[Anchor] = []
    ends: list[FloatArray] = []
    thickness: list[float | None] = []
    edge: list[float | None] = []
    for end, place, wall, pull in zip(("start", "end"), (first, second), walls, (axis, -axis), strict=True):
        outer, outward = _outer(place, wall, pull)
        ends.append(outer)
        if bar.plate:
            anchor = plate_on(stones, f"{where}: {end}", outer, outward, bar.plate)
        else:
            found = _stones_at(stones, f"{where}: {end}", outer)
            found = found[~stones.fixed[found]] if (~stones.fixed[found]).any() else found
            count = len(found)
            anchor = Anchor(found, np.tile(outer, (count, 1)), np.full(count, 1 / count), stones.panel[found])
        anchors.append(anchor)
        through = _thickness(stones, wall, anchor, outward)
        thickness.append(through)
        if bar.plate is None or bar.punching_strength is None or through is None:
            edge.append(None)
        else:
            edge.append(punched_edge(stones, outer, outward, bar.plate, through))
    strength, governs = bar.capacity((thickness[0], thickness[1]), (edge[0], edge[1]))
    length = float(np.linalg.norm(ends[1] - ends[0]))
    tie = Tie(
        bar.name,
        ends[0],
        ends[1],
        strength=strength,
        anchors=(anchors[0], anchors[1]),
        stiffness=bar.modulus * bar.area / length,
        pretension=bar.pretension,
        ultimate=np.inf if bar.ultimate_strain is None else bar.ultimate_strain * length,
        governs=governs,
    )
    anchors_of(stones, tie)
    return tie


def _check_within(stones: Assemblage, where: str, walls: Sequence[WallLine | None], first: FloatArray, span: FloatArray) -> None:
    """Raise InputError for a bar along a wall that leaves its masonry, at an opening or above a step."""
    wall, other = walls
    if wall is None or other is None or wall.name != other.name:
        return
    length = float(np.linalg.norm(span))
    way = np.linspace(_SPARED, length - _SPARED, max(2, int(length / _EVERY))) / length
    # Not exactly on the middle plane, on which joints between two leaves lie.
    places = first + way[:, None] * span + np.append(1e-3 * wall.thickness * wall.normal, 0.37e-3)
    bare = ~inside_stones(stones, places)
    if (bare[1:] & bare[:-1]).any():
        at = places[1:][bare[1:] & bare[:-1]][0]
        raise InputError(
            where,
            f"it leaves the masonry of the wall {wall.name}",
            found=f"an opening at {at.round(2).tolist()} m",
            expected="a bar within the wall",
            remedy="Move it above or below; where it is to cross the opening in the open, give its ends as points (at_m).",
        )


def _middle(stones: Assemblage, where: str, place: AnchorPlace, wall: WallLine | None) -> FloatArray:
    """Return a place on the middle plane of its wall, or the point that it is (3,) m."""
    if wall is None or place.along is None or place.height is None:
        return np.array(place.at)
    if not -_CLOSE <= place.along <= wall.length + _CLOSE:
        expected = f"within 0 and {wall.length:.6g} m along it: {wall.way}"
        raise InputError(where, f"beyond the wall {wall.name}", found=f"{place.along:g} m", expected=expected)
    foot = float(points_of(stones, wall.stones)[:, 2].min())
    if place.height < foot - _CLOSE:
        raise InputError(where, f"below the wall {wall.name}", found=f"{place.height:g} m", expected=f"at least {foot:.6g} m")
    if place.height > wall.top + _CLOSE:
        raise InputError(where, f"above the wall {wall.name}", found=f"{place.height:g} m", expected=f"at most {wall.top:.6g} m")
    return np.append(wall.at(place.along), place.height)


def _outer(place: FloatArray, wall: WallLine | None, pull: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return where a bar that pulls this way is anchored, and where the face there looks: both (3,)."""
    if wall is None:
        return place, -pull
    normal = np.append(wall.normal, 0.0)
    across = float(normal @ pull)
    if abs(across) < _THROUGH:
        return place, -pull
    return place - pull * (wall.thickness / 2) / abs(across), -np.sign(across) * normal


def _thickness(stones: Assemblage, wall: WallLine | None, anchor: Anchor, outward: FloatArray) -> float | None:
    """Return the thickness that a plate would have to punch through, m; None for a bar along its wall."""
    if wall is not None:
        return wall.thickness if abs(float(np.append(wall.normal, 0.0) @ outward)) > _THROUGH else None
    return float(np.ptp(points_of(stones, anchor.stone) @ outward))
