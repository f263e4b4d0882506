"""Processes that tests start: waited for, and asked whether they live."""

import os
import time
from collections.abc import Callable


def wait_for(condition: Callable[[], bool], seconds: float = 300.0) -> None:
    """Wait until a condition holds, for so many seconds at most."""
    stop = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < stop
        time.sleep(0.02)


def group_lives(number: int) -> bool:
    """Return whether a process of a group is left."""
    try:
        os.killpg(number, 0)
    except ProcessLookupError:
        return False
    return True
