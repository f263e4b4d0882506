"""Values that differ by rounding alone made equal."""

import numpy as np
import numpy.typing as npt

from churchpipe.model.arrays import FloatArray


def gathered(values: FloatArray, spread: float, marks: npt.ArrayLike = ()) -> FloatArray:
    """Return values (n,) with those of one line made equal: parted at the widest gaps until each part is within `spread`.

    marks: where lines are known to be; a part with its mean within half of `spread` of one goes there.
    """
    order = np.argsort(values)
    given = values[order]
    known = np.asarray(marks, dtype=np.float64)
    cuts = np.flatnonzero(np.diff(given) > spread) + 1
    parts = list(zip([0, *cuts.tolist()], [*cuts.tolist(), len(given)], strict=True))
    out = np.empty(len(given))
    while parts:
        start, stop = parts.pop()
        part = given[start:stop]
        if len(part) and part[-1] - part[0] > spread:
            cut = start + 1 + int(np.argmax(np.diff(part)))
            parts += [(start, cut), (cut, stop)]
        elif len(part):
            mean = float(part.mean())
            mark = float(known[np.argmin(np.abs(known - mean))]) if len(known) else np.inf
            out[order[start:stop]] = mark if abs(mark - mean) < 0.5 * spread else mean
    return out
