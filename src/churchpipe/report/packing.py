"""Arrays as text that JavaScript reads."""

import base64

import numpy as np
import numpy.typing as npt


def packed(array: npt.ArrayLike, dtype: str) -> str:
    """Return an array as base64 of its entries in the given (little-endian) type."""
    return base64_text(np.ascontiguousarray(array, dtype=dtype).tobytes())


def base64_text(data: bytes) -> str:
    """Return bytes as base64."""
    return base64.b64encode(data).decode("ascii")
