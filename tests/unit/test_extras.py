"""Limit analysis, drawings and cases without the packages of churchpipe[all]."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXTRAS = (
    "gmsh",
    "jinja2",
    "matplotlib",
    "meshio",
    "pandas",
    "PIL",
    "pyvista",
    "skfem",
    "snakemake",
    "vtk",
    "vtkmodules",
    "weasyprint",
)
# What pip calls those that have another name there.
PACKAGES = {"PIL": "pillow", "skfem": "scikit-fem"}
BLOCKED = f"import sys\nsys.modules |= dict.fromkeys({EXTRAS})\nimport churchpipe as cp\n"
CORE = """
from churchpipe import cli, engine, stages
from churchpipe.generators import wall
case = cp.read_case(sys.argv[1])
building = case.building()
stones = cp.derive_blocks(building)
contacts = cp.find_contacts(stones)
cp.check_soundness(stones, contacts)
friction, cohesion = cp.joint_strength(stones, contacts, case.materials)
assert cp.limit_analysis(stones, contacts, case.loads[0], friction, cohesion).status == "optimal"
cp.write_dxf(stones, sys.argv[2])
assert cp.read_dxf(sys.argv[2])[0].count == stones.count
"""
REMEDY = "pip install 'churchpipe[all]'"


def alone(code: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", BLOCKED + code, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300
    )


@pytest.mark.slow
def test_the_core_needs_none_of_them(tmp_path: Path) -> None:
    done = alone(CORE, ROOT / "pipeline" / "cases" / "wall.toml", tmp_path / "wall.dxf")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("code", "missing"),
    [
        ("cp.derive_shell(cp.read_case(sys.argv[1]).building(), 0.3)", "the mesh of a shell"),
        (
            "from churchpipe.homogenised_shell.stiffness import wall_stiffness; from churchpipe.model.materials import Elastic; "
            "wall_stiffness('running', 0.1, 0.2, 0.2, Elastic(3e9, 0.2, 1e9, 0.2, 0.01))",
            "the stiffness of a shell",
        ),
        ("from churchpipe.io.vtu import write_vtu; write_vtu('x.vtu', None)", "a file for ParaView"),
        ("from churchpipe import cli; sys.argv[1:1] = ['run']; cli.main()", "churchpipe run"),
    ],
)
def test_what_needs_them_says_how_to_install_them(code: str, missing: str, tmp_path: Path) -> None:
    done = alone(f"import os; case = sys.argv[1]; os.chdir(sys.argv.pop(2))\n{code}", ROOT / "pipeline/cases/wall.toml", tmp_path)
    assert done.returncode != 0
    assert f"{missing}: a package is not installed; found " in done.stderr
    assert REMEDY in done.stderr
    assert not list(tmp_path.rglob("run.log"))


def test_they_are_extras_of_the_package() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    names = {line.split(">")[0] for line in project["optional-dependencies"]["all"]}
    assert names == {PACKAGES.get(name, name) for name in EXTRAS if not name.startswith("vtk")}
    assert not names & {line.split(">")[0] for line in project["dependencies"]}
