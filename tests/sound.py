"""Stones of a building, laid and checked."""

from churchpipe.model.assemblage import Assemblage
from churchpipe.model.building import Building
from churchpipe.model.contacts import Contacts
from churchpipe.stones.blocks import derive_blocks
from churchpipe.stones.contacts import find_contacts
from churchpipe.stones.soundness import check_soundness, unsupported_stones


def laid(building: Building) -> tuple[Assemblage, Contacts]:
    """The stones and contacts of a building; the volume identity, to 1e-9, is checked while laying."""
    stones = derive_blocks(building)
    contacts = find_contacts(stones)
    check_soundness(stones, contacts)
    assert not len(unsupported_stones(stones, contacts))
    return stones, contacts
