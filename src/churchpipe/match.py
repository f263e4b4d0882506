"""The gate: proof that stones and shell are one building."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.clusters import components
from churchpipe.geometry.locate import facet_at, inside_stones, interior_points
from churchpipe.loading.wrenches import resultants
from churchpipe.model.arguments import check_kind, finite, listed, text
from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.placed_loads import PlacedLoads, check_loads_of
from churchpipe.model.polyhedra import face_normals
from churchpipe.model.shell import ShellModel
from churchpipe.shell_mesh.beams import APART
from churchpipe.shell_mesh.bearing import CORNER, across_base, bearing, boundary_edges
from churchpipe.stones.bed_angles import angle_to_joints

WEIGHT = 0.005
CENTROID = 0.01
THICKNESS = 0.02
UNCOVERED = 0.001
SUPPORTED = 0.02
MEAN_ANGLE = 3.0
LOADS = 1e-9
# A stone whose bed differs by more than this (degrees) is turned; part of the stones' volume that may be.
TURNED, TURNED_SHARE = 20.0, 0.001
# Places within a facet, as shares of its corners: the middles of the sixteen equal triangles that it is divided into.
_SIXTEEN = [(i + u, j + u, 4 - i - j - 2 * u) for u, n in ((1 / 3, 4), (2 / 3, 3)) for i in range(n) for j in range(n - i)]
WITHIN = np.array(_SIXTEEN) / 4
# Tells a normal from its opposite: no wall of a drawing lies along it.
SLANT = np.array([0.8367, 0.5476, 0.0123])


@dataclass(frozen=True, slots=True)
class Figure:
    """One quantity of both models: what it is, its values, how far they differ, how far they may, and whether they do not."""

    name: str
    stones: float
    shell: float
    unit: str
    difference: float
    tolerance: float
    passed: bool = field(init=False)

    def __post_init__(self) -> None:
        text("Figure.name", self.name)
        for key in ("stones", "shell", "difference", "tolerance"):
            if finite(f"Figure {self.name}: {key}", getattr(self, key)) < 0 and key in ("difference", "tolerance"):
                raise InputError(f"Figure {self.name}: {key}", "out of range", found=getattr(self, key), expected=">= 0")
        object.__setattr__(self, "passed", self.difference <= self.tolerance)


@dataclass(frozen=True, slots=True)
class Match:
    """The figures of the gate, and whether all of them pass; there are none without a shell, and `message` says why.

    junction_overlap: what mid-surface area x thickness exceeds the stones by, because mid-planes overlap where walls meet; the
    facets there weigh that much less. unfit: stones of a drawing that no panel fits. moved: how far its stones were moved for the
    shell alone, as a sentence, "" where none was.
    """

    passed: bool = field(init=False)
    figures: tuple[Figure, ...] = ()
    junction_overlap: float | None = None
    message: str = ""
    unfit: tuple[str, ...] = ()
    moved: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "passed", bool(self.figures) and all(figure.passed for figure in self.figures))


def match_models(
    stones: Assemblage, contacts: Contacts, shell: ShellModel, loads: PlacedLoads | Sequence[PlacedLoads] | None = None
) -> Match:
    """Compare the two models of a building.

    Weight, in all and wall by wall (panels side by side in one plane, toothed into one another, are one); centroid; volume
    (area x thickness less the overlaps at junctions) and thickness; openings, as mid-surface with no stone behind it and stones
    with no mid-surface; supported length x thickness; the angle between the bed of each stone and the bed direction of the
    shell there. Weights, lengths and volumes differ by their share of the larger one.

    Parameters
    ----------
    stones, contacts, shell
        The two models, by the same panel names.
    loads
        What the building carries, whose forces and moments must come to the same on both; of several cases of one mesh, of each.
    """
    for name, value, kind in (("stones", stones, Assemblage), ("contacts", contacts, Contacts), ("shell", shell, ShellModel)):
        check_kind(f"match_models: {name}", value, kind)
    check_contacts_of(stones, contacts)
    several = [] if loads is None else [loads] if isinstance(loads, PlacedLoads) else loads
    cases = listed("match_models: loads", several, PlacedLoads)
    for case in cases:
        check_loads_of(stones, case)
    # Beams are bodies of both models. All else is of the masonry, of which they are no part.
    drawn, stones = stones, replace(stones, fixed=stones.fixed | np.isin(stones.panel, shell.beams.name))
    free = ~stones.fixed
    # Stones without a panel have no mid-surface to compare with; the figures of the whole count them.
    panels = np.setdiff1d(np.concatenate([stones.panel[free], shell.panel]), [""])
    weights = [
        _relative(
            f"weight of {' + '.join(wall)}",
            stones.weight[np.isin(stones.panel, wall)].sum(),
            shell.weight[np.isin(shell.panel, wall)].sum(),
            "N",
            WEIGHT,
        )
        for wall in _walls(panels, shell)
    ]
    unit_weight = _unit_weights(stones, shell)
    carried = shell.surface_weight / np.where(unit_weight > 0, unit_weight, np.inf)
    volume = float(stones.volume[free].sum())
    facet, outside = _facets_of(stones, shell, np.flatnonzero(free))
    return Match(
        (
            _relative("weight", drawn.weight.sum(), shell.body_weight.sum(), "N", WEIGHT),
            *weights,
            *(figure for number in range(shell.beams.count) for figure in _beam(drawn, shell, number)),
            _centroid(stones, shell),
            _relative("volume", volume, float(shell.area @ carried), "m3", WEIGHT),
            _thickness(stones, shell, facet),
            *_openings(stones, shell, facet, outside),
            _supported_area(drawn, contacts, shell, carried),
            *_beds(stones, contacts, shell, facet),
            *(figure for part in enumerate(cases, 1) for figure in _carried(stones, shell, *part)),
        ),
        float(shell.area @ shell.thickness) / volume - 1,
    )


def _beam(stones: Assemblage, shell: ShellModel, number: int) -> tuple[Figure, ...]:
    """Compare a ring beam or slab: weight, centroid, and how far in plan the nodes that it holds end from its own ends, along the
    largest of its walls and across it."""
    name = str(shell.beams.name[number])
    own = np.flatnonzero(stones.panel == name)
    weight = float(stones.weight[own].sum())
    weights = _relative(f"weight of {name}", weight, float(shell.beams.weight[number]), "N", WEIGHT)
    if not len(own):
        return (weights,)
    centre = stones.weight[own] @ stones.centroid[own] / weight
    points = stones.points[np.isin(np.repeat(np.arange(stones.count), np.diff(stones.block_point_ptr)), own), :2]
    held = shell.beams.of_node == number
    along = _along_walls(shell, held[shell.triangles].any(axis=1))
    points, below = points @ along, shell.points[held, :2] @ along
    apart = float(np.linalg.norm(centre - shell.beams.centroid[number])) / stones.size
    ends = [np.concatenate([part.min(axis=0), part.max(axis=0)]) for part in (points, below)]
    # Mid-planes lie half a thickness within the faces of their walls, where other walls cross them or beside them; beams that
    # meet lie a little apart.
    room = 0.5 * float(shell.thickness[held[shell.triangles].any(axis=1)].max()) * (1 + 1e-6) + APART
    length, of_shell = (float(np.ptp(part.reshape(2, 2), axis=0).max()) for part in ends)
    return (
        weights,
        Figure(f"height of {name}", float(centre[2]), float(shell.beams.centroid[number, 2]), "m", apart, CENTROID),
        Figure(f"length of {name}", length, of_shell, "m", float(np.abs(ends[0] - ends[1]).max()), room),
    )


def _along_walls(shell: ShellModel, facets: BoolArray) -> FloatArray:
    """Return the directions (2, 2) in plan, as columns, along the largest panel of these facets (nt,) and across it."""
    panel, number = np.unique(shell.panel[facets], return_inverse=True)
    largest = panel[np.argmax(np.bincount(number.ravel(), shell.area[facets]))]
    normal = shell.axes[np.flatnonzero(facets & (shell.panel == largest))[0], 2, :2]
    x, y = normal / max(float(np.linalg.norm(normal)), np.finfo(float).tiny)
    return np.array([[-y, x], [x, y]])


def _carried(stones: Assemblage, shell: ShellModel, number: int, loads: PlacedLoads) -> list[Figure]:
    """Compare force and moment of the loads, moments over the size of the building, by the larger one."""
    figures: list[Figure] = []
    arm = np.repeat([1.0, 1.0 / stones.size], 3)
    for name, (of_stones, of_shell) in resultants(stones, shell, loads).items():
        sizes = [float(np.abs(arm * part).max()) for part in (of_stones, of_shell)]
        apart = float(np.abs(arm * (of_shell - of_stones)).max()) / (max(sizes) or 1.0)
        ours, theirs = (float(np.linalg.norm(part[:3])) for part in (of_stones, of_shell))
        which = f", case {number}" if number > 1 else ""
        figures.append(Figure(f"loads carried: {name}{which}", ours, theirs, "N", apart, LOADS))
    return figures


def _relative(name: str, stones: float, shell: float, unit: str, tolerance: float) -> Figure:
    largest = max(abs(stones), abs(shell))
    return Figure(name, float(stones), float(shell), unit, float(abs(shell - stones) / largest) if largest else 0.0, tolerance)


def _walls(panels: NameArray, shell: ShellModel) -> list[list[str]]:
    """Return the panels, those side by side in one plane as one wall: a stone across their border belongs to either."""
    normal = shell.axes[:, 2] * np.where(shell.axes[:, 2] @ SLANT < 0, -1.0, 1.0)[:, None]
    offset = np.einsum("tc,tc->t", normal, shell.points[shell.triangles[:, 0]])
    plane = np.round(np.hstack([normal, offset[:, None]]), 4)
    # Nodes and planes both in common: links of panels.
    place = np.hstack([np.repeat(plane, 3, axis=0), shell.triangles.reshape(-1, 1)])
    number = np.searchsorted(panels, shell.panel)
    pairs = np.unique(np.hstack([place, np.repeat(number, 3)[:, None]]), axis=0)
    beside = (pairs[1:, :-1] == pairs[:-1, :-1]).all(axis=1)
    links = np.stack([pairs[:-1, -1], pairs[1:, -1]], axis=1)[beside].astype(np.int64)
    label = components(len(panels), links)
    return [[str(name) for name in panels[label == wall]] for wall in range(label.max() + 1)]


def _unit_weights(stones: Assemblage, shell: ShellModel) -> FloatArray:
    """Return the unit weight (nt,) N/m3 of the stones of each facet's material, 0 where there are none."""
    out = np.zeros(len(shell.material))
    for name in np.unique(shell.material):
        of_it = (stones.material == name) & ~stones.fixed
        if of_it.any():
            out[shell.material == name] = stones.weight[of_it].sum() / stones.volume[of_it].sum()
    return out


