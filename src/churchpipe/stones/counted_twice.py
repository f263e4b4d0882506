"""What lies in two stones at once, as where stones are drawn a little too large, and counts twice in their weight."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from churchpipe.model.arrays import FloatArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.contacts import Contacts

# Below this share of the volume of the stones it is no more than what rounding and care leave: no load factor shows it.
NOTICED: Final = 1e-3


@dataclass(frozen=True, slots=True)
class CountedTwice:
    """What pairs of free stones share: volume m3, its share of the volume of all free stones, depth m where deepest; the names of
    the two that share most, and the place (3,) m where they do."""

    pairs: int
    volume: float
    share: float
    depth: float
    stones: tuple[str, str]
    place: FloatArray


def shared_volumes(stones: Assemblage, contacts: Contacts) -> FloatArray:
    """Return the volume (ni,) m3 that the stones of each joint share, none with ground, which has no weight.

    The area of the joint times the mean depth: it is linear between the least and the greatest, as between two planes.
    """
    low, high = (-contacts.gap).min(axis=1, initial=np.inf), (-contacts.gap).max(axis=1, initial=-np.inf)
    span = np.where(high > low, high - low, 1.0)
    mean = np.where(low >= 0, 0.5 * (low + high), np.maximum(high, 0.0) ** 2 / (2 * span))
    return np.where(stones.fixed[contacts.blocks].any(axis=1), 0.0, contacts.area * mean)


def counted_twice(stones: Assemblage, contacts: Contacts) -> CountedTwice | None:
    """Return what counts twice in the weight of stones, None where it is less than `NOTICED` of their volume.

    Where three stones lie in each other, each two of them count.
    """
    shared = shared_volumes(stones, contacts)
    volume, whole = float(shared.sum()), float(stones.volume[~stones.fixed].sum())
    if not volume > NOTICED * whole:
        return None
    most = int(shared.argmax())
    one, other = (str(name) for name in stones.block_id[contacts.blocks[most]])
    return CountedTwice(
        pairs=len(np.unique(np.sort(contacts.blocks[shared > 0], axis=1), axis=0)),
        volume=volume,
        share=volume / whole,
        depth=float(-contacts.gap[shared > 0].min()),
        stones=(one, other),
        place=contacts.point[slice(*contacts.point_ptr[most : most + 2])].mean(axis=0),
    )
