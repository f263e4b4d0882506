"""The report of results obtained in Python."""

import os
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from churchpipe import compare
from churchpipe.code_check import Site
from churchpipe.errors import Extra, InputError
from churchpipe.io.atomic import named_by_caller
from churchpipe.io.recording import record_of, shell_record_of
from churchpipe.io.records import Analysis
from churchpipe.loading.placing import place_loads
from churchpipe.match import match_models
from churchpipe.model.arguments import check_kind, describe, listed, path_of
from churchpipe.model.assemblage import Assemblage, checked_sequence
from churchpipe.model.carried import Carried
from churchpipe.model.checks import SafetyCheck
from churchpipe.model.contacts import Contacts, check_contacts_of
from churchpipe.model.fill import Fill
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import JointStrength
from churchpipe.model.names import GOOD, STRENGTH
from churchpipe.model.placed_loads import Applied
from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState
from churchpipe.model.shell import ShellModel
from churchpipe.model.ties import Tie
from churchpipe.run_folder import versions
from churchpipe.wording import counted

if TYPE_CHECKING:
    from churchpipe.report.given import Curves, Settlements

Result = LimitState | ShellLimitState | CapacityCurve
_MESH = "shell"


def write_report(
    path: str | os.PathLike[str],
    stones: Assemblage,
    contacts: Contacts,
    results: Iterable[tuple[LoadCase, Result]],
    *,
    materials: Sequence[JointStrength],
    shell: ShellModel | None = None,
    loads: Iterable[Carried | Fill] = (),
    ties: Sequence[Tie] = (),
    joints: Sequence[JointGroup] = (),
    curve: "Curves" = (),
    settlement: "Settlements | None" = None,
    site: Site | None = None,
    name: str = "Results",
) -> None:
    """Write results obtained in Python as the report that a run of a case makes: one HTML file, drawings and mechanisms in it.

    Parameters
    ----------
    path
        The file to write, such as "report.html".
    stones, contacts
        The structure.
    results
        Load case and result of each analysis: states of the stones, and states or capacity curves of the shell. It may be
        empty where `curve` or `settlement` is given.
    materials
        Strength of the joints of each masonry, by name.
    shell
        The mesh of the results of the shell; the report says whether it matches the stones.
    loads
        What the stones carry in these analyses; `loaded` made the load cases of it.
    ties
        Those of the analyses of the stones and of the shell.
    joints
        With a strength of their own in these analyses.
    curve
        Capacity curves of the stones, of `block_pushover`: a list of pairs of a load case and its curve. A curve alone is of
        the load of the results, if these have one load. A third entry of a pair is the curve with steps half as long
        (`halved=True`). The report draws each with its crack maps, its motion and its check by displacements.
    settlement
        The path of a support that moves, of `settlement_path`; of several, a dictionary of paths by their names. Where the path
        is of other stones, as of those of a ground that was cut, it stands in a tuple with them: (stones, contacts, path).
    site
        What the earthquake asks, a `churchpipe.code_check.Site`: each result of the stones then has its safety check. None: the
        checks say at which acceleration each mechanism starts, and compare it with nothing.
    name
        Title of the report.

    Raises
    ------
    InputError
        Arguments of the wrong kind, a result of other stones, loads or ties or of another mesh, loads that no load
        case has, a curve without a load, a file that cannot be written, a package of
        `churchpipe[all]` that is missing.
    """
    check_kind("write_report: stones", stones, Assemblage)
    check_kind("write_report: contacts", contacts, Contacts)
    check_contacts_of(stones, contacts)
    html = path_of("write_report: path", path)
    # That of Path raises on a name that is too long.
    if os.path.isdir(html):
        raise InputError("write_report: path", "a folder", found=html, expected="the file to write, such as report.html")
    materials = listed("write_report: materials", materials, JointStrength)
    groups = listed("write_report: joints", joints, JointGroup)
    if site is not None:
        check_kind("write_report: site", site, Site)
    with Extra("the report"):
        from churchpipe.report.given import curves_given, movements_given
        from churchpipe.report.html import write_report as write_html
        from churchpipe.report.of_stones import check_loads_in, check_state_of
    applied = Applied(place_loads(stones, loads), tuple(listed("write_report: ties", ties, Tie)))
    pairs: list[tuple[LoadCase, Result]] = []
    for number, pair in enumerate(checked_sequence("write_report: results", results, "pairs of a load case and its result")):
        check_kind(f"write_report: results[{number}]", pair, tuple, list)
        if len(pair) != 2:
            found, expected = counted(len(pair), "entry", "entries"), "a load case and its result"
            raise InputError(f"write_report: results[{number}]", "not a pair", found=found, expected=expected)
        check_kind("write_report: load", pair[0], LoadCase)
        pairs.append((pair[0], pair[1]))
    check_kind("write_report: name", name, str)
    followed = curves_given(curve, [load for load, _ in pairs], stones, materials, groups, applied, site)
    if not pairs and not followed and settlement is None:
        raise InputError("write_report: results", "nothing to report", found="none", expected="results, a curve or a settlement")
    of_blocks: list[tuple[Analysis, LimitState]] = []
    of_shell: list[tuple[Analysis, str, ShellLimitState | CapacityCurve]] = []
    for number, (load, result) in enumerate(pairs, 1):
        name_of = f"{number} {load.name}"
        if isinstance(result, LimitState) and len(result.velocities) == stones.count:
            check_loads_in(f"write_report: results[{number - 1}]", load, stones, applied.loads)
            check_state_of(f"write_report: results[{number - 1}]", result, stones, contacts, load, applied.ties)
            record = record_of(result, load, materials, ties=applied.ties, joints=groups)
            found = compare.stone_parts(stones, result, load) | {"check": _check(stones, result, load, site, applied, materials)}
            of_blocks.append((replace(record, name=name_of, **(found if result.status in GOOD else {})), result))
            continue
        motion = result.displacement if isinstance(result, CapacityCurve) else getattr(result, "velocities", ())
        if (
            not isinstance(cast("object", result), Result)
            or isinstance(result, LimitState)
            or shell is None
            or len(motion) != len(shell.points)
        ):
            expected = "a result of these stones" if shell is None else "a result of these stones or of this shell"
            remedy = "Give capacity curves of the stones as curve=, and paths of supports as settlement=."
            where, what = "write_report: results", "not a result of this model"
            raise InputError(where, what, found=describe(result), expected=expected, remedy=remedy)
        method = "pushover" if isinstance(result, CapacityCurve) else "limit"
        record = shell_record_of(
            result, load, materials, method=method, planes=STRENGTH, ties=applied.ties, joints=groups, mesh=shell
        )
        parts = compare.shell_parts(shell, result, load) if isinstance(result, ShellLimitState) else {}
        of_shell.append((replace(record, name=name_of, **parts), _MESH, result))
    meshes = {}
    if shell is not None:
        gate = match_models(stones, contacts, shell, applied.loads)
        size = float(np.sqrt(2 * np.median(shell.area)))
        meshes = {_MESH: compare.mesh_size(shell, gate, "base", round(size, 3))}
    moved = [] if settlement is None else movements_given(settlement, stones, contacts, materials, groups, applied)
    analyses = [record for record, *_ in (*of_blocks, *of_shell, *followed)]
    sizes, ways = {"base": compare.size(stones, contacts)}, [record for record, *_ in moved]
    with named_by_caller("write_report: path", html):
        # Drawings take long: first of all whether the file may stand there.
        html.parent.mkdir(parents=True, exist_ok=True)
        write_html(
            html,
            summary=compare.summary(name, sizes, meshes, analyses, movements=ways),
            stones=stones,
            contacts=contacts,
            results=of_blocks,
            shells={} if shell is None else {_MESH: shell},
            shell_results=of_shell,
            project={"title": name},
            materials=[asdict(material) for material in materials],
            moved=moved,
            followed=followed,
            applied={record.name: applied for record, _ in (*of_blocks, *followed)},
            case_text="",
            versions=versions(),
        )


def _check(
    stones: Assemblage,
    state: LimitState,
    load: LoadCase,
    site: Site | None,
    applied: Applied,
    materials: Sequence[JointStrength],
) -> SafetyCheck:
    """Return the safety check of a state, or why there is none."""
    from churchpipe.report.given import crushing, unchecked

    if why := unchecked(load, applied):
        return SafetyCheck(message=why)
    return compare.safety(stones, state, load, site, applied.loads, crushing=crushing(materials))
