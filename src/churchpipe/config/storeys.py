"""Which walls of a case's house another storey stands on."""

from typing import TYPE_CHECKING

from churchpipe.errors import InputError

if TYPE_CHECKING:
    from churchpipe.config.case import Case


def storeys_above(case: "Case") -> dict[str, tuple[str, float]]:
    """Return of each wall that another storey stands on the name of that, and the height at which it begins, m; none of sources
    other than a house."""
    from churchpipe.config.case import Drawing
    from churchpipe.generators.house import HouseParameters

    if isinstance(case.source, Drawing) or case.source.generator != "house":
        return {}
    try:
        walls = HouseParameters(**case.source.parameters).own_walls
    except InputError:
        return {}  # Told, with its line, where the building is made.
    return {
        below: (upper, storey.above)
        for wall in walls
        for below, upper, storey in zip(wall.names[:-1], wall.names[1:], wall.own_storeys, strict=True)
    }
