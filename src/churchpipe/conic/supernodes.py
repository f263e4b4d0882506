"""Elimination tree of a sparse symmetric matrix, gathered in supernodes (Liu 1990; Davis 2006).

Column j of the factor L is eliminated before its parent, the first row below the diagonal where L has an entry. Columns that
follow each other with the same rows below them are one supernode and are stored as one dense panel; a narrow one is joined to its
parent where few zeros come in. A supernode with its rows below is a front. Disjoint subtrees are parts, which different threads
may eliminate; the supernodes above them all are the top.
"""

from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from churchpipe.conic.tiles import COLUMNS, padded
from churchpipe.model.arrays import FloatArray, IntArray, pointer_of, ragged_indices

# A subtree with more than one of so many shares of the work is split.
PARTS = 6
# Work of an entry of a front over that of a multiplication: entries are written, read and scattered.
_ENTRY = 40.0
# A supernode is joined to its parent up to a width, if less than a share of the joint panel is zeros; columns alike come first.
_ALIKE = ((1 << 30, 0.0),)
_JOINED = ((4, 1.0), (16, 0.8), (48, 0.1), (1 << 30, 0.05))

# Numbers that a column of a front has more than rows, and columns more: tiles reach beyond the last ones.
SPARE = COLUMNS

_Int32s = npt.NDArray[np.int32]


class Supernodes(NamedTuple):
    """m supernodes in postorder, of a matrix with n rows.

    order (n,): row of the matrix that is row k of the factor. start, width, rows (m,): first column, columns, and rows of the
    front. panel (m + 1,): where each panel, row by row, starts. at (m + 1,): where the rows of a supernode start in below: their
    numbers, and place: their places in the front of the parent. parent (m,), -1 at a root; child (m + 1,): where its children
    start in children. update (m,): where the update matrix of each is written in a work space of size space[0]. entry (m + 1,):
    where the entries of the matrix in the columns of each start in taken, their numbers, and put, their places among its
    columns, which are rows + SPARE numbers apart.
    part_first, part_last, part_work (parts,): supernodes and work of each part; top: the supernodes above. reach (parts + 1,):
    where the rows that each part changes above itself start in reached.
    """

    order: IntArray
    start: IntArray
    width: IntArray
    rows: IntArray
    panel: IntArray
    at: IntArray
    below: IntArray
    place: IntArray
    parent: IntArray
    child: IntArray
    children: IntArray
    update: IntArray
    space: IntArray
    entry: IntArray
    taken: _Int32s
    put: _Int32s
    part_first: IntArray
    part_last: IntArray
    part_work: FloatArray
    reach: IntArray
    reached: IntArray
    top: IntArray


def supernodes(pattern: sp.csc_matrix[np.float64], order: IntArray) -> Supernodes:
    """Analyse a lower triangle (n, n) with sorted indices, whose rows are to be eliminated about in this order (n,)."""
    n = pattern.shape[0]
    row = np.asarray(pattern.indices, dtype=np.int64)
    column = np.repeat(np.arange(n), np.diff(pattern.indptr))
    order = order[_postorder(_tree(*_rows_of(row, column, order)))]
    by_row = _rows_of(row, column, order)
    tree = _tree(*by_row)
    alike = _joined(tree, (np.arange(n), np.ones(n, dtype=np.int64), _counts(*by_row, tree)), np.array(_ALIKE))
    sizes = start, width, rows = _joined(tree, alike, np.array(_JOINED))
    small, large = _permuted(row, column, order)
    by_column = np.lexsort((large, small)).astype(np.int32)
    pointer = pointer_of(np.bincount(small, minlength=n))
    at, panel = pointer_of(rows - width), pointer_of(width * rows)
    below, parent = _below(sizes, at, pointer, large[by_column])
    children = np.argsort(parent, kind="stable")[np.count_nonzero(parent < 0) :]
    deep = (rows - width).astype(np.float64)
    work = width**3 / 3 + deep * width * rows + _ENTRY * (width * rows + deep**2)
    first, last, part, part_work = _parts(parent, work)
    roots = np.flatnonzero((part >= 0) & (part[parent] != part) & (parent >= 0))
    update, space = _updates(parent, rows - width, part, len(first))
    return Supernodes(
        order=order,
        start=start,
        width=width,
        rows=rows,
        panel=panel,
        at=at,
        below=below,
        place=_places(sizes, at, below, parent),
        parent=parent,
        child=pointer_of(np.bincount(parent[parent >= 0], minlength=len(start))),
        children=children,
        update=update,
        space=space,
        entry=pointer[np.append(start, n)],
        taken=by_column,
        put=_put(sizes, at, below, pointer, large[by_column]),
        part_first=first,
        part_last=last,
        part_work=part_work,
        reach=pointer_of(np.bincount(part[roots], (rows - width)[roots], minlength=len(first)).astype(np.int64)),
        reached=below[ragged_indices(at[roots], (rows - width)[roots])],
        top=np.flatnonzero(part < 0),
    )


