"""Where the loops of the solvers are kept, which numba compiles once after installation, and whether they have been."""

import os
import stat
import sys
from contextlib import suppress
from pathlib import Path

# Its loops, of all solvers the first to be called, are compiled by numba at their first call and kept.
SOLVER = Path(__file__).parent / "conic" / "interior_point"
# Names another place to keep them in.
PLACE = "NUMBA_CACHE_DIR"


def keep_compiled() -> None:
    """Name a place where loops are kept, if numba finds none and would not load the solvers: neither the package can be written
    to, as where somebody else installed it, nor the home of this user, as of a service."""
    if os.environ.get(PLACE) or writable(_of_package()) or writable(_of_user()):
        return
    from tempfile import gettempdir, mkdtemp

    with suppress(OSError):
        folder = Path(gettempdir(), f"churchpipe-{os.getuid()}")
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        # One in its place is found again by whoever comes next.
        known = [folder, *sorted(folder.parent.glob(f"{folder.name}-*"))]
        os.environ[PLACE] = str(next(filter(_own, known), None) or mkdtemp(prefix=f"{folder.name}-"))


def _own(folder: Path) -> bool:
    """Return whether nobody else made a folder, or can write to it: what is kept is code."""
    with suppress(OSError):
        found = folder.lstat()
        return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o022
    return False


def compiled() -> bool:
    """Return whether compiled loops of the solvers are kept from an earlier run, in the first place that numba can write to."""
    if folder := os.environ.get(PLACE):
        return any(Path(folder).rglob("*.nbi"))
    if writable(_of_package()):
        return any(_of_package().glob("*.nbi"))
    return any(_of_user().glob(f"{SOLVER.name}_*/*.nbi"))


def _of_package() -> Path:
    return SOLVER / "__pycache__"


def _of_user() -> Path:
    return caches_of_user() / "numba"


def caches_of_user() -> Path:
    """Return the folder in the home of this user in which programs keep what they can make again."""
    home = os.path.expanduser("~")
    if sys.platform == "darwin":
        return Path(home, "Library", "Caches")
    return Path(os.environ.get("XDG_CACHE_HOME", os.path.join(home, ".cache")))


def writable(folder: Path) -> bool:
    """Return whether a folder can be written to, or made."""
    while not os.path.exists(folder) and folder != folder.parent:
        folder = folder.parent
    return os.access(folder, os.W_OK | os.X_OK)
