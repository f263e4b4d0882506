"""The eight planes of eq. (6) of Malena et al. (2019), corrected: an outer approximation of the strength of running bond.

As printed, planes f7 and f8 are inadmissible: they lack N11, without which head joints interpenetrate, and their signs break the
symmetry of the mid-plane. Each plane here is an admissible mechanism of the cell, so the planes enclose the exact domain. They
are exact for M11 with M22, and for membrane forces while friction 2 a / b <= 1 (a course height, b stone length; beyond, stones
rock in the plane before they slide). For other combinations they lie outside the exact domain. M12 is bounded only by the
optional pair f9 and f10, which is exact for N11 = N22.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.cell_limit import cohesion_shift, positive
from churchpipe.model.arrays import FloatArray, floats
from churchpipe.model.names import OUTER
from churchpipe.model.names import Planes as PlaneSet


@dataclass(frozen=True, slots=True)
class Planes:
    """Linear strength: normal_...pi stress_i <= limit_...p, with stress (N11, N22, N12, M11, M22, M12) in N/m and N."""

    normal: FloatArray
    limit: FloatArray


def paper_planes(
    a: npt.ArrayLike,
    b: npt.ArrayLike,
    h: npt.ArrayLike,
    friction: npt.ArrayLike,
    cohesion: npt.ArrayLike = 0.0,
    *,
    torsion: bool = False,
) -> Planes:
    """Return the planes f1-8 of eq. (6), corrected, normal (..., 8, 6) and limit (..., 8); with `torsion` f9-10 too.

    Raises
    ------
    InputError: values out of range; friction > 1, where the planes f1-2 cut into the exact domain.
    """
    apex = cohesion_shift(h, friction, cohesion)
    sizes = (positive("a", a), positive("b", b), positive("h", h), np.asarray(friction, dtype=np.float64))
    a, b, h, mu = np.broadcast_arrays(*sizes)
    if (mu > 1).any():
        raise InputError(
            "friction",
            "the planes of eq. (6) are valid for tan(phi) <= 1 only",
            found=float(mu.max()),
            expected="friction <= 1",
            remedy='Use planes = "cell", the exact strength of the unit cell, which holds for any friction.',
        )
    mu_b = 2 * a / b
    p = mu * b / (4 * h * mu_b)
    q = mu / mu_b * np.sqrt(1 + (b / (4 * h)) ** 2)
    zero, one = np.zeros_like(mu), np.ones_like(mu)
    pairs = [
        ([mu_b, mu, zero, zero, zero, zero], [zero, zero, 1 + mu * mu_b, zero, zero, zero]),
        ([zero, one, zero, zero, zero, zero], [zero, zero, 1 / mu, zero, zero, zero]),
        ([zero, one, zero, zero, zero, zero], [zero, zero, zero, zero, 2 / h, zero]),
        ([one, p + q, zero, zero, zero, zero], [zero, zero, zero, 2 / h, 2 / h * (q - p), zero]),
    ]
    if torsion:
        n11 = mu / 4 * np.hypot(h, a)
        # Bed joints twist, open, and slide by half the opening of the head joints. At the corners that would interpenetrate first
        # the twist cancels that sliding.
        slide, twist, roll = n11 * b / 2, h * a / 4, a * b / 8
        first, last = mu * np.hypot(slide - twist, roll) + h * b / 8, mu * np.hypot(slide + twist, roll) - h * b / 8
        pairs.append(([n11, np.maximum(first, last) / a, zero, zero, zero, zero], [zero, zero, zero, zero, zero, one]))
    both = [np.stack(same, axis=-1) + sign * np.stack(change, axis=-1) for same, change in pairs for sign in (1.0, -1.0)]
    normal = np.stack(both, axis=-2)
    return Planes(normal, np.einsum("...pi,...i->...p", normal, apex))


def with_warning(message: str, planes: PlaneSet) -> str:
    """Return the message of a result, with a warning where the strength is not exact."""
    return "; ".join(part for part in (message, OUTER.get(planes, "")) if part)


def violation(planes: Planes, stress: npt.ArrayLike) -> FloatArray:
    """Return the largest excess over the planes (n,) of stresses (n, 6); <= 0 inside. One set of planes, or one a stress."""
    values = floats("stress", stress, (None, 6))
    return (np.einsum("...pi,...i->...p", planes.normal, values) - planes.limit).max(axis=-1)
