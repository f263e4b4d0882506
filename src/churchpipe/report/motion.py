"""How a mechanism moves: rigid motion of the stones at an amplitude, and from where it is best seen."""

import numpy as np

from churchpipe.io.records import Analysis
from churchpipe.mechanism import moving_stones, reference_speed, stone_of_point, stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.shell import ShellModel

PUSH_LENGTH = 0.16
# A mechanism is drawn moved by this share of the size of the structure.
_MOVED = 0.08
# A joint is drawn as open that opens by more than this share of the widest ones.
_OPENED = 0.05
# Degrees above the horizon from where pictures look.
ELEVATION = 24.0
# A side may hide this share of the moving stones that the best side shows; so many stones are looked for.
HIDDEN, LOOKED_FOR = 0.5, 24
# Plastic strains, and rates of motions of a metre or so, that are no more than this.
_ROUNDING = 1e-7
# Of the score of a side: more than what one analysis of a load differs by from another, and less than what one side shows better.
_TO_THE_FRONT = 0.02


def plastic_size(plastic: FloatArray, thickness: FloatArray) -> FloatArray:
    """Return the size (nt,) of plastic strains (nt, 6): sqrt(E : E + (h/2)^2 chi : chi), as strain, at the faces of the wall."""
    tensor = np.array([1.0, 1.0, 0.5])
    squares = plastic**2 * np.concatenate([tensor, tensor])
    return np.sqrt(squares[:, :3].sum(axis=1) + (thickness / 2) ** 2 * squares[:, 3:].sum(axis=1))


def reference_strain(size: FloatArray) -> float:
    """Return the plastic strain that stands for the mechanism: most facets that flow strain less; 0 where all is rounding, as
    where a wall slides off the ground."""
    largest = float(size.max(initial=0.0))
    return float(np.percentile(size[size > 1e-3 * largest], 90)) if largest > _ROUNDING else 0.0


def shell_amplitude(shell: ShellModel, speed: FloatArray) -> float:
    """Return the factor on the motion of the nodes (nn,) that moves the mechanism as far as it is drawn."""
    reference = reference_speed(speed)
    return _MOVED * float(np.linalg.norm(np.ptp(shell.points, axis=0))) / reference if reference > 0 else 0.0


def joint_opening(contacts: Contacts, stones: Assemblage, velocities: FloatArray) -> FloatArray:
    """Return how fast each interface opens (ni,): the fastest of its corners; 0 where it stays shut."""
    opening = np.zeros(len(contacts.blocks))
    np.maximum.at(opening, contacts.interface_of_point, corner_rates(contacts, stones, velocities)[:, 0])
    return opening


def corner_rates(contacts: Contacts, stones: Assemblage, velocities: FloatArray) -> FloatArray:
    """Return the rates (nc, 3) at which the second stone leaves the first at each contact point, along n, t1 and t2."""
    interface = contacts.interface_of_point
    first, second = (
        velocities[block, :3] + np.cross(velocities[block, 3:], contacts.point - stones.centroid[block])
        for block in contacts.blocks[interface].T
    )
    return np.einsum("pac,pc->pa", contacts.frame[interface], second - first)


def opened_joints(opening: FloatArray) -> BoolArray:
    """Return True (ni,) for the interfaces that open by more than a share of the widest ones."""
    return opening > max(_OPENED * float(np.percentile(opening, 99.5)) if len(opening) else 0.0, np.finfo(float).tiny)


def natural_amplitude(stones: Assemblage, speed: FloatArray) -> float:
    """Return the factor on the velocities that moves the mechanism as far as it is drawn; 0 without mechanism."""
    reference = reference_speed(speed)
    return _MOVED * stones.size / reference if reference > 0 else 0.0


def displaced_points(stones: Assemblage, velocities: FloatArray, amplitude: float) -> FloatArray:
    """Return the points (nv, 3) m of the stones, each carried along its own constant velocity field for a time `amplitude`.

    The field of a stone, v + w x (p - c), makes it turn about a fixed axis: p' = c + R (p - c) + V v, with Rodrigues'
    rotation R and V its integral. So stones keep their shape at any amplitude, and stones that move as one body stay together.
    """
    owner = stone_of_point(stones)
    v, w = velocities[:, :3], velocities[:, 3:]
    rate = np.linalg.norm(w, axis=1, keepdims=True)
    turning = rate > 0
    axis = w / np.where(turning, rate, 1.0)
    sine, cosine = np.sin(amplitude * rate), np.cos(amplitude * rate)
    along = axis * np.einsum("ij,ij->i", axis, v)[:, None]
    circle = (sine * (v - along) + (1 - cosine) * np.cross(axis, v)) / np.where(turning, rate, 1.0)
    shift = np.where(turning, amplitude * along + circle, amplitude * v)
    arm = stones.points - stones.centroid[owner]
    axis, sine, cosine = axis[owner], sine[owner], cosine[owner]
    kept = axis * np.einsum("ij,ij->i", axis, arm)[:, None]
    turned = kept + cosine * (arm - kept) + sine * np.cross(axis, arm)
    return (stones.centroid + shift)[owner] + turned


