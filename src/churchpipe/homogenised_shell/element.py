"""The flat facet: membrane with linear strain (LST) or constant strain (CST), and Morley's triangle in bending.

Unknowns: three translations of each node. One rotation of each edge about its own axis, from its lower to its higher node; it is
a scalar that any number of facets share at any angle. With LST also the translation of each mid-side relative to the mean of its
two ends.

A mid-side translation has a component normal to the surface at folds only. Bending does not depend on it: in a plate nothing
would resist it, and in a curved roof made of facets it would make the membrane too soft (docs/development.md). At a level fold,
where the thrust of a vault changes its direction, as under a lantern, nothing but bending would hold it: it has none there.

Sources: L. S. D. Morley (1968), Aeronautical Quarterly 19; B. Fraeijs de Veubeke (1965) for the LST.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import scipy.sparse as sp

from churchpipe.errors import InputError
from churchpipe.homogenised_shell.edges import Edges, find_edges
from churchpipe.homogenised_shell.foot_joints import FootJoints, foot_joints, pair_stiffness
from churchpipe.homogenised_shell.ledges import carried_by_walls
from churchpipe.homogenised_shell.rigid_beams import carried_by_beams
from churchpipe.homogenised_shell.settings import SOLVER
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray
from churchpipe.model.shell import ShellModel

Membrane = Literal["LST", "CST"]
Stations = Literal["inner", "corners"]
# Barycentric coordinates (q, 3) of the points at which strain is evaluated, all with the same weight.
_STATIONS = {
    ("LST", "inner"): (np.ones((3, 3)) + 3 * np.eye(3)) / 6,
    ("LST", "corners"): np.eye(3),
    ("CST", "inner"): np.ones((1, 3)) / 3,
}


@dataclass(frozen=True, slots=True)
class ShellElements:
    """A shell cut into elements.

    Unknowns (n,): translations, node by node, m; edge_rotation, rad; bubbles, m (in this order). strain (6 nq, n): rows E11, E22,
    2 E12, chi11, chi22, 2 chi12 of each quadrature point in the facet's axes, strain at depth x3 is E + x3 chi; weight (nq,) m2;
    facet (nq,). bubble_edge (nb,), bubble_direction (nb, 3): mid-side translations beyond the mean of the ends.
    clamped (n,): unknowns held at the supported nodes, and at border edges between two of them; those of feet of vaults and of
    nodes under ring beams. motion (n - 6 nm, n): how translations, rotations and bubbles follow from the unknowns, of which the
    last are the velocities of beams: feet go with their walls, and nodes under beams with these. feet: joints at feet, whose
    pairs of corners are points behind those of the facets, with the motions of the corners, m, for strain and half of the edge,
    m, for weight; None: what stands is held there.
    """

    shell: ShellModel
    edges: Edges
    bubble_edge: IntArray
    bubble_direction: FloatArray
    strain: sp.csr_matrix[np.float64]
    weight: FloatArray
    facet: IntArray
    clamped: BoolArray
    motion: sp.csr_matrix[np.float64]
    feet: FootJoints | None = None

    @property
    def inner(self) -> int:
        """Number of points within the facets; those of the joints at their feet come after them."""
        return len(self.facet) - (0 if self.feet is None else self.feet.count)

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self.strain.shape[1]

    def translations(self, unknowns: FloatArray) -> FloatArray:
        """Return the translations of the nodes (nn, 3)."""
        return self._moved(unknowns)[: 3 * len(self.shell.points)].reshape(-1, 3)

    def edge_rotation(self, unknowns: FloatArray) -> FloatArray:
        """Return the rotation of each edge about its axis (ne,)."""
        start = 3 * len(self.shell.points)
        return self._moved(unknowns)[start : start + len(self.edges.nodes)]

    def beam_motion(self, unknowns: FloatArray) -> FloatArray:
        """Return the motion of the beams (nm, 6), about their centroids."""
        return unknowns[self.motion.shape[0] :].reshape(-1, 6)

    def _moved(self, unknowns: FloatArray) -> FloatArray:
        """Return translations, rotations and bubbles: the unknowns themselves where none goes with a wall or a beam."""
        rows, columns = self.motion.shape
        alone = rows == columns and not len(self.shell.ledges) and not len(self.shell.held)
        return unknowns if alone else np.asarray(self.motion @ unknowns)

    def conjugate(self, own: FloatArray, beams: FloatArray) -> FloatArray:
        """Return the forces (n,) conjugate to the unknowns: of those (n - 6 nm,) on nodes, edges and bubbles, and of wrenches
        (nm, 6) on the beams."""
        forces = np.asarray(self.motion.T @ own)
        forces[len(own) :] += beams.ravel()
        return forces

    def facet_strain(self, unknowns: FloatArray) -> FloatArray:
        """Return the strain of each facet (nt, 6), as `of_facets`."""
        return self.of_facets(self.point_strain(unknowns))

    def point_strain(self, unknowns: FloatArray) -> FloatArray:
        """Return the strain of each point (nq, 6), and the motions of the corners of joints at feet."""
        return np.asarray(self.strain @ unknowns).reshape(-1, 6)

    def of_facets(self, strain: FloatArray) -> FloatArray:
        """Return the mean in each facet (nt, 6) of strains at the points (nq, 6), and with it the motion in the joint at its foot
        as if it were spread over the facet, but for what slides across the thickness."""
        out = self.facet_mean(strain)
        if self.feet is not None:
            feet, shell = self.feet, self.shell
            axes, away = shell.axes[feet.facet], feet.frame[:, 0]
            first, second = np.einsum("pkj,pjc->kpc", strain[self.inner :].reshape(-1, 2, 3), feet.frame)
            across = np.einsum("pc,pc->p", feet.frame[:, 2], axes[:, 2]) * shell.thickness[feet.facet]
            spread = np.concatenate(
                [
                    _symmetric(axes, (first + second) / 2, away),
                    _symmetric(axes, (second - first) / np.where(across == 0, np.inf, across)[:, None], away),
                ],
                axis=1,
            )
            np.add.at(out, feet.facet, spread * (feet.length / shell.area[feet.facet])[:, None])
        return out

    def facet_mean(self, values: FloatArray) -> FloatArray:
        """Return the mean in each facet (nt, k) of values at the points (nq, k)."""
        own, weight = self.facet[: self.inner], self.weight[: self.inner]
        total = np.zeros((len(self.shell.triangles), values.shape[1]))
        np.add.at(total, own, values[: self.inner] * weight[:, None])
        return total / np.bincount(own, weight)[:, None]

    def point_stiffness(self, stiffness: FloatArray) -> FloatArray:
        """Return the stiffness (nq, 6, 6) of the points for that of the facets (nt, 6, 6)."""
        out = stiffness[self.facet]
        if self.feet is not None:
            out[self.inner :] = pair_stiffness(self.shell, self.feet, out[self.inner :])
        return out

    def stiffness_matrix(self, stiffness: FloatArray) -> sp.csc_matrix[np.float64]:
        """Return K (n, n) for the facets' stiffness (nt, 6, 6), as of `stiffness.wall_stiffness`."""
        local = self.point_stiffness(stiffness) * self.weight[:, None, None]
        count = len(self.facet)
        blocks = sp.bsr_matrix((local, np.arange(count), np.arange(count + 1)), shape=(6 * count, 6 * count))
        return sp.csc_matrix(self.strain.T @ blocks @ self.strain)


