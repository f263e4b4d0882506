"""Runs as jobs of a cluster: a real SLURM of one node on this machine; a killed job, and the run that goes on after it."""

import importlib.util
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from case_texts import WALL, case_file

ROOT = Path(__file__).parents[2]
SYSTEM = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "srun")
CONFIGURATION = """
ClusterName=local
SlurmctldHost={host}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SlurmdParameters=config_overrides
ReturnToService=2
MinJobAge=600
NodeName={host} CPUs=4 RealMemory=8000 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
# What a cluster without accounting needs besides the profile that churchpipe has.
OWN = "slurm-status-command: squeue\nslurm-init-seconds-before-status-checks: 3\n"


@dataclass(frozen=True)
class Cluster:
    """A SLURM of one node: its folder, with a profile for it, and the environment in which its commands find it."""

    folder: Path
    environment: dict[str, str]

    def start(self, case: Path, out: Path, *options: str) -> "subprocess.Popen[str]":
        words = [sys.executable, "-m", "churchpipe", "run", case, "--out", out, "--jobs", "4", *options]
        profile = "--profile", self.folder / "profile"
        return subprocess.Popen(
            [*words, *profile], env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )

    def call(self, *command: str) -> str:
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, check=True, timeout=60).stdout


def free_ports() -> list[int]:
    sockets = [socket.socket() for _ in range(2)]
    for one in sockets:
        one.bind(("", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    path = f"{os.environ['PATH']}:/usr/sbin:/usr/local/sbin"
    if missing := [name for name in SYSTEM if shutil.which(name, path=path) is None]:
        pytest.fail(f"{', '.join(missing)} not found: apt-get install slurm-wlm munge")
    if importlib.util.find_spec("snakemake_executor_plugin_slurm") is None:
        pytest.fail("snakemake-executor-plugin-slurm is not installed: pip install 'churchpipe[slurm]'")
    folder = tmp_path_factory.mktemp("slurm")
    for name in ("state", "spool", "bin", "profile"):
        (folder / name).mkdir()
    host = socket.gethostname().partition(".")[0]
    configuration = folder / "slurm.conf"
    user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
    configuration.write_text(CONFIGURATION.format(host=host, user=user, folder=folder, ports=free_ports()))
    # Inside a job the plugin keeps no SLURM_CONF, so that srun would look for the configuration of the machine.
    step = folder / "bin" / "srun"
    step.write_text(f'#!/bin/sh\nSLURM_CONF={configuration} exec {shutil.which("srun", path=path)} "$@"\n')
    step.chmod(0o755)
    (folder / "profile" / "config.yaml").write_text((ROOT / "pipeline" / "profiles" / "slurm" / "config.yaml").read_text() + OWN)
    key = folder / "munge.key"
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    environment = os.environ | {"PATH": f"{folder / 'bin'}:{path}", "SLURM_CONF": str(configuration)}
    munged = ["munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={key}"]
    munged += [f"--pid-file={folder}/munged.pid", f"--seed-file={folder}/munge.seed", f"--log-file={folder}/munged.log"]
    daemons: list[subprocess.Popen[bytes]] = []
    made = Cluster(folder, environment)
    try:
        for command in (munged, ["slurmctld", "-D"], ["slurmd", "-D"]):
            output = (folder / f"{command[0]}.out").open("wb")
            daemons.append(subprocess.Popen(command, env=environment, stdout=output, stderr=subprocess.STDOUT))
            time.sleep(1)
        for _ in range(60):
            if "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], env=environment, capture_output=True, text=True).stdout:
                break
            time.sleep(1)
        else:
            pytest.fail("".join((folder / f"{name}.out").read_text() for name in ("munged", "slurmctld", "slurmd")))
        yield made
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
            daemon.wait(timeout=30)


def submitted(out: Path) -> list[tuple[str, str]]:
    """Rule and SLURM's number of each job of the last run."""
    text = (out / "run.log").read_text() if (out / "run.log").exists() else ""
    return [(rule, number) for number, rule in re.findall(r"submitted with SLURM jobid (\d+) \(log: \S+/rule_([a-z]+)", text)]


