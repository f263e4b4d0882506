"""What is missing on this machine, and the line that installs it."""

import importlib.util
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

TRIAL_SECONDS = 120

# Debian's packages for the shared libraries that wheels leave to the system.
SYSTEM_PACKAGES = {
    "libGL.so": "libgl1",
    "libGLU.so": "libglu1-mesa",
    "libEGL.so": "libegl1",
    "libOSMesa.so": "libosmesa6",
    "libX11.so": "libx11-6",
    "libXext.so": "libxext6",
    "libXrender.so": "libxrender1",
    "libXcursor.so": "libxcursor1",
    "libXft.so": "libxft2",
    "libXinerama.so": "libxinerama1",
    "libXfixes.so": "libxfixes3",
    "libgomp.so": "libgomp1",
    "libfontconfig.so": "libfontconfig1",
    "libpango-1": "libpango-1.0-0",
    "libpangoft2": "libpangoft2-1.0-0",
    "libharfbuzz-subset": "libharfbuzz-subset0",
}

_DRAW = """
import pathlib, tempfile
import numpy as np
from churchpipe.model.assemblage import Assemblage
from churchpipe.report.figures import mechanism_picture
corner = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
stones = Assemblage.from_polyhedra([(corner, faces), (corner + [0, 0, 1], faces)], 2e4, fixed=[0])
with tempfile.TemporaryDirectory() as folder:
    path = pathlib.Path(folder) / "trial.png"
    mechanism_picture(stones, np.eye(2, 6, -1), path, size=(200, 150))
    from matplotlib.image import imread
    assert np.ptp(imread(path)) > 0.1, "the picture is blank"
"""


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing examined: its name, what it is for, whether it works, what was seen, and the line that mends it ("" if none)."""

    name: str
    purpose: str
    passed: bool
    detail: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Trial:
    """Code that a child process must get through; system: the Debian packages that it needs."""

    name: str
    purpose: str
    code: str
    system: str = ""


def _imports(module: str, purpose: str, package: str) -> Trial:
    return Trial(module, purpose, f"import importlib.metadata as m, {module}; print(m.version({package!r}))")


TRIALS = (
    _imports("clarabel", "load factors", "clarabel"),
    Trial("numba", "compiled kernels of the solver", "import numba; numba.njit(lambda x: x + 1)(1); print(numba.__version__)"),
    _imports("cvxpy", "reference solutions and other solvers", "cvxpy-base"),
    *([] if sys.platform == "win32" else [_imports("pymetis", "an order of the stones with little fill", "pymetis")]),
    _imports("cvxopt.amd", "the same order without METIS", "cvxopt"),
    _imports("shapely", "contacts", "shapely"),
    _imports("manifold3d", "overlapping stones", "manifold3d"),
    _imports("ezdxf", "CAD drawings", "ezdxf"),
    _imports("meshio", "ParaView files", "meshio"),
    _imports("snakemake", "the staged pipeline", "snakemake"),
    _imports("skfem", "the stiffness of the shell", "scikit-fem"),
    _imports("matplotlib", "plots", "matplotlib"),
    _imports("pyvista", "pictures", "pyvista"),
    Trial(
        "gmsh",
        "the shell's mesh",
        "import gmsh; print(gmsh.__version__)",
        system="libglu1-mesa libxrender1 libxcursor1 libxfixes3 libxft2 libxinerama1 libfontconfig1 libgomp1",
    ),
    Trial(
        "weasyprint",
        "the report as a PDF",
        "import weasyprint; weasyprint.HTML(string='trial').write_pdf(); print(weasyprint.__version__)",
        system="libpango-1.0-0 libpangoft2-1.0-0 libharfbuzz-subset0",
    ),
    Trial("off-screen picture", "pictures in the report", _DRAW, system="libegl1 libgl1-mesa-dri"),
)


def examine(trials: tuple[Trial, ...] = TRIALS) -> list[Finding]:
    """Try each native or heavy dependency in a child process of its own, so that a crash is seen, not suffered."""
    with ThreadPoolExecutor(max_workers=2) as pool:
        return list(pool.map(_examine, trials))


def _examine(trial: Trial) -> Finding:
    try:
        done = subprocess.run(
            [sys.executable, "-c", trial.code], capture_output=True, text=True, timeout=TRIAL_SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        return Finding(trial.name, trial.purpose, False, f"no answer after {TRIAL_SECONDS} s", _remedy(trial, ""))
    if done.returncode == 0:
        return Finding(trial.name, trial.purpose, True, done.stdout.strip() or "works")
    detail = _complaint(done.stderr, done.returncode)
    return Finding(trial.name, trial.purpose, False, detail, _remedy(trial, detail))


def _complaint(stderr: str, code: int) -> str:
    """Return the last telling line of a traceback, or the signal that ended the process."""
    if code < 0:
        return f"crashed ({signal.Signals(-code).name})"
    lines = [line for line in stderr.strip().splitlines() if line.strip()]
    return lines[-1].strip() if lines else f"ended with code {code}"


def _remedy(trial: Trial, detail: str) -> str:
    """Return the install line: a missing library's system package, for a missing module all extras, else what the trial needs."""
    missing = [package for library, package in SYSTEM_PACKAGES.items() if library in detail]
    if missing:
        return f"apt-get install -y {' '.join(missing)}"
    if "No module named" in detail or not trial.system:
        return f"{_installer()} 'churchpipe[all]'"
    return f"apt-get install -y {trial.system}"


def _installer() -> str:
    """Return the command that installs into this very interpreter; environments made by uv have no pip."""
    if importlib.util.find_spec("pip"):
        return f"{sys.executable} -m pip install"
    return f"uv pip install --python {sys.executable}"
