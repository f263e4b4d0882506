"""Questions about values that no masonry building has. They refuse nothing: a slip of a unit is found, a study goes on."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import is_dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from churchpipe.code_check import is_horizontal
from churchpipe.config.carries import KINDS, LOADS, plain
from churchpipe.config.distributions import quantile
from churchpipe.config.overrides import value_at
from churchpipe.config.soil_questions import of_soil
from churchpipe.model.doubts import question
from churchpipe.model.loads import LoadCase
from churchpipe.model.quantities import UNITS, Usual, declared, unit_of, written
from churchpipe.shell_mesh.element_count import element_count

if TYPE_CHECKING:
    from churchpipe.config.case import Case

# More is asked about before a run (docs/benchmarks_shell.md).
_ELEMENTS, _STEPS, _SAMPLES = 100_000, 5_000, 2_000

# Tables of a case whose texts name the materials that something is made of.
_MADE = ("source", "buttresses", "ring_beams", "variants")
# What one sample in a thousand is below, or above, is hardly drawn.
_HARDLY = np.array([1e-3, 1 - 1e-3])
_RECTANGLE = Usual(50.0, 100e3, "a pier of a model to half a church")
# Piers thinner than this many thicknesses of their groin vault are questioned.
_PIER = 2.0
_DILATANT_VAULT = (
    "A vault is analysed with joints that open as they slide, an upper estimate, up to twice the load factor that is "
    'safe: flow = "non-associative" in [rigid] gives the value to use. Is it left out on purpose?'
)
_NO_CURVE = (
    "check.spectrum is for the check by displacements, which follows the stones along a capacity curve, and the case asks for no "
    "curve: a table [rigid.curve] does, without any key. Is it left out on purpose?"
)


def questions(cases: Sequence["Case"]) -> list[str]:
    """Return what to ask about materials and site of a case's variants, each once."""
    asked = [text for case in cases for text in _of_case(case) if text]
    return list(dict.fromkeys((*asked, *_of_variants(cases), *_of_unused_materials(cases))))


def unanswered(asked: Sequence[str]) -> list[str]:
    """Return the questions without the one that is not asked beside results, whose guidance says it with their loads."""
    return [text for text in asked if text != _DILATANT_VAULT]


def work_questions(cases: Sequence["Case"]) -> list[str]:
    """Return what to ask before a run that would take days or all memory, each once."""
    return list(dict.fromkeys(text for case in cases for text in _of_work(case)))


def _of_variants(cases: Sequence["Case"]) -> Iterator[str]:
    """Yield what to ask about variants without a cost in which nothing is other than in the building as it is."""
    plain_tables = [{key: value for key, value in case.table.items() if key != "variants"} for case in cases]
    as_it_is = [table for case, table in zip(cases, plain_tables, strict=True) if case.variant is None]
    for case, table in zip(cases, plain_tables, strict=True):
        if case.variant and not case.variant.cost and table in as_it_is:
            yield f'The variant "{case.variant.name}" changes nothing: it is the building as it is. Is it meant?'


def _of_unused_materials(cases: Sequence["Case"]) -> Iterator[str]:
    """Yield what to ask about materials of a generated building of which nothing is made, in no variant of it."""
    generated = [case for case in cases if getattr(case.source, "generator", "")]
    named = {word for case in generated for key in _MADE for word in _words(case.table.get(key))}
    # What names no material is of the first one, or of the next where the first is a backfill.
    plain_ones = [next((m.name for m in case.materials if m.name != _backfill(case)), "") for case in generated]
    for name in dict.fromkeys(material.name for case in generated for material in case.materials):
        if name not in named and name not in plain_ones:
            yield f'Nothing is made of the material "{name}": what names no material is of "{plain_ones[0]}". Is it meant?'


def _backfill(case: "Case") -> str:
    given: dict[str, Any] = getattr(case.source, "parameters", {})
    return given.get("backfill", "")


