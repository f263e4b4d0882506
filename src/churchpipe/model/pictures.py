"""The pictures that a notebook asks of a model or a result by a method.

They are drawn by `churchpipe.show` and `churchpipe.plot`, which need packages that models do without: the public names load them
when they are asked for.
"""

from typing import Any


def picture(model: Any, state: Any = None) -> Any:
    """Return what `churchpipe.show` draws of a model, and of its state if one is given."""
    import churchpipe

    return churchpipe.show(model, state)


def diagram(curve: Any) -> Any:
    """Return what `churchpipe.plot` draws of a curve."""
    import churchpipe

    return churchpipe.plot(curve)
