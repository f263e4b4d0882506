"""What to ask about sizes that no masonry building has, such as millimetres taken for metres."""

from typing import TYPE_CHECKING, Annotated

import numpy as np

from churchpipe.model.doubts import question
from churchpipe.model.quantities import UNITS, Quantity, Usual

if TYPE_CHECKING:
    from churchpipe.model.assemblage import Assemblage

_HEIGHT = Usual(0.05, 200.0, "models of tilting tests to the tallest spires")
_LENGTH = Usual(0.05, 500.0, "models of tilting tests to the longest churches")
_STONE = Usual(0.005, 25.0, "bricks of models to the largest cut stones")
_THIN = Usual(0.005, 10.0, "stones of models to the walls of keeps")
_METRES = UNITS["_m"]
# Height of courses and length of stones, m; their keys are in mm, and are asked about before any stone is laid.
_LAID = Usual(5.0, 25e3, _STONE.reason)
LaidSize = Annotated[float, Quantity("_mm", 0.0, above=True, usual=_LAID)]


def size_questions(stones: "Assemblage") -> list[str]:
    """Return what to ask about the extents of a structure and of its stones, supports left out."""
    if stones.fixed.all():
        return []
    first = stones.block_point_ptr[:-1]
    low, high = (reduce.reduceat(stones.points, first)[~stones.fixed] for reduce in (np.minimum, np.maximum))
    side, whole = (high - low).max(axis=1), high.max(axis=0) - low.min(axis=0)
    sizes = (("the height of the structure", _HEIGHT, whole[2]), ("the length of the structure", _LENGTH, whole[:2].max()))
    thin = np.median((high - low).min(axis=1))
    sides = [("the longest side of a stone", _STONE, side.max()), ("the longest side of a stone", _STONE, side.min())]
    sides.append(("the thickness of most stones", _THIN, thin))
    asked = [question(name, float(found), usual, _METRES) for name, usual, found in (*sizes, *sides)]
    return list(dict.fromkeys(text for text in asked if text))
