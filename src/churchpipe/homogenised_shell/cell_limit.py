"""How far the periodic cell of a wall can be loaded in one direction: the strength that the shell has at a point.

Stresses are ordered (N11, N22, N12, M11, M22, M12), N/m and N, strains (E11, E22, 2 E12, chi11, chi22, 2 chi12). Axis 1 runs
along the bed joint, axis 2 up the courses, and the strain at depth x3 is E + x3 chi. A joint is rigid on both sides, so it is
admissible when its corners are.
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


@dataclass(frozen=True, slots=True)
class CellLimit:
    """How far the cell can be loaded in one direction.

    factor: largest multiple of the direction on top of the base stress; inf when none is too large (outcome "unbounded"),
    NaN when no multiple lies in the domain ("infeasible") or no answer was proved to 1e-6 ("failed").
    strain (6,), rotation (motions,): the mechanism, scaled to strain . direction = 1; motions are those of `rigid_cell`.
    forces (corners, 3): at the joint corners, N, normal (compression positive) and along the joint; not unique.
    """

    factor: float
    outcome: Outcome
    strain: FloatArray
    rotation: FloatArray
    forces: FloatArray


def cell_limit(
    closing: FloatArray,
    friction: float,
    h: float,
    direction: npt.ArrayLike,
    *,
    base: npt.ArrayLike = (0.0,) * 6,
    cohesion: float = 0.0,
    capacity: FloatArray | None = None,
) -> CellLimit:
    """Return the largest factor for which base + factor direction lies in the exact strength domain of a cell.

    Parameters
    ----------
    closing: of the cell's joints (corners, 3, 6 + motions), of `rigid_cell`. h: wall thickness, m. friction: > 0.
    direction, base: stresses (6,), N/m and N. cohesion: Pa.
    capacity: what each joint of four corners bears before it crushes (nj,), N; none: nothing crushes.

    Raises
    ------
    InputError: thickness, friction or cohesion out of range, no direction.
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
