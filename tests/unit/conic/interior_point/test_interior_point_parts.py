"""The parts of the interior-point core, each against its definition; and its second user, a condensed quadratic program."""

from types import SimpleNamespace
from typing import Any

import cvxpy
import numpy as np
import pytest
import scipy.sparse as sp

from churchpipe.conic.cholesky import Cholesky
from churchpipe.conic.interior_point.cones import ProductCone
from churchpipe.conic.interior_point.coulomb import CoulombPoints
from churchpipe.conic.interior_point.coupling import Coupling, touches
from churchpipe.conic.interior_point.iterate import Iterate
from churchpipe.conic.interior_point.loop import interior_start, solve_coupled
from churchpipe.conic.interior_point.nonnegative import Nonnegative
from churchpipe.conic.interior_point.normal import NormalMatrix
from churchpipe.conic.interior_point.problem import CoupledProblem
from churchpipe.conic.interior_point.second_order import SecondOrder
from churchpipe.conic.interior_point.second_order_kernels import kernels
from churchpipe.conic.interior_point.settings import VELOCITIES, Settings, with_duality_gap
from churchpipe.conic.interior_point.wrenches import WrenchCoupling
from churchpipe.generators import arch_piers
from churchpipe.homogenised_shell.planes import PlanePoints
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.rigid_blocks.equilibrium import equilibrium
from churchpipe.rigid_blocks.torsion import friction_points
from sound import laid

cp: Any = cvxpy
rng = np.random.default_rng(1)


def interior(product: ProductCone) -> np.ndarray:
    v = rng.normal(size=product.size)
    return v + (0.1 - min(product.margin(v), 0.0)) * product.identity()


def test_no_loop_encloses_another_compiled_one() -> None:
    # Numba keeps a compiled loop by the values that it encloses; another loop is a new value in every process.
    enclosed = [cell.cell_contents for loop in kernels(3) for cell in loop.py_func.__closure__]
    assert set(enclosed) == {3}


