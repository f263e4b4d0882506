"""Ring beams of a shell, and slabs below its domes: rigid bodies on the tops of its walls."""

from dataclasses import dataclass, field, replace

import numpy as np

from churchpipe.errors import InputError
from churchpipe.model.arrays import FloatArray, IntArray, NameArray, ReadOnly, indices, store, store_arrays


@dataclass(frozen=True, slots=True)
class ShellBeams(ReadOnly):
    """Rigid bodies that take nodes of a shell along.

    Fields: name, material (nm,); centroid (nm, 3) m; weight (nm,) N; of_node (nn,), the beam that a node is held by, -1 for none;
    bearing (nt,), the beam that a facet is the bearing of, in which that beam slides, -1 for none.
    """

    name: NameArray = field(default_factory=lambda: np.empty(0, dtype=np.str_))
    material: NameArray = field(default_factory=lambda: np.empty(0, dtype=np.str_))
    centroid: FloatArray = field(default_factory=lambda: np.empty((0, 3)))
    weight: FloatArray = field(default_factory=lambda: np.empty(0))
    of_node: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    bearing: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def __post_init__(self) -> None:
        count = len(self.name)
        store_arrays(self, name=(count,), material=(count,), centroid=(count, 3), weight=(count,))
        store(self, **{key: _beams(f"ShellBeams.{key}", getattr(self, key), count) for key in ("of_node", "bearing")})
        if (self.weight < 0).any():
            raise InputError("ShellBeams.weight", "out of range", found=float(self.weight.min()), expected=">= 0 N")
        loose = np.setdiff1d(np.arange(count), self.of_node)
        if len(loose):
            found = ", ".join(self.name[loose].tolist())
            raise InputError("ShellBeams.of_node", "a beam holds no node", found=found, expected="nodes on the tops of its walls")

    @property
    def count(self) -> int:
        """Number of beams."""
        return len(self.name)

    def on_mesh(self, nodes: int, facet: IntArray) -> "ShellBeams":
        """Return the beams of another mesh: of so many nodes, the first of them as before, and facets (nt,) of these numbers
        before, -1 for new ones."""
        if not self.count:
            return self
        bearing = np.where(facet >= 0, self.bearing[facet], -1)
        return replace(self, of_node=np.append(self.of_node, np.full(nodes - len(self.of_node), -1)), bearing=bearing)


def _beams(where: str, value: IntArray, count: int) -> IntArray:
    checked = indices(where, np.asarray(value) + 1, (len(value),), below=count + 1) - 1
    checked.setflags(write=False)
    return checked
