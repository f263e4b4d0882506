"""The steps of a curve, or of a support that moves, kept on the way, so that a run that was interrupted goes on from them."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Generic, TypeVar

from churchpipe.io.npz import read_npz, write_npz
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.settlement import SettlementPath

# Steps are written when this many times the time has gone by that writing took: it never costs more than a tenth of a run.
_RARELY = 10.0


T = TypeVar("T", BlockCapacityCurve, SettlementPath)


class KeptSteps(Generic[T]):
    """A file beside the result of a stage, steps_DIGEST.npz; the digest is of the stage's inputs and code, so that steps of other
    inputs are never gone on from. name: another one than steps, where several are kept in a folder."""

    def __init__(self, kind: type[T], folder: Path, inputs: Sequence[Path], code: str, name: str = "steps") -> None:
        digest = hashlib.sha256(code.encode())
        for file in inputs:
            digest.update(file.read_bytes())
        self._folder, self._file = folder, folder / f"{name}_{digest.hexdigest()[:16]}.npz"
        self._kind, self._name, self._next = kind, name, 0.0

    def found(self) -> T | None:
        """Return the steps of an interrupted run, None where there are none."""
        return read_npz(self._file, self._kind) if self._file.exists() else None

    def keep(self, path: T) -> None:
        """Write the steps so far, if it is time."""
        begin = perf_counter()
        if begin < self._next:
            return
        self._folder.mkdir(parents=True, exist_ok=True)
        write_npz(self._file, path)
        self._next = perf_counter() + _RARELY * (perf_counter() - begin)

    def clear(self) -> None:
        """Remove the steps kept here, those of other inputs too: the path is whole."""
        for file in self._folder.glob(f"{self._name}_*.npz"):
            file.unlink()
