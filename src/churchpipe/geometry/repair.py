"""Anybody's polyhedra mended to solids that `Assemblage.from_polyhedra` takes."""

from collections.abc import Iterable
from dataclasses import dataclass

from churchpipe.errors import InputError
from churchpipe.geometry.mending import mend
from churchpipe.model.assemblage import Polyhedron, checked_polyhedron, checked_sequence


@dataclass(frozen=True, slots=True)
class Change:
    """What was done to one polyhedron: its index, what, how often, and its volume before and after all that was done, m3."""

    polyhedron: int
    what: str
    count: int
    volume_before: float
    volume: float

    def __str__(self) -> str:
        volumes = f"volume {self.volume_before:.6g} -> {self.volume:.6g} m3"
        return f"polyhedra[{self.polyhedron}]: {self.what} ({self.count}); {volumes}"


def repair_polyhedra(polyhedra: Iterable[Polyhedron]) -> tuple[list[Polyhedron], tuple[Change, ...]]:
    """Mend polyhedra and say what was changed.

    Vertices that meet are welded, faces given more than once dropped, corners of neighbours put into the edges that they lie
    on, holes of one face closed, faces turned to look outwards, and warped ones split into triangles. A polyhedron that needs
    nothing is returned as it is.

    Parameters
    ----------
    polyhedra: pairs (vertices (n, 3) m, faces: lists of vertex indices).

    Returns
    -------
    The polyhedra, in their order, and the changes; none when all of them were sound.

    Raises
    ------
    InputError: a polyhedron that stays open or folded, with its index and the place.
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
