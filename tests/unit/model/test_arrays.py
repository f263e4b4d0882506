"""The array types, as dataclasses are read by them."""

from typing import Any, get_args, get_origin

import numpy as np
import pytest

from churchpipe.model.arrays import BoolArray, FloatArray, IntArray, NameArray


@pytest.mark.parametrize(
    ("kind", "scalar"), [(FloatArray, np.float64), (IntArray, np.int64), (BoolArray, np.bool_), (NameArray, np.str_)]
)
def test_an_array_is_known_by_its_annotation(kind: Any, scalar: type) -> None:
    """Case files and constructors are made of the annotations; the aliases of NumPy 2.5 hide ndarray from them."""
    assert get_origin(kind) is np.ndarray
    assert get_args(get_args(kind)[1]) == (scalar,)
