"""The unit cell of running bond: one rigid block and the Coulomb joints around it. The shell's strength is derived from it.

A block of length b and height a in a wall of thickness h meets one neighbour across a head joint and two across half bed joints.
The other three joints are periodic images of these.

With x the place of a block in the wall, blocks are displaced like the plate: translations E x and -1/2 x chi x, rotations chi x,
and one rotation omega that all blocks share. E is the membrane strain, chi the curvature. A joint is rigid on both sides, so it
is admissible when its four corners are. That makes 12 second-order cones in 9 variables.

Axis 1 runs along the bed joint, axis 2 up the courses; the strain at depth x3 is E + x3 chi. Strains are ordered (E11, E22, 2
E12, chi11, chi22, 2 chi12), stresses (N11, N22, N12, M11, M22, M12), N/m and N.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from churchpipe.conic.clarabel import solve_clarabel
from churchpipe.conic.pressed import ROWS, UNIT_ROW, pressed_closing
from churchpipe.conic.program import ConeProgram, ConeSolution, Outcome
from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, array_of, floats

# One head joint, then the two half bed joints, four corners each: lattice vector from block to neighbour in units (b, a),
# corner from the midpoint of that vector in units (b, a), and depth in units of h.
_NEIGHBOUR = np.repeat([[1.0, 0.0], [0.5, 1.0], [-0.5, 1.0]], 4, axis=0)
_CORNER = np.vstack(
    [np.repeat([[0.0, -0.5], [0.0, 0.5]], 2, axis=0), np.tile(np.repeat([[-0.25, 0.0], [0.25, 0.0]], 2, axis=0), (2, 1))]
)
_DEPTH = np.tile([-0.5, 0.5], 6)
_NORMAL = np.repeat([0, 1, 1], 4)


@dataclass(frozen=True, slots=True)
class CellLimit:
    """How far the cell can be loaded in one direction.

    factor: largest multiple of the direction on top of the base stress; inf when none is too large (outcome "unbounded"),
    NaN when no multiple lies in the domain ("infeasible") or no answer was proved to 1e-6 ("failed").
    strain (6,), rotation (motions,): the mechanism, scaled to strain . direction = 1; motions are the rotation of the stone, of a
    cell of several stones those of `rigid_cell`. forces (corners, 3): at the joint corners, N, components normal (compression
    positive), in-plane and out-of-plane shear; not unique.
    """

    factor: float
    outcome: Outcome
    strain: FloatArray
    rotation: FloatArray
    forces: FloatArray


def joint_closing(a: npt.ArrayLike, b: npt.ArrayLike, h: npt.ArrayLike) -> FloatArray:
    """Return the closing of the cell's joints per unit area of wall, closing_...kci, shape (..., 12, 3, 9), 1/m and 1/m2.

    Corner k, component c (normal, closing positive; in-plane and out-of-plane sliding), variable i (the 6 strains, then the
    rotation omega of all blocks). a, b, h (m) broadcast. Corner forces f_kc, N, make the stress sum_kc f_kc closing_kci, and
    its last three entries, the moment on the block, vanish.

    Opening at corner y of the joint to the neighbour at v: in the plane (E + y3 chi) v + omega3 (v2, -v1), across it
    -(chi v) . (y - v/2) - omega1 v2 + omega2 v1.
    """
    a, b, h = np.broadcast_arrays(*(positive(key, value) for key, value in (("a", a), ("b", b), ("h", h))))
    size = np.stack([b, a], axis=-1)[..., None, :]
    v1, v2 = np.moveaxis(_NEIGHBOUR * size, -1, 0)
    r1, r2 = np.moveaxis(_CORNER * size, -1, 0)
    y3 = _DEPTH * h[..., None]
    zero = np.zeros_like(v1)
    along = np.stack([v1, zero, v2 / 2, y3 * v1, zero, y3 * v2 / 2, zero, zero, v2], axis=-1)
    up = np.stack([zero, v2, v1 / 2, zero, y3 * v2, y3 * v1 / 2, zero, zero, -v1], axis=-1)
    across = np.stack([zero, zero, zero, -v1 * r1, -v2 * r2, -(v2 * r1 + v1 * r2) / 2, -v2, v1, zero], axis=-1)
    head = (_NORMAL == 0)[:, None]
    opening = np.stack([np.where(head, along, up), np.where(head, up, along), across], axis=-2)
    return -opening / (a * b)[..., None, None, None]


def cell_limit(
    a: float,
    b: float,
    h: float,
    friction: float,
    direction: npt.ArrayLike,
    *,
    base: npt.ArrayLike = (0.0,) * 6,
    cohesion: float = 0.0,
) -> CellLimit:
    """Return the largest factor for which base + factor direction lies in the exact strength domain of the cell.

    Parameters
    ----------
    a, b, h: course height, block length, wall thickness, m. friction: > 0. cohesion: Pa.
    direction, base: stresses (6,), N/m and N.

    Raises
    ------
    InputError: sizes, friction or cohesion out of range, no direction.
    """
    return closing_limit(joint_closing(a, b, h), friction, h, direction, base=base, cohesion=cohesion)


def closing_limit(
    closing: FloatArray,
    friction: float,
    h: float,
    direction: npt.ArrayLike,
    *,
    base: npt.ArrayLike = (0.0,) * 6,
    cohesion: float = 0.0,
    capacity: FloatArray | None = None,
) -> CellLimit:
    """Return the same of a cell of any stones, from the closing (corners, 3, 6 + motions) of its joints.

    capacity (nj,): what each joint of four corners bears before it crushes, N; none: nothing crushes.
    """
    shift = cohesion_shift(h, friction, cohesion)
    growth, start = floats("direction", direction, (6,)), floats("base", base, (6,)) - shift
    # Scaling: membrane forces as they are, moments divided by h, rotations multiplied by h.
    unit = np.array([1, 1, 1, h, h, h])
    size = float(np.abs(growth / unit).max())
    if size == 0:
        raise InputError("direction", "no direction", found=growth.tolist(), expected="a stress that is not zero")
    joints, largest = np.zeros(0) if capacity is None else capacity, float(np.abs(closing[..., :3]).max())
    scale = (float(np.abs(start / unit).max()) or largest * float(joints.max(initial=0.0)) or 1.0) / size
    corners, _, width = closing.shape
    # Motions of the stones are scaled to close joints as much as strains do.
    units = np.append(unit, np.abs(closing[..., 6:]).max(axis=(0, 1)) / largest)
    # S of `conic.pressed`: a force at a corner that makes stresses of order one.
    share = 1.0 / largest
    whole = pressed_closing(closing / units, np.sqrt(joints / (scale * size * share)))
    zero, none = np.zeros(whole.shape[2] - 6), np.zeros(len(whole))
    constant = -np.append(start / unit, zero) / (scale * size)
    constant[width + ROWS * np.arange(len(joints)) + UNIT_ROW] = -share
    program = ConeProgram(
        balance=sp.csc_matrix(whole.reshape(3 * len(whole), -1).T),
        constant=constant,
        growth=-np.append(growth / unit, zero) / size,
        limit=none,
        slope=np.where(np.arange(len(whole)) < corners, friction, 1.0),
        linear=none,
        quadratic=none,
    )
    answer, outcome = _proved(program)
    factor = {"solved": answer.tau * scale, "unbounded": np.inf}.get(outcome, np.nan)
    rate = -answer.y[:width] / units / size
    return CellLimit(factor, outcome, rate[:6], rate[6:], answer.x[:corners] * scale * size)


def _proved(program: ConeProgram) -> tuple[ConeSolution, Outcome]:
    """Solve to 1e-8, and again to 1e-9 if the bounds do not agree: the solver may end slightly short of either."""
    answer = solve_clarabel(program, duality_gap=1e-8)
    if answer.outcome == "failed" or (answer.outcome == "solved" and _doubt(program, answer) > 1e-6):
        answer = solve_clarabel(program, duality_gap=1e-9)
    doubtful = answer.outcome == "solved" and _doubt(program, answer) > 1e-6
    return answer, "failed" if doubtful else answer.outcome


def _doubt(program: ConeProgram, answer: ConeSolution) -> float:
    """Return the largest error of forces and mechanism as a proof of the factor: balance, both cones, and the two bounds."""
    forces, closing = answer.x, program.rates(answer.y)
    balance = program.residual(forces, answer.tau)
    static = np.hypot(forces[:, 1], forces[:, 2]) - program.slope * forces[:, 0]
    kinematic = program.slope * np.hypot(closing[:, 1], closing[:, 2]) - closing[:, 0]
    gap = np.array([answer.tau + program.constant @ answer.y, 1 - program.growth @ answer.y])
    size = max(1.0, abs(answer.tau))
    return float(
        max(np.abs(balance).max() / size, static.max() / np.abs(forces).max(), kinematic.max(), np.abs(gap).max() / size)
    )


def cohesion_shift(h: npt.ArrayLike, friction: npt.ArrayLike, cohesion: npt.ArrayLike) -> FloatArray:
    """Return the stress (..., 6) at the apex of the domain. Cohesion c moves N11 and N22 by h c / friction and nothing else.

    Raises
    ------
    InputError: friction not positive (the domain has no apex then), cohesion negative.
    """
    h, friction = positive("h", h), positive("friction", friction)
    cohesion = array_of("cohesion", cohesion, "iuf", "numbers").astype(np.float64)
    if not ((cohesion >= 0) & np.isfinite(cohesion)).all():
        raise InputError("cohesion", "out of range", found=float(cohesion.min()), expected="finite numbers >= 0 Pa")
    apex = h * cohesion / friction
    zero = np.zeros_like(apex)
    return np.stack([apex, apex, zero, zero, zero, zero], axis=-1)


def positive(name: str, value: npt.ArrayLike) -> FloatArray:
    """Return `value` as an array of positive finite numbers, or raise InputError naming it."""
    array = array_of(name, value, "iuf", "numbers").astype(np.float64)
    if not ((array > 0) & np.isfinite(array)).all():
        raise InputError(name, "out of range", found=float(array.min()), expected="finite numbers > 0")
    return array
