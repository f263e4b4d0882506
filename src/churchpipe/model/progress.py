"""What a long computation calls to say how far it has come."""

from collections.abc import Callable

# Called with what is being done, and the share of that which is done.
Progress = Callable[[str, float], None]
