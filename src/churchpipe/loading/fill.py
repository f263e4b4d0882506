"""Loose fill on the back of a vault: weight that it carries, and mass that an earthquake pushes."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from churchpipe.errors import InputError
from churchpipe.geometry.bare import open_triangles
from churchpipe.geometry.polygons import below
from churchpipe.geometry.walls import named_walls
from churchpipe.loading.pressure import backs
from churchpipe.model.arguments import check_kind, listed, positive
from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.doubts import doubt_argument
from churchpipe.model.fill import Fill
from churchpipe.model.loads import LoadCase, nearest_virial, replaced
from churchpipe.model.shell import ShellModel

# A facet whose normal rises by no more than this bears no fill.
_UPRIGHT = 1e-3


def with_fill(
    load: LoadCase,
    body: Assemblage | ShellModel,
    panels: str | Sequence[str],
    level: float,
    unit_weight: float,
    contacts: Contacts | None = None,
) -> LoadCase:
    """Return a load case with loose fill on the backs of vaults, up to a level: its weight acts always, and where the load case
    pushes weight, the fill is pushed with it.

    Each stone or facet carries the fill upright above it, and its mass acts in the middle of each column. Fill has no strength of
    its own here. That it holds the haunches is left out, which is safe for the vault. That it pushes the walls beside it outwards
    is left out as well, which is not safe for them: give each of them a `Pressure`.

    Parameters
    ----------
    load
        The load case, with a uniform profile.
    body
        The stones, or the shell.
    panels
        The macro-elements on whose backs the fill lies, one name or several.
    level
        Height z of the top of the fill, m.
    unit_weight
        Of the fill, N/m3.
    contacts
        The joints of the stones, where they are at hand; the fill lies on what no stone stands over.

    Raises
    ------
    InputError
        Names that nothing has, no back below the level, contacts of other stones, a load case of another profile.
    """
    check_kind("with_fill: load", load, LoadCase)
    positive("with_fill: unit_weight", unit_weight)
    doubt_argument("with_fill: unit_weight", unit_weight, Fill, "unit_weight")
    check_kind("with_fill: body", body, Assemblage, ShellModel)
    if contacts is not None:
        check_kind("with_fill: contacts", contacts, Contacts)
        if isinstance(body, Assemblage):
            check_contacts_of(body, contacts)
    names = (panels,) if isinstance(panels, str) else tuple(listed("with_fill: panels", panels, str))
    missing = sorted(set(names) - set(body.panel.tolist()))
    if missing:
        expected = named_walls(body.panel)
        raise InputError("with_fill: panels", "no such panel", found=", ".join(missing), expected=expected)
    if load.profile != "uniform":
        raise InputError("with_fill: load", "not pushed alike at all heights", found=load.profile, expected='profile = "uniform"')
    count, centre = (body.count, body.centroid) if isinstance(body, Assemblage) else (len(body.triangles), body.centroid)
    dead, live = (np.zeros((count, 6)) if extra is None else np.array(extra) for extra in (load.dead, load.live))
    pushed = np.isin(body.panel, names if load.panels is None else load.panels)
    virials = [
        nearest_virial(wrench) if own is None else np.array(own)
        for wrench, own in ((dead, load.dead_virial), (live, load.live_virial))
    ]
    down = np.array([0.0, 0.0, -1.0])
    filled = 0.0
    for owner, corner in _backs(body, names, level):
        volume, moment = _column(below(corner, level), level)
        filled += volume
        arm = moment - volume * centre[owner]
        for wrench, virial, toward in ((dead, virials[0], down), (live, virials[1], load.direction * pushed[owner])):
            wrench[owner, :3] += unit_weight * volume * toward
            wrench[owner, 3:] += unit_weight * np.cross(arm, toward)
            virial[owner] += unit_weight * np.outer(arm, toward)
    if not filled > 0:
        raise InputError(
            "with_fill: level", "no back lies below it", found=f"{level:g} m", expected="a level above the springing"
        )
    found = {"live": live, "live_virial": virials[1]} if live.any() else {}
    return replaced(load, dead=dead, dead_virial=virials[0], **found)


def _backs(body: Assemblage | ShellModel, names: Sequence[str], level: float) -> Iterator[tuple[int, FloatArray]]:
    """Yield what the named stones or facets show to the fill below a level z, m: their owner and a triangle (3, 3) m."""
    if isinstance(body, ShellModel):
        chosen = np.isin(body.panel, names)
        upward = body.axes[:, 2] * np.where(body.axes[:, 2, 2:] < 0, -1.0, 1.0)
        # Nodes move out by half the thickness along the mean normal of the facets around them, so that backs meet as facets do.
        mean = np.zeros_like(body.points)
        np.add.at(mean, body.triangles[chosen], (body.area[:, None] * upward)[chosen][:, None])
        mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), np.finfo(float).tiny)
        outward = mean[body.triangles]
        along = np.maximum(np.einsum("fkc,fc->fk", outward, upward), _UPRIGHT)
        corners = body.points[body.triangles] + (0.5 * body.thickness[:, None] / along)[..., None] * outward
        for facet in np.flatnonzero(chosen & (upward[:, 2] > _UPRIGHT)).tolist():
            yield facet, corners[facet]
        return
    owner = np.repeat(np.arange(body.count), np.diff(body.block_face_ptr))
    for face, triangles in open_triangles(body, backs(body, names), level):
        for corners in triangles:
            yield int(owner[face]), corners


def _column(corner: FloatArray, level: float) -> tuple[float, FloatArray]:
    """Return the volume between a polygon (k, 3) m and the level above it, m3, and its first moment (3,) m4."""
    volume, moment = 0.0, np.zeros(3)
    for second, third in pairwise(corner[1:]):
        triangle = np.array([corner[0], second, third])
        side = triangle[1:, :2] - triangle[0, :2]
        area = 0.5 * abs(float(side[0, 0] * side[1, 1] - side[0, 1] * side[1, 0]))
        # Depth and place are linear over the triangle; the mass of a column is half way up to the level.
        depth = level - triangle[:, 2]
        place = np.column_stack([triangle[:, :2], 0.5 * (triangle[:, 2] + level)])
        volume += area * float(depth.mean())
        moment += area / 12 * (depth.sum() * place.sum(axis=0) + depth @ place)
    return volume, moment
