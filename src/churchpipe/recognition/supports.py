"""A stone of an assemblage as a body of its own."""

import numpy as np

from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Support


def support_of(stones: Assemblage, block: int) -> Support:
    """Return a stone as a support, or as any body: its name, points m and outward faces."""
    start, stop = stones.block_point_ptr[block : block + 2]
    faces = np.arange(*stones.block_face_ptr[block : block + 2])
    nodes = [stones.face_nodes[stones.face_ptr[f] : stones.face_ptr[f + 1]] - start for f in faces]
    return Support(str(stones.block_id[block]), stones.points[start:stop].copy(), tuple(tuple(map(int, n)) for n in nodes))
