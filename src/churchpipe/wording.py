"""Numbers as text, and words that follow them."""


def counted(number: int, one: str, several: str = "") -> str:
    """Return a number and what it counts, with its verb where there is one.

    Parameters
    ----------
    one
        "stone moves", after 1.
    several
        "stones move", after any other number; by default `one` with an s.
    """
    return f"{number} {one if number == 1 else several or one + 's'}"


def four_figures(value: float) -> str:
    """Return a quantity to four figures, a large one in whole numbers and never as a power of ten: the weight of a church."""
    return f"{value:,.0f}" if abs(value) >= 999.95 else f"{value:.4g}"
