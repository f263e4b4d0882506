"""The normal matrix sum_k B_k S_k B_k^T, assembled straight into the nonzeros of its lower triangle."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse as sp

from churchpipe.model.arrays import FloatArray, IntArray, ragged_indices

# Local problems treated together: what one pass touches stays in the second-level cache.
_CHUNK = 8192


@dataclass(frozen=True, slots=True)
class _Elements:
    """Local problems that touch equally many row blocks; those with the same blocks form one element.

    members (p,), sorted by element; ends (ne + 1,); matrix_bik (basis rows, d, p); lift_rbe (further rows, basis rows, ne)
    gives the other rows of an element from the basis rows, for bodies that move rigidly against each other;
    blocks (width, ne), ascending.
    """

    members: IntArray
    ends: IntArray
    matrix: FloatArray
    lift: FloatArray | None
    blocks: IntArray


class NormalMatrix:
    """Fixed pattern and repeated assembly of the normal matrix; the coupling's rows come in blocks of `block`."""

    def __init__(self, coupling: sp.csr_matrix[np.float64], dimension: int, block: int) -> None:
        """coupling (m, dimension * count), columns component first, m a multiple of `block`."""
        size = coupling.shape[0]
        self.block = block
        self._elements = _elements(coupling, dimension, block)
        graph = _block_graph([e.blocks for e in self._elements], size // block)
        self.pattern, pointer = _pattern(graph, block)
        self._slots = [_slots(e.blocks, graph, pointer, block) for e in self._elements]
        self.diagonal = self.pattern.indptr[:-1].astype(np.int64)

    def assemble(self, compliance: FloatArray) -> FloatArray:
        """Return the values of the lower triangle, in the order of the pattern; compliance_ijk (d, d, count)."""
        nonzeros = self.pattern.nnz
        values = np.zeros(nonzeros)
        for elements, slots in zip(self._elements, self._slots, strict=True):
            lower = _element_matrices(elements, compliance)
            values += np.bincount(slots.ravel(), weights=lower.ravel(), minlength=nonzeros)
        return values


def _elements(coupling: sp.csr_matrix[np.float64], dimension: int, block: int) -> list[_Elements]:
    """Sort local problems by the number of row blocks they touch, and merge those that touch the same ones."""
    count = coupling.shape[1] // dimension
    entry = sp.coo_matrix(coupling)
    component, local = np.divmod(entry.col.astype(np.int64), count)
    row_block, within = np.divmod(entry.row.astype(np.int64), block)
    touched = sp.csc_matrix((np.ones(len(local)), (row_block, local)), shape=(coupling.shape[0] // block, count))
    touched.sort_indices()
    degree = np.diff(touched.indptr)
    out: list[_Elements] = []
    for width in np.unique(degree[degree > 0]).tolist():
        chosen = np.flatnonzero(degree == width)
        # blocks_wp: the row blocks of each local problem.
        blocks = touched.indices[touched.indptr[chosen] + np.arange(width)[:, None]].astype(np.int64)
        order = np.lexsort(blocks[::-1])
        members, blocks = chosen[order], blocks[:, order]
        first = np.flatnonzero(np.append(True, (blocks[:, 1:] != blocks[:, :-1]).any(axis=0)))
        ends = np.append(first, len(members))
        position = np.full(count, -1)
        position[members] = np.arange(len(members))
        mine = position[local] >= 0
        at = position[local[mine]]
        place = (blocks[:, at] < row_block[mine]).sum(axis=0)
        matrix = np.zeros((width * block, dimension, len(members)))
        matrix[place * block + within[mine], component[mine], at] = entry.data[mine]
        lift = _rigid_lift(matrix, ends, block) if block > 1 else None
        basis = matrix if lift is None else np.ascontiguousarray(matrix[:block])
        out.append(_Elements(members, ends, basis, lift, np.ascontiguousarray(blocks[:, first])))
    return out


def _rigid_lift(matrix: FloatArray, ends: IntArray, block: int) -> FloatArray | None:
    """Return lift_rbe with matrix[block:] = lift matrix[:block] in every element, or None when there is none.

    Two rigid bodies that meet at an interface see the same forces: the wrench on one is a fixed transform of that on the other.
    """
    if matrix.shape[0] == block:
        return None
    top, rest = matrix[:block], matrix[block:]
    gram = np.add.reduceat(np.einsum("bik,cik->bck", top, top), ends[:-1], axis=2)
    mixed = np.add.reduceat(np.einsum("rik,cik->rck", rest, top), ends[:-1], axis=2)
    inverse = np.linalg.pinv(np.moveaxis(gram, 2, 0), rcond=1e-12, hermitian=True)
    lift = np.ascontiguousarray(np.moveaxis(np.moveaxis(mixed, 2, 0) @ inverse, 0, 2))
    error = rest - np.einsum("rbk,bik->rik", np.repeat(lift, np.diff(ends), axis=2), top)
    return lift if np.abs(error).max(initial=0.0) <= 1e-11 * np.abs(matrix).max(initial=0.0) else None


def _block_graph(lists: list[IntArray], count: int) -> sp.csc_matrix[np.float64]:
    """Return the lower triangle (count, count) of which blocks meet in an element, the diagonal always."""
    rows, columns = [np.arange(count)], [np.arange(count)]
    for blocks in lists:
        i, j = np.tril_indices(len(blocks), -1)
        rows.append(blocks[i].ravel())
        columns.append(blocks[j].ravel())
    row, column = np.concatenate(rows), np.concatenate(columns)
    graph = sp.csc_matrix((np.ones(len(row)), (row, column)), shape=(count, count))
    graph.sort_indices()
    return graph


def _pattern(graph: sp.csc_matrix[np.float64], block: int) -> tuple[sp.csc_matrix[np.float64], IntArray]:
    """Return the pattern of the lower triangle with full blocks, and where each column starts."""
    count = graph.shape[0]
    blocks_below = np.diff(graph.indptr).astype(np.int64)
    lengths = (block * blocks_below[:, None] - np.arange(block)).ravel()
    pointer = np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(lengths)])
    rows = (block * graph.indices[:, None] + np.arange(block)).ravel()
    # Every column of a block column has all its rows, less those above the diagonal.
    starts = np.repeat(block * graph.indptr[:-1].astype(np.int64), block) + np.tile(np.arange(block), count)
    take = ragged_indices(starts, lengths)
    size = count * block
    pattern = sp.csc_matrix((np.zeros(len(take)), rows[take], pointer), shape=(size, size))
    return pattern, pointer


def _slots(blocks: IntArray, graph: sp.csc_matrix[np.float64], pointer: IntArray, block: int) -> IntArray:
    """Return where the lower triangle of each element goes among the values, (pairs, ne)."""
    count = graph.shape[0]
    columns = np.repeat(np.arange(count), np.diff(graph.indptr))
    first = np.asarray(graph.indptr, dtype=np.int64)
    keys = columns * count + graph.indices
    i, j = np.tril_indices(len(blocks) * block)
    out = np.empty((len(i), blocks.shape[1]), dtype=np.int64)
    for p in range(len(blocks)):
        for q in range(p + 1):
            rank = np.asarray(np.searchsorted(keys, blocks[q] * count + blocks[p]), dtype=np.int64) - first[blocks[q]]
            for k in np.flatnonzero((i // block == p) & (j // block == q)).tolist():
                r, c = i[k] % block, j[k] % block
                out[k] = pointer[blocks[q] * block + c] + rank * block + r - c
    return out


def _element_matrices(elements: _Elements, compliance: FloatArray) -> FloatArray:
    """Return the lower triangles (pairs, ne) of sum_k B_k S_k B_k^T over the members of each element."""
    basis, dimension, count = elements.matrix.shape
    ends = elements.ends
    core = np.empty((basis, basis, len(ends) - 1))
    cuts = [int(np.searchsorted(ends[:-1], start)) for start in range(0, count, _CHUNK)]
    for low, high in pairwise(sorted({*cuts, len(ends) - 1})):
        start, stop = ends[low], ends[high]
        piece = elements.matrix[:, :, start:stop]
        weight = compliance[:, :, elements.members[start:stop]]
        first = ends[low:high] - start
        for i in range(basis):
            row = [sum(piece[i, a] * weight[a, b] for a in range(dimension)) for b in range(dimension)]
            for j in range(i + 1):
                core[i, j, low:high] = np.add.reduceat(sum(row[b] * piece[j, b] for b in range(dimension)), first)
                core[j, i, low:high] = core[i, j, low:high]
    if elements.lift is None:
        i, j = np.tril_indices(basis)
        return core[i, j]
    return _lifted(core, elements.lift)


def _lifted(core: FloatArray, lift: FloatArray) -> FloatArray:
    """Return the lower triangles of (I; lift) core (I; lift)^T."""
    side = np.einsum("rbe,bce->rce", lift, core)
    corner = np.einsum("rbe,sbe->rse", side, lift)
    basis, rest = core.shape[0], corner.shape[0]
    i, j = np.tril_indices(basis + rest)
    out = np.empty((len(i), core.shape[2]))
    for k, (r, c) in enumerate(zip(i.tolist(), j.tolist(), strict=True)):
        out[k] = core[r, c] if r < basis else side[r - basis, c] if c < basis else corner[r - basis, c - basis]
    return out
