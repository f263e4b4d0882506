"""The table of the vaulted church in docs/vaults.md: stones alone, with each vault, with ties, under seven loads.

    python benchmarks/church_vaults.py               # all rows, each in a process of its own
    python benchmarks/church_vaults.py 0 4           # some of them; the last, without dilatancy, takes longest
    python benchmarks/church_vaults.py shell 0       # the second table, stones and shell; without numbers all of its rows

Processor time is that of each step, memory the most that the process held.
"""

import resource
import subprocess
import sys
from dataclasses import replace
from typing import Any

import churchpipe as cp
from churchpipe.config.case import Case, Generated
from churchpipe.stones.joints import joint_strength

CASE = "pipeline/cases/church_vaults.toml"
TIES = tuple(cp.Tie(f"tie_{y}", start=(-3.2, y, 10.9), end=(3.2, y, 10.9), strength=60e3) for y in (3, 6, 9, 12, 15))


def spent() -> float:
    """Return the processor time so far, s."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def memory() -> float:
    """Return the largest memory so far, MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10


def vaulted(case: Case, vaults: tuple[dict[str, Any], ...]) -> cp.Building:
    """Return the building of the case with these vaults alone."""
    source = case.source
    assert isinstance(source, Generated)
    return replace(case, source=replace(source, parameters=source.parameters | {"vaults": vaults})).building()


def row(name: str, building: cp.Building, case: Case, load: cp.LoadCase, **settings: Any) -> None:
    """Print one row: stones, their joints, time of each step, memory, result."""
    start = spent()
    stones = cp.derive_blocks(building)
    laid = spent()
    contacts = cp.find_contacts(stones)
    found = spent()
    state = cp.limit_analysis(stones, contacts, load, *joint_strength(stones, contacts, case.materials), **settings)
    times = f"{laid - start:.1f} | {found - laid:.1f} | {spent() - found:.0f}"
    interval = " ({:.4f} to {:.4f})".format(*state.interval) if "flow" in settings else ""
    value = f"{state.load_factor:.4f}{interval}"
    count = f"{(~stones.fixed).sum()} | {len(contacts.blocks)}"
    print(f"| {name} | {load.name} | {count} | {times} | {memory():.0f} | {value} {state.status} |", flush=True)


def both(chosen: list[int]) -> None:
    """Print stones and shell with each vault alone and with all, along +x."""
    case = cp.read_case(CASE)
    source = case.source
    assert isinstance(source, Generated)
    barrel, _, half = source.parameters["vaults"]
    bare = {key: value for key, value in barrel.items() if key != "backing"}
    groin = {"over": "crossing", "kind": "groin", "thickness": 0.4, "courses": 15}
    rows = [("barrel", (bare,)), ("half dome", (half,)), ("groin vault of 0.4 m over the crossing", (groin,))]
    rows.append(("all three", (bare, groin, half)))
    for name, vaults in [rows[k] for k in chosen or range(len(rows))]:
        building = vaulted(case, vaults)
        stones, shell = cp.derive_blocks(building), cp.derive_shell(building, 1.0)
        contacts = cp.find_contacts(stones)
        strength = joint_strength(stones, contacts, case.materials)
        start = spent()
        of_stones = cp.limit_analysis(stones, contacts, case.loads[0], *strength)
        middle = spent()
        of_shell = cp.shell_limit_analysis(shell, case.loads[0], case.materials)
        times = f"{middle - start:.0f} | {spent() - middle:.0f}"
        gate = "passed" if cp.match_models(stones, contacts, shell).passed else "failed"
        factors = f"{of_stones.load_factor:.4f} | {of_shell.load_factor:.4f}"
        print(f"| {name} | {len(shell.triangles)} | {gate} | {times} | {factors} |", flush=True)


def main(chosen: list[int]) -> None:
    """Print the table, or the rows chosen."""
    case = cp.read_case(CASE)
    source = case.source
    assert isinstance(source, Generated)
    barrel, dome, half = source.parameters["vaults"]
    bare = {key: value for key, value in barrel.items() if key != "backing"}
    every = (barrel, dome, half)
    push = case.loads[0]
    rows: list[tuple[str, tuple[dict[str, Any], ...], cp.LoadCase, dict[str, Any]]] = [
        ("no vault", (), push, {}),
        ("barrel over the nave", (bare,), push, {}),
        ("and half dome over the apse", (bare, half), push, {}),
        ("and dome over the crossing", (bare, dome, half), push, {}),
        *(("all, with masonry on the haunches", every, load, {}) for load in case.loads),
        ("all, and five ties of 60 kN", every, push, {"ties": TIES}),
        ("all, without dilatancy", every, push, {"flow": "non-associative"}),
    ]
    if len(chosen) == 1:
        name, vaults, load, settings = rows[chosen[0]]
        row(name, vaulted(case, vaults), case, load, **settings)
        return
    print("| church | load | stones | joints | stones, s | joints, s | analysis, s | memory, MiB | load factor |")
    print("|---|---|---:|---:|---:|---:|---:|---:|---|", flush=True)
    for number in chosen or range(len(rows)):
        subprocess.run([sys.executable, __file__, str(number)], check=True)


if __name__ == "__main__":
    numbers = [int(number) for number in sys.argv[1:] if number != "shell"]
    (both if "shell" in sys.argv else main)(numbers)
