"""A stone of an assemblage as a body of its own."""

from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Support


def support_of(stones: Assemblage, block: int) -> Support:
    """Return a stone as a support, or as any body: its name, points m and outward faces."""
    points, faces = stones.solid(block)
    return Support(str(stones.block_id[block]), points.copy(), tuple(map(tuple, faces)))