def _permuted(row: IntArray, column: IntArray, order: IntArray) -> tuple[IntArray, IntArray]:
    """Return the smaller and the larger of the places of row and column of every entry."""
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return np.minimum(place[row], place[column]), np.maximum(place[row], place[column])


def _rows_of(row: IntArray, column: IntArray, order: IntArray) -> tuple[IntArray, IntArray]:
    """Return where each row of the permuted lower triangle starts, and its columns."""
    small, large = _permuted(row, column, order)
    return pointer_of(np.bincount(large, minlength=len(order))), small[np.argsort(large, kind="stable")]


@numba.njit(cache=True)
def _tree(pointer: IntArray, column: IntArray) -> IntArray:
    """Return the parent of every column, -1 at a root (Liu 1990)."""
    n = len(pointer) - 1
    parent, ancestor = np.full(n, -1), np.full(n, -1)
    for i in range(n):
        for at in range(pointer[i], pointer[i + 1]):
            j = column[at]
            while j != -1 and j < i:
                above = ancestor[j]
                ancestor[j] = i
                if above == -1:
                    parent[j] = i
                j = above
    return parent


@numba.njit(cache=True)
def _postorder(parent: IntArray) -> IntArray:
    """Return the columns with every subtree together, its root last."""
    n = len(parent)
    child, sibling, stack = np.full(n, -1), np.full(n, -1), np.empty(n, dtype=np.int64)
    for j in range(n - 1, -1, -1):
        if parent[j] >= 0:
            sibling[j] = child[parent[j]]
            child[parent[j]] = j
    out, done = np.empty(n, dtype=np.int64), 0
    for root in range(n):
        if parent[root] >= 0:
            continue
        high = 0
        stack[0] = root
        while high >= 0:
            j = stack[high]
            if child[j] == -1:
                out[done] = j
                done += 1
                high -= 1
            else:
                high += 1
                stack[high] = child[j]
                child[j] = sibling[child[j]]
    return out


@numba.njit(cache=True)
def _counts(pointer: IntArray, column: IntArray, parent: IntArray) -> IntArray:
    """Return the number of entries of every column of the factor: each row is a subtree of the elimination tree."""
    n = len(parent)
    count, seen = np.ones(n, dtype=np.int64), np.full(n, -1)
    for i in range(n):
        seen[i] = i
        for at in range(pointer[i], pointer[i + 1]):
            j = column[at]
            while seen[j] != i:
                count[j] += 1
                seen[j] = i
                j = parent[j]
    return count


_Sizes = tuple[IntArray, IntArray, IntArray]


@numba.njit(cache=True)
def _joined(parent: IntArray, sizes: _Sizes, joined: FloatArray) -> _Sizes:
    """Return first column, columns and rows of supernodes (m,), the last child of each joined to it where few zeros come in."""
    count = len(sizes[0])
    start, width, rows = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    zeros = np.zeros(count)
    m = 0
    for s in range(count):
        start[m], width[m], rows[m], zeros[m] = sizes[0][s], sizes[1][s], sizes[2][s], 0.0
        end = start[m] + width[m]
        # What lies right before a supernode is its last child, if it is one.
        while m > 0 and start[m] <= parent[start[m] - 1] < end:
            wide, high = width[m - 1] + width[m], width[m - 1] + rows[m]
            new = zeros[m - 1] + zeros[m] + width[m - 1] * (high - rows[m - 1])
            level = 0
            while wide > joined[level, 0]:
                level += 1
            if new > 0.0 and new >= joined[level, 1] * wide * high:
                break
            m -= 1
            width[m], rows[m], zeros[m] = wide, high, new
        m += 1
    return start[:m].copy(), width[:m].copy(), rows[:m].copy()


@numba.njit(cache=True)
def _below(sizes: _Sizes, at: IntArray, pointer: IntArray, row: IntArray) -> tuple[IntArray, IntArray]:
    """Return the rows below every supernode, ascending, and its parent."""
    start, width, _ = sizes
    m, n = len(start), len(pointer) - 1
    out, parent = np.empty(at[m], dtype=np.int64), np.full(m, -1)
    holder, seen = np.empty(n, dtype=np.int64), np.full(n, -1)
    child, sibling = np.full(m, -1), np.full(m, -1)
    for s in range(m):
        holder[start[s] : start[s] + width[s]] = s
    for s in range(m):
        k, end = at[s], start[s] + width[s]
        for p in range(pointer[start[s]], pointer[end]):
            if row[p] >= end and seen[row[p]] != s:
                seen[row[p]] = s
                out[k] = row[p]
                k += 1
        c = child[s]
        while c >= 0:
            for p in range(at[c], at[c + 1]):
                if out[p] >= end and seen[out[p]] != s:
                    seen[out[p]] = s
                    out[k] = out[p]
                    k += 1
            c = sibling[c]
        out[at[s] : at[s + 1]].sort()
        if at[s + 1] > at[s]:
            above = holder[out[at[s]]]
            parent[s] = above
            sibling[s] = child[above]
            child[above] = s
    return out, parent


