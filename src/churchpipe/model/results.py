"""What the analyses return."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import one_of
from churchpipe.model.arrays import FloatArray, floats, store, store_arrays
from churchpipe.model.card import Shown
from churchpipe.model.pictures import diagram, picture

if TYPE_CHECKING:
    from churchpipe.model.assemblage import Assemblage
    from churchpipe.model.shell import ShellModel

Status = Literal["optimal", "converged", "not-converged", "unstable", "unbounded", "failed"]


def _none() -> FloatArray:
    return np.zeros(0)


@dataclass(frozen=True, slots=True)
class Iteration:
    """One step of the non-associative iteration: load factor, relative friction violation, and gap g / alpha if computed."""

    load_factor: float
    violation: float
    gap: float = np.nan


@dataclass(frozen=True, slots=True)
class StartRun:
    """What the non-associative iteration made of one start: all that `LimitState` says of the one it reports, for each of them.

    start: one of those that an analysis may be asked for, or "held", which it takes by itself: near a state in which stones that
    friction alone holds are held fast. converged: the iteration came to its end; whether it is a collapse state is what the gap
    says. interval: of the start that leads, NaN for others, since it costs as much as a search.
    """

    start: str
    load_factor: float
    converged: bool
    gap: float
    interval: tuple[float, float]
    history: tuple[Iteration, ...]


@dataclass(frozen=True, slots=True, repr=False)
class LimitState(Shown):
    """The result of a rigid-block limit analysis.

    load_factor: NaN when unstable or failed, or where only dilatancy is known to hold any load (not-converged), inf when
    unbounded. lower_bound, upper_bound: static and kinematic bounds
    (NaN for a non-associative result, which has none). forces (nc, 3) N, components n, t1, t2; velocities (nb, 6),
    translation of the centroid and rotation, scaled to f_L . u = 1 per total weight (for an unstable structure: the
    falling mechanism, f_D . u = 1 per total weight). equilibrium_residual and cone_violation are relative to the total weight.
    gap: de Saxce gap g of a non-associative state (NaN when associative); interval: load factors compatible with its
    mechanism; friction_violation: sum of |t| beyond the cone over sum of mu n. fixed_points: every distinct load factor
    that the starts of the iteration led to; starts: how each start got there.

    tie_forces (nt,) N, the tensions; tie_sensitivity (nt,) d load_factor / d strength, 1/N: the rate at which the mechanism
    lengthens the tie (without dilatancy, for normal forces held as they are), NaN where there is no load factor.

    Load factor and velocities of moving parts are meaningful; single point forces are not unique, nor is the tension of a tie
    that the mechanism neither lengthens nor shortens.
    """

    load_factor: float
    status: Status
    lower_bound: float
    upper_bound: float
    forces: FloatArray
    velocities: FloatArray
    equilibrium_residual: float = np.nan
    cone_violation: float = np.nan
    iterations: int = 0
    seconds: float = 0.0
    solver: str = ""
    flow: Literal["associative", "non-associative"] = "associative"
    history: tuple[Iteration, ...] = field(default=())
    gap: float = np.nan
    interval: tuple[float, float] = (np.nan, np.nan)
    friction_violation: float = np.nan
    fixed_points: tuple[float, ...] = field(default=())
    starts: tuple[StartRun, ...] = field(default=())
    message: str = ""
    tie_forces: FloatArray = field(default_factory=_none)
    tie_sensitivity: FloatArray = field(default_factory=_none)

    def __post_init__(self) -> None:
        one_of("LimitState.status", self.status, *get_args(Status))
        store_arrays(self, finite=False, forces=(None, 3), velocities=(None, 6), tie_forces=(None,))
        store_arrays(self, finite=False, tie_sensitivity=(len(self.tie_forces),))

    def show(self, stones: "Assemblage") -> Any:
        """Return a picture of the mechanism, of the stones that the state is of (`churchpipe.show`)."""
        return picture(stones, self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows: dict[str, object] = {"load factor": self.load_factor, "status": self.status, "flow rule": self.flow}
        if self.flow == "associative":
            rows |= {"lower bound": self.lower_bound, "upper bound": self.upper_bound}
        else:
            rows |= {"interval": "{:.4f} to {:.4f}".format(*self.interval), "gap": self.gap}
        return "Limit analysis of rigid blocks", rows | ({"message": self.message} if self.message else {})


@dataclass(frozen=True, slots=True, repr=False)
class ShellLimitState(Shown):
    """The result of a limit analysis of a shell.

    load_factor: NaN when unstable or failed, inf when unbounded. lower_bound, upper_bound: of the stress and of the velocity
    field, for the problem of this mesh (Morley bending is neither static nor kinematic: refine and extrapolate).
    tie_forces (nt,) N and tie_sensitivity (nt,) 1/N as in `LimitState`.
    stress (nq, 6) N/m and N, in the axes of the facets, after it the forces in the joints at feet, N/m; velocities (nn, 3) and
    edge_rotation (ne,), f_L . u = 1 per total weight (of an unstable shell: the falling mechanism, f_D . u = 1). plastic (nt, 6):
    its strain rates, 1/m and 1/m2, membrane and curvature, the mean of each facet in its own axes, and what happens in the joint
    at its foot spread over it. equilibrium_residual over the total weight, yield_violation over the unit
    of stress. beam_velocities (nm, 6): of ring beams, about their centroids.
    """

    load_factor: float
    status: Status
    lower_bound: float
    upper_bound: float
    stress: FloatArray
    velocities: FloatArray
    edge_rotation: FloatArray
    plastic: FloatArray
    equilibrium_residual: float = np.nan
    yield_violation: float = np.nan
    iterations: int = 0
    seconds: float = 0.0
    solver: str = "clarabel"
    message: str = ""
    tie_forces: FloatArray = field(default_factory=_none)
    tie_sensitivity: FloatArray = field(default_factory=_none)
    beam_velocities: FloatArray = field(default_factory=lambda: np.zeros((0, 6)))

    def __post_init__(self) -> None:
        one_of("ShellLimitState.status", self.status, *get_args(Status))
        store_arrays(self, finite=False, stress=(None, 6), velocities=(None, 3), edge_rotation=(None,), plastic=(None, 6))
        store_arrays(self, finite=False, tie_forces=(None,), tie_sensitivity=self.tie_forces.shape, beam_velocities=(None, 6))

    def show(self, shell: "ShellModel") -> Any:
        """Return a picture of the mechanism, of the shell that the state is of (`churchpipe.show`)."""
        return picture(shell, self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows = {"load factor": self.load_factor, "status": self.status}
        return "Limit analysis of the shell", {**rows, "lower bound": self.lower_bound, "upper bound": self.upper_bound}


@dataclass(frozen=True, slots=True)
class CapacityStep:
    """One step of a pushover: work-conjugate displacement f_L . u (m, per total weight), and what proves its stresses.

    residual: of equilibrium, over the total weight; violation of the strength, over the unit of stress; gap: primal against dual
    objective, relative.
    """

    displacement: float
    load_factor: float
    residual: float
    violation: float
    gap: float
    iterations: int
    seconds: float


@dataclass(frozen=True, slots=True, repr=False)
class CapacityCurve(Shown):
    """The result of a pushover of a shell: dead load first (step 0, load factor 0), then lateral load by displacement.

    load_factor (ns,); control (ns,) m, the displacement of node `control_point` along the load since the dead load;
    displacement (nn, 3) m and edge_rotation (ne,) rad at the last step, since the dead load (of an unstable shell: the falling
    mechanism); plastic (nt, 6): plastic membrane strains and curvatures (1/m) at the last step, those of the dead load
    included, the mean of each facet in its own axes; multipliers (nt, planes): of each plane, facet means, or the openings (m)
    of the twelve joint corners of the exact cell; tie_forces (ns, nt) N, the tensions of the ties.
    status: "converged" when every step is proved and the last ones lie on a plateau.
    """

    load_factor: FloatArray
    control: FloatArray
    control_point: int
    displacement: FloatArray
    edge_rotation: FloatArray
    plastic: FloatArray
    multipliers: FloatArray
    steps: tuple[CapacityStep, ...]
    status: Status
    tie_forces: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    seconds: float = 0.0
    message: str = ""

    def __post_init__(self) -> None:
        one_of("CapacityCurve.status", self.status, *get_args(Status))
        count = len(self.steps)
        store_arrays(self, load_factor=(count,), control=(count,))
        store_arrays(self, finite=False, displacement=(None, 3), edge_rotation=(None,), plastic=(None, 6))
        store_arrays(self, finite=False, multipliers=(None, None))
        store(
            self,
            tie_forces=floats(
                "CapacityCurve.tie_forces", self.tie_forces if np.size(self.tie_forces) else np.zeros((count, 0)), (count, None)
            ),
        )
        if not 0 <= int(self.control_point) < len(self.displacement):
            expected = f"0 to {len(self.displacement) - 1}"
            raise InputError("CapacityCurve.control_point", "no such node", found=int(self.control_point), expected=expected)

    @property
    def plateau(self) -> float:
        """The largest load factor reached."""
        return float(self.load_factor.max(initial=0.0))

    def show(self, shell: "ShellModel") -> Any:
        """Return a picture of the last step, of the shell that the curve is of (`churchpipe.show`)."""
        return picture(shell, self)

    def plot(self) -> Any:
        """Return the diagram of the curve (`churchpipe.plot`)."""
        return diagram(self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows = {"plateau": self.plateau, "status": self.status, "steps": len(self.load_factor)}
        return "Capacity curve of the shell", rows