def _words(value: Any) -> Iterator[str]:
    """Yield all texts in a value of a case file."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        inner = cast("Iterable[Any]", value.values() if isinstance(value, dict) else value)
        for one in inner:
            yield from _words(one)


def _of_case(case: "Case") -> Iterator[str]:
    for material in case.materials:
        yield from _of_record(material, f"material.{material.name}.")
    yield from _of_directions(case)
    yield from _of_weights(case)
    yield from _of_vaults(case)
    yield from of_soil(case)
    yield from (f"{said} Is it meant?" for said in (*case.loose_ends(), *case.hanging()))
    yield from _of_thrusts(case)
    yield from _of_storeys(case)
    yield from _of_beams(case)
    yield from _of_joints(case)
    yield from _of_movements(case)
    yield from _of_steps(case)
    yield from _of_published(case)
    yield from _of_sample(case)
    for name, settings in (("rigid", case.rigid), ("shell", case.shell), ("check", case.check)):
        if settings is not None:
            yield from _of_record(settings, f"{name}.")
    if case.check is not None and case.check.spectrum is not None and case.rigid.curve is None:
        yield _NO_CURVE
    if case.check is not None:
        yield from case.check.questions
    if case.shell is not None and "pushover" not in case.shell.analyses:
        for key, value in (("control_point", case.shell.control), ("steps", case.shell.steps)):
            if value is not None:
                yield f"shell.{key} is for the capacity curve of the shell, and analyses asks for no curve. Is it meant?"
    added = {"joints": case.joints, "buttresses": case.buttresses, "ring_beams": case.ring_beams}
    for key, records in (*added.items(), *((key, getattr(case.carries, key)) for key in KINDS)):
        told = [plain(record) for record in records]
        for number, record in enumerate(records):
            yield from _of_record(record, f"{key}.{number}.")
            if key in LOADS and told[number] in told[:number]:
                yield f"{key}.{number} is {key}.{told.index(told[number])} once more, and both count. Is it meant?"


def _of_directions(case: "Case") -> Iterator[str]:
    """Yield what to ask where an earthquake is checked that comes from one side only, or from none."""
    pushes = [load for load in case.loads if is_horizontal(load.direction)] if case.check is not None else []
    if case.check is not None and not pushes:
        yield "The check is of an earthquake, and no load pushes level, so that none is made. Is it left out on purpose?"
    lone = [load.name for load in pushes if not any(_opposite(load, other) for other in pushes)]
    if lone:
        ways = "direction" if len(lone) == 1 else "directions"
        yield (
            f"The check is made for {', '.join(lone)} and not for the opposite {ways}. An earthquake pushes both ways, and a "
            "building that is not symmetric may have a lower load factor the other way. Is it left out on purpose?"
        )


def _of_weights(case: "Case") -> Iterator[str]:
    """Yield what to ask about loads that only add to the weight of all stones, which no stones feel that do not crush."""
    crushing = any(material.compressive_strength is not None for material in case.materials)
    for load in case.loads if not crushing else ():
        down = load.direction[2] < 0 and not load.direction[:2].any()
        if down and load.panels is None and load.profile == "uniform":
            yield (
                f"The load {load.name} pushes straight down, as weight does: a building that stands bears any multiple of it as "
                'long as its stones do not crush, and the load factor is "no limit". Is a push sideways meant, such as [1, 0, 0]?'
            )


def _opposite(load: LoadCase, other: LoadCase) -> bool:
    alike = load.panels == other.panels and load.profile == other.profile
    return alike and np.allclose(other.direction[:2], -load.direction[:2])


def _of_thrusts(case: "Case") -> Iterator[str]:
    """Yield what to ask about loads that are given a side of their wall and nothing that acts towards it."""
    if any(key.startswith(LOADS) for key in case.swept):
        return
    for key in LOADS:
        for number, load in enumerate(getattr(case.carries, key)):
            sideways = getattr(load, "thrust", None), getattr(load, "eccentricity", None)
            if sideways == (0.0, 0.0) and load.toward is not None:
                yield (
                    f"{key}.{number}.toward says where a thrust or an eccentricity points, and the load has neither, so that it "
                    "changes nothing. Is it meant?"
                )


def _of_storeys(case: "Case") -> Iterator[str]:
    """Yield what to ask about loads in the middle of the top of a wall that an upper storey stands on: roofs lie higher up."""
    above = case.storeys_above()
    for key in LOADS if above else ():
        for number, load in enumerate(getattr(case.carries, key)):
            named = load.walls if hasattr(load, "walls") else (getattr(load, "wall", None),)
            aside = getattr(load, "bearing", 0.0) or getattr(load, "eccentricity", 0.0)
            below = [wall for wall in named if wall in above]
            if not below or aside or not hasattr(load, "height") or load.height is not None:
                continue
            upper, level = above[below[0]]
            yield (
                f"{key}.{number} lies on the top of {below[0]}, at {level:g} m, under the storey on it. A roof names the upper "
                f'storey, "{upper}"; a floor on the offset has its place there (bearing_m, eccentricity_m). Is it meant?'
            )


def _of_beams(case: "Case") -> Iterator[str]:
    """Yield what to ask about loads on the tops of walls that have a ring beam: they lie on the masonry, below the beam."""
    over = {wall: beam for beam in case.ring_beams for wall in beam.walls}
    for key in LOADS:
        for number, load in enumerate(getattr(case.carries, key)):
            named = (load.walls if hasattr(load, "walls") else (load.wall,)) if hasattr(load, "height") else ()
            below = [wall for wall in named if wall in over]
            if not below or load.height is not None:
                continue
            beam = over[below[0]]
            one = beam.closed or beam.slab
            name = beam.bodies[0 if one else beam.walls.index(below[0])]
            there = (
                "[[line_loads]] with between_m at the height of its top"
                if one
                else f'the name of the beam, "{name}", in place of that of the wall'
            )
            yield (
                f"{key}.{number} lies on the masonry of {below[0]}, below the ring beam there, and does not press the beam down. "
                f"Is it meant? Then give it a height_m. To lay it on the beam, write {there}."
            )


def _of_joints(case: "Case") -> Iterator[str]:
    """Yield what to ask about joints that the shell has no strength for: its analyses end without a load factor."""
    beams = {name for beam in case.ring_beams for name in beam.bodies}
    for number, group in enumerate(case.joints if case.shell is not None else ()):
        if group.kind is not None:
            what = f"of kind {group.kind}"
        elif group.between is not None and beams.isdisjoint(group.between):
            what = f"between {' and '.join(group.between)}"
        else:
            continue
        yield (
            f"joints.{number} are those {what}, and the shell has one strength for all joints of a place: it will have no load "
            "factor, the rigid blocks will. Is [shell] meant?"
        )


def _of_movements(case: "Case") -> Iterator[str]:
    """Yield what to ask about rectangles of ground that are narrower than a foundation, as those in metres are."""
    for number, movement in enumerate(case.movements):
        if movement.within is not None:
            side = 1e3 * float(np.ptp(movement.within, axis=0).min())
            yield question(f"the shorter side of movements.{number}.within_mm", side, _RECTANGLE, UNITS["_mm"])

        yield from _of_record(movement, f"movements.{number}.")


def _of_steps(case: "Case") -> Iterator[str]:
    """Yield what to ask about paths that end within their first step, as in another unit."""
    moved = [(f"movements.{number}", movement) for number, movement in enumerate(case.movements)]
    for place, path in [("rigid.curve", case.rigid.curve), *moved]:
        if path is not None and path.step is not None and path.furthest is not None and path.step > path.furthest:
            yield (
                f"{place}.step_mm is {1e3 * path.step:g}, and furthest_mm {1e3 * path.furthest:g}: the first step would go "
                "further than that. Is it meant?"
            )


def _of_published(case: "Case") -> Iterator[str]:
    """Yield what to ask about published values, in per cent, or of a model that the file does not ask for."""
    left_out = "shell" in case.table or any(re.match(r"shell\s*=", change) for change in case.overrides)
    for number, value in enumerate(case.published):
        yield from _of_record(value, f"published.{number}.")
        if value.model == "shell" and not left_out:
            yield (
                f"published.{number} is of a shell, and the case asks for none, so that nothing is set beside it: [shell] does. "
                "Is it left out on purpose?"
            )


def _of_sample(case: "Case") -> Iterator[str]:
    """Yield what to ask about samples that are never as the file says, or in one of a thousand."""
    # What a variant changes is not sampled in it, and of the rest the building as it is asks.
    for number, parameter in enumerate(case.sample.parameters if case.sample and case.variant is None else ()):
        hardly = quantile(parameter, _HARDLY).tolist()
        low, high = (
            rare if given is None else given for rare, given in zip(hardly, (parameter.low, parameter.high), strict=True)
        )
        for key in parameter.key:
            value = value_at(case.table, key)
            if isinstance(value, int | float) and not low * (1 - 1e-9) <= value <= high * (1 + 1e-9):
                yield (
                    f"sample.parameters.{number} draws {key} from {low:.4g} to {high:.4g}, and the case has {value:g}: no sample "
                    "is like it. Is it meant?"
                )


def _of_work(case: "Case") -> Iterator[str]:
    if case.shell is not None and hasattr(case.source, "generator"):
        size = case.shell.element_size
        count = element_count(case.laid(), size)
        if count > _ELEMENTS:
            yield (
                f"shell.element_size_mm is {1e3 * size:g}, which makes about {count:,.0f} elements. Of a church, 65,855 took "
                "2 GiB and two minutes of processor time for each load. Is it meant?"
            )
    moved = [(f"movements.{number}", movement) for number, movement in enumerate(case.movements)]
    for place, settings in [("rigid.curve", case.rigid.curve), ("shell", case.shell), *moved]:
        if settings is not None and (settings.steps or 0) > _STEPS:
            yield f"{place}.steps is {settings.steps:,}, each of them an analysis; usual are some hundreds. Is it meant?"
    if case.sample is not None and case.sample.number > _SAMPLES:
        yield (
            f"sample.number is {case.sample.number:,}, and each sample is all analyses of the case again; usual are 50 to "
            "1,000. Is it meant?"
        )


def _of_vaults(case: "Case") -> Iterator[str]:
    """Yield what to ask about vaults: where they mislead whoever meets them for the first time (docs/vaults.md)."""
    generator = getattr(case.source, "generator", "")
    given: dict[str, Any] = getattr(case.source, "parameters", {})
    if generator not in ("vault", "dome") and not given.get("vaults"):
        return
    if "non-associative" not in case.rigid.flow:
        yield _DILATANT_VAULT
    if given.get("plan") == "half" and given.get("front", "free") == "free":
        yield (
            "A half dome pushes outwards all round, and here nothing stands before it: it holds by friction along its rings "
            'alone. Is front = "wall" meant?'
        )
    pier = given.get("wall_thickness")
    if given.get("kind") == "groin" and pier is not None and pier < _PIER * given["thickness"]:
        yield (
            f"A groin vault {given['thickness']:g} m thick pushes piers {pier:g} m thick over: it falls under its own weight "
            "where they are no thicker than itself. Are thicker piers or ties meant?"
        )
    if case.shell is not None and generator == "dome" and "rise" in given:
        yield (
            "The shell of a low dome does not slide off the upper joints of its skewbacks, as its stones do: of both load "
            "factors the lower one is to be used. Is [shell] meant?"
        )
    if generator == "dome" and given.get("laid") == "lunes" and given.get("stone_sides", 2) > 1:
        turn = (1 if given.get("plan") == "half" else 2) * np.pi * given.get("stone_sides", 2) / given.get("sides", 32) / 2
        bow = given["span"] / 2 * (1 - np.cos(turn))
        yield (
            f"Stones of {given.get('stone_sides', 2)} sides are bowed in plan by {1e3 * bow:.3g} mm, which acts as additional "
            "thickness of their lunes. Is stone_sides = 1 meant?"
        )


def _of_record(record: Any, place: str) -> Iterator[str]:
    """Yield what to ask about the fields of a dataclass, and about those of dataclasses in it."""
    for item in declared(type(record)).values():
        value = getattr(record, item.name)
        if is_dataclass(value):
            yield from _of_record(value, f"{place}{item.key}.")
        elif item.quantity and item.quantity.usual and value is not None:
            for one in value if isinstance(value, tuple) else (value,):
                yield question(place + item.key, written(item.key, float(one)), item.quantity.usual, unit_of(item.key))
