"""The tables of the vaulted church in docs/vault_validation.md: stones and shell, with each vault, under seven loads, with ties.

    python benchmarks/church_vaults.py               # the rows of the stones, each in a process of its own
    python benchmarks/church_vaults.py 0 4           # some of them; the last two, without dilatancy, take longest
    python benchmarks/church_vaults.py shell 0       # the rows of the shell

Collapse under some of the loads goes to docs/pictures/vaults as a picture.

Processor time is that of each step, memory the most that the process held.
"""

import resource
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import churchpipe as cp
from churchpipe.config.case import Case, Generated
from churchpipe.report.figures import mechanism_picture
from churchpipe.stones.joints import joint_strength

FOLDER = Path("docs/pictures/vaults")
CASE = "pipeline/cases/church_vaults.toml"
TIES = tuple(cp.Tie(f"tie_{y}", start=(-3.2, y, 10.9), end=(3.2, y, 10.9), strength=60e3) for y in (3, 6, 9, 12, 15))
ELEMENT = 1.0
# Of some loads; that of the first is in docs/gallery.md.
PICTURES = {"-y": "church_front", "tower +x": "church_tower"}


@dataclass(frozen=True, slots=True)
class Row:
    """A church with these vaults, under one load of its case, with settings of its analysis."""

    name: str
    vaults: tuple[dict[str, Any], ...]
    load: cp.LoadCase
    settings: dict[str, Any] = field(default_factory=dict[str, Any])
    picture: str = ""


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


def rows_of(case: Case) -> tuple[list[Row], list[Row]]:
    """Return the rows of the stones and those of the shell."""
    source = case.source
    assert isinstance(source, Generated)
    every = barrel, dome, half = source.parameters["vaults"]
    backed = (barrel | {"backing": 1.8}, dome, half)
    push, _, _, outwards, *_ = case.loads
    alone = [Row("barrel over the nave", (barrel,), push)]
    of_loads = [Row("all three", every, load) for load in case.loads]
    stones = [
        Row("no vault", (), push),
        *alone,
        *(replace(row, picture=PICTURES.get(row.load.name, "")) for row in of_loads),
        Row("all three, and five ties of 60 kN", every, push, {"ties": TIES}),
        Row("all three, masonry on the haunches", backed, push),
        Row("all three, masonry on the haunches, five ties", backed, push, {"ties": TIES}),
        *(Row("all three, without dilatancy", every, load, {"flow": "non-associative"}) for load in (push, outwards)),
    ]
    groin = {"over": "crossing", "kind": "groin", "thickness": 0.4, "courses": 15}
    others = [Row("half dome over the apse", (half,), push), Row("dome over the crossing", (dome,), push)]
    others.append(Row("groin vault of 0.4 m over the crossing", (groin,), push))
    tied = Row("all three, and five ties of 60 kN", every, push, {"ties": TIES})
    return stones, [*alone, *others, *of_loads, tied]


def of_stones(case: Case, row: Row) -> None:
    """Print a row of the stones: their number, that of their joints, time of each step, memory, result."""
    building, start = vaulted(case, row.vaults), spent()
    stones = cp.derive_blocks(building)
    laid = spent()
    contacts = cp.find_contacts(stones)
    found = spent()
    state = cp.limit_analysis(stones, contacts, row.load, *joint_strength(stones, contacts, case.materials), **row.settings)
    times = f"{laid - start:.1f} | {found - laid:.1f} | {spent() - found:.0f}"
    if row.picture:
        mechanism_picture(stones, state.velocities, FOLDER / f"{row.picture}.png", row.load.direction, size=(760, 560))
    interval = " ({:.4f} to {:.4f}, {})".format(*state.interval, state.status) if "flow" in row.settings else ""
    count = f"{(~stones.fixed).sum()} | {len(contacts.blocks)}"
    print(
        f"| {row.name} | {row.load.name} | {count} | {times} | {memory():.0f} | {state.load_factor:.4f}{interval} |", flush=True
    )


def of_shell(case: Case, row: Row) -> None:
    """Print a row of the shell: its facets, the gate, times, memory, result."""
    building, start = vaulted(case, row.vaults), spent()
    shell = cp.derive_shell(building, ELEMENT)
    made = spent()
    stones = cp.derive_blocks(building)
    gate = "passed" if cp.match_models(stones, cp.find_contacts(stones), shell).passed else "failed"
    begin = spent()
    state = cp.shell_limit_analysis(shell, row.load, case.materials, **row.settings)
    times = f"{made - start:.1f} | {spent() - begin:.0f} | {memory():.0f}"
    value = f"{state.load_factor:.4f}" if state.status == "optimal" else state.status
    print(f"| {row.name} | {row.load.name} | {len(shell.triangles)} | {gate} | {times} | {value} |", flush=True)


def main(arguments: Sequence[str]) -> None:
    """Print a table, or the rows chosen."""
    case = cp.read_case(CASE)
    shell = "shell" in arguments
    rows = rows_of(case)[shell]
    chosen = [int(number) for number in arguments if number != "shell"]
    if len(chosen) == 1:
        (of_shell if shell else of_stones)(case, rows[chosen[0]])
        return
    stones = "stones | joints | stones, s | joints, s | analysis, s"
    columns = "facets | match gate | mesh, s | analysis, s" if shell else stones
    print(f"| church | load | {columns} | memory, MiB | load factor |", flush=True)
    for number in chosen or range(len(rows)):
        subprocess.run([sys.executable, __file__, *(["shell"] if shell else []), str(number)], check=True)


if __name__ == "__main__":
    main(sys.argv[1:])
