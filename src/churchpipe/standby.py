"""A process that stands by during a run, with all loaded that its stages use, and forks for each of them.

To load Python, its libraries and the compiled loops takes longer than most stages work. A fork has them at once, and is otherwise
a process like any other: it ends with its stage, and what it does is seen by nobody else.

    python -m churchpipe.standby PLACE COMMAND ...

runs the engine's command, ends with its exit code, and serves `call_standby.py` meanwhile at a socket of this path.
"""

import gc
import importlib
import json
import os
import runpy
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import NoReturn

from churchpipe.call_standby import PLACE, THREADS

# In the order in which a run comes to need them: those of the stages up to the analyses, and those of the report.
MODULES = (
    *("churchpipe.cli.entry", "churchpipe.stages", "churchpipe.generators", "churchpipe.stones.blocks"),
    *("churchpipe.stones.contacts", "churchpipe.stones.soundness", "churchpipe.shell_mesh.shell", "churchpipe.match"),
    *("churchpipe.rigid_blocks.limit", "churchpipe.rigid_blocks.ranking", "churchpipe.rigid_blocks.sensitivity"),
    *("churchpipe.homogenised_shell.limit", "churchpipe.homogenised_shell.pushover"),
)
RESULTS = (
    *("churchpipe.run_folder", "churchpipe.report.html", "churchpipe.report.powers", "matplotlib.backends.backend_svg"),
    # In parts: who asks for a stage meanwhile waits for the end of one.
    *("pyvista", "vtkmodules.vtkRenderingOpenGL2", "pyvista.plotting"),
    # A stage that writes a drawing first loads it by itself, beside the others.
    "churchpipe.dxf.writer",
)
# Of what sets the number of threads of BLAS.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def available() -> bool:
    """Return whether a process can stand by on this system: elsewhere than on Linux, libraries do not outlive a fork."""
    return sys.platform == "linux"


def main(place: str, *command: str) -> int:
    """Run a command, and stand by as long as it lasts; return its exit code. place: path of the socket, which must be short."""
    # The system's default would end this process before the engine and the stages, which share its group, have ended.
    signal.signal(signal.SIGINT, lambda *_: None)
    os.environ.update(dict.fromkeys(_THREADS, THREADS))
    with socket.socket(socket.AF_UNIX) as door, selectors.DefaultSelector() as events:
        try:
            door.bind(place)
            door.listen(socket.SOMAXCONN)
            environment = os.environ | {PLACE: place}
        except OSError:
            # Not every file system has sockets.
            environment = None
        engine = subprocess.Popen(command, env=environment)
        if environment is None:
            return engine.wait()
        return _Standby(door, events, engine).serve()


@dataclass
class _Standby:
    door: socket.socket
    events: selectors.BaseSelector
    engine: "subprocess.Popen[bytes]"
    # Line to whoever waits for a process, by its number.
    lines: dict[int, socket.socket] = field(default_factory=dict[int, socket.socket])

    def serve(self) -> int:
        self.events.register(self.door, selectors.EVENT_READ)
        self.events.register(os.pidfd_open(self.engine.pid), selectors.EVENT_READ, self.engine.pid)
        self.load(MODULES)
        _call_a_loop()
        self.load(RESULTS)
        while self.engine.returncode is None:
            self.answer(None)
        for process in self.lines:
            os.kill(process, signal.SIGTERM)
        return self.engine.returncode

    def load(self, modules: Sequence[str]) -> None:
        for module in modules:
            # What is missing is said by the stage that needs it.
            with suppress(ImportError):
                importlib.import_module(module)
            self.answer(0)

    def answer(self, patience: float | None) -> None:
        """Start what is asked for, and say what has ended; wait for either, at most so many seconds."""
        for key, _ in self.events.select(patience):
            if key.data is None:
                self.fork()
                continue
            self.events.unregister(key.fd)
            os.close(key.fd)
            if key.data == self.engine.pid:
                self.engine.wait()
                continue
            code = os.waitstatus_to_exitcode(os.waitpid(key.data, 0)[1])
            with self.lines.pop(key.data) as line, suppress(OSError):
                # As shells say it of a command that a signal has ended.
                line.sendall(str(code if code >= 0 else 128 - code).encode())

    def fork(self) -> None:
        line, _ = self.door.accept()
        order, files, _, _ = socket.recv_fds(line, 2**16, 3)
        while part := line.recv(2**16):
            order += part
        if (asked := json.loads(order)) is None:
            # The lock of the run, which stays open from here on: no stage outlives it, be it a fork or started anew.
            os.set_inheritable(files[0], True)
            line.close()
            return
        # A collection in the fork would touch, and so copy, all that is shared.
        gc.freeze()
        process = os.fork()
        if process == 0:
            for other in (self.door, *self.lines.values(), line):
                other.close()
            _run(files, *asked)
        for file in files:
            os.close(file)
        self.lines[process] = line
        self.events.register(os.pidfd_open(process), selectors.EVENT_READ, process)


def _call_a_loop() -> None:
    """Let numba start its compiler, which it does for the first loop of a process, compiled before or not; it takes .2 s."""
    # Not before the number of threads is set, which BLAS reads as it is loaded.
    import numpy as np

    from churchpipe.conic.interior_point.iterate import plus

    plus(np.zeros(1), np.zeros(1), 0.0)


def _run(files: Sequence[int], arguments: Sequence[str], folder: str, environment: dict[str, str]) -> NoReturn:
    """Become what `python -m churchpipe ARGUMENTS` would be, and end."""
    code: object = 1
    try:
        for number, file in enumerate(files):
            os.dup2(file, number)
            os.close(file)
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        if environment.get(_THREADS[0], THREADS) != THREADS:
            os.execv(sys.executable, [sys.executable, "-m", "churchpipe", *arguments])
        tempfile.tempdir = None
        signal.signal(signal.SIGINT, signal.default_int_handler)
        sys.argv = ["churchpipe", *arguments]
        runpy.run_module("churchpipe", run_name="__main__")
    except SystemExit as end:
        code = end.code
    except BaseException:
        traceback.print_exc()
    finally:
        leave(code)


def leave(code: object) -> NoReturn:
    """End this process as SystemExit would, but at once: to take its libraries down takes longer than many stages."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError):
            stream.flush()
    os._exit(code if isinstance(code, int) else int(code is not None))


if __name__ == "__main__":
    leave(main(*sys.argv[1:]))
