"""Run `churchpipe ARGUMENTS` in a fork of the process that stands by (`standby.py`), or here where there is none.

A script: python -I -S call_standby.py ARGUMENTS. It imports nothing of this package, so that it starts in a hundredth of a
second.
"""

import json
import os
import signal
import socket
import sys
from collections.abc import Sequence

# Says to all that belongs to a run where the process that stands by can be reached.
PLACE = "CHURCHPIPE_STANDBY"
# Of BLAS, in the process that stands by and so in its forks: where a job is given more, its fork starts Python anew.
THREADS = "1"


def ask(place: str, arguments: Sequence[str]) -> int | None:
    """Return the exit code of a command run by the process that stands by; None where nobody does."""
    with socket.socket(socket.AF_UNIX) as line:
        try:
            line.connect(place)
        except OSError:
            return None
        order = json.dumps([list(arguments), os.getcwd(), dict(os.environ)]).encode()
        sent = socket.send_fds(line, [order], [0, 1, 2])
        line.sendall(order[sent:])
        line.shutdown(socket.SHUT_WR)
        # Whoever stood by was killed, and the command with it, where there is no answer.
        return int(line.recv(16) or 128 + signal.SIGKILL)


def entrust(place: str, file: int) -> None:
    """Let the process that stands by, and with it all its forks from now on, hold a file open as long as they live."""
    with socket.socket(socket.AF_UNIX) as line:
        line.connect(place)
        socket.send_fds(line, [b"null"], [file])


def main() -> int:
    """Do what the command line says."""
    place = os.environ.get(PLACE)
    code = ask(place, sys.argv[1:]) if place else None
    if code is None:
        os.execv(sys.executable, [sys.executable, "-m", "churchpipe", *sys.argv[1:]])
    return code


if __name__ == "__main__":
    raise SystemExit(main())
