from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

class CSRAdjacency:
    def __init__(self, adj_starts: npt.NDArray[np.int32], adjacent: npt.NDArray[np.int32]) -> None: ...

def nested_dissection(adjacency: CSRAdjacency) -> tuple[Sequence[int], Sequence[int]]: ...
