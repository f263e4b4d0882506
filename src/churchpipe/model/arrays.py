"""Array types, and the checks that every frozen dataclass of arrays runs on itself."""

from collections.abc import Sequence
from dataclasses import fields
from functools import lru_cache
from typing import Any, cast, get_type_hints

import numpy as np
import numpy.typing as npt

from churchpipe.errors import InputError, check_whole
from churchpipe.model.arguments import describe

# Written out, because dataclasses are read by their annotations: from NumPy 2.5 on NDArray is an alias that hides ndarray.
FloatArray = np.ndarray[tuple[Any, ...], np.dtype[np.float64]]
IntArray = np.ndarray[tuple[Any, ...], np.dtype[np.int64]]
BoolArray = np.ndarray[tuple[Any, ...], np.dtype[np.bool_]]
NameArray = np.ndarray[tuple[Any, ...], np.dtype[np.str_]]


class ReadOnly:
    """A frozen dataclass of arrays that stay read-only in its copies, and in other processes that it is sent to."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        """Set what `dataclass` would set without that."""
        super().__init_subclass__()
        cls.__setstate__ = _restore


def _restore(instance: Any, state: Sequence[object]) -> None:
    for item, value in zip(fields(instance), state, strict=True):
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
        object.__setattr__(instance, item.name, value)


def _frozen(array: npt.NDArray[Any], given: object) -> npt.NDArray[Any]:
    # What somebody else can write to stays so, and only a copy of it is kept: a caller's array, or what one was made of without
    # a copy, as of a column of pandas.
    out = array if isinstance(given, list | tuple) or not _writable(array) else array.copy()
    out.setflags(write=False)
    return out


def _writable(array: npt.NDArray[Any]) -> bool:
    """Return whether what an array shows can be written to, in it or in what owns it."""
    owner: object = array
    while isinstance(owner, np.ndarray):
        if owner.flags.writeable:
            return True
        owner = cast("object", owner.base)
    return owner is not None


def array_of(name: str, value: object, kinds: str, expected: str) -> npt.NDArray[Any]:
    """Return `value` as an array whose type is one of NumPy's kinds; an empty one is of every kind."""
    if np.ma.is_masked(value):
        raise InputError(name, "masked entries", found=describe(value), expected=f"{expected} without a mask")
    try:
        array = np.asarray(value)
    except (ValueError, TypeError) as error:
        raise InputError(name, "no array", found=f"{describe(value)} ({error})", expected=expected) from error
    if array.size and array.dtype.kind not in kinds:
        if "U" in kinds and all(isinstance(item, str) for item in array.flat):
            return array.astype(np.str_)
        raise InputError(name, f"not {expected}", found=describe(value) if array.ndim == 0 else array.dtype, expected=expected)
    return array


def _check_shape(name: str, array: npt.NDArray[Any], shape: Sequence[int | None]) -> None:
    if array.ndim != len(shape) or any(want is not None and want != have for want, have in zip(shape, array.shape, strict=True)):
        wanted = "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"
        raise InputError(name, "wrong shape", found=array.shape, expected=wanted)


def rows_of(name: str, value: Any) -> int:
    """Return the length of what should be an array."""
    try:
        return len(value)
    except TypeError:
        raise InputError(name, "not an array", found=describe(value), expected="an array") from None


def floats(name: str, value: npt.ArrayLike, shape: Sequence[int | None], *, finite: bool = True) -> FloatArray:
    """Return `value` as a read-only float64 array of the given shape (None: any length); every entry finite."""
    array = array_of(name, value, "iufb", "numbers").astype(np.float64, copy=False)
    _check_shape(name, array, shape)
    if finite and not np.isfinite(array).all():
        where = np.argwhere(~np.isfinite(array))[0].tolist()
        raise InputError(name, f"not a finite number at index {where}", found=array[tuple(where)], expected="finite numbers")
    return _frozen(array, value)


def indices(name: str, value: npt.ArrayLike, shape: Sequence[int | None], *, below: int | None = None) -> IntArray:
    """Return `value` as a read-only int64 array of the given shape, entries in [0, below)."""
    array = array_of(name, value, "iu", "whole numbers").astype(np.int64, copy=False)
    _check_shape(name, array, shape)
    if array.size and (array.min() < 0 or (below is not None and array.max() >= below)):
        bad = array[(array < 0) | (array >= (below if below is not None else np.iinfo(np.int64).max))].flat[0]
        expected = ">= 0" if below is None else f"0 <= index < {below}"
        raise InputError(name, "index out of range", found=int(bad), expected=expected)
    return _frozen(array, value)


