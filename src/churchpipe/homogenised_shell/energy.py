"""Elastic energy of the points of a shell in a step of its capacity curve."""

from dataclasses import dataclass, replace

import numpy as np

from churchpipe.model.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Energy:
    """Elastic energy of the points of a step: compliance C and stiffness C^-1 (6, 6, nq), root (nq, 6, 6), linear (6, nq)."""

    compliance: FloatArray
    stiffness: FloatArray
    root: FloatArray
    linear: FloatArray


def elastic_energy(compliance: FloatArray, origin: FloatArray, known: Energy | None = None) -> Energy:
    """Return the energy 1/2 (stress - origin) C (stress - origin), C_abq (6, 6, nq), origin (6, nq).

    known: one that may have the same compliance, whose inverse then serves.
    """
    linear = -np.einsum("abq,bq->aq", compliance, origin)
    if known is not None and known.compliance is compliance:
        return replace(known, linear=linear)
    stiffness = np.linalg.inv(np.moveaxis(compliance, 2, 0)).astype(np.float64, copy=False)
    return Energy(
        compliance=compliance,
        stiffness=np.ascontiguousarray(np.moveaxis(stiffness, 0, 2)),
        root=np.ascontiguousarray(np.swapaxes(np.linalg.cholesky(stiffness).astype(np.float64, copy=False), 1, 2)),
        linear=linear,
    )
