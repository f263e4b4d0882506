"""The [check] table of a case: what the earthquake asks."""

from typing import Any

from churchpipe.code_check import Floor, Site
from churchpipe.config.schema import CheckTable
from churchpipe.config.units import in_si
from churchpipe.errors import InputError


def read_site(file: str, section: CheckTable) -> Site:
    """Return a [check] table in SI.

    Raises
    ------
    InputError: an acceleration that is missing or given twice, a mechanism above the building.
    """
    table = section.model_dump(exclude={"floor"})
    ground = _acceleration(f"{file}: check", table, "a_g_m_s2", "ag_g")
    floor = None
    if section.floor is not None:
        of_floor = section.floor.model_dump()
        spectral = _acceleration(f"{file}: check.floor", of_floor, "spectral_acceleration_m_s2", "spectral_acceleration_g")
        try:
            floor = Floor(**in_si(of_floor), spectral_acceleration=spectral)
        except InputError as error:
            raise InputError(f"{file}: check.floor", error.problem, found=error.found, expected=error.expected) from error
    return Site(ground, table["soil_factor"], table["q"], table["confidence_factor"], floor)


def _acceleration(place: str, table: dict[str, Any], *keys: str) -> float:
    """Take an acceleration, given once, by one of its keys, out of a table."""
    given = [value for key in keys for value in in_si({key: table.pop(key)}).values() if value is not None]
    if len(given) != 1:
        problem = "two values for one acceleration" if given else "missing key"
        raise InputError(place, problem, expected=f"either {' or '.join(keys)}")
    return given[0]