def test_scaling_maps_both_points_to_one() -> None:
    product = ProductCone([SecondOrder(3, 2, 50), Nonnegative(4, 50), SecondOrder(5, 1, 50)])
    s, z = interior(product), interior(product)
    scaling = product.scaling(s, z)
    np.testing.assert_allclose(scaling.apply(z), scaling.solve(s), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(scaling.point(), scaling.apply(z), rtol=1e-12)
    np.testing.assert_allclose(scaling.solve(scaling.apply(s)), s, rtol=1e-9, atol=1e-9)
    v = rng.normal(size=product.size)
    np.testing.assert_allclose(product.product(scaling.point(), scaling.divide(v)), v, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("ignored", [1, 7, 60])
def test_the_largest_rates_are_left_out_of_account(ignored: int) -> None:
    # Many equal values, values in ascending order, and more of them than are left out.
    values = np.concatenate([np.linspace(-1.0, 2.0, 100), np.zeros(50), rng.normal(size=100)])
    problem: Any = SimpleNamespace(cone=ProductCone([Nonnegative(1, len(values))]))
    one, still = np.ones_like(values), 1e9 * np.ones_like(values)
    at = Iterate(one, 0.0, one, still, one, 1.0, 1.0)
    step = Iterate(one, 0.0, one, one, -values, 0.0, 0.0)
    assert at.longest_step(problem, step, ignored) == pytest.approx(1.0 / np.sort(values)[-1 - ignored])


def test_longest_step_ends_on_the_boundary() -> None:
    product = ProductCone([SecondOrder(3, 1, 200), Nonnegative(1, 200)])
    s, step = interior(product), rng.normal(size=product.size)
    length = 1.0 / float(product.rates(s, step, step, np.zeros(1)).max())
    assert product.margin(s + 0.999 * length * step) > 0 > product.margin(s + 1.001 * length * step)


def test_fewer_multipliers_stop_short_where_the_gap_wanted_is_small_and_correctors_lengthen_the_steps() -> None:
    rough, exact = with_duality_gap(VELOCITIES, 1e-3), with_duality_gap(VELOCITIES, 1e-6)
    assert (rough.duality_gap, rough.ignored) == (1e-3, VELOCITIES.ignored)
    assert exact.duality_gap == 1e-6
    assert 1e-6 < exact.ignored < 1e-3
    assert rough.correctors < exact.correctors


def test_multipliers_that_block_first_stop_short_alone() -> None:
    count = 400
    local = CoulombPoints(np.zeros(count), np.full(count, 0.6), np.zeros(count), np.zeros(count))
    plain = sp.csc_matrix(sp.random(6, 3 * count, density=0.5, random_state=1))
    problem = CoupledProblem(local, Coupling(touches(plain, 3, 6)), np.zeros(6), np.ones(6))
    cone = problem.cone
    s, z = interior(cone), interior(cone)
    step = Iterate(np.ones(3 * count), 1.0, np.ones(6), 0.1 * s, -0.5 * z, 0.0, 0.0)
    at = Iterate(np.ones(3 * count), 1.0, np.ones(6), s, z, 1.0, 1.0)
    # Two cones would leave at .25 and .4 of the step, the others at 2.
    step.z.reshape(3, -1)[:, 7] *= 8.0
    step.z.reshape(3, -1)[:, 9] *= 5.0
    assert at.longest_step(problem, step) == pytest.approx(0.25)
    assert at.longest_step(problem, step, 1) == pytest.approx(0.4)
    assert at.longest_step(problem, step, 2) == pytest.approx(2.0)
    new, length = at.stepped(problem, step, 0.99, 2)
    assert length == 1.0
    np.testing.assert_array_equal(new.s, s + step.s)
    went = ((new.z - z) / step.z).reshape(3, -1)
    assert went[:, 7] == pytest.approx(0.8 * 0.25)
    assert went[:, 9] == pytest.approx(0.8 * 0.4)
    assert np.delete(went, [7, 9], axis=1) == pytest.approx(1.0)
    assert cone.margin(new.z) > 0
    # Slacks are spared only where they are asked to be, and then it is they that stop, not the forces.
    step.s.reshape(3, -1)[:, 5] = -4.0 * s.reshape(3, -1)[:, 5]
    assert at.stepped(problem, step, 0.99, 2)[1] == pytest.approx(0.99 * 0.25)
    new, length = at.stepped(problem, step, 0.99, 2, slack=True)
    assert length == 1.0
    assert ((new.s - s) / step.s).reshape(3, -1)[:, 5] == pytest.approx(0.8 * 0.25)
    np.testing.assert_array_equal(new.x, at.x + step.x)


def test_rates_of_a_product_are_those_of_its_parts() -> None:
    product = ProductCone([SecondOrder(3, 2, 30), Nonnegative(4, 30)])
    s, step = interior(product), rng.normal(size=product.size)
    rates = product.rates(s, step, step, np.array([0.0, 0.5]))
    assert rates.shape == (2, product.degree)
    for place in range(product.degree):
        if rates[0, place] > 1e-6:
            alone = product.entries((np.arange(product.degree) == place).astype(float))
            length = 1.0 / rates[0, place]
            assert product.margin(s + 0.999 * length * alone * step) > -1e-12
            assert product.margin(s + 1.001 * length * alone * step) < 0
    np.testing.assert_allclose(rates[1], 1.5 * rates[0], rtol=1e-9)


def by_hand(stones: Assemblage, contacts: Contacts, length: float) -> np.ndarray:
    """The matrix of point forces on wrenches, one entry after another; friction acts where the torsion model has it."""
    row_of = dict(zip(np.flatnonzero(~stones.fixed).tolist(), range(int((~stones.fixed).sum())), strict=True))
    matrix = np.zeros((6 * len(row_of), 3 * len(contacts.point)))
    for k, interface in enumerate(contacts.interface_of_point):
        for place, axis in enumerate(contacts.frame[interface]):
            acts = contacts.point[k] if place == 0 else friction_points(contacts)[k]
            for stone, sign in zip(contacts.blocks[interface].tolist(), (-1.0, 1.0), strict=True):
                if stone in row_of:
                    arm = (acts - stones.centroid[stone]) / length
                    wrench = sign * np.concatenate([axis, np.cross(arm, axis)])
                    matrix[6 * row_of[stone] : 6 * row_of[stone] + 6, 3 * k + place] = wrench
    return matrix


def test_wrenches_multiply_like_their_matrix() -> None:
    piers = {"course": 0.25, "stone_length": 0.5, "springing": 1.0, "pier_width": 0.9, "thickness": 0.6, "height": 2.5}
    arch = arch_piers(**piers, span=1.5, voussoirs=9, depth=0.4)
    stones, contacts = laid(arch)
    balance = equilibrium(stones, contacts, LoadCase((1, 0, 0)), "torsion")
    wrenches, expected = balance.wrenches, by_hand(stones, contacts, balance.length)
    np.testing.assert_allclose(wrenches.tocsc().toarray(), expected, rtol=0, atol=1e-14)
    x, y = rng.normal(size=(len(contacts.point), 3)), rng.normal(size=wrenches.shape[0])
    np.testing.assert_allclose(wrenches.apply(x), expected @ x.ravel(), rtol=0, atol=1e-12)
    np.testing.assert_allclose(wrenches.transpose(y), (expected.T @ y).reshape(-1, 3), rtol=0, atol=1e-12)
    largest, passing = wrenches.sizes(x)
    np.testing.assert_allclose(largest, np.abs(expected).max(axis=1), rtol=1e-12)
    np.testing.assert_allclose(passing, np.abs(expected) @ np.abs(x.ravel()), rtol=1e-12)

    coupling = WrenchCoupling(wrenches)
    plain = Coupling(touches(wrenches.tocsc(), 3, 6, by_point=True))
    np.testing.assert_array_equal(coupling.values, plain.values)
    active = rng.random((3, coupling.count)) < 0.7
    x = x.T.ravel()
    for kept in (np.ones_like(active), active):
        np.testing.assert_allclose(coupling.masked(kept).couple(x), plain.masked(kept).couple(x), rtol=0, atol=1e-12)
        np.testing.assert_allclose(coupling.masked(kept).spread(y), plain.masked(kept).spread(y), rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["coulomb", "cohesive", "capped", "smooth", "mixed", "bounded"])
def test_compliance_inverts_the_local_stiffness(kind: str) -> None:
    count = 40
    limit = {"coulomb": 0.0, "cohesive": 0.5, "capped": 0.5, "smooth": 0.0}.get(kind, 0.5) * np.ones(count)
    slope = {"coulomb": 0.7, "cohesive": 0.7, "capped": -0.2, "smooth": 0.0}.get(kind, 0.4) * np.ones(count)
    bound = np.full(count, np.inf)
    if kind in ("mixed", "bounded"):
        limit[::2], slope[::4] = 0.0, 0.0
    if kind == "bounded":
        bound[::3], bound[1::12] = 0.7, 0.0
    local = CoulombPoints(limit, slope, np.zeros(count), rng.uniform(0, 1, count), bound)
    product = ProductCone(local.cones)
    scaling = product.scaling(interior(product), interior(product))
    compliance = local.compliance(scaling.parts)
    x = np.where(local.active, rng.normal(size=(3, count)), 0.0)
    force = local.quadratic(x) + local.transpose(scaling.solve(scaling.solve(local.apply(x))))
    np.testing.assert_allclose(compliance.apply(force), x, rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(np.einsum("ijk,jk->ik", compliance.matrix, force), x, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize(("block", "rigid"), [(1, False), (6, False), (6, True)])
def test_assembly_equals_the_plain_product(block: int, rigid: bool) -> None:
    bodies, pairs, points = 9, 14, 3
    rows = bodies * block
    coupling = np.zeros((rows, 3, pairs * points))
    for pair in range(pairs):
        i, j = rng.choice(bodies, 2, replace=False)
        transform = rng.normal(size=(block, block))
        for k in range(pair * points, (pair + 1) * points):
            coupling[i * block : (i + 1) * block, :, k] = rng.normal(size=(block, 3))
            other = transform @ coupling[i * block : (i + 1) * block, :, k] if rigid else rng.normal(size=(block, 3))
            coupling[j * block : (j + 1) * block, :, k] = other
    plain = coupling.reshape(rows, -1)
    normal = NormalMatrix(Coupling(touches(sp.csc_matrix(plain), 3, block)))
    root = rng.normal(size=(3, 3, pairs * points))
    compliance = np.einsum("iak,jak->ijk", root, root)
    expected = np.einsum("rik,ijk,sjk->rs", coupling, compliance, coupling)
    matrix = normal.pattern.copy()
    matrix.data = normal.assemble(compliance)
    np.testing.assert_allclose(matrix.toarray(), np.tril(expected), atol=1e-10 * np.abs(expected).max())

    values = normal.assemble(compliance)
    values[normal.diagonal] += 1.0
    factor = Cholesky(normal.pattern, block)
    factor.factor(values)
    right = rng.normal(size=(rows, 2))
    np.testing.assert_allclose((expected + np.eye(rows)) @ factor.solve(right), right, atol=1e-7)


def condensed(matrix: np.ndarray, right: np.ndarray, count: int) -> tuple[PlanePoints, sp.csr_matrix]:
    """Stress increments x_k in R^6 with compliance C^-1, in `count` elements on a strip of nodes with six unknowns."""
    root = rng.normal(size=(6, 6, count))
    compliance = np.einsum("iak,jak->ijk", root, root) + 0.1 * np.eye(6)[:, :, None]
    linear = 0.1 * rng.normal(size=(6, count))
    local = PlanePoints(compliance, linear, matrix, right, np.zeros((6, count)), np.zeros(count))
    dense = np.zeros((6 * (count // 2), 6, count))
    for k in range(count):
        for node in (k // 2, min(k // 2 + 1, count // 2 - 1)):
            dense[6 * node : 6 * node + 6, :, k] = rng.normal(size=(6, 6))
    return local, sp.csr_matrix(dense.reshape(dense.shape[0], -1))


def test_condensed_quadratic_program_agrees_with_cvxpy() -> None:
    count = 20
    matrix, right = rng.normal(size=(8, 6, count)), np.ones((8, count))
    local, coupling = condensed(matrix, right, count)
    inside = 0.05 * rng.normal(size=6 * count)
    growth = rng.normal(size=coupling.shape[0])
    constant = -coupling @ inside
    # Displacement control: the multiplier of the live load earns the prescribed displacement.
    target = 0.3
    problem = CoupledProblem(local, Coupling(touches(sp.csc_matrix(coupling), 6, 6)), constant, growth, reward=target)
    normal = NormalMatrix(problem.coupling)
    ending = solve_coupled(problem, normal, Cholesky(normal.pattern, 6), interior_start(problem, Settings()), Settings())
    assert ending.status == "solved"

    x, load = cp.Variable((6, count)), cp.Variable()
    quadratic = np.zeros((6 * count, 6 * count))
    for k in range(count):
        quadratic[np.ix_(np.arange(6) * count + k, np.arange(6) * count + k)] = local.quadratic_matrix[:, :, k]
    flat = cp.vec(x, order="C")
    slack = [right[:, k] - matrix[:, :, k] @ x[:, k] for k in range(count)]
    constraints: list[Any] = [s >= 0 for s in slack]
    constraints.append(coupling @ flat + constant + load * growth == 0)
    cost = 0.5 * cp.quad_form(flat, cp.psd_wrap(quadratic)) + local.linear.ravel() @ flat
    reference = cp.Problem(cp.Minimize(cost - target * load), constraints)
    reference.solve(solver="CLARABEL")
    assert reference.status == "optimal"
    assert ending.info.primal == pytest.approx(-reference.value, rel=1e-6)
    at = ending.at
    assert at.load / at.theta == pytest.approx(float(load.value), rel=1e-4)
    np.testing.assert_allclose((at.x / at.theta).reshape(6, count), x.value, atol=1e-4)
