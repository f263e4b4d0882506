"""The pictures that a notebook asks of a model or a result by a method.

They are drawn by `churchpipe.show` and `churchpipe.plot`, which need packages that models do without: the public names load them
when they are asked for.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from churchpipe.model.assemblage import Assemblage
    from churchpipe.model.block_curve import BlockCapacityCurve
    from churchpipe.model.contacts import Contacts
    from churchpipe.model.results import CapacityCurve, LimitState, ShellLimitState
    from churchpipe.model.settlement import SettlementPath
    from churchpipe.model.shell import ShellModel


def picture(
    model: "Assemblage | Contacts | ShellModel", state: "LimitState | ShellLimitState | CapacityCurve | None" = None
) -> Any:
    """Return what `churchpipe.show` draws of a model, and of its state if one is given."""
    import churchpipe

    return churchpipe.show(model, state)


def diagram(curve: "CapacityCurve | BlockCapacityCurve | SettlementPath") -> Any:
    """Return what `churchpipe.plot` draws of a curve."""
    import churchpipe

    return churchpipe.plot(curve)