def pointers(name: str, value: npt.ArrayLike, rows: int, total: int) -> IntArray:
    """Return a CSR-style pointer array: `rows + 1` non-decreasing entries from 0 to `total`."""
    array = indices(name, value, (rows + 1,))
    if not len(array) or array[0] != 0 or array[-1] != total or (np.diff(array) < 0).any():
        raise InputError(
            name, "not a pointer array", found=f"{array[:3]} .. {array[-1:]}", expected=f"0 .. {total}, non-decreasing"
        )
    return array


def flags(name: str, value: npt.ArrayLike, shape: Sequence[int | None]) -> BoolArray:
    """Return `value` as a read-only bool array of the given shape."""
    array = array_of(name, value, "biuf", "flags")
    if array.dtype != np.bool_ and not np.isin(array, (0, 1)).all():
        raise InputError(name, "not a flag", found=array.dtype, expected="true or false")
    array = array.astype(np.bool_, copy=False)
    _check_shape(name, array, shape)
    return _frozen(array, value)


def names(name: str, value: npt.ArrayLike, shape: Sequence[int | None]) -> NameArray:
    """Return `value` as a read-only array of strings of the given shape."""
    array = array_of(name, value, "Uiu", "texts").astype(np.str_, copy=False)
    _check_shape(name, array, shape)
    for text in set(array.ravel().tolist()):
        check_whole(name, text)
    return _frozen(array, value)


def unit_vector(name: str, value: npt.ArrayLike, length: int = 3) -> FloatArray:
    """Return a vector of so many components, of whatever length but zero, as a read-only one of length one."""
    vector = floats(name, value, (length,))
    # Scaled first: squares of very large or small components would overflow or vanish.
    scaled = vector / (np.abs(vector).max() or 1.0)
    if not scaled.any():
        raise InputError(name, "no direction", found=vector.tolist(), expected="a vector of length > 0")
    return _frozen(scaled / np.linalg.norm(scaled), [])


def one_each(name: str, array: npt.NDArray[Any], count: int) -> npt.NDArray[Any]:
    """Return a value for each of `count` items: the array's own, or its only one for all."""
    if array.shape not in ((), (1,), (count,)):
        raise InputError(name, "wrong shape", found=array.shape, expected=f"one for all, or ({count},)")
    return np.broadcast_to(array, (count,)).copy()


def store(instance: object, **checked: object) -> None:
    """Set checked fields on a frozen dataclass from inside its `__post_init__`."""
    for key, value in checked.items():
        object.__setattr__(instance, key, value)


def store_arrays(instance: object, *, finite: bool = True, **shapes: Sequence[int | None]) -> None:
    """Check array fields of a frozen dataclass, each by its annotation and the shape that it must have, and store them read-only.

    finite: whether every entry of those of floats must be. Errors name the class and the field.
    """
    kinds = _hints(instance.__class__)
    for key, shape in shapes.items():
        name, value = f"{instance.__class__.__name__}.{key}", getattr(instance, key)
        if kinds[key] == FloatArray:
            array: object = floats(name, value, shape, finite=finite)
        else:
            array = {IntArray: indices, BoolArray: flags, NameArray: names}[kinds[key]](name, value, shape)
        object.__setattr__(instance, key, array)


@lru_cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def pointer_of(counts: npt.ArrayLike) -> IntArray:
    """Return where the entries of each row begin in one list, and where the last ones end (n + 1,); counts (n,): of a row."""
    return np.concatenate(([0], np.cumsum(np.asarray(counts, dtype=np.int64))))


def ragged_indices(starts: IntArray, counts: IntArray) -> IntArray:
    """Return the concatenation of arange(start, start + count) over all rows, without a loop."""
    total = int(counts.sum())
    offsets = np.repeat(starts - np.concatenate(([0], np.cumsum(counts)[:-1])), counts)
    return np.arange(total, dtype=np.int64) + offsets