def shell_elements(
    shell: ShellModel, membrane: Membrane = "LST", stations: Stations = "inner", *, on_joints: bool = False
) -> ShellElements:
    """Divide a shell into elements.

    stations: where the strain of an LST is evaluated. With "inner" the elastic energy is exact and load factors are most
    accurate. With "corners" a linear strain that obeys the flow rule at the corners obeys it everywhere, so load factors in the
    plane of a wall are upper bounds, at the price of a larger error. Those of a CST are upper bounds in any case.
    on_joints: whether feet stand on joints that open and slide, or are held.

    Raises
    ------
    InputError: unknown kind of membrane or stations.
    """
    if not isinstance(membrane, str) or membrane not in get_args(Membrane):
        raise InputError("membrane", "unknown element", found=membrane, expected=", ".join(get_args(Membrane)))
    if not isinstance(stations, str) or stations not in get_args(Stations):
        raise InputError("stations", "unknown points", found=stations, expected=", ".join(get_args(Stations)))
    edges = find_edges(shell.triangles)
    places = _STATIONS[membrane, stations if membrane == "LST" else "inner"]
    bubble_edge, bubble_direction = np.zeros(0, dtype=np.int64), np.zeros((0, 3))
    if membrane == "LST":
        bubble_edge, bubble_direction = _bubbles(shell, edges)
    facet = np.repeat(np.arange(len(shell.triangles), dtype=np.int64), len(places))
    strain = _strain_operator(shell, edges, places, bubble_edge, bubble_direction)
    held = shell.supported[edges.nodes].all(axis=1) & (edges.facets == 1)
    carried, along = carried_by_beams(shell, edges, bubble_edge)
    on_walls, feet = carried_by_walls(shell, edges, bubble_edge, bubble_direction)
    motion = sp.csr_matrix(sp.hstack([on_walls, on_walls @ carried]))
    strain, weight = sp.csr_matrix(strain @ motion), shell.area[facet] / len(places)
    clamped = np.concatenate([np.repeat(shell.supported, 3), held, held[bubble_edge]]) | along | feet
    joints = foot_joints(shell, edges) if on_joints else None
    if joints is not None:
        own = joints.motion
        strain = sp.csr_matrix(
            sp.vstack([strain, sp.csr_matrix((own.data, own.indices, own.indptr), (own.shape[0], strain.shape[1]))])
        )
        facet, weight = np.append(facet, joints.facet), np.append(weight, joints.length)
        clamped[: own.shape[1]] &= ~joints.free(len(shell.points), len(edges.nodes))
    return ShellElements(
        shell=shell,
        edges=edges,
        bubble_edge=bubble_edge,
        bubble_direction=bubble_direction,
        strain=strain,
        weight=weight,
        facet=facet,
        clamped=np.append(clamped, np.zeros(carried.shape[1], np.bool_)),
        motion=motion,
        feet=joints,
    )


