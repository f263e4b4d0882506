"""A primal-dual interior-point method for many small local problems that are coupled by common rows."""

from churchpipe.conic.interior_point.info import Info
from churchpipe.conic.interior_point.settings import Settings
from churchpipe.conic.interior_point.solver import InteriorPointSolver, solve_interior_point
from churchpipe.conic.interior_point.storage import load_program, save_program

__all__ = ["Info", "InteriorPointSolver", "Settings", "load_program", "save_program", "solve_interior_point"]
