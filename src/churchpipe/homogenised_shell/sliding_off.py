"""Whether stones slide off a level before a shell falls, which slides across its thickness at its feet alone."""

from collections.abc import Iterator, Sequence

import numpy as np

from churchpipe.geometry.clusters import NODE_TOLERANCE
from churchpipe.homogenised_shell.loads import pushed
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.model.arrays import BoolArray, FloatArray
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength, by_name
from churchpipe.model.results import ShellLimitState
from churchpipe.model.shell import ShellModel

# The cosine of an angle that is right but for rounding.
_RIGHT = 1e-6


def sliding_off(shell: ShellModel, load: LoadCase, materials: Sequence[JointStrength], state: ShellLimitState) -> str:
    """Return what to say where a shell is pushed by more than friction holds on some level, "" where on none.

    All stones above a level slide off it as one, unless cohesion holds some of them. Of several walls the one with most friction
    counts, so that nothing is said in vain. Of several levels the one whose friction is exceeded most is told.
    """
    if state.status != "optimal":
        return ""
    known = by_name(materials)
    friction = np.array([known[name].friction for name in shell.material.tolist()])
    cohesion = np.array([known[name].cohesion for name in shell.material.tolist()])
    acts = _acting(shell, load, state.load_factor)
    worst, said = 1.0 + SOLVER.duality_gap, ""
    for level, joints, place in _levels(shell):
        if (cohesion[joints] > 0).any():
            continue
        x, y, z = acts[shell.body_centroid[:, 2] > level].sum(axis=0)
        along, down = float(np.hypot(x, y)), max(-float(z), np.finfo(float).tiny)
        holds = float(friction[joints].max())
        if along > worst * holds * down:
            worst = along / (holds * down) if holds > 0 else np.inf
            said = (
                f"the push is {along / down:.4g} of the weight{place[0]}, more than the friction of the joints, {holds:g}: "
                f"stones slide off {place[1]} before, which the shell does not, so use their load factor"
            )
    return said


def _acting(shell: ShellModel, load: LoadCase, load_factor: float) -> FloatArray:
    """Return all forces on facets and beams (nt + nm, 3) at a load factor, N."""
    share = load_factor * pushed(shell, load) * shell.body_weight
    acts = share[:, None] * load.direction
    acts[:, 2] -= shell.body_weight
    for wrench, factor in ((load.dead, 1.0), (load.live, load_factor)):
        if wrench is not None:
            acts += factor * wrench[:, :3]
    return acts


def _levels(shell: ShellModel) -> Iterator[tuple[float, BoolArray, tuple[str, str]]]:
    """Yield heights above which everything may slide, m, the facets (nt,) whose joints hold it there, and two words of the place.

    The ground, where it is level; and where a wall, or a part of it with joints of its own, begins, and its middle, if there all
    walls stand upright in level courses and nothing above is supported.
    """
    height = shell.points[:, 2]
    low, high = height[shell.triangles].min(axis=1), height[shell.triangles].max(axis=1)
    ground = height[shell.supported]
    if len(ground) and np.ptp(ground) < NODE_TOLERANCE:
        yield -np.inf, np.any(shell.supported[shell.triangles], axis=1), ("", "the ground")
    courses = (np.abs(shell.axes[:, 0, 2]) < _RIGHT) & (shell.axes[:, 1, 2] > 1 - _RIGHT)
    bottom = ground.max(initial=float(height.min())) + NODE_TOLERANCE
    places = np.char.add(np.char.add(shell.panel.astype(np.str_), "\n"), shell.material.astype(np.str_))
    tried: set[float] = set()
    for place in np.unique(places).tolist():
        own = places == place
        begin, end = float(low[own].min()), float(high[own].max())
        for level in (begin + NODE_TOLERANCE, 0.5 * (begin + end)):
            joints = (low < level) & (high > level)
            if level > bottom and round(level, 6) not in tried and joints.any() and courses[joints].all():
                tried.add(round(level, 6))
                yield level, joints, (f" above z = {level:.4g} m", "that level")