def surface_load(elements: ShellElements, pressure: FloatArray) -> FloatArray:
    """Return the work-conjugate forces (n,), N and Nm, of a load per area on each facet (nt, 3), N/m2.

    In the plane of the facet they are consistent with the membrane; normal to it each corner takes a third.
    """
    shell = elements.shell
    third = pressure * shell.area[:, None] / 3
    nodes = np.zeros((len(shell.points), 3))
    np.add.at(nodes, shell.triangles, third[:, None, :])
    # The mid-side function 4 lambda_i lambda_j (lambda: barycentric coordinates) has the integral A / 3 over the area A. It
    # comes on top of A / 3 for each corner.
    third = np.repeat(third[:, None], 3, axis=1)
    return node_load(elements, nodes, third, np.zeros_like(third))


def node_load(elements: ShellElements, nodes: FloatArray, sides: FloatArray, moments: FloatArray) -> FloatArray:
    """Return the work-conjugate forces (n,), N and Nm, of forces on the nodes (nn, 3) N, and of forces N and moments Nm in the
    plane of the facets on their sides, both (nt, k, 3): side k from corner k to the next, forces with the motion of its middle
    beyond the mean of its ends, moments with the rotation there.

    Of forces on the sides only what acts in the plane of the facet counts, since bending does not depend on them. A side turns
    about itself by its own rotation, and square to itself as its ends rise, by the slope (w_j - w_i) / L of Morley's triangle.
    """
    shell, edges = elements.shell, elements.edges
    normal = shell.axes[:, None, 2]
    in_plane = sides - np.einsum("fkc,fkc->fk", sides, np.broadcast_to(normal, sides.shape))[..., None] * normal
    total, about = np.zeros((len(edges.nodes), 3)), np.zeros(len(edges.nodes))
    np.add.at(total, edges.of_facet, in_plane)
    bubbles = np.einsum("bc,bc->b", total[elements.bubble_edge], elements.bubble_direction)
    along = edges.directions(shell.points)[edges.of_facet]
    np.add.at(about, edges.of_facet, np.einsum("fkc,fkc->fk", moments, along))
    ends = edges.nodes[edges.of_facet]
    length = np.linalg.norm(shell.points[ends[..., 1]] - shell.points[ends[..., 0]], axis=2)
    rise = np.einsum("fkc,fkc->fk", np.cross(np.broadcast_to(normal, moments.shape), moments), along) / length
    lifted = nodes.copy()
    for end, sign in ((1, 1.0), (0, -1.0)):
        np.add.at(lifted, ends[..., end], sign * rise[..., None] * normal)
    own = np.concatenate([lifted.ravel(), about, bubbles])
    return elements.conjugate(own, np.zeros((shell.beams.count, 6)))