@numba.njit(cache=True)
def _places(sizes: _Sizes, at: IntArray, below: IntArray, parent: IntArray) -> IntArray:
    """Return the places of the rows below every supernode in the front of its parent."""
    start, width, _ = sizes
    out = np.empty_like(below)
    for s in range(len(start)):
        above = parent[s]
        k = at[above]
        for p in range(at[s], at[s + 1]):
            if below[p] < start[above] + width[above]:
                out[p] = below[p] - start[above]
            else:
                while below[k] != below[p]:
                    k += 1
                out[p] = width[above] + k - at[above]
    return out


@numba.njit(cache=True)
def _put(sizes: _Sizes, at: IntArray, below: IntArray, pointer: IntArray, row: IntArray) -> _Int32s:
    """Return the places of the entries of the matrix among the columns of their fronts."""
    start, width, rows = sizes
    out = np.empty(len(row), dtype=np.int32)
    for s in range(len(start)):
        end = start[s] + width[s]
        for j in range(start[s], end):
            k = at[s]
            for p in range(pointer[j], pointer[j + 1]):
                if row[p] < end:
                    local = row[p] - start[s]
                else:
                    while below[k] != row[p]:
                        k += 1
                    local = width[s] + k - at[s]
                out[p] = (j - start[s]) * (rows[s] + SPARE) + local
    return out


def _parts(parent: IntArray, work: FloatArray) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    """Return first and last supernode of every part, the part of every supernode, -1 above them, and the work of the parts."""
    first, whole = _subtrees(parent, work)
    top = whole > work.sum() / PARTS
    last = np.flatnonzero(~top & ((parent < 0) | top[parent]))
    # Many small trees side by side are one part.
    return _gathered(first[last], last, whole[last], len(parent), work.sum() / PARTS)


def _gathered(
    first: IntArray, last: IntArray, work: FloatArray, count: int, most: float
) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    begins: list[int] = []
    ends: list[int] = []
    sums: list[float] = []
    for begin, end, size in zip(first.tolist(), last.tolist(), work.tolist(), strict=True):
        if ends and ends[-1] + 1 == begin and sums[-1] + size <= most:
            ends[-1], sums[-1] = end, sums[-1] + size
        else:
            begins.append(begin)
            ends.append(end)
            sums.append(size)
    part = np.full(count, -1)
    for number, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        part[begin : end + 1] = number
    return np.array(begins, dtype=np.int64), np.array(ends, dtype=np.int64), part, np.array(sums)


@numba.njit(cache=True)
def _subtrees(parent: IntArray, work: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the first supernode of the subtree under each, and its work."""
    first, whole = np.arange(len(parent)), work.copy()
    for s in range(len(parent)):
        if parent[s] >= 0:
            whole[parent[s]] += whole[s]
            first[parent[s]] = min(first[parent[s]], first[s])
    return first, whole


@numba.njit(cache=True)
def _updates(parent: IntArray, deep: IntArray, part: IntArray, parts: int) -> tuple[IntArray, IntArray]:
    """Return where each supernode writes its update matrix, and the size of the work space.

    A part, and the top, has two stacks, for even and for odd depths: a supernode reads those of its children from the one and
    takes them off, and lays its own on the other.
    """
    m = len(parent)
    depth, out, waiting = np.zeros(m, dtype=np.int64), np.empty(m, dtype=np.int64), np.zeros(m, dtype=np.int64)
    height, most = np.zeros(2 * parts + 2, dtype=np.int64), np.zeros(2 * parts + 3, dtype=np.int64)
    for s in range(m - 1, -1, -1):
        depth[s] = (depth[parent[s]] + 1) % 2 if parent[s] >= 0 else 0
    for s in range(m):
        own = 2 * (part[s] if part[s] >= 0 else parts) + depth[s]
        height[own + 1 - 2 * depth[s]] -= waiting[s]
        out[s] = height[own]
        height[own] += padded(deep[s]) ** 2
        most[own + 1] = max(most[own + 1], height[own])
        if parent[s] >= 0 and part[parent[s]] == part[s]:
            waiting[parent[s]] += padded(deep[s]) ** 2
    first = np.cumsum(most)
    for s in range(m):
        out[s] += first[2 * (part[s] if part[s] >= 0 else parts) + depth[s]]
    return out, first[-1:]
