"""A case: one source, materials, loads, analyses. Plain dataclasses, in SI."""

import copy
import re
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from churchpipe.bond.count import TOO_MANY, check_count
from churchpipe.code_check import Site
from churchpipe.config import overrides as changes
from churchpipe.config.analyses import MovementSettings, RigidSettings, ShellSettings
from churchpipe.config.carries import KINDS, Carries, placed, tried
from churchpipe.config.case_file import read_table
from churchpipe.config.complete import check_complete, checked_for, unknown_material
from churchpipe.config.distributions import SampleSettings, quantile
from churchpipe.config.places import located
from churchpipe.config.project import Project
from churchpipe.config.published import Published, check_published
from churchpipe.config.ready import farthest_number
from churchpipe.config.schema import NAME_PATTERN, check
from churchpipe.config.section import LETTERS, TWICE, UNKNOWN, GatheredError, Section, Table, nearest
from churchpipe.config.tables import record
from churchpipe.config.variants import Variant, variant_combinations, variants_of
from churchpipe.dxf.reading import AS_DRAWN, Reading
from churchpipe.errors import InputError
from churchpipe.model.arguments import path_of
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import MOST_STONES, Building
from churchpipe.model.buttress import Buttress
from churchpipe.model.contacts import TOLERANCES
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.quantities import in_si
from churchpipe.model.ring_beam import RingBeam
from churchpipe.resources import sample_case
from churchpipe.shell_mesh.element_count import check_elements, check_longest, element_count

_Record = TypeVar("_Record")


