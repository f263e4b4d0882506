"""Loops over many places, shared out to the cores that this process may use.

The loops are numba's, compiled with `nogil`, and take as their first arguments which of how many shares they are to do. Python's
own threads serve: they begin when first needed, so that a process which stands by and forks has none.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numba

# Below so many places a loop is done before another thread has begun.
_LEAST = 20_000
# What BLAS takes its number of threads from; a run sets it to the share of each of its jobs.
_VARIABLE = "OMP_NUM_THREADS"

_pools: dict[int, ThreadPoolExecutor] = {}
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pools.clear)


def threads() -> int:
    """Return the number of threads of one solve as BLAS has it: OMP_NUM_THREADS, or all cores where it is not set."""
    given = os.environ.get(_VARIABLE, "").partition(",")[0].strip()
    return max(1, int(given)) if given.isdecimal() else _cores()


def shares_of(places: int) -> int:
    """Return into how many shares a loop over so many places is divided."""
    return threads() if places >= _LEAST else 1


def in_shares(loop: Callable[..., Any], places: int, *arguments: Any) -> None:
    """Call loop(share, shares, *arguments) for each share of so many places; what they write must not overlap."""
    shares = shares_of(places)
    together(*((loop, share, shares, *arguments) for share in range(shares)))


def together(*calls: tuple[Any, ...]) -> None:
    """Make calls (function, arguments ...) that release the interpreter, at once where there are threads for it."""
    count = threads()
    if count == 1 or len(calls) <= 1:
        for function, *arguments in calls:
            function(*arguments)
        return
    if count not in _pools:
        _pools[count] = ThreadPoolExecutor(count - 1, "share")
    *others, (function, *arguments) = calls
    waiting = [_pools[count].submit(other, *rest) for other, *rest in others]
    function(*arguments)
    for each in waiting:
        each.result()


@numba.njit(cache=True, inline="always")
def bounds_of(places: int, share: int, shares: int) -> tuple[int, int]:
    """Return where a share of so many places begins and ends."""
    return places * share // shares, places * (share + 1) // shares


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
