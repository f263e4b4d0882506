"""The stones of a case's building; what is wrong with them has the line of the file."""

from churchpipe.config.case import Case
from churchpipe.errors import InputError
from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.stones.blocks import derive_blocks


def laid_stones(case: Case, building: Building) -> Assemblage:
    """Return the stones of a building that a case has made, with its ring beams.

    Raises
    ------
    InputError: stones that cannot be laid, such as slivers beside an opening; with the line of its wall, or of [source].
    """
    try:
        return derive_blocks(building)
    except InputError as error:
        raise case.located(error) from error
