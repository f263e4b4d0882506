"""The part of Clarabel's interface that churchpipe uses; the wheel ships no types."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

class ZeroConeT:
    def __init__(self, dim: int) -> None: ...

class NonnegativeConeT:
    def __init__(self, dim: int) -> None: ...

class SecondOrderConeT:
    def __init__(self, dim: int) -> None: ...

Cone = ZeroConeT | NonnegativeConeT | SecondOrderConeT

class DefaultSettings:
    verbose: bool
    max_threads: int
    max_iter: int
    equilibrate_enable: bool
    tol_gap_abs: float
    tol_gap_rel: float
    tol_feas: float
    reduced_tol_gap_abs: float
    reduced_tol_gap_rel: float
    reduced_tol_feas: float

class DefaultSolution:
    x: Sequence[float]
    z: Sequence[float]
    status: object
    iterations: int

class DefaultSolver:
    def __init__(
        self,
        P: sp.csc_matrix[np.float64],
        q: npt.NDArray[np.float64],
        A: sp.csc_matrix[np.float64],
        b: npt.NDArray[np.float64],
        cones: Sequence[Cone],
        settings: DefaultSettings,
    ) -> None: ...
    def solve(self) -> DefaultSolution: ...