def viewpoint(stones: Assemblage, velocities: FloatArray) -> FloatArray:
    """Return the unit vector (3,) towards a camera that sees both the breadth of the structure and its motion.

    The azimuth is the one that scores best for the width of the plan, for motion across the line of sight, and for looking
    at the side towards which the stones move, where the joints open; of those from which the rest of the structure does not
    hide what moves, as it does the one stone that comes out of the far wall.
    """
    free = ~stones.fixed
    plan = np.ptp(stones.points[free[stone_of_point(stones)], :2], axis=0)
    drift = (stones.weight[:, None] * velocities[:, :2]).sum(axis=0)
    length = float(np.hypot(*drift))
    drift = drift / length if length > 0 else np.array([0.0, -1.0])
    azimuth = np.deg2rad(np.arange(7.5, 360.0, 15.0))
    toward = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    width = np.abs(toward[:, 1]) * plan[0] + np.abs(toward[:, 0]) * plan[1]
    across = np.abs(toward[:, 0] * drift[1] - toward[:, 1] * drift[0])
    # Where two sides are as good, the front: which one rounding prefers would differ from one analysis to the next.
    score = width / width.max() + 0.6 * across + 0.5 * toward @ drift - _TO_THE_FRONT * toward[:, 1]
    rise = np.deg2rad(ELEVATION)
    eyes = np.column_stack([np.cos(rise) * toward, np.full(len(toward), np.sin(rise))])
    shown = _shown(stones, velocities, eyes)
    return eyes[np.argmax(np.where(shown >= (1 - HIDDEN) * shown.max(), score, -np.inf))]


def _shown(stones: Assemblage, velocities: FloatArray, toward: FloatArray) -> FloatArray:
    """Return the share (k,) of the motion that no other stone hides from eyes far away in the directions (k, 3).

    Of many stones that move some are looked for, from the fastest to the slowest, each weighed by its speed.
    Stones hide as the boxes around them do; the neighbours of a stone, whose boxes begin within its own half diagonal, hide
    nothing of it.
    """
    speed = stone_speed(stones, velocities)
    moving = np.flatnonzero(moving_stones(speed) & ~stones.fixed)
    if not len(moving):
        return np.ones(len(toward))
    # Stones of one wall follow each other where all are as fast: even steps through the order meet all walls.
    steps = np.linspace(0, len(moving) - 1, min(len(moving), LOOKED_FOR)).astype(int)
    looked = moving[np.argsort(-speed[moving], kind="stable")[steps]]
    owner, free = stone_of_point(stones), np.flatnonzero(~stones.fixed)
    low, high = np.full((stones.count, 3), np.inf), np.full((stones.count, 3), -np.inf)
    np.minimum.at(low, owner, stones.points)
    np.maximum.at(high, owner, stones.points)
    radius = np.linalg.norm(high - low, axis=1) / 2
    seen = np.zeros(len(toward))
    for stone in looked:
        start = (low[stone] + high[stone]) / 2
        # The line of sight enters and leaves the slabs between opposite faces of each box: kne, of eye k, stone n and axis e.
        faces = np.stack([low[free] - start, high[free] - start])[:, None] / toward[:, None]
        enters, leaves = faces.min(axis=0).max(axis=2), faces.max(axis=0).min(axis=2)
        seen += speed[stone] * ~((enters < leaves) & (enters > radius[stone])).any(axis=1)
    return seen / speed[looked].sum()


def camera_position(points: FloatArray, toward: FloatArray, view_angle: float, aspect: float) -> tuple[FloatArray, FloatArray]:
    """Return camera position (3,) and focus (3,) that frame points (n, 3) seen from the direction `toward`, z upright.

    view_angle: vertical, degrees; aspect: width over height of the picture.
    """
    right = np.cross([0.0, 0.0, 1.0], toward)
    right /= np.linalg.norm(right)
    # axis_ac: axis a (right, up, towards the camera), component c.
    axis = np.stack([right, np.cross(toward, right), toward])
    projected = points @ axis.T
    centre = (projected.min(axis=0) + projected.max(axis=0)) / 2
    reach = np.abs(projected - centre)
    slope = np.tan(np.deg2rad(view_angle) / 2)
    distance = float((np.maximum(reach[:, 0] / aspect, reach[:, 1]) / slope + (projected - centre)[:, 2]).max())
    focus = centre @ axis
    return focus + 1.08 * distance * toward, focus


def ground_plate(stones: Assemblage) -> BoolArray:
    """Return True (nb,) for fixed stones that lie below the whole structure and reach beyond it on every side in plan."""
    owner = stone_of_point(stones)
    low, high = np.full((stones.count, 3), np.inf), np.full((stones.count, 3), -np.inf)
    np.minimum.at(low, owner, stones.points)
    np.maximum.at(high, owner, stones.points)
    if not (~stones.fixed).any():
        return np.zeros(stones.count, dtype=bool)
    bottom, top = low[~stones.fixed].min(axis=0), high[~stones.fixed].max(axis=0)
    slack = 1e-6 * stones.size
    covers = (low[:, :2] <= bottom[:2] + slack).all(axis=1) & (high[:, :2] >= top[:2] - slack).all(axis=1)
    return stones.fixed & covers & (high[:, 2] <= bottom[2] + slack)


def push_direction(record: Analysis) -> FloatArray | None:
    """Return the unit vector (3,) of an analysis' load, None of one that pushes nowhere."""
    vector = np.array(record.direction)
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else None


def push_arrow_start(stones: Assemblage, push: FloatArray) -> FloatArray:
    """Return the tail (3,) m of the arrow of a load in direction `push`: above the structure, where nothing hides it."""
    free = stones.points[~stones.fixed[stone_of_point(stones)]]
    low, high = free.min(axis=0), free.max(axis=0)
    middle = np.array([*(low + high)[:2] / 2, high[2] + 0.09 * stones.size])
    return middle - 0.5 * PUSH_LENGTH * stones.size * push