def _bubbles(shell: ShellModel, edges: Edges) -> tuple[IntArray, FloatArray]:
    """Return edges (nb,) and directions (nb, 3) of the mid-side unknowns: along the edge, across it, and normal at folds."""
    along, own = edges.directions(shell.points), shell.axes[:, None, 2]
    first = shell.axes[edges.first, 2][edges.of_facet]
    same_side = np.where((own * first).sum(axis=2) < 0, -1.0, 1.0)
    mean = np.zeros_like(along)
    np.add.at(mean, edges.of_facet, same_side[..., None] * own)
    mean /= np.sqrt((mean**2).sum(axis=1))[:, None]
    fold = np.zeros(len(along))
    np.maximum.at(fold, edges.of_facet, np.sqrt((np.cross(own, first) ** 2).sum(axis=2)))
    level = np.abs(along[:, 2]) < SOLVER.level
    everywhere, folded = np.arange(len(along), dtype=np.int64), np.flatnonzero((fold > SOLVER.fold) & ~level)
    directions = np.concatenate([along, np.cross(mean, along), mean[folded]])
    return np.concatenate([everywhere, everywhere, folded]), directions


def _strain_operator(
    shell: ShellModel, edges: Edges, places: FloatArray, bubble_edge: IntArray, bubble_direction: FloatArray
) -> sp.csr_matrix[np.float64]:
    nn, nt, nq, ne = len(shell.points), len(shell.triangles), len(places), len(edges.nodes)
    slope = _slopes(shell)
    # Rows of point q of facet f: 6 (f nq + q) + component.
    row = 6 * (nq * np.arange(nt)[:, None] + np.arange(nq))
    parts: list[tuple[FloatArray, IntArray, IntArray]] = []

    translation = 3 * shell.triangles[:, :, None] + np.arange(3)
    corner = _symmetric(shell.axes[:, None, None], np.eye(3)[None, None], slope[:, :, None])
    for q in range(nq):
        parts.append(_entries(corner, row[:, q], translation))
    bend_corner, bend_edge = _bending(shell, edges, slope)
    for q in range(nq):
        parts.append(_entries(bend_corner, row[:, q] + 3, translation))
        parts.append(_entries(bend_edge, row[:, q] + 3, 3 * nn + edges.of_facet))
    if len(bubble_edge):
        side = _sides_of_edges(edges)[bubble_edge]
        for copy in range(side.shape[1]):
            bubble = np.flatnonzero(side[:, copy] >= 0)
            facet, k = np.divmod(side[bubble, copy], 3)
            first, second = slope[facet, k], slope[facet, (k + 1) % 3]
            for q in range(nq):
                gradient = 4 * (places[q, k, None] * second + places[q, (k + 1) % 3, None] * first)
                values = _symmetric(shell.axes[facet], bubble_direction[bubble], gradient)
                parts.append(_entries(values, row[facet, q], 3 * nn + ne + bubble))
    values, rows, columns = (np.concatenate(same) for same in zip(*parts, strict=True))
    matrix = sp.csr_matrix((values, (rows, columns)), shape=(6 * nt * nq, 3 * nn + ne + len(bubble_edge)))
    matrix.eliminate_zeros()
    return matrix


