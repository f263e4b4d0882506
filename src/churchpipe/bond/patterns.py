"""The bond of a region, by the name of its pattern."""

from churchpipe.bond.field import Bond
from churchpipe.bond.header_stretcher import HeaderStretcherBond
from churchpipe.bond.running import RunningBond
from churchpipe.bond.single import SingleStone
from churchpipe.bond.stack import StackBond
from churchpipe.bond.voussoir import VoussoirRing
from churchpipe.errors import InputError
from churchpipe.model.building import BondRegion


def bond_of(region: BondRegion) -> Bond:
    """Return the bond of a region of a wall."""
    match region.pattern:
        case "running":
            cut = region.through_offset + region.cell.b / 2 if region.cut_offset is None else region.cut_offset
            return RunningBond(region.cell, region.joints, region.through_offset, cut)
        case "stack":
            return StackBond(region.cell, region.joints, region.through_offset)
        case "header-stretcher":
            cut = region.through_offset if region.cut_offset is None else region.cut_offset
            return HeaderStretcherBond(region.cell, region.joints, region.through_offset, cut, region.headers)
        case "single":
            return SingleStone(region.cell, region.outline)
        case "voussoir":
            if region.centre is None:
                raise InputError(f"BondRegion {region.name}.centre", "missing", expected="the centre (s, t) of the ring, m")
            return VoussoirRing(region.cell, region.outline, region.centre, region.pieces)


def stone_length(region: BondRegion, bay: float) -> float:
    """Return how long stones are laid in a clear bay, m: b, or with rule "bay" what divides it evenly. bay: its length, m."""
    bond = bond_of(region)
    in_courses = isinstance(bond, RunningBond | StackBond | HeaderStretcherBond)
    return bond.stone_length(bay) if in_courses else region.cell.b
