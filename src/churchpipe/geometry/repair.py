"""Polyhedra from any source mended to solids that `Assemblage.from_polyhedra` accepts."""

from collections.abc import Iterable
from dataclasses import dataclass

from churchpipe.errors import InputError
from churchpipe.geometry.mending import mend
from churchpipe.model.assemblage import Polyhedron, checked_polyhedron, checked_sequence


@dataclass(frozen=True, slots=True)
class Change:
    """One kind of change of one polyhedron: its index, the kind, how often it was made, and the volume before and after all
    changes, m3.
    """

    polyhedron: int
    what: str
    count: int
    volume_before: float
    volume: float

    def __str__(self) -> str:
        volumes = f"volume {self.volume_before:.6g} -> {self.volume:.6g} m3"
        return f"polyhedra[{self.polyhedron}]: {self.what} ({self.count}); {volumes}"


def repair_polyhedra(polyhedra: Iterable[Polyhedron]) -> tuple[list[Polyhedron], tuple[Change, ...]]:
    """Mend polyhedra and report what was changed.

    Vertices that meet are joined. Faces given more than once are dropped. Corners of neighbouring faces are inserted into the
    edges that they lie on. Holes that one face closes are closed. Faces are turned outwards, and warped ones split into
    triangles. A polyhedron without a fault is returned as it is.

    Parameters
    ----------
    polyhedra
        Pairs (vertices (n, 3) m, faces: lists of vertex indices).

    Returns
    -------
    The polyhedra, in their order, and the changes; none when all of them were sound.

    Raises
    ------
    InputError
        A polyhedron that stays open or folded, with its index and the place.
    """
    out: list[Polyhedron] = []
    changes: list[Change] = []
    for number, polyhedron in enumerate(checked_sequence("polyhedra", polyhedra, "pairs of vertices and faces")):
        where = f"polyhedra[{number}]"
        mended = mend(*checked_polyhedron(where, polyhedron), repair=True)
        if mended.fault:
            x, y, z = mended.points[mended.fault.vertex]
            found = f"{mended.fault.found} at ({x:.6g}, {y:.6g}, {z:.6g}) m"
            remedy = "Close it in the program that made it."
            raise InputError(where, mended.fault.problem, found=found, expected=mended.fault.expected, remedy=remedy)
        out.append((mended.points, mended.faces))
        changes += [Change(number, what, count, mended.volume_before, mended.volume) for what, count in mended.changes.items()]
    return out, tuple(changes)
