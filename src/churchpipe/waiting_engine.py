"""Snakemake, with its libraries loaded, that waits for its orders.

    python -m churchpipe.waiting_engine PROFILE

Orders come over the socket that is its standard input: the arguments of Snakemake as JSON, and with them the lock of the run's
folder. The engine holds it as long as it lives, and so do the process that stands by and all its forks. If the socket closes
before, nothing is done.
"""

import importlib
import json
import os
import pkgutil
import socket
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

from churchpipe.call_standby import PLACE, entrust
from churchpipe.engine import LOCAL
from churchpipe.standby import leave

# Snakemake comes to need them after its orders, and they take .4 s to load.
LATER = ("snakemake.report.html_reporter", "snakemake.executors.local", "smart_open")


def main(arguments: Sequence[str]) -> None:
    """Wait for orders and carry them out."""
    if arguments[0] == LOCAL:
        # One for clusters loads pandas, .4 s; those of the local profile belong to Snakemake.
        pkgutil.iter_modules = _no_plugins
    from snakemake.cli import main as snakemake

    for module in LATER:
        # Where a version has none of that name, Snakemake loads what it has.
        with suppress(ImportError):
            importlib.import_module(module)
    with socket.socket(fileno=os.dup(sys.stdin.fileno())) as line:
        order, locks, _, _ = socket.recv_fds(line, 2**16, 1)
    if locks and (place := os.environ.get(PLACE)):
        # Before any stage is asked for, so that all of them hold it, and none outlives it.
        entrust(place, locks[0])
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, sys.stdin.fileno())
    os.close(nothing)
    if order:
        try:
            snakemake(json.loads(order))
        except SystemExit as end:
            leave(end.code)


def _no_plugins(*_: Any, **__: Any) -> Iterator[pkgutil.ModuleInfo]:
    return iter(())


if __name__ == "__main__":
    main(sys.argv[1:])