@dataclass(frozen=True, slots=True)
class Generated:
    """A building made by a generator: its name and its parameters, SI."""

    generator: str
    parameters: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing: its path, and how it is read."""

    path: Path
    reading: Reading = AS_DRAWN


@dataclass(frozen=True, slots=True)
class Case:
    """One building of a case file. `variant`: which of its variants, None for the building as it is; `swept`: the values under
    [sweep] that tell it from the others, by dotted key.

    shell: None for the rigid blocks alone. check: what the earthquake asks, None where the file does not say. movements: supports
    that move. published: load factors of others, for the report. sample: parameters that are not known exactly.
    most_stones: a building with more is refused before any is laid.

    `table` is the checked file, as it is written, without its sweep; overrides: what --set changed in it.
    """

    name: str
    path: Path
    source: Generated | Drawing
    materials: tuple[Material, ...]
    loads: tuple[LoadCase, ...]
    rigid: RigidSettings
    shell: ShellSettings | None = None
    check: Site | None = None
    movements: tuple[MovementSettings, ...] = ()
    published: tuple[Published, ...] = ()
    joints: tuple[JointGroup, ...] = ()
    buttresses: tuple[Buttress, ...] = ()
    ring_beams: tuple[RingBeam, ...] = ()
    carries: Carries = field(default_factory=Carries)
    project: Project = field(default_factory=Project)
    sample: SampleSettings | None = None
    most_stones: int = MOST_STONES
    variant: Variant | None = None
    swept: dict[str, Any] = field(default_factory=dict[str, Any])
    overrides: tuple[str, ...] = ()
    table: dict[str, Any] = field(default_factory=dict[str, Any])

    @property
    def tolerances(self) -> dict[str, float]:
        """The tolerances of joints that the case gives, as `churchpipe.find_contacts` takes them."""
        reading = self.source.reading if isinstance(self.source, Drawing) else AS_DRAWN
        return reading.tolerances({key: getattr(self.rigid, key) for key in TOLERANCES})

    def loose_ends(self) -> tuple[str, ...]:
        """Return what is to be said of walls of a house that may have been meant to meet; nothing of other sources."""
        if isinstance(self.source, Drawing) or self.source.generator != "house":
            return ()
        from churchpipe.generators.house import HouseParameters
        from churchpipe.generators.house_plan import loose_ends

        with suppress(InputError):  # Told, with its line, where the building is made.
            return tuple(loose_ends(HouseParameters(**self.source.parameters).layouts))
        return ()

    def storeys_above(self) -> dict[str, tuple[str, float]]:
        """Return of each wall that another storey of a house stands on its name and height, m; nothing of other sources."""
        if isinstance(self.source, Drawing) or self.source.generator != "house":
            return {}
        from churchpipe.generators.house import HouseParameters

        with suppress(InputError):  # Told, with its line, where the building is made.
            return HouseParameters(**self.source.parameters).storeys_above
        return {}

    def hanging(self) -> tuple[str, ...]:
        """Return what is to be said of masonry that hangs over rectangular openings; of a drawing its reader says it."""
        if isinstance(self.source, Drawing) or self.source.generator not in ("wall", "box", "house", "prototype"):
            return ()
        from churchpipe.recognition.overhangs import hanging

        with suppress(InputError):  # Told, with its line, where the building is made.
            return tuple(hanging(self.laid().panels))
        return ()

    def located(self, error: InputError) -> InputError:
        """Return an error about the building with the line of the file that it is about."""
        generator = self.source.generator if isinstance(self.source, Generated) else ""
        return located(error, self.path, self.overrides, generator, swept=self.swept, variant=self.variant)

    def laid(self) -> Building:
        """Generate the walls, vaults and beams, without a look at what they bear.

        Raises
        ------
        InputError: a drawing has stones, not a building; parameters that contradict each other; too many stones or elements.
        """
        if isinstance(self.source, Drawing):
            raise InputError(
                f"{self.path}: source",
                "a drawing gives stones, not a building",
                found=self.source.path.name,
                remedy="Read the stones with churchpipe.read_dxf.",
            )
        from churchpipe.generators import generate, with_buttresses

        try:
            building = generate(
                self.source.generator, self.source.parameters, self.materials, self.name, most_stones=self.most_stones
            )
            check_count(building)
        except InputError as error:
            if error.problem == TOO_MANY:
                error = _of_the_farthest_number(error, f"{self.path}: source", self.source)
            raise self.located(error) from error
        try:
            for number, buttress in enumerate(self.buttresses):
                building = tried(f"buttresses.{number}", partial(with_buttresses, building, [buttress]))
            building = replace(building, ring_beams=self.ring_beams)
            check_count(building)
        except InputError as error:
            raise self.located(error.at(f"{self.path}: {error.where}")) from error
        if self.shell is not None:
            try:
                check_longest(building.panels, self.shell.element_size)
                check_elements(element_count(building, self.shell.element_size), self.shell.element_size)
            except InputError as error:
                raise self.located(error.at(f"{self.path}: shell.element_size_mm")) from error
        return building

    def building(self) -> Building:
        """Generate the building, and look at what it bears.

        Raises
        ------
        InputError: as of `laid`; a load on walls that the building has not, or where they bear nothing.
        """
        building = self.laid()
        self.check_named(building.macro_elements)
        if self.carries or self.ring_beams or self.joints:
            from churchpipe.stones.blocks import derive_blocks

            try:
                stones = derive_blocks(replace(building, ring_beams=()))
            except InputError as error:
                raise self.located(error) from error
            self.check_applied(stones)
        return building

    def check_named(self, known: Sequence[str]) -> None:
        """Raise InputError for a load or a group of joints on walls that are not among the known ones."""
        named = [(f"load.{number}.panels", load.panels or ()) for number, load in enumerate(self.loads)]
        named += [(f"joints.{number}", group.named) for number, group in enumerate(self.joints)]
        for place, names in named:
            for name in {*names} - {*known}:
                where, expected = f"{self.path}: {place}", ", ".join(known)
                error = InputError(where, "no such panel", found=name, expected=expected, remedy=nearest(name, known))
                raise self.located(error)

    def check_applied(self, stones: Assemblage) -> None:
        """Raise InputError, with the table at fault, for beams, loads and ties that the stones cannot bear, and joints that they
        cannot have. stones: without the beams."""
        from churchpipe.stones.joints import check_group
        from churchpipe.stones.ring_beams import add_beams

        weights = {material.name: material.unit_weight for material in self.materials}
        try:
            for number in range(len(self.ring_beams)):
                beams = self.ring_beams[: number + 1]
                tried(f"ring_beams.{number}", lambda beams=beams: add_beams(stones, beams, weights))
            whole = add_beams(stones, self.ring_beams, weights)
            for number, group in enumerate(self.joints):
                tried(f"joints.{number}", partial(check_group, whole, group))
            if self.carries:
                placed(self.carries, whole)
        except InputError as error:
            raise self.located(error.at(f"{self.path}: {error.where}")) from error


def _of_the_farthest_number(error: InputError, where: str, source: Generated) -> InputError:
    """Return an error of a building that is far too large, with the number of its [source] that is to be looked at."""
    ready = cases_of(tomllib.loads(sample_case(source.generator)), Path(f"{source.generator}.toml"))[0].source
    key, words = farthest_number(source.parameters, ready.parameters if isinstance(ready, Generated) else {})
    found = f"{error.found}; {words} in the ready case {source.generator}" if words else error.found
    return InputError(f"{where}{key}", error.problem, found=found, expected=error.expected, remedy=error.remedy)


def read_case(path: str | Path, overrides: Sequence[str] = ()) -> Case:
    """Read a case file; of a file with a sweep, the first variant.

    Parameters
    ----------
    path
        The case file, TOML.
    overrides
        Changes "a.b.c=value" to keys of the file.

    Raises
    ------
    InputError
        Everything that is wrong with the file: key, found, expected, remedy.
    """
    return read_variants(path, overrides)[0]


def read_variants(path: str | Path, overrides: Sequence[str] = ()) -> tuple[Case, ...]:
    """Read a case file: one case for the building as it is and one for each variant, for each combination of swept values."""
    path = path_of("read_case: path", path)
    table = changes.apply_overrides(read_table(path), overrides)
    if "name" not in table and not re.match(NAME_PATTERN, path.stem):
        remedy = 'Give the case a name of its own, such as name = "nave" in its first line, or rename the file.'
        raise InputError(
            str(path), "a file's name that cannot be that of a run", found=path.stem, expected=LETTERS, remedy=remedy
        )
    table.setdefault("name", path.stem)
    cases = cases_of(table, path, overrides)
    if cases[0].sample:
        _check_sample(cases[0], cases[0].sample, table, overrides)
    return cases


def cases_of(
    table: dict[str, Any], path: Path, overrides: Sequence[str] = (), drawn: Mapping[str, Any] | None = None
) -> tuple[Case, ...]:
    """Return the cases of a file's table, as `read_variants` does; drawn: values that [sample] gives keys."""
    table, values = copy.deepcopy(table), dict(drawn or {})
    for key, value in values.items():
        changes.set_key(table, key, value)
    cases: list[Case] = []
    variant: Variant | None = None
    swept: dict[str, Any] = {}
    try:
        for changed, swept in changes.combinations(table):
            cases.append(_case(path, changed, swept, tuple(overrides)))
        swept = {}
        for number, variant in enumerate(variants_of(cases[0].table.get("variants", []))):
            for changed, swept in variant_combinations(table, number, variant):
                cases.append(replace(_case(path, changed, swept, tuple(overrides)), variant=variant))
                _check_source(cases[0], cases[-1], f"{path}: variants.{number}")
    except InputError as error:
        named = error if error.where.startswith(str(path)) else error.at(f"{path}: {error.where}")
        raise located(named, path, overrides, swept=swept, drawn=values, variant=variant) from error
    return tuple(cases)