def _centroid(stones: Assemblage, shell: ShellModel) -> Figure:
    of_stones = stones.weight @ stones.centroid / stones.weight.sum()
    of_shell = shell.weight @ shell.points[shell.triangles].mean(axis=1) / max(shell.weight.sum(), np.finfo(float).tiny)
    apart = float(np.linalg.norm(of_shell - of_stones)) / stones.size
    return Figure("height of the centroid", float(of_stones[2]), float(of_shell[2]), "m", apart, CENTROID)


def _facets_of(stones: Assemblage, shell: ShellModel, free: IntArray) -> tuple[IntArray, FloatArray]:
    """Return for each stone the facet of its own panel at its middle (nb,), -1 for none, and how far outside it lies, m."""
    middle = interior_points(stones)
    facet, outside = np.full(stones.count, -1, dtype=np.int64), np.full(stones.count, np.inf)
    for name in np.intersect1d(stones.panel[free], shell.panel):
        own = free[stones.panel[free] == name]
        facet[own], outside[own] = facet_at(shell, middle[own], str(name))
    return facet, outside


def _thickness(stones: Assemblage, shell: ShellModel, facet: IntArray) -> Figure:
    """Compare each stone's volume over the mean area of its front and back with the facet's thickness; means by volume.

    A stone that lies off the mid-surface is one of two side by side: it reaches from there to the face of the wall. Stones that
    turn a corner are left out. Where most do, as in a dome of few sides, volume over the area of the mid-surface counts, too,
    panel by panel.
    """
    found = np.flatnonzero(facet >= 0)
    if not len(found):
        return Figure("thickness", 0.0, float(shell.thickness.mean()), "m", 1.0, THICKNESS)
    area_vector, normal, _ = face_normals(stones.points, stones.face_nodes, stones.face_ptr)
    block = np.repeat(np.arange(stones.count), np.diff(stones.block_face_ptr))
    # Front and back look along the wall's normal, chords of a curved wall nearly so.
    across = np.abs(np.einsum("fc,fc->f", normal, shell.axes[facet[block], 2])) > 0.7
    area = 0.5 * np.bincount(block[across], np.linalg.norm(area_vector[across], axis=1), minlength=stones.count)[found]
    extent = stones.volume[found] / np.maximum(area, np.finfo(float).tiny)
    weight = stones.volume[found] / stones.volume[found].sum()
    thickness = shell.thickness[facet[found]]
    corner = shell.points[shell.triangles[facet[found], 0]]
    off = np.abs(np.einsum("sc,sc->s", stones.centroid[found] - corner, shell.axes[facet[found], 2]))
    # One through the wall that ends in an edge on one face, as at a skewback, has its centroid a sixth of the thickness off.
    through = (np.abs(extent / thickness - 1) <= THICKNESS) & (off <= thickness * (1 + THICKNESS) / 6)
    extent = np.where((off > thickness / 8) & ~through, extent + 2 * off, extent)
    odd = np.flatnonzero(np.abs(extent / thickness - 1) > THICKNESS)
    measured = np.ones(len(found), dtype=np.bool_)
    around = _facets_around(stones, shell, found[odd])
    turns = [len(normals) > 0 and float(np.abs(normals @ normals.T).min()) < np.cos(np.radians(CORNER)) for normals in around]
    measured[odd[np.array(turns, dtype=np.bool_)]] = False
    straight = np.where(measured, weight, 0.0)
    share, off = float(straight.sum()), float(straight @ np.minimum(np.abs(extent / thickness - 1), 1.0))
    apart = off / share if share > 0 else 0.0
    if share > 0.5:
        weight = straight / share
    else:
        whole = _filled(stones, shell, found)
        extent, apart = thickness * whole, max(apart, float(weight @ np.abs(whole - 1)))
    return Figure("thickness", float(weight @ extent), float(weight @ thickness), "m", apart, THICKNESS)


