"""What a case file may say: its tables, made of the dataclasses that keep what they say."""

from typing import Annotated, Any

from pydantic import Field, create_model

from churchpipe.code_check import Site
from churchpipe.config.analyses import MovementSettings, RigidSettings, ShellSettings
from churchpipe.config.carries import KINDS, MEANINGS
from churchpipe.config.distributions import SampleSettings
from churchpipe.config.project import Project
from churchpipe.config.published import Published
from churchpipe.config.section import Section, Table, Vector, gathered, steering, validated
from churchpipe.config.sources import check_source
from churchpipe.config.tables import table_of
from churchpipe.config.variants import Variant
from churchpipe.model.building import MOST_STONES
from churchpipe.model.buttress import Buttress
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import WRENCHES, LoadCase
from churchpipe.model.materials import Material
from churchpipe.model.quantities import MOST_COUNTED, declared
from churchpipe.model.ring_beam import RingBeam

# A name of a case, which is that of the folder of its run.
NAME_PATTERN = r"^\w[\w .+-]*$"
_Name = Annotated[str, Field(pattern=NAME_PATTERN, max_length=100)]
_MATERIAL = table_of(Material, "Material", without=("name",), may_lack=("unit_weight", "friction"))
_LOAD = table_of(
    LoadCase,
    "Load",
    without=("direction", *WRENCHES),
    direction=(Vector | None, Field(None, description=declared(LoadCase)["direction"].meaning)),
)
_RIGID, _SHELL = table_of(RigidSettings, "Rigid"), table_of(ShellSettings, "Shell")
_CHECK = table_of(Site, "Check")
_PUBLISHED, _VARIANT = table_of(Published, "Published"), table_of(Variant, "Variant")
_MOVEMENT, _SAMPLE = table_of(MovementSettings, "Movement"), table_of(SampleSettings, "Sample")
_PROJECT = table_of(Project, "Project")
_BUTTRESS = table_of(Buttress, "Buttress")
_RING_BEAM, _JOINTS = table_of(RingBeam, "RingBeam"), table_of(JointGroup, "Joints")
_CARRIED = {kind: table_of(kind, kind.__name__) for kind in KINDS.values()}


def _key(takes: Any, meaning: str, default: Any = None) -> Any:
    """Return a key of the whole file."""
    return takes, Field(default, description=meaning)


# One combination of the swept values of a file; [source] is checked apart, by its generator.
CaseTable = create_model(
    "CaseTable",
    __base__=Section,
    name=_key(_Name, "Of the run, for tables, pictures and folders; by default the name of the file.", ...),
    source=_key(dict[str, Any], "What the building is.", ...),
    material=_key(dict[str, _MATERIAL], "What stones and joints are made of, by name.", {}),
    joints=_key(list[_JOINTS], "Joints with a strength of their own, in place of that of their materials.", []),
    load=_key(list[_LOAD], "What pushes, each analysed by itself.", []),
    rigid=_key(_RIGID | None, "The rigid blocks."),
    shell=_key(_SHELL | None, "The homogenised shell; left out: the rigid blocks alone."),
    **{key: _key(list[_CARRIED[kind]], MEANINGS[key], []) for key, kind in KINDS.items()},
    buttresses=_key(list[_BUTTRESS], "Buttresses and pilasters of walls of a generator.", []),
    ring_beams=_key(list[_RING_BEAM], "Rigid beams on the tops of walls.", []),
    check=_key(_CHECK | None, "What the earthquake asks; left out: no safety check."),
    variants=_key(list[_VARIANT], "What else the building could be, beside the building as it is.", []),
    movements=_key(list[_MOVEMENT], "Supports that move, each analysed by itself.", []),
    sample=_key(_SAMPLE | None, "Parameters that are not known exactly."),
    published=_key(list[_PUBLISHED], "Load factors of others, for the report.", []),
    most_stones=_key(
        Annotated[int, Field(ge=1, le=MOST_COUNTED)], "A larger building is refused before any stone is laid.", MOST_STONES
    ),
    project=_key(_PROJECT | None, "The title block of the report."),
)


def check(table: Table, file: str) -> tuple[Table, Section]:
    """Return a case's table and its source, checked; the table by the keys that the file has.

    Raises
    ------
    InputError: everything that is wrong, each with its key; an unknown key with the nearest known one.
    """
    problems = list(steering(table, f"{file}: "))
    case = validated(CaseTable, table, "", file, problems)
    source = check_source(table["source"], file, problems) if isinstance(table.get("source"), dict) else None
    if problems or case is None or source is None:
        raise gathered(file, problems)
    return case.model_dump(exclude_unset=True), source
