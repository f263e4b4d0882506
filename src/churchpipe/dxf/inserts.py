"""How many stones the inserts of a drawing ask for, arrays and blocks in blocks, and which of them are seen."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from ezdxf.entities.insert import Insert
from ezdxf.math import Vec3

from churchpipe.dxf.traces import KINDS
from churchpipe.model.arrays import FloatArray

# Arrays of arrays can ask for more stones than there is memory.
MOST_INSERTS = 200_000
# Blocks in blocks: people nest a handful.
DEEPEST = 50
# Entities that can be stones or their outlines, or hold them.
DRAWN = frozenset({*KINDS, "INSERT", "MESH", "3DFACE", "3DSOLID", "BODY"})


@dataclass(frozen=True, slots=True)
class Hidden:
    """Names of layers in capitals: those on which nothing is seen, off or frozen, and the frozen ones among them.

    As in CAD programs, what is in a block is seen by the layer that it lies on itself. An insert on a layer that is off hides
    only what lies on layer 0 in its block, which takes the layer of the insert; one on a frozen layer hides all.
    """

    all: frozenset[str]
    frozen: frozenset[str]

    def hides(self, insert: Insert, layer: str, trail: tuple[str, ...] = ()) -> bool:
        """Return whether an insert on a layer hides all that could be a stone in its block."""
        if layer not in self.all:
            return False
        name, block = insert.dxf.name.upper(), insert.block()
        if layer in self.frozen or block is None or name in trail:
            return True
        for entity in block:
            own = entity_layer(entity.dxf.layer, layer)
            if entity.dxftype() in DRAWN and own not in self.all:
                return False
            if isinstance(entity, Insert) and own in self.all and not self.hides(entity, own, (*trail, name)):
                return False
        return True


def entity_layer(name: str, of_insert: str) -> str:
    """Return the layer of an entity in capitals; what lies on layer 0 in a block is on the layer of the insert."""
    return of_insert if name == "0" else name.upper()


class TooDeepError(Exception):
    """Blocks nested too deep: the names of all from the outermost on."""

    def __init__(self, trail: tuple[str, ...]) -> None:
        self.trail = trail


def count_inserts(entities: Any, known: dict[str, int], trail: tuple[str, ...] = ()) -> int:
    """Return the number of inserts that follow from these entities, nested and arrayed ones included.

    Raises
    ------
    TooDeepError: blocks nested deeper than any drawing needs.
    """
    total = 0
    for insert in entities:
        if not isinstance(insert, Insert) or (name := insert.dxf.name.upper()) in trail:
            continue
        if len(trail) >= DEEPEST:
            raise TooDeepError(trail)
        block = insert.block()
        if block is not None and name not in known:
            known[name] = count_inserts(block, known, (*trail, name))
        total += array_size(insert) * (1 + known.get(name, 0))
    return total


def _array_counts(insert: Insert) -> tuple[int, int]:
    """Return rows and columns of an array; a count below 1, or members that would lie on each other, are one."""
    dxf = insert.dxf
    rows = dxf.row_count if dxf.row_spacing else 1
    columns = dxf.column_count if dxf.column_spacing else 1
    return max(rows, 1), max(columns, 1)


def array_size(insert: Insert) -> int:
    """Return how many members an insert has, 1 where it is no array."""
    rows, columns = _array_counts(insert)
    return rows * columns


def array_offsets(insert: Insert) -> FloatArray:
    """Return how far the members of an array lie from its insertion point (k, 3), row by row; they turn with the insert."""
    counts = _array_counts(insert)
    if counts == (1, 1):
        return np.zeros((1, 3))
    row, column = (index.ravel() for index in np.indices(counts))
    turn = np.radians(insert.dxf.rotation)
    x, y = column * insert.dxf.column_spacing, row * insert.dxf.row_spacing
    ocs = insert.ocs()
    ux, uy = (np.array(ocs.to_wcs(axis).xyz) for axis in (Vec3(1, 0, 0), Vec3(0, 1, 0)))
    return np.outer(x * np.cos(turn) - y * np.sin(turn), ux) + np.outer(x * np.sin(turn) + y * np.cos(turn), uy)