def _filled(stones: Assemblage, shell: ShellModel, chosen: IntArray) -> FloatArray:
    """Return the volume of all chosen stones of a panel over area x thickness of its facets, for each of them (k,)."""
    panel, of_stone = np.unique(stones.panel[chosen], return_inverse=True)
    volume = np.bincount(of_stone.ravel(), stones.volume[chosen])
    of_facets = np.array([float((shell.area * shell.thickness)[shell.panel == name].sum()) for name in panel])
    filled: FloatArray = (volume / of_facets)[of_stone.ravel()]
    return filled


def _facets_around(stones: Assemblage, shell: ShellModel, chosen: IntArray) -> list[FloatArray]:
    """Return for each stone the normals (n, 3) of its panel's facets that reach into its box: at a vault's corner they differ.

    Front and back of a stone that turns a corner lie in several planes, so its volume over those of one facet is no thickness.
    """
    corner = shell.points[shell.triangles]
    low, high = corner.min(axis=1), corner.max(axis=1)
    found: list[FloatArray] = []
    for stone in chosen.tolist():
        points = stones.points[slice(*stones.block_point_ptr[stone : stone + 2])]
        start, stop = points.min(axis=0), points.max(axis=0)
        near = ((low < stop) & (high > start)).all(axis=1) & shell.yields & (shell.panel == stones.panel[stone])
        place = np.einsum("pk,tkc->tpc", WITHIN, corner[near])
        found.append(shell.axes[near, 2][((place > start) & (place < stop)).all(axis=2).any(axis=1)])
    return found