# What is checked of a distribution: its median, and a least and a greatest value that one in a million is beyond.
_LOOKED_AT = np.array([0.5, 1e-6, 1 - 1e-6])
_NARROWER = "Bound it by low and high, or take a lognormal, uniform or beta distribution."
# What no load factor of a sample depends on.
_NOT_SAMPLED = ("name", "sample", "sweep", "project", "published", "movements", "most_stones")
_OF_VARIANTS = re.compile(r"variants\.\d+\.(name|remove|cost)\b")
_ANOTHER = "Not even its median is a value of the key: sample one that takes numbers with decimals, in its own range."


def _check_sample(case: Case, sample: SampleSettings, table: Table, overrides: Sequence[str]) -> None:
    """Raise InputError for a distribution that reaches what its key cannot be, and a key that is swept or changes no sample."""
    path, known = case.path, [material.name for material in case.materials]
    for number, parameter in enumerate(sample.parameters):
        place = f"{path}: sample.parameters.{number}"
        for key in parameter.key:
            table_of, *named = key.split(".")
            if table_of == "material" and named and named[0] not in known:
                raise located(unknown_material(f"{place}.key", named[0], known), path, overrides)
            twice = any(changes.overlap(key, other) for other in case.swept)
            if twice or table_of in _NOT_SAMPLED or _OF_VARIANTS.match(key):
                problem = "swept and sampled" if twice else "not to be sampled"
                raise located(InputError(f"{place}.key", problem, found=key, expected="another key"), path, overrides)
        for share, value in zip(_LOOKED_AT, quantile(parameter, _LOOKED_AT).tolist(), strict=True):
            try:
                cases_of(table, path, overrides, dict.fromkeys(parameter.key, value))
            except InputError as error:
                first = error.problems[0] if isinstance(error, GatheredError) else error
                remedy = first.remedy or ("" if first.problem == TWICE else _ANOTHER if share == 0.5 else _NARROWER)
                told = first if "[sample]" in first.where else located(first.at(f"{place}.key"), path, overrides)
                problem = first.problem if first.problem == UNKNOWN else f"its distribution reaches {value:.4g}: {first.problem}"
                raise InputError(told.where, problem, found=first.found, expected=first.expected, remedy=remedy) from error


