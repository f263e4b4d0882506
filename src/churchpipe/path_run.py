"""The paths of the stones in a run, capacity curves and supports that move: from the files of a stage to its path.

A run that was killed goes on from the steps that it kept.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from churchpipe.closure import code_of
from churchpipe.config.carries import carries_of, placed
from churchpipe.config.settings import joints_of, load_of, strengths_of, used_by
from churchpipe.io.atomic import read_json
from churchpipe.io.kept_steps import KeptSteps
from churchpipe.io.movement_record import movement_record, widest_cracks
from churchpipe.io.npz import read_npz, write_npz
from churchpipe.io.recording import curve_record_of
from churchpipe.io.records import write_record
from churchpipe.large_displacements.moved_support import moved_support
from churchpipe.large_displacements.pushover import block_pushover
from churchpipe.loading.wrenches import loaded
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.block_curve import BlockCapacityCurve
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase
from churchpipe.model.progress import Progress
from churchpipe.model.results import LimitState
from churchpipe.model.settlement import SettlementPath
from churchpipe.stones.joints import crushing_strength, joint_strength

_KEYS = ("solver", "control", "step", "steps", "furthest", "halo", "contact_model")


def follow_curve(
    stage: Literal["curve", "halved"],
    inputs: tuple[Path, Path, Path],
    state: Path,
    record: Path | None,
    first: Sequence[Path],
    progress: Progress | None = None,
) -> None:
    """Write the curve of settings, assemblage and contacts, and its record; first: the limit analyses that it begins from, where
    made. Of a stage "halved" its steps are half as long."""
    settings, assemblage, contacts = inputs
    table, stones, joints = read_json(settings), read_npz(assemblage, Assemblage), read_npz(contacts, Contacts)
    materials, load = strengths_of(table), load_of(table)
    friction, _ = joint_strength(stones, joints, materials, joints_of(table))
    applied = placed(carries_of(table), stones)
    name = "halved_steps" if stage == "halved" else "steps"
    kept = KeptSteps(BlockCapacityCurve, state.parent, (*inputs, *first), code_of(stage), name)
    made = {found.flow: found for found in (read_npz(path, LimitState) for path in first)}
    found = block_pushover(
        stones,
        joints,
        loaded(load, stones, applied.loads),
        friction,
        applied.ties,
        **{key: table[key] for key in _KEYS if key in table},
        compressive_strength=crushing_strength(stones, joints, materials),
        halved=stage == "halved",
        state=made.get("associative"),
        sliding=made.get("non-associative"),
        progress=progress,
        resume=kept.found(),
        keep=kept.keep,
    )
    write_npz(state, found)
    kept.clear()
    if record:
        words = (load, used_by(stones, materials), joints_of(table), table.get("contact_model"))
        write_record(record, curve_record_of(found, stones, *words))


def follow_movement(inputs: tuple[Path, Path, Path, Path], made: Sequence[Path], progress: Progress | None = None) -> None:
    """Write what a support that moves leaves: stones, their ground cut, joints, path and record, to `made`.

    inputs: settings, tolerances, assemblage and contacts.
    """
    settings, tolerances, assemblage, contacts = inputs
    table, materials = read_json(settings), strengths_of(read_json(settings))
    stones, found = read_npz(assemblage, Assemblage), read_npz(contacts, Contacts)
    carries = carries_of(table)

    def dead_on(cut: Assemblage) -> LoadCase | None:
        return loaded(LoadCase((1, 0, 0)), cut, placed(carries, cut).loads) if carries else None

    kept = KeptSteps(SettlementPath, made[-1].parent, inputs, code_of("movement"))
    more = {"progress": progress, "groups": joints_of(table), "resume": kept.found(), "keep": kept.keep}
    moved = moved_support(stones, found, table, materials, read_json(tolerances), dead_on, **more)
    for file, part in zip(made, (moved.stones, moved.contacts, moved.path), strict=False):
        write_npz(file, part)
    kept.clear()
    cracks = widest_cracks(moved.stones, moved.contacts, moved.opening, moved.slip)
    write_record(made[-1], movement_record(moved.path, table, moved.stones, used_by(stones, materials), cracks, joints_of(table)))
