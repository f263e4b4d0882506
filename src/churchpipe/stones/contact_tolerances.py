"""Tolerances of joints, proposed from the gaps and angles of the stones themselves."""

import math
from dataclasses import dataclass

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.planar import widths
from churchpipe.model.arguments import finite
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import TOUCHING, ContactTolerances
from churchpipe.model.polyhedra import face_normals
from churchpipe.stones.facing import Overlaps

# Shares of the median stone's thickness. A gap below the first is always a joint. No wider gap than the second is proposed. The
# third and the fourth bound the estimate of how far corners are displaced along the joints: no stone is cut so exactly that it
# bears on a narrower strip.
HAIRLINE = 0.008
WIDEST = 0.02
NOISIEST = 0.04
LEAST_NOISE = 1e-4
# Proposed angles are between these, rad.
LEAST_ANGLE = math.radians(3.0)
MOST_ANGLE = math.radians(5.0)
# Gaps (or angles) are sorted. One more than this many times as large as the one before it begins another group: joints that are
# meant to be open.
STEP = 2.0
# Pairs of faces that share less than this part of the smaller one are not used to estimate the gaps.
TELLING_SHARE = 0.1


@dataclass(frozen=True, slots=True)
class Limits:
    """The tolerances, and lengths that follow from the thickness of the stones.

    tolerances: of joints. middle: how far apart the facets of a joint may be in the middle of their overlap, m; infinite where
    the contact gap was given. noise: how far corners are displaced along the joints, m; overlaps narrower than that are no
    joints. thickness: of each stone (nb,) m. typical: of the median stone, m.
    """

    tolerances: ContactTolerances
    middle: float
    noise: float
    thickness: FloatArray
    typical: float


def thicknesses(stones: Assemblage) -> FloatArray:
    """Return the thickness of each stone (nb,) m: its volume over the largest area of its projections along x, y, z and the
    normal of its largest face.
    """
    vector, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    stone = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    area = np.linalg.norm(vector, axis=1)
    order = np.lexsort((area, stone))
    largest = normal[order[np.searchsorted(stone[order], np.arange(stones.count), side="right") - 1]]
    shadows = [0.5 * np.bincount(stone, np.abs(vector[:, k]), minlength=stones.count) for k in range(3)]
    shadows.append(0.5 * np.bincount(stone, np.abs(np.einsum("ij,ij->i", vector, largest[stone])), minlength=stones.count))
    return stones.volume / np.max(shadows, axis=0)


def typical_thickness(stones: Assemblage, thickness: FloatArray) -> tuple[float, float]:
    """Return the thickness of the median free stone and of the thinnest one, m."""
    free = thickness[~stones.fixed] if not stones.fixed.all() else thickness
    return float(np.median(free)), float(free.min())


def search_reach(stones: Assemblage, contact_gap: float | None, overlap: float | None) -> float:
    """Return up to which distance facets are examined for joints, m."""
    typical, _ = typical_thickness(stones, thicknesses(stones))
    return max(2.0 * WIDEST * typical if contact_gap is None else contact_gap, overlap or WIDEST * typical)


def given_or_none(name: str, value: float | None, most: float = np.inf) -> float | None:
    """Return a tolerance that was given, after checking it, or None."""
    if value is None:
        return None
    if not 0 < finite(f"find_contacts: {name}", value) < most:
        raise InputError(f"find_contacts: {name}", "out of range", found=value, expected=f"> 0 and < {most:.4g}")
    return float(value)