def _openings(stones: Assemblage, shell: ShellModel, facet: IntArray, outside: FloatArray) -> tuple[Figure, Figure]:
    # Off the centroid and off the mid-surface, so that no point falls exactly on a joint.
    corner = shell.points[shell.triangles]
    place = np.einsum("tkc,k->tc", corner, [0.3331, 0.3342, 0.3327]) + 1e-3 * shell.thickness[:, None] * shell.axes[:, 2]
    bare = ~inside_stones(stones, place)
    area = float(shell.area.sum())
    without = float(shell.area[bare].sum())
    free = ~stones.fixed
    # A stone that runs through a corner may have its centroid beyond the mid-plane, by half a wall at most.
    stray = free & ((facet < 0) | (outside > 0.5 * float(shell.thickness.max()) + 1e-6))
    volume, lost = float(stones.volume[free].sum()), float(stones.volume[stray].sum())
    return (
        Figure("mid-surface backed by stones", area - without, area, "m2", without / area, UNCOVERED),
        Figure("stones on a mid-surface", volume, volume - lost, "m3", lost / volume, UNCOVERED),
    )


def _supported_area(stones: Assemblage, contacts: Contacts, shell: ShellModel, carried: FloatArray) -> Figure:
    """Compare base joints with supported edges times thickness, less the overlaps at junctions."""
    fixed = stones.fixed[contacts.blocks]
    base = fixed[:, 0] != fixed[:, 1]
    on_stones = float(contacts.area[base].sum()) + _mortar_on_base(contacts, base)
    ends, facet = boundary_edges(shell)
    on_base = shell.supported[ends].all(axis=1)
    length = np.linalg.norm(shell.points[ends[:, 1]] - shell.points[ends[:, 0]], axis=1)
    width = length * bearing(shell, carried)[facet]
    return _relative(
        "supported length x thickness",
        on_stones,
        float((width[on_base] / across_base(contacts, shell, base, ends[on_base], facet[on_base])).sum()),
        "m2",
        SUPPORTED,
    )


