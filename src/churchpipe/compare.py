"""Results side by side."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from churchpipe.code_check import CONFIDENCE_FACTOR, Site, activation, along, verified
from churchpipe.errors import InputError
from churchpipe.io.movement_record import Movement, Shift, Turn
from churchpipe.io.records import Analysis
from churchpipe.io.sample_study import SampleStudy
from churchpipe.io.summary import ContactModels, Mesh, Pair, ShellSize, Size, Summary, VariantResult
from churchpipe.loading.wrenches import pushed_masses
from churchpipe.match import Match
from churchpipe.mechanism import mechanism_name, moving_stones, parts, start_height, stone_speed
from churchpipe.model.arrays import BoolArray, FloatArray, NameArray
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.checks import SafetyCheck
from churchpipe.model.contacts import Contacts
from churchpipe.model.loads import LoadCase, way_of
from churchpipe.model.motion import velocity_at
from churchpipe.model.names import GOOD, LOOSE, NEARLY, OUTER
from churchpipe.model.placed_loads import PlacedLoads
from churchpipe.model.results import LimitState, ShellLimitState
from churchpipe.model.shell import ShellModel
from churchpipe.model.swept import MESH_SIZE, of_both, setting
from churchpipe.stones.account import joint_account, joint_lines
from churchpipe.thrust_lines import vaulted
from churchpipe.variant_states import weaker_variants
from churchpipe.wording import counted


def size(stones: Assemblage, contacts: Contacts) -> Size:
    """Return the size of an assemblage."""
    near_misses, joints = joint_account(stones, contacts)
    return Size(
        blocks=int((~stones.fixed).sum()),
        interfaces=len(contacts.blocks),
        contact_points=len(contacts.point),
        weight=round(float(stones.weight.sum()), 3),
        vaults=tuple(vaulted(stones, contacts)),
        near_misses=near_misses,
        joints=joints,
    )


def mesh_size(shell: ShellModel | None, gate: Match, geometry: str, element_size: float) -> Mesh:
    """Return the size of a mesh and its gate; shell: None where there is none. element_size: m."""
    elements, nodes = (len(shell.triangles), len(shell.points)) if shell else (0, 0)
    return Mesh(geometry=geometry, element_size=element_size, elements=elements, nodes=nodes, match=gate)


def summary(
    name: str,
    sizes: Mapping[str, Size],
    meshes: Mapping[str, Mesh],
    analyses: Sequence[Analysis],
    compared: Sequence[Pair] = (),
    questions: Sequence[str] = (),
    variants: Sequence[VariantResult] = (),
    movements: Sequence[Shift | Turn] = (),
    uncertainty: SampleStudy | None = None,
) -> Summary:
    """Return the summary of a run; sizes and meshes by the names of the geometries and meshes, the first ones leading.

    variants: the building as it is first; where it is alone, there are none.
    """
    first, mesh = next(iter(sizes.values())), next(iter(meshes.values()), None)
    vaults = {name: one.vaults for name, one in sizes.items()}
    shell = ShellSize(elements=mesh.elements, nodes=mesh.nodes, element_size=mesh.element_size) if mesh else None
    return Summary(
        case=name,
        **{item.name: getattr(first, item.name) for item in fields(Size)},
        shell=shell,
        match=mesh.match if mesh else None,
        geometries=dict(sizes) if len(sizes) > 1 else {},
        shells=dict(meshes) if len(meshes) > 1 else {},
        analyses=tuple(analyses),
        comparison=tuple(compared),
        variants=tuple(variants) if len(variants) > 1 else (),
        movements=tuple(movements),
        contact_models=tuple(contact_models(analyses)),
        guidance=tuple(guidance(analyses, vaults)),
        questions=tuple(questions),
        uncertainty=uncertainty,
    )


# So many sentences of one kind.
_FEW_LINES = 3
# A capacity curve starts above the state without dilatancy by these shares at most, the larger one where the interval is wide.
_START, _ABOVE = 0.005, 0.015
_OTHER_MOTION = "So it follows another motion, and a check by displacements that is made of it may be too favourable."
_ASK_FOR_IT = 'Ask for the value without dilatancy: flow = ["associative", "non-associative"] under [rigid].'
# Why load factors of one structure differ, by the kind of analysis.
_REASONS = {
    "associative": "In an associative analysis joints open as they slide (dilatancy): its load factor is an upper estimate.",
    "non-associative": "In a non-associative one they slide without opening, as in reality; its load factor is one of several.",
    "shell": "The shell is associative too. It has infinitely small stones, cracks above its feet as wide as an element, and "
    "walls that meet on their mid-planes, so that it may err to either side.",
    "cohesion": "Joints with cohesion bear tension in the shell (up to the cohesion over the friction coefficient) and none "
    "between stones, so that the shell may be far too strong.",
    "torsion": "Friction at the corners of a joint overrates its resistance to torsion, which the torsion model gets right under "
    "uniform pressure.",
    "crushing": "The masonry crushes in analyses of the stones and in a shell of cells alone.",
    "planes": "The planes of the paper overrate the strength of the shell, so that their load factors are too large.",
}


def careful_first(analyses: Sequence[Analysis]) -> list[Analysis]:
    """Return records of analyses in an order in which, of those that answer one question, the careful one leads.

    That is the lowest load factor of those that are proved or converged. Load factors by planes of the paper, which are too
    large, lead only where there is nothing else; capacity curves of the stones, which tell what follows, come last.
    """
    return [record for records in _asked(analyses).values() for record in sorted(records, key=_carefulness)]


def _asked(analyses: Sequence[Analysis]) -> dict[tuple[str, ...], list[Analysis]]:
    found: dict[tuple[str, ...], list[Analysis]] = {}
    for record in analyses:
        found.setdefault(_question(record), []).append(record)
    return found


def _carefulness(record: Analysis) -> tuple[bool, bool, float]:
    # Equal to four digits is equal.
    factor = round(record.load_factor, 4) if record.stands else 0.0
    return not record.stands and record.status != "unstable", record.planes in OUTER, factor


def guidance(analyses: Sequence[Analysis], vaults: Mapping[str, Sequence[str]] | None = None) -> list[str]:
    """Return a sentence for each question that several analyses answer: which load factor to use, and why they differ.

    The careful one leads, as in `careful_first`. A sweep has one sentence for all its questions, besides those of load factors
    below zero, of stones that may come out, of lower states, of variants weaker without dilatancy alone, and of curves that
    start elsewhere. vaults: their names, of each geometry; where there are some, a sentence before the others tells of them.
    """
    asked = [[record for record in records if record.stands] for records in _asked(analyses).values()]
    # One that is below zero is told of even where it stands alone.
    several = [sorted(own, key=_carefulness) for own in asked if len(own) > 1 or any(_below(record) for record in own)]
    first = _of_vaults(asked, list(dict.fromkeys(name for names in (vaults or {}).values() for name in names)))
    below = [records for records in several if _below(records[0])]
    standing = [record for records in asked for record in records]
    first += [_below_zero(records) for records in below] + _of_lower_states(standing, LOOSE, "stones")
    several = [records for records in several if records not in below]
    sentences = [_advice(records) for records in several]
    if len(sentences) > 3:
        reasons = _reasons([record for records in several for record in records])
        sentences = [f"Of the load factors for one load and one strength use the lowest. Why they differ: {reasons}"]
    return first + sentences + _of_lower_states(standing, NEARLY, "states") + weaker_variants(analyses) + _of_curves(analyses)


def _of_vaults(asked: Sequence[Sequence[Analysis]], names: Sequence[str]) -> list[str]:
    if not names or not any(asked):
        return []
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    start = f"{', '.join(names[:3])}{more}: stones of vaults are held on all sides. An associative analysis wedges them as they "
    start += "slide (dilatancy), which is strength that no vault has. "
    lacking = [of[0].load for of in asked if of and all(record.flow != "non-associative" for record in of)]
    if not lacking:
        return [start + "Use the load factors without dilatancy (non-associative)."]
    loads = ", ".join(dict.fromkeys(lacking))
    return [f"{start}So the load factors of load {loads} are upper estimates, which may be far too large. {_ASK_FOR_IT}"]


def _advice(records: Sequence[Analysis]) -> str:
    first = records[0]
    least = f"{first.load_factor:z.4f}"
    alike = [record for record in records if f"{record.load_factor:z.4f}" == least]
    others = [f"{record.load_factor:z.4f} ({_kind(record)})" for record in records if record not in alike]
    start = f"{_load_words(first)}: use {least} ({'; '.join(map(_kind, alike))})"
    if not others:
        return f"{start}, in which all limit analyses agree."
    return f"{start}, the careful value, not {', '.join(others)}. Why they differ: {_reasons(records)}"


def _of_lower_states(analyses: Sequence[Analysis], mark: str, found: str) -> list[str]:
    """Return what analyses without dilatancy say of lower states that do not lead, by a mark, as sentences; found: such what."""
    sliding = (record for record in analyses if record.flow == "non-associative")
    said = [f"{_load_words(record)}: {part}." for record in sliding for part in record.message.split("; ") if mark in part]
    more = len(said) - _FEW_LINES
    rest = [f"{counted(more, 'other analysis', 'other analyses')} found such {found}."] if more > 0 else []
    return said[:_FEW_LINES] + rest


def _of_curves(analyses: Sequence[Analysis]) -> list[str]:
    """Return which capacity curves of the stones start above an analysis without dilatancy, or below all where there is none."""
    said: list[str] = []
    for records in _asked(analyses).values():
        known = [record for record in records if record.stands]
        curves = [one for one in records if one.method == "curve" and np.isfinite(one.load_factor)]
        sliding = [record for record in known if record.flow == "non-associative"]
        proved = [one.load_factor for one in curves if one.status in GOOD]
        if sliding and curves:
            least, most = min(sliding, key=_carefulness), max(one.load_factor for one in curves)
            if most > least.load_factor + _ABOVE * abs(least.load_factor):
                start = f"{_load_words(least)}: its capacity curve starts at {most:z.4f}, above {least.load_factor:z.4f} "
                said.append(f"{start}({_kind(least)}). {_OTHER_MOTION}")
        elif known and proved and min(proved) < min(record.load_factor for record in known) * (1 - _START):
            tied = " and begins with no more in its ties than their pretension" if any(one.tie_forces for one in known) else ""
            start = f"{_load_words(known[0])}: its capacity curve, which is without dilatancy{tied}, starts lower, at "
            said.append(f"{start}{min(proved):z.4f}. {_ASK_FOR_IT}")
    more = counted(len(said) - _FEW_LINES, "other curve starts", "other curves start")
    return said[:_FEW_LINES] + ([f"{more} lower or higher, too."] if len(said) > _FEW_LINES else [])


def _below_zero(records: Sequence[Analysis]) -> str:
    """Return what a load factor below zero means, as a sentence; the one that leads is one."""
    first = records[0]
    start = f"{_load_words(first)}: {first.load_factor:z.4f} ({_kind(first)}) is below zero, and no load factor of the building: "
    start += "in the state that was found stones fall under the dead load alone, before anything pushes. Only thrusts that need "
    start += "not be there can hold them, as over an opening with a flat head. Look at what moves: it needs a lintel, an arch or "
    start += "a tie."
    above = [f"{record.load_factor:z.4f} ({_kind(record)})" for record in records if not _below(record)]
    return f"{start} What the other analyses found takes these thrusts for granted: {', '.join(above)}." if above else start


def _below(record: Analysis) -> bool:
    # Nothing to four digits is nothing, as without any friction.
    return round(record.load_factor, 4) < 0


def _load_words(record: Analysis) -> str:
    start = f"{record.variant}, load {record.load}" if record.variant else f"Load {record.load}"
    return ", ".join([start, *(setting(key, value) for key, value in record.swept.items() if of_both(key))])


def _kind(record: Analysis) -> str:
    size = [f"{1e3 * record.element_size:g} mm"] if record.element_size else []
    # What a sweep changes in one model alone tells analyses apart that are of one kind.
    own = [setting(key, value) for key, value in record.swept.items() if not of_both(key) and key != MESH_SIZE]
    return ", ".join([record.model_words, record.kind, *size, *own])


def _reasons(records: Sequence[Analysis]) -> str:
    keys = {"shell" if record.of_shell else str(record.flow) for record in records}
    flows = {"associative", "non-associative"}
    if flows <= keys and len({f"{record.load_factor:z.4f}" for record in records if not record.of_shell}) == 1:
        # Stones that agree under both differ from the shell for other reasons.
        keys -= flows
    keys |= {"planes" for record in records if record.planes in OUTER}
    keys |= {"cohesion"} if any(record.of_shell and record.coheres for record in records) else set()
    keys |= {"torsion"} if len({record.contact_model for record in records if record.contact_model}) > 1 else set()
    keys |= {"crushing"} if len({record.crushes for record in records}) > 1 else set()
    return " ".join(reason for key, reason in _REASONS.items() if key in keys)


def contact_models(analyses: Sequence[Analysis]) -> list[ContactModels]:
    """Return the load factors of both contact models of a joint, where analyses ask for both; with a sentence where they are
    more than 3 % apart."""
    found: dict[tuple[str, ...], dict[str, Analysis]] = {}
    for record in analyses:
        if record.contact_model and record.stands:
            asked = (*_question(record), str(record.flow), str(record.compressive_strength))
            found.setdefault(asked, {})[record.contact_model] = record
    out: list[ContactModels] = []
    for both in found.values():
        if len(both) == 2 and (first := both["corners"]).load_factor > 0:
            second = both["torsion"]
            apart = second.load_factor / first.load_factor - 1
            factors, names = (first.load_factor, second.load_factor), (first.name, second.name)
            said = _APART if abs(apart) > _ALIKE else ""
            out.append(ContactModels(first.load, str(first.flow), *factors, apart, names, said, first.variant, first.swept))
    return out


# Load factors of both contact models that differ by no more than this share are alike.
_ALIKE = 0.03
_APART = (
    "Where friction acts in a joint matters to this mechanism, whose stones twist on each other: at the corners it resists up to "
    "1.85 times the torque that it resists under uniform pressure. Use the lower load factor."
)


def account_of_joints(found: Summary) -> list[str]:
    """Return in sentences what was decided about joints and what nearly meets, of each geometry of a summary."""
    lines = {name: joint_lines(one.near_misses, one.joints) for name, one in found.sizes.items()}
    return list(dict.fromkeys(f"{name}: {line}" if name else line for name, own in lines.items() for line in own))


def bad_news(found: Summary) -> list[Analysis | Movement | Match]:
    """Return the analyses without a result to rest on (unstable, not converged, failed), and the gates that failed."""
    records = [record for record in (*found.analyses, *found.movements) if record.status not in GOOD]
    return [*records, *(gate for gate in found.gates.values() if not gate.passed)]


def pairs(analyses: Sequence[Analysis]) -> list[Pair]:
    """Return the analyses of both models that answer the same question: stones, load and strength alike."""
    comparable = [record for record in analyses if record.method != "curve" and math.isfinite(record.load_factor)]
    found: list[Pair] = []
    for shell in (record for record in comparable if record.of_shell):
        for blocks in (record for record in comparable if not record.of_shell):
            if _question(blocks) == _question(shell):
                ratio = shell.load_factor / blocks.load_factor if blocks.load_factor > 0 else None
                found.append(Pair(shell.load, blocks.name, shell.name, ratio))
    return found


def _question(record: Analysis) -> tuple[str, ...]:
    """Return what an analysis asks, by either model: stones, load and strength."""
    shared = {key: value for key, value in record.swept.items() if of_both(key)}
    asked = (record.geometry, record.variant, record.load, record.friction, record.cohesion, record.joints, shared)
    return tuple(map(str, asked))


def stone_parts(stones: Assemblage, state: LimitState, load: LoadCase) -> dict[str, Any]:
    """Return the macro-elements of a mechanism of the stones ("parts") and its name; nothing where there are no two of them."""
    moving = moving_stones(stone_speed(stones, state.velocities))
    return _parts(stones.panel, stones.weight, state.velocities[:, :3], moving, load)


def shell_parts(shell: ShellModel, state: ShellLimitState, load: LoadCase) -> dict[str, Any]:
    """Return the same of a shell, whose bodies are its facets."""
    velocity = state.velocities[shell.triangles].mean(axis=1)
    moving = moving_stones(np.linalg.norm(state.velocities, axis=1)[shell.triangles].max(axis=1))
    return _parts(shell.panel, shell.surface_weight * shell.area, velocity, moving, load)


def _parts(panel: NameArray, weight: FloatArray, velocity: FloatArray, moving: BoolArray, load: LoadCase) -> dict[str, Any]:
    found = parts(panel, weight, velocity, moving, way_of(load))
    return {"parts": found, "mechanism": mechanism_name(found)} if len(found) > 1 else {}


def safety(
    stones: Assemblage,
    state: LimitState,
    load: LoadCase,
    site: Site | None,
    loads: PlacedLoads | None = None,
    *,
    crushing: bool = False,
) -> SafetyCheck:
    """Return the safety check of a mechanism, on all stones that move; its message says why the code has none for it, if so.

    site: None gives the acceleration that activates the mechanism, and nothing to compare it with. crushing: whether the masonry
    crushes in the analysis, so that the confidence factor is that of the knowledge level. loads: what the stones carry, whose
    masses are bodies of their own, as Q_k are in the circular. A structure that does not stand under its own weight withstands
    no earthquake: its index is zero.
    """
    asked = SafetyCheck(a_g=site.ground_acceleration) if site else SafetyCheck()
    if state.status == "unstable":
        fallen = replace(asked, message="the structure does not stand under its own weight")
        return replace(fallen, a_g_slv=0.0, zeta_e=0.0, satisfied=False) if site else fallen
    if state.status not in GOOD:
        return replace(asked, message="the analysis has no load factor")
    # Solvers take long to load, and the command line needs this module to tell results.
    from churchpipe.rigid_blocks.equilibrium import lateral_weight

    moving = moving_stones(stone_speed(stones, state.velocities)) & ~stones.fixed
    confidence = site.confidence(crushing) if site else CONFIDENCE_FACTOR
    try:
        weight, pushed = stones.weight[moving], lateral_weight(stones, load)[moving]
        displacement = along(load.direction, state.velocities)[moving]
        if loads is not None and loads.mass.any():
            more, masses = pushed_masses(load, stones, loads)
            on = moving[loads.stone]
            velocity = velocity_at(stones, state.velocities, loads.stone, loads.point)[on]
            weight = np.concatenate([weight, loads.mass[on]])
            pushed = np.concatenate([pushed + more[moving], masses[on]])
            displacement = np.concatenate([displacement, along(load.direction, velocity)])
        found = activation(state.load_factor, weight, pushed, displacement, confidence)
    except InputError as error:
        return replace(asked, message=str(error).removeprefix("check: "))
    found = replace(found, moving_stones=int(moving.sum()), begins=start_height(stones, moving))
    return verified(found, site) if site else found


def overlap(stones: Assemblage, velocities: FloatArray, shell: ShellModel, motion: FloatArray) -> float:
    """Return how far two mechanisms are the same: 1 when alike but for their size, 0 when they have nothing in common.

    The cosine of the velocities of the stones (nb, 6) at their centroids against those of the shell (nn, 3) at the same places,
    each weighed by the stone's weight. Stones whose panel the shell does not have are left out.
    """
    # Every stage imports this module, and one of them needs a tree of facets.
    from churchpipe.geometry.locate import facet_at

    moved = np.full((stones.count, 3), np.nan)
    for name in np.intersect1d(stones.panel[~stones.fixed], shell.panel):
        own = np.flatnonzero(~stones.fixed & (stones.panel == name))
        facet, _ = facet_at(shell, stones.centroid[own], str(name))
        share = _barycentric(shell.points[shell.triangles[facet]], stones.centroid[own])
        moved[own] = np.einsum("nk,nkc->nc", share, motion[shell.triangles[facet]])
    known = np.isfinite(moved).all(axis=1)
    weight = stones.weight[known, None]
    first, second = np.nan_to_num(velocities[known, :3]), moved[known]
    size = math.sqrt(float((weight * first**2).sum()) * float((weight * second**2).sum()))
    return float((weight * first * second).sum()) / size if size > 0 else math.nan


def _barycentric(corners: FloatArray, points: FloatArray) -> FloatArray:
    """Return the barycentric coordinates (n, 3) of points (n, 3) over the planes of triangles (n, 3, 3)."""
    one, two, place = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], points - corners[:, 0]
    gram = np.stack([np.stack([(u * v).sum(axis=1) for v in (one, two)], axis=1) for u in (one, two)], axis=1)
    side = np.stack([(u * place).sum(axis=1) for u in (one, two)], axis=1)
    share = np.linalg.solve(gram, side[:, :, None])[:, :, 0]
    return np.column_stack([1 - share.sum(axis=1), share])
