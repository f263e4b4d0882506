"""Where on a capacity curve a beam loses its seat."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LostSeat:
    """The joist that loses its seat first. step: of the capacity curve, between two of them a share."""

    joist: str
    step: float

    def said(self, displacement: float) -> str:
        """Return it as a sentence; displacement: m, of the oscillator of the check."""
        return f"Joist {self.joist} loses its seat at {1e3 * displacement:.3g} mm, beyond which neither limit state goes."
