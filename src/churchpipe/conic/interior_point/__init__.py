"""A primal-dual interior-point method for many small local problems that are coupled by common rows.

It solves, with x_k the few variables of local problem k (the force at a contact point, the stress in a facet),

    minimise    sum_k (1/2 x_k Q_k x_k + linear_k x_k) - reward load
    subject to  B x + constant + load growth = 0,   G_k x_k + s_k = right_k,   s_k in a cone,   load <= cap

B is the `coupling` (the balance of all bodies), y its multipliers (velocities); s are slacks and z their multipliers, the
constraints of one local problem; theta and kappa are the pair that makes the problem homogeneous, so that certificates of
infeasibility are solutions as well.

Vectors of a cone have a product u o v and a unit e, u o e = u, the Jordan product (Alizadeh and Goldfarb 2003): entry by entry
for nonnegative numbers, (u . v, u_0 v_1 + v_0 u_1) for the second-order cone u_0 >= |u_1|. A vector lies in its cone when its
eigenvalues, u_0 - |u_1| and u_0 + |u_1| there, are not negative. At a solution s o z = 0. Every iteration comes nearer to it by
keeping s o z near mu e, where mu, the mean of the complementarity products, falls to zero. The scaling W of Nesterov and Todd
makes slacks and multipliers one vector, lam = W z = W^-1 s. "Flat" arrays hold all cones one after another, and "component first"
means that first the first component of all local problems is listed, then the second. In the order of reading:

- `cones`, `nonnegative`, `second_order`: products, steps to the boundary, and the scaling W.
- `local`: what a local problem must know; `coulomb`: contact points with friction; the shell has its own.
- `coupling`, `wrenches`: products with B and its transpose.
- `problem`: the problem above; `residuals`: how far an iterate is from solving it; `iterate`: iterates and steps.
- `warm`: starts near a solution that is known roughly.
- `normal`: the sparse matrix B S B^T, where S_k = (Q_k + G_k^T W_k^-2 G_k)^-1 is the compliance of local problem k.
- `kkt`: the linear system of one iteration, named after Karush, Kuhn and Tucker, reduced to that matrix and factorised.
- `newton`: the directions of one iteration, all by one factor; `loop`: predictor, corrector and the end.
- `solver`: cone programs of `conic.program` on this loop.
"""

from churchpipe.conic.interior_point.info import Info
from churchpipe.conic.interior_point.settings import Settings
from churchpipe.conic.interior_point.solver import InteriorPointSolver, solve_interior_point

__all__ = ["Info", "InteriorPointSolver", "Settings", "solve_interior_point"]