def rigid_jobs(out: Path) -> list[tuple[str, str]]:
    """Name of the analysis and SLURM's number of each rigid-block job of the last run."""
    text = (out / "run.log").read_text() if (out / "run.log").exists() else ""
    found = re.findall(r"submitted with SLURM jobid (\d+) \(log: \S+/rule_rigid/([^/]+)/", text)
    return [(name, number) for number, name in found]


def summary(out: Path) -> dict[str, Any]:
    return json.loads((out / "summary.json").read_text())


def here(case: Path, out: Path, *options: str) -> dict[str, Any]:
    """The results of a run on this machine without a cluster."""
    words = [sys.executable, "-m", "churchpipe", "run", case, "--out", out, "--jobs", "2", *options]
    done = subprocess.run(words, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr
    return summary(out)


@pytest.mark.slow("docs/cluster.md: a sweep of frictions of the church as jobs, one killed, resumed")
def test_a_sweep_of_the_church_goes_on_after_a_killed_job(cluster: Cluster, tmp_path: Path) -> None:
    case = tmp_path / "church.toml"
    shutil.copy(ROOT / "pipeline" / "cases" / "church_friction.toml", case)
    # Larger stones: 2269 of them.
    options = ["--model", "blocks", "--load", "+x", "--set", "source.course_m=0.55", "--set", "source.stone_length_m=0.8"]
    options += ["--set", 'sweep={ "material.default.friction" = [0.4, 0.6, 0.8] }']
    expected = here(case, tmp_path / "local", *options)
    out = tmp_path / "out"
    process = cluster.start(case, out, *options)
    killed = ""
    while process.poll() is None and not killed:
        running = cluster.call("squeue", "-h", "-t", "RUNNING", "-o", "%i").split()
        # The stage itself is at work, not only its job.
        working = {log.stem for log in out.glob("log/rigid/*.txt") if "start" in log.read_text()}
        killed = next((number for name, number in rigid_jobs(out) if name in working and number in running), "")
        time.sleep(0.2)
    assert killed, (out / "run.log").read_text()
    cluster.call("scancel", killed)
    said, _ = process.communicate(timeout=900)
    assert process.returncode == 3, said
    rules = Counter(rule for rule, _ in submitted(out))
    assert rules == {"source": 1, "blocks": 1, "contacts": 1, "rigid": 3}
    assert len(list(out.glob("rigid/*/rigid.json"))) == 2
    assert not (out / "summary.json").exists()
    process = cluster.start(case, out, *options)
    said, _ = process.communicate(timeout=900)
    assert process.returncode == 0, said
    assert Counter(rule for rule, _ in submitted(out)) == {"rigid": 1, "compare": 1, "report": 1}
    found = summary(out)
    factors = [[record["load_factor"] for record in one["analyses"]] for one in (found, expected)]
    assert len(factors[0]) == 3
    assert factors[0] == pytest.approx(factors[1], rel=1e-9)
    assert factors[0] == sorted(factors[0])


@pytest.mark.slow("docs/cluster.md: samples as jobs")
def test_samples_are_jobs_of_the_cluster(cluster: Cluster, tmp_path: Path) -> None:
    sample = '[sample]\nnumber = 20\n[[sample.parameters]]\nkey = "source.thickness_mm"\n'
    case = case_file(tmp_path, WALL + sample + 'distribution = "normal"\nmean = 250\nstandard_deviation = 20\n')
    process = cluster.start(case, tmp_path / "out")
    said, _ = process.communicate(timeout=1500)
    assert process.returncode == 0, said
    rules = Counter(rule for rule, _ in submitted(tmp_path / "out"))
    assert rules == {"source": 1, "blocks": 1, "contacts": 1, "rigid": 1, "sample": 20, "compare": 1, "report": 1}
    study = summary(tmp_path / "out")["uncertainty"]
    # A wall 0.6 m high overturns at thickness over height.
    expected = [thickness / 600 for thickness in study["points"]["source.thickness_mm"]]
    assert study["analyses"][0]["load_factors"] == pytest.approx(expected, abs=1e-6)


def test_a_profile_that_is_none_is_said(tmp_path: Path) -> None:
    case = case_file(tmp_path, WALL)
    words = [sys.executable, "-m", "churchpipe", "run", case, "--profile", "lsf"]
    done = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    assert "no such profile" in done.stderr
    assert "local, slurm" in done.stderr