def _mortar_on_base(contacts: Contacts, base: BoolArray) -> float:
    """Return the area, m2, on which mortar stands that was kept open between stones of the lowest course; base (ni,): joints."""
    low = np.unique(contacts.blocks[base])
    normal, points = contacts.frame[:, 0], contacts.point
    heads = np.flatnonzero(~base & np.isin(contacts.blocks, low).all(axis=1) & (np.abs(normal[:, 2]) < 0.5))
    level = np.cross(normal, [0.0, 0.0, 1.0])
    depth = [np.ptp(points[slice(*contacts.point_ptr[row : row + 2])] @ level[row]) for row in heads]
    return float(contacts.gap[heads].mean(axis=1) @ np.array(depth)) if len(heads) else 0.0


def _beds(stones: Assemblage, contacts: Contacts, shell: ShellModel, facet: IntArray) -> tuple[Figure, Figure]:
    """Compare the bed of each stone with the bed direction of the facet at its centroid; means weighed by volume."""
    found = facet >= 0
    across, along, normal = (shell.axes[facet, row] for row in (1, 0, 2))
    # In courses beds are level. Elsewhere (voussoirs) they are the joints with the largest area.
    level = np.cross([0.0, 0.0, 1.0], normal)
    length = np.linalg.norm(level, axis=1)
    cosine = np.abs(np.einsum("ij,ij->i", level, along)) / np.where(length > 0, length, 1.0)
    angle = np.where(length > 0.5, np.degrees(np.arccos(np.minimum(cosine, 1.0))), np.nan)
    loose = found & ~stones.coursed
    angle[loose] = angle_to_joints(stones, contacts, along, across)[loose]
    known = found & np.isfinite(angle)
    if not known.any():
        return _bed_figures(np.array([90.0]), np.ones(1))
    return _bed_figures(angle[known], stones.volume[known])


def _bed_figures(angle: FloatArray, volume: FloatArray) -> tuple[Figure, Figure]:
    mean, turned = float(volume @ angle / volume.sum()), float(volume[angle > TURNED].sum() / volume.sum())
    return (
        Figure("angle between beds, mean", 0.0, mean, "degrees", mean, MEAN_ANGLE),
        Figure(f"stones turned by more than {TURNED:g} degrees", 0.0, turned, "", turned, TURNED_SHARE),
    )
