"""Settings of the stages, as `config.plan` writes them: SI. What reads them knows no case file, so that the code that reads
cases decides a stage through its settings alone."""

from collections.abc import Mapping, Sequence
from typing import Any

from churchpipe.code_check import Floor, Site
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.buttress import Buttress
from churchpipe.model.joint_group import JointGroup
from churchpipe.model.loads import LoadCase
from churchpipe.model.materials import Elastic, JointStrength, UnitWeight
from churchpipe.model.ring_beam import RingBeam
from churchpipe.spectrum import SiteSpectrum


def weights_of(settings: Mapping[str, Any]) -> list[UnitWeight]:
    """Return the unit weights of the materials of a geometry, in the order of the case."""
    return [UnitWeight(name, settings["unit_weight"][name]) for name in settings["materials"]]


def beams_of(settings: Mapping[str, Any]) -> list[RingBeam]:
    """Return the ring beams of a geometry."""
    return [RingBeam(**table) for table in settings.get("ring_beams", ())]


def buttresses_of(settings: Mapping[str, Any]) -> list[Buttress]:
    """Return the buttresses of a geometry."""
    return [Buttress(**table) for table in settings.get("buttresses", ())]


def joints_of(settings: Mapping[str, Any]) -> list[JointGroup]:
    """Return the joints of an analysis that have a strength of their own."""
    return [JointGroup(**table) for table in settings.get("joints", ())]


def load_of(settings: Mapping[str, Any]) -> LoadCase:
    """Return the load of an analysis."""
    return LoadCase(**settings["load"])


def strengths_of(settings: Mapping[str, Any]) -> list[JointStrength]:
    """Return what the joints of each material of an analysis bear."""
    return [
        JointStrength(name, **{**values, "elastic": Elastic(**values["elastic"]) if "elastic" in values else None})
        for name, values in settings["material"].items()
    ]


def used_by(stones: Assemblage, materials: Sequence[JointStrength]) -> list[JointStrength]:
    """Return the materials of the stones that are free."""
    return [material for material in materials if material.name in stones.material[~stones.fixed]]


def site_of(settings: Mapping[str, Any]) -> Site:
    """Return what the earthquake asks, from the fields of its `Site`."""
    floor, spectrum = settings["floor"], settings.get("spectrum")
    parts = {"floor": Floor(**floor) if floor else None, "spectrum": SiteSpectrum(**spectrum) if spectrum else None}
    return Site(**{**settings, **parts})
