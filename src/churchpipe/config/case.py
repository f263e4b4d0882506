"""A case: one source, materials, loads, analyses. Plain dataclasses, in SI."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from churchpipe.code_check import Site
from churchpipe.config import overrides as changes
from churchpipe.config.places import located
from churchpipe.config.published import Published, read_published
from churchpipe.config.schema import CaseTable, check
from churchpipe.config.section import Section, nearest
from churchpipe.config.site import read_site
from churchpipe.config.sources import DrawingSource, FileSource
from churchpipe.config.units import in_si
from churchpipe.dxf.reading import AS_DRAWN, Reading
from churchpipe.errors import InputError
from churchpipe.model.arguments import path_of
from churchpipe.model.building import Building
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, Material
from churchpipe.model.names import STRENGTH, Planes

Flow = Literal["associative", "non-associative"]
Method = Literal["limit", "pushover"]
Start = Literal["dead-load", "uniform", "associative"]


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
class CurveSettings:
    """The capacity curve of the stones: see `churchpipe.block_pushover`; lengths in m."""

    step: float | None = None
    steps: int = 400
    furthest: float | None = None
    control: tuple[float, ...] | None = None


@dataclass(frozen=True, slots=True)
class RigidSettings:
    """The rigid-block analyses: see `churchpipe.limit_analysis`; contact_gap, contact_angle, overlap: see
    `churchpipe.find_contacts`, None where the file does not say; curve: None where none is asked for."""

    flow: tuple[Flow, ...] = ("associative",)
    solver: str = "auto"
    method: Literal["default", "paper"] = "default"
    start: tuple[Start, ...] | None = None
    bipotential_gap: float = 1e-5
    contact_gap: float | None = None
    contact_angle: float | None = None
    overlap: float | None = None
    curve: CurveSettings | None = None


@dataclass(frozen=True, slots=True)
class ShellSettings:
    """The homogenised shell: see `churchpipe.derive_shell`, `shell_limit_analysis` and `pushover`.

    element_size: m. control_point: a node of the mesh, or a place (m) whose nearest node is taken; None: what moves most.
    """

    element_size: float
    planes: Planes = STRENGTH
    membrane: Literal["LST", "CST"] = "LST"
    analyses: tuple[Method, ...] = ("limit",)
    solver: str = "auto"
    control_point: int | tuple[float, ...] | None = None
    steps: int | None = None


@dataclass(frozen=True, slots=True)
class Case:
    """One variant of a case file. `variant`: the swept values that tell it from the others, by dotted key.

    shell: None for the rigid blocks alone. check: what the earthquake asks, None where the file does not say. published: load
    factors of others, for the report.

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
    published: tuple[Published, ...] = ()
    variant: dict[str, Any] = field(default_factory=dict)
    overrides: tuple[str, ...] = ()
    table: dict[str, Any] = field(default_factory=dict)

    def building(self) -> Building:
        """Generate the building.

        Raises
        ------
        InputError: a drawing has stones, not a building; parameters that contradict each other; a load on panels that it has not.
        """
        if isinstance(self.source, Drawing):
            raise InputError(
                f"{self.path}: source",
                "a drawing gives stones, not a building",
                found=self.source.path.name,
                remedy="Read the stones with churchpipe.read_dxf.",
            )
        from churchpipe.generators import generate

        try:
            building = generate(self.source.generator, self.source.parameters, self.materials, self.name)
        except InputError as error:
            raise located(error, self.path, self.overrides, self.source.generator, swept=self.variant) from error
        known = [name for panel in building.panels for name in (panel.name, *(part.name for part in panel.parts))]
        for number, load in enumerate(self.loads):
            for name in {*(load.panels or ())} - {*known}:
                where, expected = f"{self.path}: load.{number}.panels", ", ".join(known)
                error = InputError(where, "no such panel", found=name, expected=expected, remedy=nearest(name, known))
                raise located(error, self.path, self.overrides, swept=self.variant)
        return building


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
    """Read a case file and multiply it by its sweep: one case for each combination of the swept values."""
    path = path_of("read_case: path", path)
    table = changes.apply_overrides(read_table(path), overrides)
    table.setdefault("name", path.stem)
    cases: list[Case] = []
    variant: dict[str, Any] = {}
    try:
        for changed, variant in changes.variants(table):
            cases.append(_case(path, changed, variant, tuple(overrides)))
    except InputError as error:
        named = error if error.where.startswith(str(path)) else error.at(f"{path}: {error.where}")
        raise located(named, path, overrides, swept=variant) from error
    return tuple(cases)


