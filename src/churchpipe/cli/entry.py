"""What every command ends in: its exit code, and errors in one sentence."""

import signal
from typing import NoReturn

from churchpipe.cli import cases, machine, runs, stones
from churchpipe.cli.app import FINDINGS, STRUCTURE, USAGE, app, err, leave_pipe
from churchpipe.errors import InputError, UsageError

# The modules of commands register themselves in the order in which they are imported.
__all__ = ["app", "cases", "machine", "main", "runs", "stones"]


def main() -> NoReturn:
    """Run the command line and leave with its exit code."""
    signal.signal(signal.SIGTERM, _interrupt)
    # The terminal is closed; nohup lets a run go on then.
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        signal.signal(signal.SIGHUP, _interrupt)
    try:
        app()
    except InputError as error:
        err.print(str(error), style="red", soft_wrap=True)
        raise SystemExit(USAGE if isinstance(error, UsageError) else FINDINGS) from None
    except BrokenPipeError:
        leave_pipe()
    except SystemExit as leaving:
        # Help and what is wrong with the usage are printed by Typer, which leaves as if a closed pipe were an error.
        if isinstance(pipe := leaving.__context__, BrokenPipeError):
            leave_pipe(getattr(pipe.__context__, "exit_code", 0))
        raise
    except OSError as error:
        place = f"{error.filename}: " if error.filename else "A file cannot be written: "
        problem = error.strerror or str(error)
        err.print(f"{place}{problem}. Choose another place to write to.", style="red", soft_wrap=True)
        raise SystemExit(USAGE) from None
    except UnicodeEncodeError as error:
        # Of a name that the system gave as bytes, Python has those that are no text as surrogates.
        if not "\udc80" <= error.object[error.start] <= "\udcff":
            found = error.object[error.start : error.end].encode("ascii", "backslashreplace").decode()
            problem = f"The terminal or the file system is set to {error.encoding}, which cannot write everything here"
            err.print(f"{problem}; found {found}. Set LC_ALL=C.UTF-8 and PYTHONIOENCODING=utf-8.", style="red", soft_wrap=True)
            raise SystemExit(USAGE) from None
        begin = error.object.rfind("\n", 0, error.start) + 1
        name = error.object[begin:].partition("\n")[0].encode(errors="surrogateescape").decode(errors="backslashreplace")
        problem = "The name of a file or a folder is not in UTF-8, as after unpacking an archive of another system"
        err.print(f"{problem}; found {name}. Rename it.", style="red", soft_wrap=True)
        raise SystemExit(USAGE) from None
    except MemoryError:
        err.print("Out of memory: the structure is too large for this machine.", style="red", soft_wrap=True)
        raise SystemExit(STRUCTURE) from None
    raise SystemExit(0)


def _interrupt(*_: object) -> NoReturn:
    raise KeyboardInterrupt
