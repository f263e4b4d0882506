"""Sums over many elements into the blocks of rows that they touch, divided so that several threads make them.

Each block of rows has one share as its owner, which alone writes it: that of the first element that touches the block. A share
has to look at its own elements and at the later ones at its edge. Sums are made in the order of the elements, whatever the
number of shares.
"""

from typing import NamedTuple

import numpy as np

from churchpipe.model.arrays import IntArray, pointer_of, ragged_indices


class Division(NamedTuple):
    """Elements of each share, ascending: members[first[share] : first[share + 1]]; owner (blocks,): the share of each block."""

    members: IntArray
    first: IntArray
    owner: IntArray

    @property
    def shares(self) -> int:
        """Number of shares."""
        return len(self.first) - 1


def divided(start: IntArray, width: IntArray, blocks: IntArray, count: int, shares: int) -> Division:
    """Divide elements e, which touch blocks[start[e] : start[e] + width[e]] of `count`, into shares."""
    elements = len(start)
    share = np.arange(elements) * shares // max(elements, 1)
    owner = np.full(count, shares - 1, dtype=np.int64)
    touched = blocks[ragged_indices(start, width)]
    np.minimum.at(owner, touched, np.repeat(share, width))
    looks = np.zeros((shares, elements), dtype=np.bool_)
    looks[owner[touched], np.repeat(np.arange(elements), width)] = True
    members = np.nonzero(looks)
    first = pointer_of(looks.sum(axis=1))
    return Division(members[1].astype(np.int64), first, owner)