def _check_source(first: Case, case: Case, where: str) -> None:
    """Raise InputError where a variant is of another drawing, or generated where the building as it is is drawn."""
    expected, found = (str(one.source.path) if isinstance(one.source, Drawing) else "a generator" for one in (first, case))
    if expected != found:
        problem, remedy = "another source than the building as it is", "Write a case of its own for it."
        raise InputError(where, problem, found=found, expected=expected, remedy=remedy)


def _case(path: Path, table: dict[str, Any], swept: dict[str, Any], overrides: tuple[str, ...]) -> Case:
    file = str(path)
    checked, source = check(table, file)
    check_complete(checked, file)
    materials = [record(Material, values, f"{file}: material.{name}", name=name) for name, values in checked["material"].items()]
    loads = _all(LoadCase, checked, "load", file)
    published = _all(Published, checked, "published", file)
    if len(set(names := [load.name for load in loads])) != len(names):
        raise InputError(f"{file}: load", "two loads of one name", found=", ".join(names), expected="a name of its own for each")
    check_published(file, published, names)
    beams, buttresses = _all(RingBeam, checked, "ring_beams", file), _all(Buttress, checked, "buttresses", file)
    for key, added in (("ring_beams", beams), ("buttresses", buttresses)):
        for number, one in enumerate(added):
            if one.material and one.material not in checked["material"]:
                raise unknown_material(f"{file}: {key}.{number}.material", one.material, checked["material"])
    called: list[str] = []
    bars = [(key, *numbered) for key in ("ties", "tie_candidates") for numbered in enumerate(checked.get(key, []))]
    for key, number, bar in bars:
        if (name := str(bar["name"])) in called:
            where = f"{file}: {key}.{number}.name"
            raise InputError(where, "two ties of one name", found=name, expected="a name of its own for each, candidates too")
        called.append(name)
    source = _source(path, source)
    if buttresses and isinstance(source, Drawing):
        remedy = "Draw them, or take a generator."
        raise InputError(f"{file}: buttresses.0", "a drawing gives stones, to which no buttress is bonded", remedy=remedy)
    movements = _all(MovementSettings, checked, "movements", file)
    if len(set(names := [movement.name for movement in movements])) != len(names):
        raise InputError(f"{file}: movements", "two movements of one name", found=", ".join(names), expected="a name each")
    return Case(
        name=checked["name"],
        path=path,
        source=source,
        materials=tuple(materials),
        loads=loads,
        rigid=record(RigidSettings, checked.get("rigid", {}), f"{file}: rigid"),
        shell=record(ShellSettings, checked["shell"], f"{file}: shell") if "shell" in checked else None,
        check=record(Site, checked["check"], f"{file}: check") if "check" in checked else None,
        movements=movements,
        published=published,
        joints=_all(JointGroup, checked, "joints", file),
        buttresses=buttresses,
        ring_beams=beams,
        sample=record(SampleSettings, checked["sample"], f"{file}: sample") if "sample" in checked else None,
        most_stones=checked.get("most_stones", MOST_STONES),
        carries=checked_for(loads, Carries(**{key: _all(kind, checked, key, file) for key, kind in KINDS.items()}), file),
        project=record(Project, checked.get("project", {}), f"{file}: project"),
        swept=swept,
        overrides=overrides,
        table=checked,
    )


def _all(kind: type[_Record], checked: Table, key: str, file: str) -> tuple[_Record, ...]:
    """Return the records of a list of tables."""
    return tuple(record(kind, table, f"{file}: {key}.{n}") for n, table in enumerate(checked.get(key, [])))


def _source(path: Path, source: Section) -> Generated | Drawing:
    table = source.model_dump(exclude_none=True)
    if "generator" in table:
        return Generated(table.pop("generator"), in_si(table))
    place = table.pop("dxf", None) or table.pop("file")
    return Drawing(path.parent / place, record(Reading, table, f"{path}: source"))
