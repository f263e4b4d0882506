"""One cone program in one npz: for bug reports, solved again with `solve_interior_point(load_program(path))`."""

from pathlib import Path

import numpy as np
import scipy.sparse as sp

from churchpipe.conic.program import ConeProgram
from churchpipe.errors import InputError

_VECTORS = ("constant", "growth", "limit", "slope", "linear", "quadratic", "bound")


def save_program(path: Path, program: ConeProgram) -> None:
    """Write a program to an npz file."""
    balance = program.balance
    arrays = {name: getattr(program, name) for name in _VECTORS}
    np.savez_compressed(
        path,
        allow_pickle=False,
        data=balance.data,
        indices=balance.indices,
        indptr=balance.indptr,
        shape=np.array(balance.shape),
        cap=np.array(program.cap),
        **arrays,
    )


def load_program(path: Path) -> ConeProgram:
    """Read a program from an npz file of `save_program`.

    Raises
    ------
    InputError: the file lacks an array.
    """
    with np.load(path, allow_pickle=False) as stored:
        missing = [name for name in ("data", "indices", "indptr", "shape", "cap", *_VECTORS) if name not in stored]
        if missing:
            raise InputError(str(path), "not a stored cone program", found="no " + ", ".join(missing))
        shape = (int(stored["shape"][0]), int(stored["shape"][1]))
        balance = sp.csc_matrix((stored["data"], stored["indices"], stored["indptr"]), shape=shape)
        return ConeProgram(balance, **{name: stored[name] for name in _VECTORS}, cap=float(stored["cap"]))