def read_table(path: Path) -> dict[str, Any]:
    """Return a case file's table as it is written.

    Raises
    ------
    InputError: not a text file, not TOML.
    """
    try:
        if path.exists() and not path.is_file():
            # A pipe can be read once only.
            raise InputError(str(path), "not a file", found="a folder, a pipe or a device", expected="a case file")
        table = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(str(path), "cannot be read", found=error.strerror or error, expected="a case file") from error
    except UnicodeDecodeError as error:
        raise InputError(
            str(path),
            "not a text in UTF-8",
            found=f"{error.reason}, byte {error.start + 1}",
            expected="a case file in TOML",
            remedy="A text in another encoding (UTF-16, Latin-1) is to be saved as UTF-8.",
        ) from error
    except RecursionError as error:
        raise _too_deep(path) from error
    except ValueError as error:
        # TOMLDecodeError is one; a number of thousands of digits is refused by Python itself.
        remedy = "Text needs quotes; tables stand in [brackets]."
        if path.suffix.lower() != ".toml":
            remedy = "Of a drawing or a mesh, churchpipe import makes a case."
        raise InputError(str(path), "not TOML", found=error, remedy=remedy) from error
    if changes.depth(table) > changes.DEEPEST:
        raise _too_deep(path)
    return table


def _too_deep(path: Path) -> InputError:
    expected = f"a case file, at most {changes.DEEPEST} levels"
    return InputError(str(path), "not a case file", found="lists or tables too deep", expected=expected)


def _case(path: Path, table: dict[str, Any], variant: dict[str, Any], overrides: tuple[str, ...]) -> Case:
    file = str(path)
    checked, source = check(table, file)
    _check_complete(checked, file)
    rigid = checked.rigid
    loads = _loads(file, checked)
    return Case(
        name=checked.name,
        path=path,
        source=_source(path, source),
        materials=tuple(_material(file, name, section.model_dump()) for name, section in checked.material.items()),
        loads=loads,
        rigid=RigidSettings(
            flow=tuple(rigid.flow),
            solver=rigid.solver,
            method=rigid.method,
            start=tuple(rigid.start) if rigid.start else None,
            bipotential_gap=rigid.bipotential_gap,
            curve=CurveSettings(**in_si(rigid.curve.model_dump(exclude_none=True))) if rigid.curve else None,
            **in_si(rigid.model_dump(include={"contact_gap_mm", "contact_angle_deg", "overlap_mm"}, exclude_none=True)),
        ),
        shell=_shell(file, checked),
        check=read_site(file, checked.check) if checked.check else None,
        published=read_published(file, checked.published, [load.name for load in loads]),
        variant=variant,
        overrides=overrides,
        table=checked.model_dump(exclude_none=True) | {"source": source.model_dump(exclude_none=True)},
    )


def _check_complete(checked: CaseTable, file: str) -> None:
    """Name at once all that an imported drawing did not say: materials, their unit weight and friction, loads."""
    missing = [
        f"material.{name}.{key}"
        for name, section in checked.material.items()
        for key in ("unit_weight_kN_m3", "friction")
        if getattr(section, key) is None
    ]
    if not checked.material:
        missing += ["material.default.unit_weight_kN_m3", "material.default.friction"]
    if checked.shell and "pushover" in checked.shell.analyses:
        missing += [
            f"material.{name}.elastic (for the capacity curve)" for name, m in checked.material.items() if m.elastic is None
        ]
    if not checked.load:
        missing.append("load (a table [[load]] with its direction)")
    if missing:
        raise InputError(
            file,
            "missing keys",
            expected=", ".join(missing),
            remedy="Neither the file nor its drawing says them, and nothing is assumed.",
        )


def _source(path: Path, source: Section) -> Generated | Drawing:
    if isinstance(source, DrawingSource | FileSource):
        place = source.dxf if isinstance(source, DrawingSource) else source.file
        options = source.model_dump(exclude_none=True, exclude={"dxf", "file"})
        try:
            return Drawing(path.parent / place, Reading(**in_si(options)))
        except InputError as error:
            raise error.at(f"{path}: source.{error.where}") from error
    parameters = source.model_dump(exclude_none=True)
    return Generated(parameters.pop("generator"), in_si(parameters))


def _material(file: str, name: str, table: dict[str, Any]) -> Material:
    elastic = table.pop("elastic")
    si = in_si(table)
    try:
        return Material(name, si["unit_weight"], si["friction"], si["cohesion"], _elastic(in_si(elastic)) if elastic else None)
    except InputError as error:
        raise error.at(f"{file}: material.{name}.{error.where.rpartition(': ')[2]}") from error


def _elastic(si: dict[str, float]) -> Elastic:
    return Elastic(si["block_E"], si["block_nu"], si["joint_E"], si["joint_nu"], si["joint_thickness"])


def _shell(file: str, checked: CaseTable) -> ShellSettings | None:
    if checked.shell is None:
        return None
    table = checked.shell.model_dump(exclude_none=True)
    if "control_point" in table and "control_point_mm" in table:
        raise InputError(f"{file}: shell", "two control points", expected="control_point (a node) or control_point_mm (a place)")
    return ShellSettings(**in_si(table))


def _loads(file: str, checked: CaseTable) -> tuple[LoadCase, ...]:
    loads: list[LoadCase] = []
    for number, section in enumerate(checked.load):
        try:
            loads.append(LoadCase(**section.model_dump()))
        except InputError as error:
            raise InputError(f"{file}: load.{number}", error.problem, found=error.found, expected=error.expected) from error
    names = [load.name for load in loads]
    if len(set(names)) != len(names):
        raise InputError(f"{file}: load", "two loads of one name", found=", ".join(names), expected="a name of its own for each")
    return tuple(loads)