def _entries(values: FloatArray, first_row: IntArray, columns: IntArray) -> tuple[FloatArray, IntArray, IntArray]:
    """Flatten values (f, ..., 3 components), first rows (f,) and columns (f, ...) to triplets."""
    rows = first_row.reshape(-1, *[1] * (values.ndim - 1)) + np.arange(3)
    shape = values.shape
    return values.ravel(), np.broadcast_to(rows, shape).ravel(), np.broadcast_to(columns[..., None], shape).ravel()


def _slopes(shell: ShellModel) -> FloatArray:
    """Return the gradients (nt, 3, 3) of the barycentric coordinates, `slope_fkc`, 1/m."""
    corners = shell.points[shell.triangles]
    opposite = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]
    winding = np.cross(opposite[:, 0], opposite[:, 1])
    double_area = np.sqrt((winding**2).sum(axis=1))[:, None]
    return np.cross((winding / double_area)[:, None], opposite) / double_area[:, None]


def _symmetric(axes: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the components 11, 22, 12 + 21 (..., 3) of the dyad first x second (..., 3) in the facet's axes (..., 3, 3).

    With a direction of motion and the gradient of its shape function this is its membrane strain.
    """
    u = np.einsum("...ac,...c->...a", axes[..., :2, :], first)
    v = np.einsum("...ac,...c->...a", axes[..., :2, :], second)
    return np.stack([u[..., 0] * v[..., 0], u[..., 1] * v[..., 1], u[..., 0] * v[..., 1] + u[..., 1] * v[..., 0]], axis=-1)


def _bending(shell: ShellModel, edges: Edges, slope: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the Morley curvature of the corner translations (nt, 3, 3, 3) and of the edge rotations (nt, 3, 3).

    With A the area, w the displacement normal to the facet, dw/dm its slope at mid-edge, L the length of an edge, m its outward
    normal and s its direction from corner i to corner j, chi = -1/A sum over edges [L dw/dm m m + (w_j - w_i) s m]_sym. L m = -2
    A g, with g the gradient of the barycentric coordinate of the opposite corner.
    """
    normal = shell.axes[:, 2]
    corners = shell.points[shell.triangles]
    side = corners[:, [1, 2, 0]] - corners
    g = slope[:, [2, 0, 1]]
    outward = -g / np.sqrt((g**2).sum(axis=2))[..., None]
    axes = shell.axes[:, None]
    turn = np.einsum("fc,fkc->fk", normal, np.cross(edges.directions(shell.points)[edges.of_facet], outward))
    rotation = 2 * turn[..., None] * _symmetric(axes, outward, g)
    rise = 2 * _symmetric(axes, side, g) / (side**2).sum(axis=2)[..., None]
    deflection = np.roll(rise, 1, axis=1) - rise
    return deflection[:, :, None, :] * normal[:, None, :, None], rotation


def _sides_of_edges(edges: Edges) -> IntArray:
    """Return the facet sides 3 f + k that lie on each edge (ne, most facets), filled up with -1."""
    sides = edges.of_facet.ravel()
    order = np.argsort(sides, kind="stable")
    start = np.concatenate([[0], np.cumsum(edges.facets)[:-1]])
    out = np.full((len(edges.nodes), int(edges.facets.max())), -1, dtype=np.int64)
    out[sides[order], np.arange(len(sides)) - start[sides[order]]] = order
    return out
