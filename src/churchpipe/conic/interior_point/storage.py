"""One cone program in one npz: for bug reports, solved again with `solve_interior_point(load_program(path))`."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram
from churchpipe.conic.wrenches import Balance, Wrenches
from churchpipe.errors import InputError

_VECTORS = ("constant", "growth", "limit", "slope", "linear", "quadratic", "bound")
_MATRIX = ("data", "indices", "indptr", "shape")
_WRENCHES = tuple(field.name for field in fields(Wrenches))


def save_program(path: Path, program: ConeProgram) -> None:
    """Write a program to an npz file."""
    names = _WRENCHES if isinstance(program.balance, Wrenches) else _MATRIX
    arrays: dict[str, Any] = {name: np.asarray(getattr(program.balance, name)) for name in names}
    arrays |= {name: getattr(program, name) for name in _VECTORS}
    np.savez_compressed(path, allow_pickle=False, cap=np.array(program.cap), **arrays)


def load_program(path: Path) -> ConeProgram:
    """Read a program from an npz file of `save_program`.

    Raises
    ------
    InputError: the file lacks an array.
    """
    with np.load(path, allow_pickle=False) as stored:
        wrenches = "frames" in stored
        names = (*(_WRENCHES if wrenches else _MATRIX), "cap", *_VECTORS)
        missing = [name for name in names if name not in stored]
        if missing:
            raise InputError(str(path), "not a stored cone program", found="no " + ", ".join(missing))
        arrays = {name: stored[name] for name in names}
    if wrenches:
        balance: Balance = Wrenches(int(arrays["count"]), **{name: arrays[name] for name in _WRENCHES if name != "count"})
    else:
        shape = (int(arrays["shape"][0]), int(arrays["shape"][1]))
        balance = sp.csc_matrix((arrays["data"], arrays["indices"], arrays["indptr"]), shape=shape)
    return ConeProgram(balance, **{name: arrays[name] for name in _VECTORS}, cap=float(arrays["cap"]))
