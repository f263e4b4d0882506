"""The bonds of vaults in the shell: running bond, or a stack where stones lie in lunes that do not interlock."""

import numpy as np

from churchpipe.bond.period import BondName
from churchpipe.model.vault import Run, Vault

# Joints closer than this are one, m.
_ONE = 1e-6


def vault_bonds(vault: Vault) -> dict[str, BondName]:
    """Return the bond of each part of a vault.

    Each ring of voussoirs is a piece of its own, in running bond: its voussoirs are as wide as the ring. The joint of two rings
    is a strip in stack bond (`vault_facets`), however their voussoirs lie: staggered, they lock two rings by friction alone, and
    nothing presses free rings together; what locks them in an associative analysis is that they would have to move apart.
    """
    if vault.beds == "section":
        return dict.fromkeys(vault.parts, "running")
    return {part: "stack" if _in_lunes([run for run in vault.runs if run.part == part]) else "running" for part in vault.parts}


def _in_lunes(runs: list[Run]) -> bool:
    """Say whether courses about an axis have head joints at corners alone, and most courses have them where the next has them."""
    sides = {_rounded(run.side.origin, run.side.normal) for run in runs}
    if len(sides) < 3 or any(len(run.stone) > 1 for run in runs):
        return False
    below = {_rounded(run.side.origin, run.side.normal, run.section.upper): run for run in runs}
    pairs: dict[int, set[tuple[int, int]]] = {}
    for run in runs:
        lower = below.get(_rounded(run.side.origin, run.side.normal, run.section.lower))
        if lower is not None and lower.course != run.course:
            pairs.setdefault(run.course, set()).add((int(lower.stone[0]), int(run.stone[0])))
    # Where each stone lies on one, there are no more pairs than stones.
    goes_on = [len(own) <= max(map(len, map(set, zip(*own, strict=True)))) for own in pairs.values()]
    return bool(goes_on) and float(np.mean(goes_on)) > 0.5


def _rounded(*place: np.ndarray) -> tuple[float, ...]:
    return tuple((np.round(np.concatenate(place) / _ONE) * _ONE).tolist())