def limits_of(
    stones: Assemblage,
    found: Overlaps,
    contact_gap: float | None,
    contact_angle: float | None,
    overlap: float | None,
    least: FloatArray,
    exact: int,
    drawn: BoolArray,
    ragged: float,
) -> Limits:
    """Return the tolerances that were given, and proposals for the others.

    The gaps between facets that face each other are sorted. All gaps up to a hairline belong to joints. The proposal is then
    raised from gap to gap as long as the next is no more than `STEP` times as large. It ends where a range of sizes is empty:
    between the joints, however imprecise, and the gaps that are meant to be open. Angles are treated alike. No proposal exceeds
    half the thickness of the thinnest stone.

    least (n,): area of the smaller facet of each overlap, m2. exact: number of joints exactly as drawn. drawn (n,): which
    overlaps are so, too, face by face. ragged: how far corners lie off the faces of their walls, m; two of them are up to twice
    that apart, across the joints and along them, which few joints show where most neighbours have their corners in common.
    """
    thickness = thicknesses(stones)
    typical, thinnest = typical_thickness(stones, thickness)
    widest = min(WIDEST * typical, 0.5 * thinnest)
    telling = found[(found.area > TELLING_SHARE * least) & (found.angle <= MOST_ANGLE) & (found.penetration <= TOUCHING)]
    hairline = min(HAIRLINE * typical, widest)
    gap = _proposed(telling.opening, TOUCHING, hairline, widest) if contact_gap is None else contact_gap
    if contact_gap is None:
        gap = max(gap, min(2.0 * ragged, hairline), _hairlines(found, hairline, NOISIEST * typical))
    near = telling[telling.opening <= gap + TOUCHING]
    angle = contact_angle or max(_proposed(near.angle, 1e-5, LEAST_ANGLE, MOST_ANGLE), LEAST_ANGLE)
    given = {"contact_gap": contact_gap, "contact_angle": contact_angle, "overlap": overlap}
    deepest = overlap or max(widest, gap)
    meets = (found.area > TELLING_SHARE * least) & (found.angle <= angle) & (found.opening <= gap + TOUCHING)
    meets &= found.penetration <= deepest + TOUCHING
    exact += int((meets & drawn).sum())
    noise = _noise(found[meets & ~drawn], exact, NOISIEST * typical)
    return Limits(
        tolerances=ContactTolerances(
            contact_gap=gap,
            contact_angle=angle,
            overlap=deepest,
            given=tuple(name for name, value in given.items() if value is not None),
        ),
        middle=widest if contact_gap is None else np.inf,
        noise=max(noise, min(2.0 * ragged, NOISIEST * typical), LEAST_NOISE * typical),
        thickness=thickness,
        typical=typical,
    )


def _hairlines(found: Overlaps, hairline: float, narrowest: float) -> float:
    """Return the widest gap up to a hairline, m, of pairs that are parallel and share more than a strip such as corners that are
    displaced make, m, however little of their faces it is.
    """
    parallel = (found.angle <= LEAST_ANGLE) & (found.penetration <= TOUCHING) & (found.middle - found.slack <= hairline)
    opening = found.opening[parallel & (found.opening <= hairline) & (widths(found.polygon) > narrowest)]
    return float(opening.max(initial=0.0))


def _proposed(values: FloatArray, least: float, sure: float, most: float) -> float:
    """Return where the values, sorted, leave a step after `sure`."""
    ordered = np.sort(values[(values > least) & np.isfinite(values)])
    last = float(ordered[ordered <= sure].max(initial=least))
    for value in ordered[ordered > last].tolist():
        if value > min(STEP * last, most):
            return min(float(np.sqrt(last * value)), STEP * last, most)
        last = value
    return min(STEP * last, most)


def _noise(joints: Overlaps, exact: int, most: float) -> float:
    """Return how far corners are displaced, m. They are taken to be as inexact along the joints as gaps, tilts and warps show
    across, and stones that are too large to reach as far into their neighbours' neighbours as into these.
    """
    if not len(joints):
        return TOUCHING
    middle, none = float(np.median(joints.middle)), np.zeros(exact)
    shift = 4.0 * float(np.quantile(np.concatenate([np.abs(joints.middle - middle), none]), 0.95))
    tilt = 2.0 * float(np.quantile(np.concatenate([np.abs(joints.gap - middle).max(axis=1), none]), 0.95))
    warp = 2.0 * float(np.median(np.concatenate([joints.slack, none])))
    depth = 2.0 * float(np.quantile(np.concatenate([np.maximum(-joints.middle, 0.0), none]), 0.95))
    return min(max(shift, tilt, warp, depth, TOUCHING), most)
