"""The mid-surface of a building as flat triangles with a bed-joint direction: the second model."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arguments import check_kind
from churchpipe.model.arrays import (
    BoolArray,
    FloatArray,
    IntArray,
    NameArray,
    floats,
    indices,
    names,
    rows_of,
    store,
    store_arrays,
)
from churchpipe.model.card import Shown
from churchpipe.model.pictures import picture
from churchpipe.model.shell_beams import ShellBeams


@dataclass(frozen=True, slots=True, repr=False)
class ShellModel(Shown):
    """Mid-surface mesh, bed-joint field and unit cells of a building.

    Fields: points (nn, 3) m; triangles (nt, 3); axes (nt, 3, 3), `axes_fac`: axis a (along the bed joints, up the courses,
    normal) and component c (x, y, z) of facet f, right-handed, the normal square to the facet whichever way round its vertices
    run; thickness (nt,) m; surface_weight (nt,) N/m2, zero where another wall's stones are counted; cell (nt,), row of
    unit_cells (nu, 2) m, course height a and stone length b; material, panel (nt,) names; yields (nt,) False for parts
    kept elastic, such as a lintel; supported (nn,) nodes that stand on the ground or on fixed bodies. bonds (nu,): the bond of
    each unit cell, a name of `bond.period`; running bond if left out. beams: rigid bodies that hold nodes of its walls.
    ledges (nl, 2, 2), `ledges_lkn`: nodes n of an edge at the foot of a vault (k = 0), and of the edge at the top of a wall that
    bears it (k = 1) at a distance. held (nh, 2): nodes that lie in a facet of a wall and go with it, each with that facet.
    bed_normal (nn, 3): normal of the surface on which a supported node stands, zeros where none is known.
    """

    points: FloatArray
    triangles: IntArray
    axes: FloatArray
    thickness: FloatArray
    surface_weight: FloatArray
    cell: IntArray
    unit_cells: FloatArray
    material: NameArray
    panel: NameArray
    yields: BoolArray
    supported: BoolArray
    bonds: NameArray = field(default_factory=lambda: np.empty(0, dtype=np.str_))
    beams: ShellBeams = field(default_factory=ShellBeams)
    ledges: IntArray = field(default_factory=lambda: np.empty((0, 2, 2), dtype=np.int64))
    held: IntArray = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    bed_normal: FloatArray = field(default_factory=lambda: np.empty((0, 3)))

    def __post_init__(self) -> None:
        nn, nt = rows_of("ShellModel.points", self.points), rows_of("ShellModel.triangles", self.triangles)
        nu = rows_of("ShellModel.unit_cells", self.unit_cells)
        store_arrays(self, points=(nn, 3), axes=(nt, 3, 3), thickness=(nt,), surface_weight=(nt,), unit_cells=(nu, 2))
        store_arrays(self, material=(nt,), panel=(nt,), yields=(nt,), supported=(nn,))
        store(
            self,
            triangles=indices("ShellModel.triangles", self.triangles, (nt, 3), below=nn),
            cell=indices("ShellModel.cell", self.cell, (nt,), below=nu),
            bonds=names("ShellModel.bonds", self.bonds if np.size(self.bonds) else np.full(nu, "running"), (nu,)),
            held=indices("ShellModel.held", self.held, (None, 2), below=max(nn, nt)),
            ledges=indices("ShellModel.ledges", self.ledges, (None, 2, 2), below=nn),
            bed_normal=floats(
                "ShellModel.bed_normal", self.bed_normal if np.size(self.bed_normal) else np.zeros((nn, 3)), (nn, 3)
            ),
        )
        check_kind("ShellModel.beams", self.beams, ShellBeams)
        sizes = len(self.beams.of_node), len(self.beams.bearing)
        if sizes != ((nn, nt) if self.beams.count else (0, 0)):
            raise InputError(
                "ShellModel.beams", "of another mesh", found=sizes, expected=f"an entry a node and facet, {(nn, nt)}"
            )
        self._check_ranges()
        self._check_facets()

    def _check_ranges(self) -> None:
        for key, values, positive in (
            ("thickness", self.thickness, True),
            ("unit_cells", self.unit_cells, True),
            ("surface_weight", self.surface_weight, False),
        ):
            bad = values <= 0 if positive else values < 0
            if bad.any():
                expected = "> 0" if positive else ">= 0"
                raise InputError(f"ShellModel.{key}", "out of range", found=float(values[bad][0]), expected=expected)
        followed = np.concatenate([self.ledges[:, 1].ravel(), self.triangles[self.held[:, 1]].ravel()])
        both = np.intersect1d(np.concatenate([self.ledges[:, 0].ravel(), self.held[:, 0]]), followed)
        if len(both):
            found = f"node {int(both[0])}"
            raise InputError("ShellModel", "a node both of a vault's end and of its wall", found=found, expected="one of them")
        unused = np.setdiff1d(np.arange(len(self.points)), self.triangles)
        if len(unused):
            raise InputError("ShellModel.points", "a node belongs to no triangle", found=int(unused[0]))

    def _check_facets(self) -> None:
        if not len(self.triangles):
            raise InputError("ShellModel.triangles", "no triangle", expected="at least one")
        corners = self.points[self.triangles]
        sides = corners[:, [1, 2, 0]] - corners
        longest = np.sqrt((sides**2).sum(axis=2).max(axis=1))
        flat = self.area <= 1e-9 * longest**2
        if flat.any():
            raise InputError("ShellModel.triangles", "a triangle has no area", found=int(np.flatnonzero(flat)[0]))
        gram = np.einsum("fac,fbc->fab", self.axes, self.axes)
        handed = np.linalg.det(self.axes)
        if np.abs(gram - np.eye(3)).max() > 1e-9 or (handed < 0).any():
            raise InputError(
                "ShellModel.axes", "axes are not orthonormal and right-handed", expected="rows along the bed, up, normal"
            )
        out_of_plane = np.abs(np.einsum("fkc,fc->fk", sides, self.axes[:, 2])).max(axis=1) / longest
        if (out_of_plane > 1e-6).any():
            raise InputError(
                "ShellModel.axes",
                "the third axis is not normal to its facet",
                found=f"facet {int(out_of_plane.argmax())}, sine {float(out_of_plane.max()):.2g}",
                expected="sine of the angle < 1e-6",
            )

    @property
    def area(self) -> FloatArray:
        """Area of each facet (nt,), m2."""
        corners = self.points[self.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return 0.5 * np.sqrt((normal**2).sum(axis=1))

    @property
    def centroid(self) -> FloatArray:
        """Middle of each facet (nt, 3), m."""
        return np.asarray(self.points[self.triangles].mean(axis=1))

    @property
    def weight(self) -> FloatArray:
        """Weight of each facet (nt,), N."""
        return self.area * self.surface_weight

    @property
    def on_beam(self) -> BoolArray:
        """Which nodes (nn,) a beam holds."""
        return self.beams.of_node >= 0 if self.beams.count else np.zeros(len(self.points), dtype=np.bool_)

    @property
    def body_centroid(self) -> FloatArray:
        """Middles (nt + nm, 3) m of what loads act on: the facets, then the beams."""
        return np.concatenate([self.centroid, self.beams.centroid])

    @property
    def body_weight(self) -> FloatArray:
        """Weights (nt + nm,) N of facets and beams."""
        return np.concatenate([self.weight, self.beams.weight])

    @property
    def body_panel(self) -> NameArray:
        """Macro-elements (nt + nm,) of facets, and the beams' own names."""
        return np.concatenate([self.panel, self.beams.name])

    def show(self) -> Any:
        """Return a picture of the shell as it stands (`churchpipe.show`)."""
        return picture(self)

    def _rows(self) -> tuple[str, Mapping[str, object]]:
        rows = {
            "facets": len(self.triangles),
            "nodes": len(self.points),
            "macro-elements": ", ".join(map(str, np.unique(self.panel))),
        }
        return "Homogenised shell", rows
